//! What runs a network: WGSL on a graphics card, vector instructions on the processor where there is none.

use crate::kernels;
use deepshade_infer::forward::{self, ForwardError, Precision};
use deepshade_infer::{Model, NetSpec, cpu};
use deepshade_render::processor_name;
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{Gpu, Timing};
use std::cell::RefCell;
use std::sync::Arc;
use web_time::Instant;

/// The adapter where networks are fastest on it: the processor is faster where the adapter is software, as
/// software Vulkan is. A web page has the adapter alone: it has one thread of the processor, and no vector
/// instructions.
pub fn card(gpu: &Gpu) -> Option<&Gpu> {
    (cfg!(target_arch = "wasm32") || !gpu.is_software()).then_some(gpu)
}

/// A network on a device.
pub struct Engine {
    /// On the processor: its packed weights.
    processor: cpu::Network,
    /// On an adapter: the device, and the model whose kernels are chosen by the size of the images.
    card: Option<(Gpu, Model)>,
    /// What ran the last image, with its size: `[height, width]`.
    runner: RefCell<Option<([usize; 2], Runner)>>,
}

/// A network on images of one size.
enum Runner {
    Cpu(Box<cpu::CpuPlan>),
    Wgsl(Box<Gpu>, Arc<forward::Runner>),
}

impl Engine {
    /// Prepares a network: on the processor where there is no adapter, or that one makes wrong images.
    ///
    /// # Errors
    /// If the weights are not the spec's.
    pub fn new(gpu: Option<&Gpu>, model: &Model) -> Result<Self, ForwardError> {
        let processor = cpu::Network::new(&model.spec, &model.weights)?;
        let card = gpu.map(|gpu| (gpu.clone(), model.clone()));
        Ok(Self { processor, card, runner: RefCell::new(None) })
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        self.processor.spec()
    }

    /// What ran the last image.
    pub fn device(&self) -> String {
        match &*self.runner.borrow() {
            Some((_, Runner::Wgsl(gpu, _))) => gpu.info.name.clone(),
            _ => processor_name().unwrap_or_else(|| "unknown processor".to_owned()),
        }
    }

    /// The engine that ran the last image, as figures name it: `wgsl` or `cpu`.
    #[cfg(feature = "train")]
    pub fn name(&self) -> &'static str {
        match &*self.runner.borrow() {
            Some((_, Runner::Wgsl(..))) => "wgsl",
            _ => "cpu",
        }
    }

    /// One run's image, `[output channels, height, width]`, of its input, `[input channels, height, width]`,
    /// and how long it took: the median of `timed` runs, at least one, after `warm_up` others, without the
    /// way to a graphics card and back.
    ///
    /// # Errors
    /// If the input is not the network's, or the device fails.
    #[cfg(any(feature = "train", test))]
    pub fn run(
        &self,
        input: &Planes,
        warm_up: usize,
        timed: usize,
    ) -> Result<(Planes, Timing), ForwardError> {
        deepshade_shaders::gpu::wait(self.run_async(input, warm_up, timed))?
    }

    /// As [`Engine::run`], awaited.
    ///
    /// # Errors
    /// If the input is not the network's, or the device fails.
    pub async fn run_async(
        &self,
        input: &Planes,
        warm_up: usize,
        timed: usize,
    ) -> Result<(Planes, Timing), ForwardError> {
        let size = [input.height(), input.width()];
        let mut runner = self.runner(size)?;
        let made = match &mut runner {
            Runner::Wgsl(gpu, passes) => passes.run_timed_async(&gpu.queue, input, warm_up, timed).await,
            Runner::Cpu(plan) => run_on_cpu(plan, input, warm_up, timed),
        };
        self.runner.replace(Some((size, runner)));
        made
    }

    /// The network's passes on images of a size; none where the processor runs it.
    ///
    /// # Errors
    /// If the device fails.
    pub fn on_card(&self, size: [usize; 2]) -> Result<Option<Arc<forward::Runner>>, ForwardError> {
        let runner = self.runner(size)?;
        let passes = match &runner {
            Runner::Wgsl(_, passes) => Some(Arc::clone(passes)),
            Runner::Cpu(_) => None,
        };
        self.runner.replace(Some((size, runner)));
        Ok(passes)
    }

    /// What runs images of a size, taken from what ran the last image where that was as large.
    fn runner(&self, size: [usize; 2]) -> Result<Runner, ForwardError> {
        let last = self.runner.take().filter(|(last, _)| *last == size);
        last.map_or_else(|| self.new_runner(size), |(_, runner)| Ok(runner))
    }

    fn new_runner(&self, [height, width]: [usize; 2]) -> Result<Runner, ForwardError> {
        if let Some((gpu, model)) = &self.card {
            match kernels::fastest(gpu, model, Precision::F32, [height, width]) {
                Ok(network) => {
                    let passes = network.runner(height, width)?;
                    return Ok(Runner::Wgsl(Box::new(gpu.clone()), Arc::new(passes)));
                }
                Err(error @ ForwardError::NoKernel { .. }) => {
                    note!("{error}; the processor runs the network")
                }
                Err(error) => return Err(error),
            }
        }
        Ok(Runner::Cpu(Box::new(self.processor.plan(height, width)?)))
    }
}

fn run_on_cpu(
    plan: &mut cpu::CpuPlan,
    input: &Planes,
    warm_up: usize,
    timed: usize,
) -> Result<(Planes, Timing), ForwardError> {
    (0..warm_up).try_for_each(|_| plan.run(input).map(drop))?;
    let mut times = Vec::with_capacity(timed);
    loop {
        let start = Instant::now();
        let image = plan.run(input)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
        if times.len() >= timed {
            return Ok((image, Timing::new(times, false)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach, Weights, parity, reference};

    #[test]
    fn images_of_any_sizes_in_any_order_are_their_own() {
        let spec =
            NetSpec::ao(ChannelOrder::Interleaved, Reach { radius: 1.0, diagonal_share: 0.1, height: 64 });
        let model = Model { weights: Weights::random(&spec, 1), spec };
        let engine = Engine::new(None, &model).expect("prepared");
        for (seed, [height, width]) in [[16, 24], [16, 24], [24, 16], [16, 24]].into_iter().enumerate() {
            let input = parity::noise(6, height, width, seed as u32);
            let (image, _) = engine.run(&input, 1, 1).expect("runs");
            let expected = reference::forward(&model.spec, &model.weights, &input);
            assert!(deepshade_infer::Comparison::new(&expected, &image).agrees(), "{seed}");
        }
    }
}
