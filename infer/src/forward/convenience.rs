//! Running a network on an image in main memory: for tools and tests. A renderer has a [`Plan`] instead.

use super::{ForwardError, Network, Plan};
use crate::{Activation, Model};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Gpu, Timing};

/// A plan with buffers of its own for input and output.
struct Run {
    plan: Plan,
    input: wgpu::Buffer,
    output: wgpu::Buffer,
}

/// The network's image, `[output channels, height, width]`, of an input `[input channels, height, width]`.
///
/// # Errors
/// If the input is not the network's or the GPU refuses.
pub fn run(gpu: &Gpu, model: &Model, input: &Planes) -> Result<Planes, ForwardError> {
    let run = Run::new(&Network::new(&gpu.device, &model.spec, &model.weights)?, input)?;
    run.once(gpu)?;
    run.plan.image(&gpu.queue, &run.output)
}

/// What every layer makes on the way to the network's image, as [`crate::reference::layers`] gives it.
///
/// # Errors
/// If the input is not the network's or the GPU refuses.
pub fn run_layers(gpu: &Gpu, model: &Model, input: &Planes) -> Result<Vec<Activation>, ForwardError> {
    let run = Run::new(&Network::new(&gpu.device, &model.spec, &model.weights)?, input)?;
    run.once(gpu)?;
    run.plan.layers(&gpu.queue, &run.output)
}

impl Network {
    /// The network's image of an input, and how long its passes take, by the clock that [`gpu::time`] has on this
    /// device: the median of `timed` runs after `warm_up` others, without the way between main memory and the GPU.
    ///
    /// # Errors
    /// If the input is not the network's or the GPU refuses.
    pub fn run_timed(
        &self,
        queue: &wgpu::Queue,
        input: &Planes,
        warm_up: usize,
        timed: usize,
    ) -> Result<(Planes, Timing), ForwardError> {
        let run = Run::new(self, input)?;
        let mut recorded = Ok(());
        let timing = gpu::time(&self.device, queue, "net", warm_up, timed, |encoder| {
            if recorded.is_ok() {
                recorded = run.plan.encode(encoder, &run.input, &run.output);
            }
        })?;
        recorded?;
        Ok((run.plan.image(queue, &run.output)?, timing))
    }
}

impl Run {
    fn new(network: &Network, input: &Planes) -> Result<Self, ForwardError> {
        let Network { device, spec, .. } = network;
        let (expected, found) = (spec.input_channels(), input.channels());
        if expected != found {
            return Err(ForwardError::Input { expected, found });
        }
        let elements = spec.output_channels() * input.pixels();
        Ok(Self {
            plan: network.plan(input.height(), input.width())?,
            input: gpu::storage(device, "net.input", input.data())?,
            output: gpu::empty::<f32>(device, "net.output", elements)?,
        })
    }

    fn once(&self, gpu: &Gpu) -> Result<(), ForwardError> {
        let mut recorded = Ok(());
        gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| {
            recorded = self.plan.encode(encoder, &self.input, &self.output);
        })?;
        recorded
    }
}
