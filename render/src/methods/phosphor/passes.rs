//! The passes: boxes around tiles, the tile of each pixel, a step of all states, what is seen of them.

use super::tile::Tiles;
use crate::raster::World;
use crate::raster::glow::Keeping;
use crate::raster::groups;
use crate::raster::light::shadow_sampler;
use crate::screen::{Device, GpuGBuffer, MethodStep, PassDispatch};
use deepshade_shaders::Attribute;
use deepshade_shaders::gpu::{self, GpuError};
use deepshade_shaders::wgsl::uniforms::{GlowLevel, GlowStretch};
use deepshade_shaders::wgsl::{Shader, TILE};

/// Tiles, or nodes, of a node of the tree.
const FAN: usize = 8;

/// The tiles of a scene on the GPU, and where each pixel's is written.
#[derive(Debug)]
pub struct Finding {
    tiles: wgpu::Buffer,
    owners: wgpu::Buffer,
    boxes: wgpu::Buffer,
    found: wgpu::Buffer,
    levels: Vec<GlowLevel>,
    texels: usize,
}

impl Finding {
    /// Those of a scene with so many texels along its diagonal, for images of the g-buffer's size.
    ///
    /// # Errors
    /// If the device has no room.
    pub fn new(device: &Device, world: &World, gbuffer: &GpuGBuffer, texels: u32) -> Result<Self, GpuError> {
        let all = Tiles::new(&world.animated(), &world.geometry.draws, texels);
        let levels = levels(all.tiles.len());
        let nodes: u32 = levels.iter().map(|level| level.nodes).sum();
        let pixels = gbuffer.height() * gbuffer.width();
        // A binding holds at least one.
        let (mut tiles, mut owners) = (all.tiles.clone(), all.owners(world.scene()));
        tiles.resize(tiles.len().max(1), bytemuck::Zeroable::zeroed());
        owners.resize(owners.len().max(world.glow.words().1 as usize), 0);
        Ok(Self {
            tiles: gpu::storage(device, "phosphor.tiles", &tiles)?,
            owners: gpu::storage(device, "phosphor.owners", &owners)?,
            boxes: gpu::empty::<[f32; 6]>(device, "phosphor.boxes", nodes as usize)?,
            found: gpu::empty::<[f32; 4]>(device, "phosphor.found", pixels)?,
            levels,
            texels: all.texels,
        })
    }

    /// How many texels there are.
    pub const fn texels(&self) -> usize {
        self.texels
    }

    /// Room for the states of all texels, `[2, texels, states]`: excited shares, and what rounding leaves of
    /// their changes.
    ///
    /// # Errors
    /// If the device has none.
    pub fn states(&self, device: &Device, world: &World) -> Result<wgpu::Buffer, GpuError> {
        gpu::empty::<f32>(device, "phosphor.states", 2 * self.texels.max(1) * world.glow.states())
    }

