//! The forward pass as one writes it first, as a yardstick: every step a pass of its own over planar storage buffers, one
//! element of the result an invocation, nothing fused, nothing shared. Benchmarks measure the other kernels against it;
//! nothing else is to use it.

use super::tiles::Tile;
use super::{ForwardError, Input, Options, Output, filter};
use crate::reference::padded;
use crate::{Layer, LayerWeights, Model, NetSpec, Source, Weights};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, BoundPass, Gpu, GpuError, Pass, Timing};
use deepshade_shaders::wgsl::{self, Shader, TILE, uniforms::NaiveLayer};
use wgpu::Buffer;

/// An image on the device.
#[derive(Clone)]
struct Image {
    buffer: Buffer,
    channels: usize,
    height: usize,
    width: usize,
}

/// All dispatches of a run, in order.
struct Recorder<'a> {
    gpu: &'a Gpu,
    spec: &'a NetSpec,
    dispatches: Vec<(BoundPass, [u32; 3])>,
}

/// The network's image of an input, and how long its passes take: the median of `timed` runs after `warm_up` others.
///
/// # Errors
/// If the input or the weights are not the network's or the GPU refuses, for one if an image is larger than a binding.
pub fn run_timed(
    gpu: &Gpu,
    model: &Model,
    input: &Planes,
    warm_up: usize,
    timed: usize,
) -> Result<(Planes, Timing), ForwardError> {
    let (expected, found) = (model.spec.input_channels(), input.channels());
    if expected != found {
        return Err(ForwardError::Input { expected, found });
    }
    if model.spec.validate().is_err() || !model.weights.fit(&model.spec) {
        return Err(ForwardError::Unfit);
    }
    let mut recorder = Recorder { gpu, spec: &model.spec, dispatches: Vec::new() };
    let padded = padded(input, model.spec.alignment());
    let read = recorder.read(&padded)?;
    let made = recorder.network(&model.weights, &read)?;
    let made = recorder.filtered(&read, made)?;
    let timing = gpu::time(&gpu.device, &gpu.queue, "naive", warm_up, timed, |encoder| {
        recorder.dispatches.iter().for_each(|(pass, workgroups)| pass.dispatch(encoder, *workgroups));
    })?;
    let data = gpu::read(&gpu.device, &gpu.queue, &made.buffer)?;
    let whole = Planes::from_data(made.channels, made.height, made.width, data);
    Ok((whole.window(0, 0, input.height(), input.width()), timing))
}

