//! The passes of a [`crate::Head`] on a device: the pyramid of what it works on, which is that of the whole
//! image, and what a tile keeps of the image, made of it by what the tile's last block has left.

use super::io;
use super::recording::TileUniform;
use super::tiles::Tile;
use super::{ForwardError, Input, InputKind, Options, Output};
use crate::{NetSpec, spec};
use deepshade_shaders::gpu::{self, BoundPass, GpuError, Pass};
use deepshade_shaders::wgsl::convolution::{Reading, Writing};
use deepshade_shaders::wgsl::head::{Head, HeadKind};
use deepshade_shaders::wgsl::{TILE, uniforms::NetLayer};
use wgpu::{Buffer, Device};

/// The compiled passes of a network.
#[derive(Clone, Debug)]
pub struct Passes {
    head: Head,
    /// Channels of the network's input.
    inputs: u32,
    /// Writes the estimate and level 0.
    light: Option<Pass>,
    /// Of levels 1, 2, ...
    halve: Vec<Pass>,
    image: Pass,
}

/// What they work on, for images of one size.
#[derive(Debug)]
pub struct HeadBuffers {
    /// What the last block makes of a tile, planar, of the tile's frame on the block's level.
    pub kernels: Buffer,
    /// The estimate, and level after level.
    pyramid: Option<Buffer>,
    size: [usize; 2],
    frame: [usize; 2],
    /// Rows and columns of `kernels`.
    tile: [usize; 2],
}

/// A pass with how many workgroups of it run.
type Bound = (BoundPass, [u32; 3]);

/// The passes of a network's head; none where its last block makes the image.
pub fn of(spec: &NetSpec) -> Option<Head> {
    let square = 1 << spec.last_level();
    let channels = spec.output_channels() as u32;
    let first = |channels: Vec<usize>| channels.first().map_or(0, |first| *first as u32);
    let (kind, crate::Filter { levels, kernel, .. }) = match spec.head {
        spec::Head::Image if square == 1 => return None,
        spec::Head::Image => (HeadKind::Unfold, crate::Filter { levels: 0, kernel: 1, black: false }),
        spec::Head::Filter(filter) => (HeadKind::Filter { black: filter.black }, filter),
        spec::Head::Correction(correction) => {
            let estimate = first(spec.channels_of(correction.of));
            let half_gate = correction.gated.then_some(spec::HALF_GATE);
            let (gain, range) = (correction.gain, spec.effect.range());
            let kind = HeadKind::Correction { estimate, gain, half_gate, range };
            (kind, correction.filter())
        }
    };
    let [levels, kernel] = [levels, kernel].map(|number| number as u32);
    Some(Head { kind, levels, kernel, channels, first: first(spec.pyramid_channels()), square })
}

impl Passes {
    /// Compiles them; none where a network makes its image itself.
    pub fn new(device: &Device, spec: &NetSpec, options: &Options<'_>) -> Result<Option<Self>, ForwardError> {
        let Some(head) = of(spec) else { return Ok(None) };
        let pass =
            |name: &str, source: String| Pass::cached(device, &format!("net.{name}"), &source, options.cache);
        let reading = match options.input {
            InputKind::Buffer => Reading::Planes,
            InputKind::Textures => Reading::Textures(io::texture_channels(spec)),
        };
        let writing = options.output.format(spec)?.map_or(Writing::Planes, Writing::Texture);
        let halve = (1..head.levels).map(|level| pass("halve", head.halve(level)));
        Ok(Some(Self {
            head,
            inputs: spec.input_channels() as u32,
            light: head.has_pyramid().then(|| pass("light", head.light(&reading))).transpose()?,
            halve: halve.collect::<Result<_, _>>()?,
            image: pass("image", head.image(writing))?,
        }))
    }

    /// Room for images of `[height, width]` in tiles of a frame, each `[rows, columns]`.
    pub fn buffers(
        &self,
        device: &Device,
        spec: &NetSpec,
        size: [usize; 2],
        tile: [usize; 2],
    ) -> Result<HeadBuffers, GpuError> {
        let frame = size.map(|size| size.next_multiple_of(spec.alignment()));
        let tile = tile.map(|size| size >> spec.last_level());
        let kernels = gpu::empty::<f32>(device, "net.kernels", spec.last_channels() * tile[0] * tile[1])?;
        let numbers = self.head.pyramid_numbers(frame);
        let pyramid = (numbers > 0).then(|| gpu::empty::<f32>(device, "net.pyramid", numbers)).transpose()?;
        Ok(HeadBuffers { kernels, pyramid, size, frame, tile })
    }

