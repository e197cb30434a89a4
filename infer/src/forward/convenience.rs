//! Running a network on an image in main memory: for tools and tests. A renderer has a [`Plan`] instead.

use super::maps::MapId;
use super::{ForwardError, Input, Network, Output, Plan, Recording};
use crate::{Activation, Model};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Gpu, Timing};

/// A plan with buffers of its own for input and output.
struct Run {
    plan: Plan,
    recording: Recording,
    output: wgpu::Buffer,
}

/// The network's image, `[output channels, height, width]`, of an input `[input channels, height, width]`.
///
/// # Errors
/// If the input is not the network's or the GPU refuses.
pub fn run(gpu: &Gpu, model: &Model, input: &Planes) -> Result<Planes, ForwardError> {
    let run = Run::new(&Network::new(&gpu.device, &model.spec, &model.weights)?, input)?;
    gpu::submit(&gpu.device, &gpu.queue, "net", |encoder| run.recording.encode(encoder))?;
    run.plan.image(&gpu.queue, &run.output)
}

/// What every layer makes on the way to the network's image, as [`crate::reference::layers`] gives it.
///
/// # Errors
/// If the input is not the network's, too large to be run as a whole, or the GPU refuses.
pub fn run_layers(gpu: &Gpu, model: &Model, input: &Planes) -> Result<Vec<Activation>, ForwardError> {
    run_layers_of(&Network::new(&gpu.device, &model.spec, &model.weights)?, &gpu.queue, input)
}

/// As [`run_layers`], of a network from buffers to buffers.
///
/// # Errors
/// If the input is not the network's, too large to be run as a whole, or the GPU refuses.
pub fn run_layers_of(
    network: &Network,
    queue: &wgpu::Queue,
    input: &Planes,
) -> Result<Vec<Activation>, ForwardError> {
    let run = Run::new(network, input)?;
    if run.plan.tiles() > 1 {
        let (height, width) = (input.height(), input.width());
        return Err(ForwardError::Memory { width, height, limit: u64::MAX });
    }
    let mut made = Vec::new();
    for (index, layer) in network.layers.iter().enumerate() {
        // One by one: a later layer may write where an earlier one's map was.
        gpu::submit(&network.device, queue, "net", |encoder| run.recording.encode_layer(index, encoder))?;
        let planes = match layer.activation {
            true => run.plan.storage.read(&network.device, queue, MapId::Made(index))?,
            false => run.plan.image(queue, &run.output)?,
        };
        made.push(Activation { layer: layer.name.clone(), planes });
    }
    Ok(made)
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
        let record = |encoder: &mut wgpu::CommandEncoder| run.recording.encode(encoder);
        let timing = gpu::time(&self.device, queue, "net", warm_up, timed, record)?;
        Ok((run.plan.image(queue, &run.output)?, timing))
    }

    /// How long each layer takes on images of a size, by name: each by itself, the median of `timed` runs after
    /// `warm_up` others.
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
        let run = Run::new(self, &Planes::filled(self.spec.input_channels(), height, width, 0.5))?;
        let time = |(index, layer): (usize, &crate::Layer)| {
            let record = |encoder: &mut wgpu::CommandEncoder| run.recording.encode_layer(index, encoder);
            let timing = gpu::time(&self.device, queue, &layer.name, warm_up, timed, record)?;
            Ok((layer.name.clone(), timing))
        };
        self.layers.iter().enumerate().map(time).collect()
    }
}

impl Run {
    fn new(network: &Network, input: &Planes) -> Result<Self, ForwardError> {
        let Network { device, spec, .. } = network;
        let (expected, found) = (spec.input_channels(), input.channels());
        if expected != found {
            return Err(ForwardError::Input { expected, found });
        }
        let plan = network.plan(input.height(), input.width())?;
        let elements = spec.output_channels() * input.pixels();
        let input = gpu::storage(device, "net.input", input.data())?;
        let output = gpu::empty::<f32>(device, "net.output", elements)?;
        let recording = plan.bind(Input::Buffer(&input), Output::Buffer(&output))?;
        Ok(Self { plan, recording, output })
    }
}