impl Recorder<'_> {
    fn read(&self, input: &Planes) -> Result<Image, GpuError> {
        let buffer = gpu::storage(&self.gpu.device, "naive.input", input.data())?;
        let (channels, height, width) = (input.channels(), input.height(), input.width());
        Ok(Image { buffer, channels, height, width })
    }

    /// The image of what the last convolution makes.
    fn filtered(&mut self, input: &Image, made: Image) -> Result<Image, ForwardError> {
        let (device, spec) = (&self.gpu.device, self.spec);
        let Some(passes) = filter::Passes::new(device, spec, &Options::default())? else { return Ok(made) };
        let image = self.image(spec.output_channels(), made.height, made.width)?;
        let room = passes.room(device, spec, [made.height, made.width], made.buffer)?;
        let whole = Tile { origin: [0; 2], keep: [0..made.height, 0..made.width] };
        self.dispatches.extend(passes.bind_pyramid(device, &room, Input::Buffer(&input.buffer))?.0);
        self.dispatches.push(passes.bind_gather(device, &room, &whole, Output::Buffer(&image.buffer))?);
        Ok(image)
    }

    fn network(&mut self, weights: &Weights, input: &Image) -> Result<Image, GpuError> {
        let mut image = input.clone();
        let mut made: Vec<Image> = Vec::new();
        for (layer, weights) in self.spec.layers().iter().zip(&weights.0) {
            let source = match layer.source {
                Source::Input => input.clone(),
                Source::Plain(from) => made[from].clone(),
                Source::Pooled(from) => self.pooled(&made[from])?,
                Source::Joined { coarse, skip } => {
                    let doubled = self.doubled(&made[coarse])?;
                    self.joined(layer, &doubled, &made[skip])?
                }
            };
            image = self.convolved(layer, weights, &source)?;
            if layer.activation {
                image = self.activated(&image)?;
            }
            made.push(image.clone());
        }
        Ok(image)
    }

    fn convolved(
        &mut self,
        layer: &Layer,
        weights: &LayerWeights,
        source: &Image,
    ) -> Result<Image, GpuError> {
        let uniform = NaiveLayer {
            kernel: self.spec.kernel as u32,
            group_inputs: (layer.inputs / layer.groups) as u32,
            group_outputs: (layer.outputs / layer.groups) as u32,
            ..uniform(source.height, source.width)
        };
        let [weight, bias] = [&weights.weight, &weights.bias]
            .map(|data| gpu::storage(&self.gpu.device, "naive.weights", data));
        let made = self.image(layer.outputs, source.height, source.width)?;
        self.pass(&wgsl::NAIVE_CONVOLUTION, uniform, &made, source, &[&weight?, &bias?])
    }

    fn activated(&mut self, source: &Image) -> Result<Image, GpuError> {
        let made = self.image(source.channels, source.height, source.width)?;
        let uniform = NaiveLayer { leak: self.spec.leak, ..uniform(made.height, made.width) };
        self.pass(&wgsl::NAIVE_ACTIVATION, uniform, &made, source, &[])
    }

    fn pooled(&mut self, source: &Image) -> Result<Image, GpuError> {
        let made = self.image(source.channels, source.height / 2, source.width / 2)?;
        self.pass(&wgsl::NAIVE_POOLING, uniform(made.height, made.width), &made, source, &[])
    }

    fn doubled(&mut self, source: &Image) -> Result<Image, GpuError> {
        let made = self.image(source.channels, 2 * source.height, 2 * source.width)?;
        self.pass(&wgsl::NAIVE_DOUBLING, uniform(made.height, made.width), &made, source, &[])
    }

    fn joined(&mut self, layer: &Layer, coarse: &Image, skip: &Image) -> Result<Image, GpuError> {
        let order = self.spec.joined_order(coarse.channels, skip.channels, layer.groups);
        let order: Vec<u32> = order.into_iter().map(|channel| channel as u32).collect();
        let order = gpu::storage(&self.gpu.device, "naive.order", &order)?;
        let made = self.image(layer.inputs, skip.height, skip.width)?;
        let uniform = NaiveLayer { coarse: coarse.channels as u32, ..uniform(made.height, made.width) };
        self.pass(&wgsl::NAIVE_CONCATENATION, uniform, &made, coarse, &[&skip.buffer, &order])
    }

    fn image(&self, channels: usize, height: usize, width: usize) -> Result<Image, GpuError> {
        let buffer = gpu::empty::<f32>(&self.gpu.device, "naive.image", channels * height * width)?;
        Ok(Image { buffer, channels, height, width })
    }

    /// Adds a pass that makes an image of a source and some more.
    fn pass(
        &mut self,
        shader: &Shader,
        uniform: NaiveLayer,
        made: &Image,
        source: &Image,
        more: &[&Buffer],
    ) -> Result<Image, GpuError> {
        let device = &self.gpu.device;
        let uniform = gpu::uniform(device, "naive.layer", &uniform)?;
        let resources = [&uniform, &source.buffer, &made.buffer].into_iter().chain(more.iter().copied());
        let resources: Vec<_> = resources.map(Buffer::as_entire_binding).collect();
        let bound = Pass::new(device, shader.name, &shader.source())?.bind(device, &resources)?;
        let [x, y, _] = gpu::groups(made.height, made.width, TILE);
        self.dispatches.push((bound, [x, y, made.channels as u32]));
        Ok(made.clone())
    }
}

fn uniform(height: usize, width: usize) -> NaiveLayer {
    NaiveLayer { height: height as u32, width: width as u32, ..bytemuck::Zeroable::zeroed() }
}
