//! One network in all engines at one size.

use super::super::pytorch;
use super::layers;
use super::subjects::Subject;
use crate::onnxruntime;
use anyhow::{Result, ensure};
use deepshade_infer::forward::Precision;
use deepshade_infer::{Cost, Model, cpu, forward, parity};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Ceilings, Gpu, Timing};
use serde::Serialize;
use serde_json::json;
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
/// How long a graphics card is busy before it is measured.
pub const WAKING: Duration = Duration::from_millis(500);

/// Bytes that an engine keeps a number in.
#[derive(Clone, Copy, Debug)]
struct Bytes {
    /// Of a feature map.
    map: u64,
    /// Of all else.
    other: u64,
}

/// All in 32-bit floats.
const SINGLE: Bytes = Bytes { map: 4, other: 4 };

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
    /// Billions of bytes a second, of those that must move at least.
    pub gigabytes: f64,
    /// The first rate as a share of what the device can do at best, where that was measured.
    pub share_flops: Option<f64>,
    /// The second rate as such a share.
    pub share_bytes: Option<f64>,
}

impl Measurement {
    /// The share of the peak of operations, in words.
    pub fn of_peak_flops(&self) -> String {
        per_cent(self.share_flops)
    }

    /// The share of the peak of bytes, in words.
    pub fn of_peak_bytes(&self) -> String {
        per_cent(self.share_bytes)
    }
}

fn per_cent(share: Option<f64>) -> String {
    share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share))
}

/// What engines run on.
pub struct Devices<'a> {
    /// The device of WGSL, and what it can do at best.
    pub gpu: (&'a Gpu, Ceilings),
    /// What the processor can do at best.
    pub cpu: Ceilings,
    /// The library of the rival.
    pub onnxruntime: &'a onnxruntime::Args,
    /// The other rival.
    pub pytorch: &'a pytorch::Args,
    /// Threads of all that run on the processor.
    pub threads: usize,
}

/// One network at one size.
pub struct Race<'a> {
    /// The network.
    pub subject: &'a Subject,
    /// Columns and rows.
    pub size: [usize; 2],
    /// How long.
    pub effort: Effort,
    /// On what.
    pub devices: &'a Devices<'a>,
}

