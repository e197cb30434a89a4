//! The passes of [`crate::filter`] on a device: the pyramid of the light, which is that of the whole image, and what a tile
//! keeps of the image, gathered from it by the kernels that the tile's last convolution has left.

use super::io;
use super::recording::Told;
use super::tiles::Tile;
use super::{ForwardError, Input, InputKind, Options, Output};
use crate::NetSpec;
use deepshade_shaders::gpu::{self, BoundPass, GpuError, Pass};
use deepshade_shaders::wgsl::convolution::{Reading, Writing};
use deepshade_shaders::wgsl::filter::Filter;
use deepshade_shaders::wgsl::{TILE, uniforms::NetLayer};
use wgpu::{Buffer, Device};

/// The compiled passes of a network.
#[derive(Clone, Debug)]
pub struct Passes {
    filter: Filter,
    /// Channels of the network's input.
    inputs: u32,
    light: Pass,
    /// Of levels 1, 2, ...
    halve: Vec<Pass>,
    gather: Pass,
}

/// What they work on, for images of one size.
#[derive(Debug)]
pub struct Room {
    /// What the last convolution makes of a tile, planar `[weights, rows, columns]` of what the tile keeps.
    pub kernels: Buffer,
    /// The light, level after level.
    pyramid: Buffer,
    size: [usize; 2],
    frame: [usize; 2],
}

/// A pass with how many workgroups of it run.
type Bound = (BoundPass, [u32; 3]);

/// The passes of a network's filter; none where it makes its image itself.
pub fn of(spec: &NetSpec) -> Option<Filter> {
    let crate::Filter { levels, kernel, black } = spec.filter?;
    let first = spec.light_channels().first().copied()?;
    let [levels, kernel, channels, first] =
        [levels, kernel, spec.output_channels(), first].map(|number| number as u32);
    Some(Filter { levels, kernel, black, channels, first })
}

impl Passes {
    /// Compiles them; none where a network makes its image itself.
    pub fn new(device: &Device, spec: &NetSpec, options: &Options<'_>) -> Result<Option<Self>, ForwardError> {
        let Some(filter) = of(spec) else { return Ok(None) };
        let pass =
            |name: &str, source: String| Pass::cached(device, &format!("net.{name}"), &source, options.cache);
        let reading = match options.input {
            InputKind::Buffer => Reading::Planes,
            InputKind::Textures => Reading::Textures(io::texture_channels(spec)),
        };
        let writing = options.output.format(spec)?.map_or(Writing::Planes, Writing::Texture);
        let halve = (1..filter.levels).map(|level| pass("halve", filter.halve(level)));
        Ok(Some(Self {
            filter,
            inputs: spec.input_channels() as u32,
            light: pass("light", filter.light(&reading))?,
            halve: halve.collect::<Result<_, _>>()?,
            gather: pass("gather", filter.gather(writing))?,
        }))
    }

    /// Room for images of `[height, width]` whose kernels are in a buffer.
    pub fn room(
        &self,
        device: &Device,
        spec: &NetSpec,
        size: [usize; 2],
        kernels: Buffer,
    ) -> Result<Room, GpuError> {
        let frame = size.map(|size| size.next_multiple_of(spec.alignment()));
        let pyramid = gpu::empty::<f32>(device, "net.pyramid", self.filter.pyramid_numbers(frame))?;
        Ok(Room { kernels, pyramid, size, frame })
    }

    /// The passes that make the pyramid of `input`, and what the first of them is told.
    pub fn bind_pyramid(
        &self,
        device: &Device,
        room: &Room,
        input: Input<'_>,
    ) -> Result<(Vec<Bound>, Told), GpuError> {
        let workgroups = |level: usize| {
            let [height, width] = room.frame.map(|size| size >> level);
            gpu::groups(height, width, TILE)
        };
        let (light, told) = self.bind_light(device, room, input)?;
        let mut bound = vec![(light, workgroups(0))];
        for (level, pass) in (1..).zip(&self.halve) {
            let uniform = gpu::uniform(device, "net.halve", &room.uniform(level))?;
            let resources = [(0, uniform.as_entire_binding()), (3, room.pyramid.as_entire_binding())];
            bound.push((pass.bind_at(device, resources)?, workgroups(level)));
        }
        Ok((bound, told))
    }

    /// The pass that makes what a tile keeps of the image.
    pub fn bind_gather(
        &self,
        device: &Device,
        room: &Room,
        tile: &Tile,
        output: Output<'_>,
    ) -> Result<Bound, GpuError> {
        let uniform = gpu::uniform(device, "net.gather", &tile.placed(room.uniform(0)))?;
        let [uniform, kernels, pyramid] =
            [&uniform, &room.kernels, &room.pyramid].map(Buffer::as_entire_binding);
        let gather = self.gather.bind(device, &[uniform, kernels, pyramid, output.binding()])?;
        let [rows, columns] = &tile.keep;
        Ok((gather, gpu::groups(rows.len(), columns.len(), TILE)))
    }

    fn bind_light(
        &self,
        device: &Device,
        room: &Room,
        input: Input<'_>,
    ) -> Result<(BoundPass, Told), GpuError> {
        let told =
            Told::new(device, "net.light", input, NetLayer { channels: self.inputs, ..room.uniform(0) })?;
        let mut resources = vec![(0, told.binding()), (3, room.pyramid.as_entire_binding())];
        resources.extend(input.bindings());
        Ok((self.light.bind_at(device, resources)?, told))
    }

    /// Bytes of the kernels of a tile whose frame has that size, and of the pyramid of a whole image.
    pub fn bytes(&self, spec: &NetSpec, tile: [usize; 2], image: [usize; 2]) -> [u64; 2] {
        let image = image.map(|size| size.next_multiple_of(spec.alignment()));
        let kernels = spec.last_channels() * tile[0] * tile[1];
        [kernels, self.filter.pyramid_numbers(image)].map(|numbers| (numbers * size_of::<f32>()) as u64)
    }
}

impl Room {
    /// All bytes.
    pub fn bytes(&self) -> u64 {
        self.kernels.size() + self.pyramid.size()
    }

    /// What a pass on a level is told.
    fn uniform(&self, level: usize) -> NetLayer {
        let [height, width] = self.frame.map(|size| (size >> level) as u32);
        let [image_height, image_width] = self.size.map(|size| size as u32);
        NetLayer { width, height, image_width, image_height, ..bytemuck::Zeroable::zeroed() }
    }
}