    /// The passes that fit the tree to the frame and find each pixel's tile; `view` is the camera's.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn steps(
        &self,
        device: &Device,
        world: &World,
        gbuffer: &GpuGBuffer,
        view: &wgpu::Buffer,
    ) -> Result<Vec<MethodStep>, GpuError> {
        let posed = &world.geometry.posed;
        let pass = |leaves: u32| {
            device.pass(Shader::at("methods/phosphor/fit"), &[("FAN", FAN as u32), ("LEAVES", leaves)])
        };
        let (leaves, parents) = (pass(1)?, pass(0)?);
        let mut steps = Vec::new();
        for (height, level) in self.levels.iter().enumerate() {
            let uniform = gpu::uniform(device, "phosphor.level", level)?;
            let buffers =
                [&uniform, &self.tiles, posed, &self.boxes].map(|buffer| buffer.as_entire_binding());
            let bound = if height == 0 { &leaves } else { &parents }.bind(device, &buffers)?;
            let workgroups = groups(level.nodes as usize).into();
            steps.push(MethodStep { step: PassDispatch { pass: bound, workgroups }, writes: Vec::new() });
        }
        steps.push(self.find(device, world, gbuffer, view)?);
        Ok(steps)
    }

    fn find(
        &self,
        device: &Device,
        world: &World,
        gbuffer: &GpuGBuffer,
        view: &wgpu::Buffer,
    ) -> Result<MethodStep, GpuError> {
        let tiles = self.levels[0].children;
        let constants = [("FAN", FAN as u32), ("LEVELS", self.levels.len() as u32), ("TILES", tiles)];
        let pass = device.pass(Shader::at("methods/phosphor/find"), &constants)?;
        let levels: Vec<[u32; 4]> =
            self.levels.iter().map(|level| [level.first, level.nodes, 0, 0]).collect();
        let levels = gpu::uniforms(device, "phosphor.levels", &levels)?;
        let [valid, position, object] =
            [Attribute::Valid, Attribute::Position, Attribute::ObjectId].map(|a| gbuffer.buffer(a));
        let posed = &world.geometry.posed;
        let buffers = [view, &levels, &self.tiles, posed, &self.boxes, valid, position, object, &self.found];
        let pass = pass.bind(device, &buffers.map(|buffer| buffer.as_entire_binding()))?;
        let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE).into();
        Ok(MethodStep { step: PassDispatch { pass, workgroups }, writes: Vec::new() })
    }

    /// What keeps light, with its states, which move on by so many steps of Euler's scheme, or exactly.
    pub fn keeping<'a>(&'a self, states: &'a wgpu::Buffer, euler: u32) -> Keeping<'a> {
        Keeping {
            euler,
            shaders: [Shader::at("methods/phosphor/step"), Shader::at("methods/phosphor/step_dimmed")],
            keepers: [&self.tiles, &self.owners],
            count: self.texels,
            states,
        }
    }

    /// The pass that shows states.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn show(
        &self,
        device: &Device,
        world: &World,
        states: &wgpu::Buffer,
        image: &wgpu::Buffer,
    ) -> Result<MethodStep, GpuError> {
        let glow = &world.glow;
        let constants = [("STATES", glow.states() as u32), glow.paint_states(), glow.words()];
        let pass = device.pass(Shader::at("methods/phosphor/show"), &constants)?;
        let pixels = (self.found.size() / 16) as usize;
        let reads = [&glow.paints, &self.tiles, &self.owners, &self.found, states];
        MethodStep::bind(device, &pass, groups(pixels), &reads, &[image])
    }

    /// The passes that look back over a stretch of the past, in which the world was like this, each with some
    /// of the samples that `settings` say. The first `adds` to the image, or begins it.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn look_back(
        &self,
        device: &Device,
        world: &World,
        gbuffer: &GpuGBuffer,
        ([since, until], samples, adds): ([f32; 2], u32, bool),
        [settings, image]: [&wgpu::Buffer; 2],
    ) -> Result<Vec<MethodStep>, GpuError> {
        let glow = &world.glow;
        let at_once = glow.samples_at_once(world.scene().medium.is_some());
        let (shader, constants) = world.dimmed([
            Shader::at("methods/phosphor/glassner"),
            Shader::at("methods/phosphor/glassner_dimmed"),
        ]);
        let pass = device.pass(shader, &constants)?;
        let sampler = shadow_sampler(device);
        let own = [settings, &glow.paints, &self.tiles, &world.geometry.posed, &self.found, &glow.past];
        let own = own.map(|buffer| buffer.as_entire_binding()).into_iter();
        let mut resources: Vec<_> = (0..).zip(own.chain(world.lamps(&sampler))).collect();
        resources.extend((11..).zip(world.dimming()));
        resources.push((13, image.as_entire_binding()));
        let step = |first: u32| {
            let (adds, count) = (u32::from(adds || first > 0), at_once.min(samples - first));
            let stretch = GlowStretch { since, until, adds, first, count };
            let stretch = gpu::uniform(device, "phosphor.stretch", &stretch)?;
            let stretch = [(14, stretch.as_entire_binding())];
            let pass = pass.bind_at(device, resources.iter().cloned().chain(stretch))?;
            let workgroups = gpu::groups(gbuffer.height(), gbuffer.width(), TILE).into();
            Ok(MethodStep { step: PassDispatch { pass, workgroups }, writes: Vec::new() })
        };
        let firsts = (0..samples).step_by(at_once as usize);
        let mut steps = firsts.map(step).collect::<Result<Vec<_>, GpuError>>()?;
        if let Some(last) = steps.last_mut() {
            last.writes.push(image.clone());
        }
        Ok(steps)
    }
}

/// The tree over so many tiles, leaves first, up to a single node.
fn levels(tiles: usize) -> Vec<GlowLevel> {
    let mut levels: Vec<GlowLevel> = Vec::new();
    let (mut children, mut first, mut first_child) = (tiles as u32, 0, 0);
    loop {
        let nodes = children.div_ceil(FAN as u32).max(1);
        levels.push(GlowLevel { nodes, children, first, first_child });
        if nodes == 1 {
            return levels;
        }
        (first_child, first, children) = (first, first + nodes, nodes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_ends_in_one_node() {
        let shape = |tiles| -> Vec<[u32; 4]> {
            let level = |l: &GlowLevel| [l.nodes, l.children, l.first, l.first_child];
            levels(tiles).iter().map(level).collect()
        };
        assert_eq!(shape(0), [[1, 0, 0, 0]]);
        assert_eq!(shape(8), [[1, 8, 0, 0]]);
        assert_eq!(shape(65), [[9, 65, 0, 0], [2, 9, 9, 0], [1, 2, 11, 9]]);
    }
}
