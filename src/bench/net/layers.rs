//! How long each layer of a network takes, in WGSL and on the CPU.

use super::subjects::Subject;
use crate::kernels;
use anyhow::Result;
use deepshade_infer::forward::{ForwardError, Network, Precision};
use deepshade_infer::{Model, cpu, parity};
use deepshade_shaders::{gpu::Gpu, lists};

/// Runs that are timed, after others that are not.
const RUNS: usize = 5;

/// Prints the times of a network's layers.
///
/// # Errors
/// If the GPU does not run it.
pub fn print(gpu: &Gpu, subject: &Subject, size: [usize; 2]) -> Result<()> {
    let [width, height] = size;
    say!("layers of {} at {width}x{height}", subject.name)?;
    let wgsl = wgsl(gpu, &subject.model, size)?;
    let costs = subject.model.spec.costs(height, width);
    for (((name, cpu), (_, wgsl)), cost) in cpu_times(&subject.model, size).iter().zip(&wgsl).zip(costs) {
        let gflops = |milliseconds: f64| 2.0 * cost.multiply_adds as f64 / milliseconds * 1e-6;
        say!(
            "  {name:<6} wgsl {wgsl:>8.3} ms {:>7.1} GFLOP/s   cpu {cpu:>8.3} ms {:>7.1} GFLOP/s",
            gflops(*wgsl),
            gflops(*cpu)
        )?;
    }
    Ok(())
}

/// Half floats, where the device has them.
pub fn half_where_there_is(gpu: &Gpu) -> Precision {
    let has_half = gpu.device.features().contains(wgpu::Features::SHADER_F16);
    if has_half { Precision::F16 } else { Precision::F32 }
}

/// A network with the kernels that the program uses on a device.
///
/// # Errors
/// If the device refuses it.
pub fn network(gpu: &Gpu, model: &Model, precision: Precision) -> Result<Network, ForwardError> {
    match gpu.is_software() {
        true => Network::new(&gpu.device, &model.spec, &model.weights),
        false => kernels::fastest(gpu, model, precision),
    }
}

/// Milliseconds of every layer in WGSL, by name.
///
/// # Errors
/// If the GPU does not run it.
pub fn wgsl(gpu: &Gpu, model: &Model, [width, height]: [usize; 2]) -> Result<Vec<(String, f64)>> {
    let network = network(gpu, model, Precision::F32)?;
    let times = network.layer_times(&gpu.queue, [height, width], 1, RUNS)?;
    Ok(times.into_iter().map(|(name, timing)| (name, timing.milliseconds)).collect())
}

/// Milliseconds of every layer on the CPU, by name.
pub fn cpu_times(model: &Model, [width, height]: [usize; 2]) -> Vec<(String, f64)> {
    let network = cpu::Network::new(&model.spec, &model.weights);
    let input = parity::noise(model.spec.input_channels(), height, width, 1);
    let mut plan = network.plan(height, width);
    let runs: Vec<Vec<(String, f64)>> = (0..=RUNS).map(|_| plan.layer_times(&network, &input)).collect();
    let median = |layer: usize| lists::median(runs[1..].iter().map(|run| run[layer].1).collect());
    runs[0].iter().enumerate().map(|(layer, (name, _))| (name.clone(), median(layer))).collect()
}
