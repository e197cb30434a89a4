//! The method `learned`: a trained network, run by `infer`.

use crate::methods::LEARNED;
use deepshade_infer::forward::{ForwardError, Network};
use deepshade_infer::{Model, NetSpec};
use deepshade_render::method::{Clock, Frame, Method, MethodError, Repeats, Shaded};
use deepshade_shaders::gpu::{self, Gpu, Timing};
use deepshade_shaders::{Effect, MissingAttribute, Planes};

/// A trained network on a device.
pub struct Learned {
    gpu: Gpu,
    network: Network,
}

impl Learned {
    /// Compiles the network's passes and uploads its weights.
    ///
    /// # Errors
    /// If the device refuses.
    pub fn new(gpu: &Gpu, model: &Model) -> Result<Self, ForwardError> {
        let network = Network::new(&gpu.device, &model.spec, &model.weights)?;
        Ok(Self { gpu: gpu.clone(), network })
    }

    fn spec(&self) -> &NetSpec {
        self.network.spec()
    }

    /// The network's image of its input, and how long it took on the GPU.
    fn run(&self, input: &Planes, repeats: Repeats) -> Result<(Planes, Timing), ForwardError> {
        let Gpu { device, queue, .. } = &self.gpu;
        let plan = self.network.plan(input.height(), input.width())?;
        let elements = self.effect().channels() * input.pixels();
        let from = gpu::storage(device, "learned.input", input.data())?;
        let to = gpu::empty::<f32>(device, "learned.output", elements)?;
        let mut recorded = Ok(());
        let Repeats { warm_up, timed } = repeats;
        let timing = gpu::time(device, queue, LEARNED, warm_up, timed, |encoder| {
            if recorded.is_ok() {
                recorded = plan.encode(encoder, &from, &to);
            }
        })?;
        recorded?;
        Ok((plan.image(queue, &to)?, timing))
    }
}

impl Method for Learned {
    fn name(&self) -> &'static str {
        LEARNED
    }

    fn effect(&self) -> Effect {
        self.spec().effect
    }

    /// The time is that of the network's passes on the GPU, without sending the g-buffer there and the image back.
    fn shade(&self, frame: &Frame<'_>, repeats: Repeats) -> Result<Shaded, MethodError> {
        let missing = |source: MissingAttribute| MethodError::Missing { method: LEARNED, source };
        let input = self.spec().input(frame.gbuffer, frame.radius).map_err(missing)?;
        let (mut image, timing) = self.run(&input, repeats).map_err(failed)?;
        self.spec().set_background(frame.gbuffer, &mut image).map_err(missing)?;
        let clock = if timing.by_gpu { Clock::Gpu } else { Clock::Cpu };
        Ok(Shaded { image, milliseconds: timing.milliseconds, clock })
    }
}

fn failed(error: ForwardError) -> MethodError {
    match error {
        ForwardError::Gpu(source) => MethodError::Gpu { method: LEARNED, source },
        other => MethodError::Other { method: LEARNED, what: other.to_string() },
    }
}
