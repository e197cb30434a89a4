//! The passes of [`crate::filter`] on a device: the pyramid of the light, and the image that is gathered from it by the
//! kernels that the last convolution has left. They run on the whole image once all its tiles are made.

use super::io;
use super::{ForwardError, Input, InputKind, Options, Output};
use crate::{NetSpec, Scaling};
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
    /// What the last convolution makes, planar `[taps, height, width]`.
    pub kernels: Buffer,
    /// The light, level after level.
    pyramid: Buffer,
    size: [usize; 2],
    frame: [usize; 2],
}

/// The passes of a network's filter; none where it makes its image itself.
pub fn of(spec: &NetSpec) -> Option<Filter> {
    let crate::Filter { levels, kernel } = spec.filter?;
    let first = spec.light_channels().first().copied()?;
    let [levels, kernel, channels, first] =
        [levels, kernel, spec.output_channels(), first].map(|number| number as u32);
    Some(Filter { levels, kernel, channels, first })
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

    /// The passes that make the image of `input` from the kernels in the room, with how many workgroups run of each.
    pub fn bind(
        &self,
        device: &Device,
        room: &Room,
        input: Input<'_>,
        output: Output<'_>,
    ) -> Result<Vec<(BoundPass, [u32; 3])>, GpuError> {
        let workgroups = |level: usize| {
            let [height, width] = room.frame.map(|size| size >> level);
            gpu::groups(height, width, TILE)
        };
        let mut bound = vec![(self.bind_light(device, room, input)?, workgroups(0))];
        for (level, pass) in (1..).zip(&self.halve) {
            let uniform = gpu::uniform(device, "net.halve", &room.uniform(level))?;
            let resources = [(0, uniform.as_entire_binding()), (3, room.pyramid.as_entire_binding())];
            bound.push((pass.bind_at(device, resources)?, workgroups(level)));
        }
        let uniform = gpu::uniform(device, "net.gather", &room.uniform(0))?;
        let [uniform, kernels, pyramid] =
            [&uniform, &room.kernels, &room.pyramid].map(Buffer::as_entire_binding);
        let gather = self.gather.bind(device, &[uniform, kernels, pyramid, output.binding()])?;
        bound.push((gather, workgroups(0)));
        Ok(bound)
    }

    fn bind_light(&self, device: &Device, room: &Room, input: Input<'_>) -> Result<BoundPass, GpuError> {
        let (Scaling { length, light }, run) = input.scaling();
        let uniform = NetLayer {
            channels: self.inputs,
            length_scale: length,
            light_scale: light,
            run,
            ..room.uniform(0)
        };
        let uniform = gpu::uniform(device, "net.light", &uniform)?;
        let mut resources = vec![(0, uniform.as_entire_binding()), (3, room.pyramid.as_entire_binding())];
        resources.extend(input.bindings());
        self.light.bind_at(device, resources)
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