    /// The passes that make the pyramid of `input`, and what the first of them is told.
    pub fn bind_pyramid(
        &self,
        device: &Device,
        buffers: &HeadBuffers,
        input: Input<'_>,
    ) -> Result<(Vec<Bound>, Option<TileUniform>), GpuError> {
        let (Some(light), Some(pyramid)) = (&self.light, &buffers.pyramid) else {
            return Ok((Vec::new(), None));
        };
        let workgroups = |level: usize| {
            let [height, width] = buffers.frame.map(|size| size >> level);
            gpu::groups(height, width, TILE)
        };
        let (light, told) = self.bind_light(device, light, pyramid, buffers, input)?;
        let mut bound = vec![(light, workgroups(0))];
        for (level, pass) in (1..).zip(&self.halve) {
            let uniform = gpu::uniform(device, "net.halve", &buffers.uniform(level))?;
            let resources = [(0, uniform.as_entire_binding()), (3, pyramid.as_entire_binding())];
            bound.push((pass.bind_at(device, resources)?, workgroups(level)));
        }
        Ok((bound, Some(told)))
    }

    /// The pass that makes what a tile keeps of the image.
    pub fn bind_image(
        &self,
        device: &Device,
        buffers: &HeadBuffers,
        tile: &Tile,
        output: Output<'_>,
    ) -> Result<Bound, GpuError> {
        let [channels, stride] = buffers.tile.map(|size| size as u32);
        let told = NetLayer { channels, stride, ..tile.placed(buffers.uniform(0)) };
        let uniform = gpu::uniform(device, "net.image", &told)?;
        let mut resources = vec![(0, uniform.as_entire_binding()), (1, buffers.kernels.as_entire_binding())];
        resources.extend(buffers.pyramid.iter().map(|pyramid| (2, pyramid.as_entire_binding())));
        resources.push((3, output.binding()));
        let image = self.image.bind_at(device, resources)?;
        let [rows, columns] = &tile.keep;
        Ok((image, gpu::groups(rows.len(), columns.len(), TILE)))
    }

    fn bind_light(
        &self,
        device: &Device,
        light: &Pass,
        pyramid: &Buffer,
        buffers: &HeadBuffers,
        input: Input<'_>,
    ) -> Result<(BoundPass, TileUniform), GpuError> {
        let told = TileUniform::new(
            device,
            "net.light",
            input,
            NetLayer { channels: self.inputs, ..buffers.uniform(0) },
        )?;
        let mut resources = vec![(0, told.binding()), (3, pyramid.as_entire_binding())];
        resources.extend(input.bindings());
        Ok((light.bind_at(device, resources)?, told))
    }

    /// Bytes of the kernels of a tile whose frame has that size, and of the pyramid of a whole image.
    pub fn bytes(&self, spec: &NetSpec, tile: [usize; 2], image: [usize; 2]) -> [u64; 2] {
        let image = image.map(|size| size.next_multiple_of(spec.alignment()));
        let tile = tile.map(|size| size >> spec.last_level());
        let kernels = spec.last_channels() * tile[0] * tile[1];
        [kernels, self.head.pyramid_numbers(image)].map(|numbers| (numbers * size_of::<f32>()) as u64)
    }
}

impl HeadBuffers {
    /// All bytes.
    pub fn bytes(&self) -> u64 {
        self.kernels.size() + self.pyramid.as_ref().map_or(0, Buffer::size)
    }

    /// What a pass on a level is told.
    fn uniform(&self, level: usize) -> NetLayer {
        let [height, width] = self.frame.map(|size| (size >> level) as u32);
        let [image_height, image_width] = self.size.map(|size| size as u32);
        NetLayer { width, height, image_width, image_height, ..bytemuck::Zeroable::zeroed() }
    }
}
