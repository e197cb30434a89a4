//! What runs a network: WGSL on a graphics card, vector instructions on the processor where there is none.

use crate::figures::machine;
use crate::kernels;
use deepshade_infer::forward::{self, ForwardError, Precision};
use deepshade_infer::{Model, NetSpec, cpu};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{Gpu, Timing};
use serde_json::Value;
use std::time::Instant;

/// A network on the fastest device there is.
pub enum Engine {
    /// On the processor.
    Cpu(cpu::Network),
    /// On a graphics card.
    Wgsl {
        /// The device.
        gpu: Gpu,
        /// Its passes.
        network: forward::Network,
    },
}

impl Engine {
    /// Prepares a network: on the processor where the device is none of its own, as software Vulkan is.
    ///
    /// # Errors
    /// If the device refuses the network.
    pub fn new(gpu: Option<&Gpu>, model: &Model) -> Result<Self, ForwardError> {
        Ok(match gpu {
            Some(gpu) if !gpu.is_software() => {
                Self::Wgsl { gpu: gpu.clone(), network: kernels::fastest(gpu, model, Precision::F32)? }
            }
            _ => Self::Cpu(cpu::Network::new(&model.spec, &model.weights)),
        })
    }

    /// The network's spec.
    pub const fn spec(&self) -> &NetSpec {
        match self {
            Self::Cpu(network) => network.spec(),
            Self::Wgsl { network, .. } => network.spec(),
        }
    }

    /// What runs it, for figures.
    pub fn device(&self) -> Value {
        match self {
            Self::Cpu(_) => machine()["processor"].clone(),
            Self::Wgsl { gpu, .. } => Value::from(gpu.info.name.clone()),
        }
    }

    /// One run's image, `[output channels, height, width]`, of its input, `[input channels, height, width]`, and how
    /// long it took: the median of `timed` runs after `warm_up` others, without the way to a graphics card and back.
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
            Self::Cpu(network) => {
                let (expected, found) = (network.spec().input_channels(), input.channels());
                if expected != found {
                    return Err(ForwardError::Input { expected, found });
                }
                let mut plan = network.plan(input.height(), input.width());
                let mut timed_run = || {
                    let start = Instant::now();
                    let image = plan.run(network, input);
                    (image, start.elapsed().as_secs_f64() * 1e3)
                };
                (0..warm_up).for_each(|_| drop(timed_run()));
                let (image, first) = timed_run();
                let further = (1..timed).map(|_| timed_run().1);
                Ok((image, Timing::new(std::iter::once(first).chain(further).collect(), false)))
            }
        }
    }
}
