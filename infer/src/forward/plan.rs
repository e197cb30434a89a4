//! A network on images of one size.

use super::{ForwardError, Network, Stage, StagePart, packing};
use crate::{Activation, Layer, Source};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, BoundPass, GpuError, Pass};
use deepshade_shaders::wgsl::{TILE, uniforms::NetLayer};
use wgpu::{BindingResource, TextureView};

/// A network on images of one size: its feature maps and what is bound to its passes.
///
/// Each level has two texture arrays: one keeps the way down for the skip connection, the other holds the pooled image
/// that the level reads and afterwards, when that is used up, the level's way up.
#[derive(Debug)]
pub struct Plan {
    device: wgpu::Device,
    height: usize,
    width: usize,
    channels: [usize; 2],
    levels: Vec<Level>,
    steps: Vec<Step>,
}

/// The feature maps of a level.
#[derive(Debug)]
struct Level {
    down: Option<wgpu::Texture>,
    /// First the pooled image of the level above, then the way up.
    up: Option<wgpu::Texture>,
}

/// One dispatch.
#[derive(Debug)]
struct Step {
    layer: Layer,
    pass: Pass,
    workgroups: [u32; 3],
    resources: Vec<Resource>,
    /// Absent where the caller's buffers are read or written.
    bound: Option<BoundPass>,
}

/// Something bound to a pass.
#[derive(Clone, Debug)]
enum Resource {
    Buffer(wgpu::Buffer),
    Texture(TextureView),
    Input,
    Output,
}

impl Plan {
    pub(super) fn new(network: &Network, height: usize, width: usize) -> Result<Self, ForwardError> {
        check_size(network, height, width)?;
        let (device, spec) = (&network.device, &network.spec);
        let levels = (0..spec.levels).map(|level| Level::new(network, level, height, width));
        let mut plan = Self {
            device: device.clone(),
            height,
            width,
            channels: [spec.input_channels(), spec.output_channels()],
            levels: levels.collect::<Result<_, GpuError>>()?,
            steps: Vec::new(),
        };
        for stage in &network.stages {
            for part in &stage.parts {
                let step = plan.step(network, stage, part)?;
                plan.steps.push(step);
            }
        }
        Ok(plan)
    }

    /// Records a run: from `input`, `[input channels, height, width]` f32, to `output`, `[output channels, height,
    /// width]` f32, two storage buffers of the network's device.
    ///
    /// `input` is what [`NetSpec::input`](crate::NetSpec::input) makes of a g-buffer, or a pass of the caller's that
    /// does the same: lengths multiplied by [`Reach::position_scale`](crate::Reach::position_scale), and 0 in every
    /// channel where no surface is seen. What the network makes where none is seen means nothing;
    /// [`NetSpec::set_background`](crate::NetSpec::set_background), or the caller's own pass, puts the effect's
    /// [`background`](deepshade_shaders::Effect::background) there.
    ///
    /// # Errors
    /// If a buffer is too small or no storage buffer.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        input: &wgpu::Buffer,
        output: &wgpu::Buffer,
    ) -> Result<(), ForwardError> {
        for (buffer, channels, label) in
            [(input, self.channels[0], "input"), (output, self.channels[1], "output")]
        {
            let needed = (channels * self.height * self.width * size_of::<f32>()) as u64;
            if buffer.size() < needed {
                let what = format!("a buffer of {} bytes; {needed} are needed", buffer.size());
                return Err(GpuError::Refused { label: format!("deepshade.net.{label}"), what }.into());
            }
        }
        for step in &self.steps {
            match &step.bound {
                Some(bound) => bound.dispatch(encoder, step.workgroups),
                None => step.bind(&self.device, Some((input, output)))?.dispatch(encoder, step.workgroups),
            }
        }
        Ok(())
    }

    /// Every layer's image as the last run left it; `output` is the buffer that it wrote.
    ///
    /// # Errors
    /// If the device is lost or its memory exhausted.
    pub fn layers(
        &self,
        queue: &wgpu::Queue,
        output: &wgpu::Buffer,
    ) -> Result<Vec<Activation>, ForwardError> {
        let mut made: Vec<Activation> = Vec::new();
        for Step { layer, .. } in &self.steps {
            if made.last().is_some_and(|last| last.layer == layer.name) {
                continue;
            }
            let planes = match self.made(layer) {
                Some(texture) => self.read(queue, texture, layer.outputs)?,
                None => self.image(queue, output)?,
            };
            made.push(Activation { layer: layer.name.clone(), planes });
        }
        Ok(made)
    }

    /// The network's image, `[output channels, height, width]`, as the last run left it in `output`.
    ///
    /// # Errors
    /// If the device is lost or its memory exhausted.
    pub fn image(&self, queue: &wgpu::Queue, output: &wgpu::Buffer) -> Result<Planes, ForwardError> {
        let mut data: Vec<f32> = gpu::read(&self.device, queue, output)?;
        data.truncate(self.channels[1] * self.height * self.width);
        Ok(Planes::from_data(self.channels[1], self.height, self.width, data))
    }

    fn read(
        &self,
        queue: &wgpu::Queue,
        texture: &wgpu::Texture,
        channels: usize,
    ) -> Result<Planes, ForwardError> {
        let texels = gpu::read_texture_array(&self.device, queue, texture)?;
        let (height, width) = (texture.height() as usize, texture.width() as usize);
        Ok(Planes::from_fn(channels, height, width, |c, y, x| {
            texels[(((c / 4) * height + y) * width + x) * 4 + c % 4]
        }))
    }

    fn step(&self, network: &Network, stage: &Stage, part: &StagePart) -> Result<Step, ForwardError> {
        let layer = &stage.layer;
        let alignment = network.spec.alignment();
        let [height, width] =
            [self.height, self.width].map(|size| size.next_multiple_of(alignment) >> layer.level);
        let uniform = NetLayer {
            width: width as u32,
            height: height as u32,
            image_width: self.width as u32,
            image_height: self.height as u32,
            channels: self.channels[0] as u32,
            first: part.first as u32,
            stride: stage.stride as u32,
            leak: network.spec.leak,
        };
        let uniform = gpu::uniform(&self.device, &format!("net.{}", layer.name), &uniform)?;
        let mut resources =
            [uniform, part.reads.clone(), part.weights.clone()].map(Resource::Buffer).to_vec();
        resources.extend(self.images(network, layer));
        let [x, y, _] = gpu::groups(height.div_ceil(2), width.div_ceil(2), TILE);
        let workgroups = [x, y, part.count as u32];
        let mut step =
            Step { layer: layer.clone(), pass: stage.pass.clone(), workgroups, resources, bound: None };
        if !step.resources.iter().any(|resource| matches!(resource, Resource::Input | Resource::Output)) {
            step.bound = Some(step.bind(&self.device, None)?);
        }
        Ok(step)
    }

    /// What a layer's pass binds after its weights: what it makes, then what it reads, then where pooling goes.
    fn images(&self, network: &Network, layer: &Layer) -> Vec<Resource> {
        let view = |texture: Option<&wgpu::Texture>| {
            Resource::Texture(gpu::array_view(
                texture.expect("a level has the feature maps that its layers use"),
            ))
        };
        let levels = &self.levels;
        let mut images = vec![match self.made(layer) {
            Some(texture) => view(Some(texture)),
            None => Resource::Output,
        }];
        match layer.source {
            Source::Input => images.push(Resource::Input),
            Source::Plain(_) => images.push(view(levels[layer.level].down.as_ref())),
            Source::Pooled(_) => images.push(view(levels[layer.level].up.as_ref())),
            Source::Joined { coarse, .. } => {
                images.push(view(self.made(&network.stages[coarse].layer)));
                images.push(view(levels[layer.level].down.as_ref()));
                return images;
            }
        }
        if let Some(below) = levels.get(layer.level + 1) {
            images.push(view(below.up.as_ref()));
        }
        images
    }

    /// The feature map that a layer makes; none where it makes the image.
    fn made(&self, layer: &Layer) -> Option<&wgpu::Texture> {
        let level = &self.levels[layer.level];
        match layer.source {
            _ if !layer.activation => None,
            Source::Input | Source::Plain(_) | Source::Pooled(_) => level.down.as_ref(),
            Source::Joined { .. } => level.up.as_ref(),
        }
    }
}