impl Race<'_> {
    /// Measures all engines; what does not run is said and left out.
    pub fn run(&self) -> Vec<Measurement> {
        let mut made = Vec::new();
        for (engine, precision) in precisions(self.devices.gpu.0) {
            made.extend(self.said(engine, self.wgsl(engine, precision)));
        }
        made.extend(self.said("cpu", self.on_processor()).into_iter().flatten());
        made.extend(self.said("pytorch", self.pytorch()).into_iter().flatten());
        made
    }

    /// Measures the forward pass as one writes it first.
    pub fn naive(&self) -> Option<Measurement> {
        let run = || {
            let gpu = self.devices.gpu.0;
            gpu::wake(&gpu.device, &gpu.queue, WAKING)?;
            let (_, timing) = forward::naive::run_timed(gpu, &self.subject.model, &self.input(), 1, FEWEST)?;
            Ok(self.measurement("naive", &timing, Some(self.devices.gpu.1), SINGLE))
        };
        self.said("naive", run())
    }

    fn said<T>(&self, engine: &str, made: Result<T>) -> Option<T> {
        let [width, height] = self.size;
        made.inspect_err(|error| {
            note!("{} at {width}x{height}: {engine}: {error:#}", self.subject.name);
        })
        .ok()
    }

    fn input(&self) -> Planes {
        let [width, height] = self.size;
        parity::noise(self.subject.model.spec.input_channels(), height, width, 1)
    }

    fn wgsl(&self, engine: &str, precision: Precision) -> Result<Measurement> {
        let (gpu, ceilings) = self.devices.gpu;
        let (network, input) =
            (layers::network(gpu, &self.subject.model, precision, self.size)?, self.input());
        let kept = network.precision();
        ensure!(
            kept == precision,
            "no kernel works in {precision:?}; it would be that in {kept:?} once more"
        );
        gpu::wake(&gpu.device, &gpu.queue, WAKING)?;
        let (_, once) = network.run_timed(&gpu.queue, &input, 1, 1)?;
        let fitting = self.effort.time.as_secs_f64() * 1e3 / once.milliseconds;
        let runs = (fitting as usize).clamp(FEWEST, self.effort.most);
        let (_, timing) = network.run_timed(&gpu.queue, &input, 1, runs)?;
        let bytes = if precision == Precision::F16 { Bytes { map: 2, other: 4 } } else { SINGLE };
        Ok(self.measurement(engine, &timing, Some(ceilings), bytes))
    }

    /// Our engine and, where there is one, onnxruntime, in turns: what disturbs the machine disturbs both.
    fn on_processor(&self) -> Result<Vec<Measurement>> {
        let Model { spec, weights } = &self.subject.model;
        let ([width, height], input) = (self.size, self.input());
        let mut plan = cpu::Network::new(spec, weights)?.plan(height, width)?;
        let session = self.devices.onnxruntime.session(&self.subject.onnx, self.devices.threads);
        let mut session = self.said("rival", session);
        let cpu = || Ok(plan.run(&input).map(drop)?);
        let mut engines: Vec<(&str, Work<'_>)> = vec![("cpu", Box::new(cpu))];
        if let Some(session) = &mut session {
            engines.push(("onnxruntime", Box::new(|| session.image(&input).map(drop))));
        }
        let made = |(engine, timing): (&str, Timing)| {
            self.measurement(engine, &timing, Some(self.devices.cpu), SINGLE)
        };
        Ok(in_turns(engines, self.effort)?.into_iter().map(made).collect())
    }

    fn pytorch(&self) -> Result<Vec<Measurement>> {
        let Effort { time, most } = self.effort;
        let more = json!({ "mode": "infer", "size": self.size, "runs": most, "seconds": time.as_secs_f64() });
        let Some(report) = self.devices.pytorch.run(&self.subject.model, self.devices.threads, more)? else {
            return Ok(Vec::new());
        };
        let made = |row: &pytorch::Row| {
            let on_processor = report.device == pytorch::PROCESSOR;
            let timing = Timing { milliseconds: row.milliseconds, p95: row.p95, by_gpu: !on_processor };
            let ceilings = on_processor.then_some(self.devices.cpu);
            let bytes = if on_processor { SINGLE } else { Bytes { map: 2, other: 2 } };
            self.measurement(&row.engine, &timing, ceilings, bytes)
        };
        Ok(report.made.iter().map(made).collect())
    }

    fn measurement(
        &self,
        engine: &str,
        timing: &Timing,
        ceilings: Option<Ceilings>,
        bytes: Bytes,
    ) -> Measurement {
        let [width, height] = self.size;
        let cost: Cost = self.subject.model.spec.costs(height, width).into_iter().sum();
        let seconds = timing.milliseconds * 1e-3;
        let operations = 2.0 * cost.multiply_adds as f64 / seconds;
        let moved = (bytes.map * cost.maps + bytes.other * cost.others) as f64 / seconds;
        Measurement {
            network: self.subject.name.clone(),
            size: self.size,
            engine: engine.to_owned(),
            milliseconds: timing.milliseconds,
            p95: timing.p95,
            clock: if timing.by_gpu { "timestamps" } else { "wall clock" },
            gflops: operations * 1e-9,
            gigabytes: moved * 1e-9,
            share_flops: ceilings.map(|ceilings| operations / ceilings.multiply_add),
            share_bytes: ceilings.map(|ceilings| moved / ceilings.copy),
        }
    }
}

/// The ways of keeping feature maps that are measured on a device: half floats bring nothing on the processor.
fn precisions(gpu: &Gpu) -> Vec<(&'static str, Precision)> {
    let single = ("wgsl", Precision::F32);
    match layers::half_where_there_is(gpu) {
        Precision::F16 if !gpu.is_software() => vec![single, ("wgsl_half", Precision::F16)],
        _ => vec![single],
    }
}

type Work<'a> = Box<dyn FnMut() -> Result<()> + 'a>;

/// Runs the engines in turns. Each turn begins with a pause, since onnxruntime's threads wait for more work by
/// spinning, and with a run that does not count.
fn in_turns<'a>(mut engines: Vec<(&'a str, Work<'_>)>, effort: Effort) -> Result<Vec<(&'a str, Timing)>> {
    let mut times = vec![Vec::new(); engines.len()];
    for _ in 0..TURNS {
        for ((_, engine), times) in engines.iter_mut().zip(&mut times) {
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
    Ok(engines.iter().zip(times).map(|((name, _), times)| (*name, Timing::new(times, false))).collect())
}
