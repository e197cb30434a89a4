//! How fast a network trains here, on made-up pairs.

use crate::loss::{Loss, Target};
use crate::net::UNet;
use crate::optim::Optimiser;
use crate::{TrainConfig, TrainError};
use burn::optim::GradientsParams;
use burn::tensor::{Device, Distribution, Tensor};
use deepshade_shaders::lists;
use std::time::{Duration, Instant};

/// Steps before the clock starts.
const WARM_UP: usize = 2;

/// Time of the parts of a step: medians over some steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTimes {
    /// Network and loss.
    pub forward: Duration,
    /// Their gradients.
    pub backward: Duration,
    /// The optimiser.
    pub update: Duration,
    /// Images a second, from the median of whole steps.
    pub images_per_second: f64,
}

/// Times `steps` training steps with the config's network, optimiser, batch and crop. A part ends when the
/// device has done its work, not when it was told to.
///
/// # Errors
/// If the device fails.
///
/// # Panics
/// If there is no step.
pub fn bench(config: &TrainConfig, steps: usize) -> Result<StepTimes, TrainError> {
    let device = crate::device::devices(1)?.remove(0).autodiff();
    let mut net = UNet::random(&config.spec, config.seed, &device);
    let mut optimiser = config.optimiser.start();
    let noise = |channels: usize| noise([config.batch, channels, config.crop, config.crop], &device);
    let (input, image) = (noise(config.spec.input_channels()), noise(config.spec.output_channels()));
    let valid = Tensor::ones([config.batch, 1, config.crop, config.crop], &device);
    let target = Target { variance: image.zeros_like(), image, valid };
    let done = || device.sync().map_err(|error| TrainError::Device(error.to_string()));
    let mut times = Vec::with_capacity(steps);
    done()?;
    for step in 0..WARM_UP + steps {
        let began = Instant::now();
        let loss = Loss::Dssim.of(net.forward(input.clone()), target.clone());
        done()?;
        let forward = began.elapsed();
        let gradients = GradientsParams::from_grads(loss.backward(), &net);
        done()?;
        let backward = began.elapsed();
        net = optimiser.step(rate(&config.optimiser), net, gradients);
        done()?;
        if step >= WARM_UP {
            times.push([forward, backward - forward, began.elapsed() - backward, began.elapsed()]);
        }
    }
    let median = |part: usize| {
        lists::median(times.iter().map(|times: &[Duration; 4]| times[part].as_secs_f64()).collect())
    };
    let [forward, backward, update] = [0, 1, 2].map(|part| Duration::from_secs_f64(median(part)));
    Ok(StepTimes { forward, backward, update, images_per_second: config.batch as f64 / median(3) })
}

fn rate(optimiser: &Optimiser) -> f64 {
    optimiser.rate(0, 1)
}

fn noise(shape: [usize; 4], device: &Device) -> Tensor<4> {
    Tensor::random(shape, Distribution::Default, device)
}