impl Level {
    fn new(network: &Network, level: usize, height: usize, width: usize) -> Result<Self, GpuError> {
        let spec = &network.spec;
        let [height, width] = [height, width].map(|size| size.next_multiple_of(spec.alignment()) >> level);
        let texture = |name: &str, channels: usize| {
            let layers = channels.next_multiple_of(packing::FEATURES) / 4;
            gpu::texture_array(&network.device, &format!("net.level{level}.{name}"), layers, height, width)
        };
        let coarsest = level + 1 == spec.levels;
        let pooled = if coarsest { 1 } else { 0 };
        Ok(Self {
            down: Some(texture("down", spec.u0 << level)?),
            up: (level > 0).then(|| texture("up", spec.u0 << (level - pooled))).transpose()?,
        })
    }
}

impl Step {
    fn bind(
        &self,
        device: &wgpu::Device,
        callers: Option<(&wgpu::Buffer, &wgpu::Buffer)>,
    ) -> Result<BoundPass, GpuError> {
        let outer = || callers.expect("a step with the caller's buffers is bound as it is recorded");
        let resources: Vec<BindingResource<'_>> = self
            .resources
            .iter()
            .map(|resource| match resource {
                Resource::Buffer(buffer) => buffer.as_entire_binding(),
                Resource::Texture(view) => BindingResource::TextureView(view),
                Resource::Input => outer().0.as_entire_binding(),
                Resource::Output => outer().1.as_entire_binding(),
            })
            .collect();
        self.pass.bind(device, &resources)
    }
}

fn check_size(network: &Network, height: usize, width: usize) -> Result<(), ForwardError> {
    let (limits, spec) = (network.device.limits(), &network.spec);
    let error =
        |layer: &Layer, reason| Err(ForwardError::Size { width, height, layer: layer.name.clone(), reason });
    let (first, last) = (&network.stages[0].layer, &network.stages[network.stages.len() - 1].layer);
    let most = limits.max_texture_dimension_2d as usize;
    if height == 0 || width == 0 {
        return error(first, "has no pixel to read".to_owned());
    }
    if height.max(width) > most / spec.alignment() * spec.alignment() {
        return error(first, format!("has feature maps of at most {most} rows and columns on this device"));
    }
    for (layer, channels) in [(first, spec.input_channels()), (last, spec.output_channels())] {
        let bytes = (channels * height * width * size_of::<f32>()) as u64;
        let limit = limits.max_storage_buffer_binding_size;
        if bytes > limit {
            return error(layer, format!("binds a buffer of {bytes} bytes; the device allows {limit}"));
        }
    }
    Ok(())
}
