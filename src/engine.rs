//! What runs a network: WGSL on a graphics card, vector instructions on the processor where there is none.

use crate::figures::machine;
use crate::kernels;
use deepshade_infer::forward::{self, ForwardError, Precision};
use deepshade_infer::{Model, NetSpec, cpu};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{Gpu, Timing};
use serde_json::Value;
use std::cell::RefCell;
use std::time::Instant;

/// Rows and columns of the images for which the fastest kernels are looked for: the size of the thesis' Table 7.1.
const USUAL_SIZE: [usize; 2] = [512, 768];

/// A network on the fastest device there is.
pub enum Engine {
    /// On the processor.
    Cpu {
        /// Its packed weights.
        network: cpu::Network,
        /// Room for images of the size of the last one, with that size.
        plan: RefCell<Option<([usize; 2], cpu::Plan)>>,
    },
    /// On a graphics card.
    Wgsl {
        /// The device.
        gpu: Gpu,
        /// Its passes.
        network: Box<forward::Network>,
    },
}

impl Engine {
    /// Prepares a network: on the processor where the device is none of its own, as software Vulkan is, or makes wrong
    /// images.
    ///
    /// # Errors
    /// If the device refuses the network.
    pub fn new(gpu: Option<&Gpu>, model: &Model) -> Result<Self, ForwardError> {
        let Some(gpu) = gpu.filter(|gpu| !gpu.is_software()) else { return Self::cpu(model) };
        match kernels::fastest(gpu, model, Precision::F32, USUAL_SIZE) {
            Ok(network) => Ok(Self::Wgsl { gpu: gpu.clone(), network: Box::new(network) }),
            Err(error @ ForwardError::NoKernel { .. }) => {
                note!("{error}; the processor runs the network");
                Self::cpu(model)
            }
            Err(error) => Err(error),
        }
    }

    /// Prepares a network on the processor.
    ///
    /// # Errors
    /// If the weights are not the spec's.
    pub fn cpu(model: &Model) -> Result<Self, ForwardError> {
        let network = cpu::Network::new(&model.spec, &model.weights)?;
        Ok(Self::Cpu { network, plan: RefCell::new(None) })
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        match self {
            Self::Cpu { network, .. } => network.spec(),
            Self::Wgsl { network, .. } => network.spec(),
        }
    }

    /// What runs it, for figures.
    pub fn device(&self) -> Value {
        match self {
            Self::Cpu { .. } => machine()["processor"].clone(),
            Self::Wgsl { gpu, .. } => Value::from(gpu.info.name.clone()),
        }
    }

    /// One run's image, `[output channels, height, width]`, of its input, `[input channels, height, width]`, and how
    /// long it took: the median of `timed` runs, at least one, after `warm_up` others, without the way to a graphics
    /// card and back.
    ///
    /// # Errors
    /// If the input is not the network's, or the device fails.
    pub fn run(
        &self,
        input: &Planes,
        warm_up: usize,
        timed: usize,
    ) -> Result<(Planes, Timing), ForwardError> {
        match self {
            Self::Wgsl { gpu, network } => network.run_timed(&gpu.queue, input, warm_up, timed),
            Self::Cpu { network, plan } => {
                let size = [input.height(), input.width()];
                let mut slot = plan.borrow_mut();
                let (_, plan) = match slot.take().filter(|(planned, _)| *planned == size) {
                    Some(fitting) => slot.insert(fitting),
                    None => slot.insert((size, network.plan(size[0], size[1])?)),
                };
                run_on_cpu(plan, input, warm_up, timed)
            }
        }
    }
}

fn run_on_cpu(
    plan: &mut cpu::Plan,
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
