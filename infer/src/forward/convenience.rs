//! Running a network on an image in main memory: for tools and tests. A renderer has a [`Plan`] instead.

use super::maps::MapId;
use super::{ForwardError, Input, Network, Output, Plan, Recording};
use crate::{Activation, Model};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Gpu, Timing};

/// A network on images of one size in main memory: a plan with buffers of its own for input and output.
#[derive(Debug)]
pub struct Runner {
    plan: Plan,
    recording: Recording,
    input: wgpu::Buffer,
    output: wgpu::Buffer,
}

/// The network's image, `[output channels, height, width]`, of an input `[input channels, height, width]`.
///
/// # Errors
/// If the input is not the network's or the GPU refuses.
pub fn run(gpu: &Gpu, model: &Model, input: &Planes) -> Result<Planes, ForwardError> {
    let runner =
        Network::new(&gpu.device, &model.spec, &model.weights)?.runner(input.height(), input.width())?;
    runner.write(&gpu.queue, input)?;
    gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| runner.recording.encode(encoder))?;
    runner.plan.image(&gpu.queue, &runner.output)
}

/// What every layer of a network from buffers to buffers makes on the way to its image, as
/// [`crate::reference::layers`] gives it.
///
/// # Errors
/// If the input is not the network's, too large to be run as a whole, or the GPU refuses.
pub fn run_layers(
    network: &Network,
    queue: &wgpu::Queue,
    input: &Planes,
) -> Result<Vec<Activation>, ForwardError> {
    let (height, width) = (input.height(), input.width());
    let runner = network.runner(height, width)?;
    runner.write(queue, input)?;
    if runner.plan.tiles() > 1 {
        return Err(ForwardError::Memory { width, height, limit: u64::MAX });
    }
    let mut made = Vec::new();
    for (index, layer) in network.layers.iter().enumerate() {
        // One by one: a later layer may write where an earlier one's map was.
        gpu::submit(&network.device, queue, "net", |encoder| runner.recording.encode_layer(index, encoder))?;
        let planes = match layer.activation {
            true => runner.plan.storage.read(&network.device, queue, MapId::Made(index))?,
            false => runner.plan.image(queue, &runner.output)?,
        };
        made.push(Activation { layer: layer.name.clone(), planes });
    }
    Ok(made)
}

impl Network {
    /// Prepares runs on images of a size in main memory.
    ///
    /// # Errors
    /// If the size is beyond the device's limits or its memory.
    pub fn runner(&self, height: usize, width: usize) -> Result<Runner, ForwardError> {
        let plan = self.plan(height, width)?;
        let buffer = |label, channels| gpu::empty::<f32>(&self.device, label, channels * height * width);
        let input = buffer("net.input", self.spec.input_channels())?;
        let output = buffer("net.output", self.spec.output_channels())?;
        let recording = plan.bind(Input::Buffer(&input), Output::Buffer(&output))?;
        Ok(Runner { plan, recording, input, output })
    }

    /// As [`Runner::run_timed`], on one image.
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
        self.runner(input.height(), input.width())?.run_timed(queue, input, warm_up, timed)
    }

    /// How long each layer takes on images of a size, by name: each by itself, the median of `timed` runs
    /// after `warm_up` others.
    ///
    /// # Errors
    /// If the size is beyond the device's limits or the GPU refuses.
    pub fn layer_times(
        &self,
        queue: &wgpu::Queue,
        [height, width]: [usize; 2],
        warm_up: usize,
        timed: usize,
    ) -> Result<Vec<(String, Timing)>, ForwardError> {
        let runner = self.runner(height, width)?;
        runner.write(queue, &Planes::filled(self.spec.input_channels(), height, width, 0.5))?;
        let time = |(index, layer): (usize, &crate::Layer)| {
            let record = |encoder: &mut wgpu::CommandEncoder| runner.recording.encode_layer(index, encoder);
            let timing = gpu::time(&self.device, queue, &layer.name, warm_up, timed, record)?;
            Ok((layer.name.clone(), timing))
        };
        self.layers.iter().enumerate().map(time).collect()
    }
}

impl Runner {
    /// Where a run reads, `[input channels, height, width]`.
    pub const fn input(&self) -> &wgpu::Buffer {
        &self.input
    }

    /// Where a run writes, `[output channels, height, width]`.
    pub const fn output(&self) -> &wgpu::Buffer {
        &self.output
    }

    /// Records a run on what lies in [`Runner::input`].
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        self.recording.encode(encoder);
    }

    /// The network's image of an input, and how long its passes take, by the clock that [`gpu::time`] has on
    /// this device: the median of `timed` runs after `warm_up` others, without the way between main memory
    /// and the GPU.
    ///
    /// # Errors
    /// If the input is not the network's or the GPU refuses.
    ///
    /// # Panics
    /// If the input is of another size than the runner.
    pub fn run_timed(
        &self,
        queue: &wgpu::Queue,
        input: &Planes,
        warm_up: usize,
        timed: usize,
    ) -> Result<(Planes, Timing), ForwardError> {
        gpu::wait(self.run_timed_async(queue, input, warm_up, timed))?
    }

    /// As [`Runner::run_timed`], awaited.
    ///
    /// # Errors
    /// If the input is not the network's or the GPU refuses.
    ///
    /// # Panics
    /// If the input is of another size than the runner.
    pub async fn run_timed_async(
        &self,
        queue: &wgpu::Queue,
        input: &Planes,
        warm_up: usize,
        timed: usize,
    ) -> Result<(Planes, Timing), ForwardError> {
        self.write(queue, input)?;
        let record = |encoder: &mut wgpu::CommandEncoder| self.recording.encode(encoder);
        let timing = gpu::time_async(&self.plan.device, queue, "net", warm_up, timed, record).await?;
        Ok((self.plan.image_async(queue, &self.output).await?, timing))
    }

    fn write(&self, queue: &wgpu::Queue, input: &Planes) -> Result<(), ForwardError> {
        let (expected, found) = (self.plan.spec.input_channels(), input.channels());
        assert_eq!([input.height(), input.width()], self.plan.size, "size of the input");
        if expected != found {
            return Err(ForwardError::Input { expected, found });
        }
        Ok(gpu::write(&self.plan.device, queue, &self.input, input.data())?)
    }
}
