//! How long each layer of a network takes, in WGSL and on the CPU.

use super::subjects::MeasuredNetwork;
use crate::kernels;
use anyhow::Result;
use deepshade_infer::forward::{ForwardError, Network, Precision};
use deepshade_infer::{Cost, Model, cpu, parity};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::lists;
use serde::Serialize;

/// Runs that are timed, after others that are not.
const RUNS: usize = 5;

/// What a layer took.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The network.
    pub network: String,
    /// Columns and rows of the image.
    pub size: [usize; 2],
    /// The layer.
    pub layer: String,
    /// The engine.
    pub engine: &'static str,
    /// Median, milliseconds.
    pub milliseconds: f64,
    /// Billions of floating-point operations a second.
    pub gflops: f64,
    /// Billions of bytes a second, of those that must move at least.
    pub gigabytes: f64,
}

/// What every layer of a network takes.
///
/// # Errors
/// If an engine does not run it.
pub fn rows(gpu: &Gpu, subject: &MeasuredNetwork, size: [usize; 2]) -> Result<Vec<Row>> {
    let [width, height] = size;
    let costs = subject.model.spec.costs(height, width);
    let row = |engine, (layer, milliseconds): (String, f64), cost: &Cost| Row {
        network: subject.name.clone(),
        size,
        layer,
        engine,
        milliseconds,
        gflops: 2.0 * cost.multiply_adds as f64 / milliseconds * 1e-6,
        gigabytes: 4.0 * cost.numbers() as f64 / milliseconds * 1e-6,
    };
    let times = [("wgsl", wgsl(gpu, &subject.model, size)?), ("cpu", cpu_times(&subject.model, size)?)];
    let rows = times.into_iter().flat_map(|(engine, times)| {
        times.into_iter().zip(&costs).map(move |(time, cost)| row(engine, time, cost)).collect::<Vec<_>>()
    });
    Ok(rows.collect())
}

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { network, size: [width, height], layer, engine, milliseconds, gflops, gigabytes } = self;
        let (size, layer) = (format!("{width}x{height}"), format!("{engine} {layer}"));
        write!(f, "{network:<12} {size:<10} {layer:<18} {milliseconds:>8.3} {gflops:>17.1} {gigabytes:>16.1}")
    }
}

/// Half floats, where the device has them.
pub fn half_where_there_is(gpu: &Gpu) -> Precision {
    let has_half = gpu.device.features().contains(wgpu::Features::SHADER_F16);
    if has_half { Precision::F16 } else { Precision::F32 }
}

/// A network with the kernels that the program uses on a device for images of that many columns and rows.
///
/// # Errors
/// If the device refuses it.
pub fn network(
    gpu: &Gpu,
    model: &Model,
    precision: Precision,
    [width, height]: [usize; 2],
) -> Result<Network, ForwardError> {
    match gpu.is_software() {
        true => Network::new(&gpu.device, &model.spec, &model.weights),
        false => kernels::fastest(gpu, model, precision, [height, width]),
    }
}

/// Milliseconds of every layer in WGSL, by name.
///
/// # Errors
/// If the GPU does not run it.
pub fn wgsl(gpu: &Gpu, model: &Model, [width, height]: [usize; 2]) -> Result<Vec<(String, f64)>> {
    let network = network(gpu, model, Precision::F32, [width, height])?;
    gpu::warm_up(&gpu.device, &gpu.queue, super::rivals::WARM_UP_TIME)?;
    let times = network.layer_times(&gpu.queue, [height, width], 1, RUNS)?;
    Ok(times.into_iter().map(|(name, timing)| (name, timing.milliseconds)).collect())
}

/// Milliseconds of every layer on the CPU, by name.
///
/// # Errors
/// If there is no room for its feature maps.
pub fn cpu_times(model: &Model, [width, height]: [usize; 2]) -> Result<Vec<(String, f64)>> {
    let mut plan = cpu::Network::new(&model.spec, &model.weights)?.plan(height, width)?;
    let input = parity::noise(model.spec.input_channels(), height, width, 1);
    let first = plan.layer_times(&input)?;
    let runs = (0..RUNS).map(|_| plan.layer_times(&input)).collect::<Result<Vec<_>, _>>()?;
    let median = |layer: usize| lists::median(runs.iter().map(|run| run[layer].1).collect());
    Ok(first.into_iter().enumerate().map(|(layer, (name, _))| (name, median(layer))).collect())
}
