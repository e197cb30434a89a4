//! One network in all engines at one size, taking turns: what disturbs the machine disturbs all of them.

use super::super::pytorch;
use super::layers;
use super::subjects::Subject;
use crate::onnxruntime;
use anyhow::Result;
use deepshade_infer::forward::Precision;
use deepshade_infer::{Cost, cpu, forward, parity};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{Gpu, Timing};
use serde::Serialize;
use std::time::{Duration, Instant};

/// How long and how often an engine is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Time for each engine's runs, after one that does not count.
    pub time: Duration,
    /// Most runs that count.
    pub most: usize,
}

/// Fewest runs that count.
const FEWEST: usize = 3;
/// Turns that engines take, and the pause before each.
const TURNS: usize = 3;
const PAUSE: Duration = Duration::from_millis(100);

/// What an engine took for a network.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// The network.
    pub network: String,
    /// Columns and rows of the image.
    pub size: [usize; 2],
    /// The engine.
    pub engine: String,
    /// Median, milliseconds.
    pub milliseconds: f64,
    /// 95th percentile, milliseconds.
    pub p95: f64,
    /// Which clock: `timestamps` or `wall clock`.
    pub clock: &'static str,
    /// Billions of floating-point operations a second.
    pub gflops: f64,
    /// Billions of bytes a second that must move at least, counted in 32-bit numbers.
    pub gigabytes: f64,
}

/// What engines run on.
pub struct Devices<'a> {
    /// The device of WGSL.
    pub gpu: &'a Gpu,
    /// The library of the rival.
    pub onnxruntime: &'a onnxruntime::Args,
    /// Threads of the rival.
    pub threads: usize,
}

/// Measures a network in WGSL, on the CPU and in onnxruntime.
///
/// # Errors
/// If an engine does not run it.
pub fn measure(
    subject: &Subject,
    size: [usize; 2],
    devices: &Devices<'_>,
    effort: Effort,
) -> Result<Vec<Measurement>> {
    let [width, height] = size;
    let input = parity::noise(subject.model.spec.input_channels(), height, width, 1);
    let mut made = Vec::new();
    for (engine, precision) in precisions(devices.gpu) {
        let timing = wgsl(subject, &input, devices.gpu, precision, effort)?;
        made.push(measurement(subject, size, engine, &timing));
    }
    let network = cpu::Network::new(&subject.model.spec, &subject.model.weights);
    let mut plan = network.plan(height, width);
    let mut session = devices.onnxruntime.session(&subject.onnx, devices.threads)?;
    let cpu = || Ok(drop(plan.run(&network, &input)));
    let onnxruntime = || session.image(&input).map(drop);
    let timings = in_turns([Box::new(cpu), Box::new(onnxruntime)], effort)?;
    for (engine, timing) in ["cpu", "onnxruntime"].iter().zip(&timings) {
        made.push(measurement(subject, size, engine, timing));
    }
    Ok(made)
}

/// As a measurement.
pub fn measurement(subject: &Subject, size: [usize; 2], engine: &str, timing: &Timing) -> Measurement {
    let [width, height] = size;
    let cost: Cost = subject.model.spec.costs(height, width).into_iter().sum();
    let seconds = timing.milliseconds * 1e-3;
    Measurement {
        network: subject.name.clone(),
        size,
        engine: engine.to_owned(),
        milliseconds: timing.milliseconds,
        p95: timing.p95,
        clock: if timing.by_gpu { "timestamps" } else { "wall clock" },
        gflops: 2.0 * cost.multiply_adds as f64 / seconds * 1e-9,
        gigabytes: 4.0 * cost.numbers as f64 / seconds * 1e-9,
    }
}

/// Measures the forward pass as one writes it first.
///
/// # Errors
/// If the GPU does not run it.
pub fn naive(subject: &Subject, size: [usize; 2], gpu: &Gpu) -> Result<Measurement> {
    let [width, height] = size;
    let input = parity::noise(subject.model.spec.input_channels(), height, width, 1);
    let (_, timing) = forward::naive::run_timed(gpu, &subject.model, &input, 1, FEWEST)?;
    Ok(measurement(subject, size, "naive", &timing))
}

/// What PyTorch measured.
pub fn of_pytorch(subject: &Subject, size: [usize; 2], row: &pytorch::Row) -> Measurement {
    let timing = Timing { milliseconds: row.milliseconds, p95: row.p95, by_gpu: false };
    measurement(subject, size, &row.engine, &timing)
}

/// The ways of keeping feature maps that are measured on a device: half floats bring nothing on the processor.
fn precisions(gpu: &Gpu) -> Vec<(&'static str, Precision)> {
    let single = ("wgsl", Precision::F32);
    match layers::half_where_there_is(gpu) {
        Precision::F16 if !gpu.is_software() => vec![single, ("wgsl_half", Precision::F16)],
        _ => vec![single],
    }
}

fn wgsl(
    subject: &Subject,
    input: &Planes,
    gpu: &Gpu,
    precision: Precision,
    effort: Effort,
) -> Result<Timing> {
    let network = layers::network(gpu, &subject.model, precision)?;
    let (_, once) = network.run_timed(&gpu.queue, input, 1, 1)?;
    let fitting = effort.time.as_secs_f64() * 1e3 / once.milliseconds;
    let runs = (fitting as usize).clamp(FEWEST, effort.most);
    Ok(network.run_timed(&gpu.queue, input, 0, runs)?.1)
}

type Work<'a> = Box<dyn FnMut() -> Result<()> + 'a>;

/// Runs the engines in turns. Each turn begins with a pause, since onnxruntime's threads wait for more work by
/// spinning, and with a run that does not count.
fn in_turns<const N: usize>(mut engines: [Work<'_>; N], effort: Effort) -> Result<[Timing; N]> {
    let mut times: [Vec<f64>; N] = [const { Vec::new() }; N];
    for _ in 0..TURNS {
        for (engine, times) in engines.iter_mut().zip(&mut times) {
            std::thread::sleep(PAUSE);
            engine()?;
            let turn = Instant::now();
            let (fewest, most) = (FEWEST.div_ceil(TURNS), effort.most.div_ceil(TURNS));
            for run in 0..most {
                if run >= fewest && turn.elapsed() > effort.time / TURNS as u32 {
                    break;
                }
                let start = Instant::now();
                engine()?;
                times.push(start.elapsed().as_secs_f64() * 1e3);
            }
        }
    }
    Ok(times.map(|times| Timing::new(times, false)))
}
