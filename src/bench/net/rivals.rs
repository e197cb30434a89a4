//! One network in all engines at one size.

use super::super::pytorch;
use super::layers;
use super::measurement::{Device, Measurement};
use super::subjects::MeasuredNetwork;
use super::turns::{Effort, EngineRun, FEWEST, in_turns};
use crate::onnxruntime;
use anyhow::{Result, ensure};
use deepshade_infer::forward::Precision;
use deepshade_infer::{Cost, Model, cpu, parity};
use deepshade_shaders::Planes;
use deepshade_shaders::gpu::{self, Gpu, Timing};
use serde_json::json;
use std::time::Duration;

/// How long a graphics card is busy before it is measured.
pub const WARM_UP_TIME: Duration = Duration::from_millis(500);

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

/// What engines run on.
pub struct Devices<'a> {
    /// The device of WGSL.
    pub gpu: &'a Gpu,
    /// The library of the rival, where there is one.
    pub onnxruntime: Option<&'a onnxruntime::Args>,
    /// The other rival.
    pub pytorch: &'a pytorch::Args,
    /// Threads of all that run on the processor.
    pub threads: usize,
}

/// One network at one size.
pub struct EngineComparison<'a> {
    /// The network.
    pub subject: &'a MeasuredNetwork,
    /// Columns and rows.
    pub size: [usize; 2],
    /// How long.
    pub effort: Effort,
    /// On what.
    pub devices: &'a Devices<'a>,
}

/// What came of a comparison of engines.
#[derive(Debug, Default)]
pub struct EngineMeasurements {
    /// What was measured.
    pub made: Vec<Measurement>,
    /// What was not, and why.
    pub failed: Vec<String>,
}

impl EngineComparison<'_> {
    /// Measures all engines; what does not run is left out of what is made.
    pub fn run(&self) -> EngineMeasurements {
        let mut outcome = EngineMeasurements::default();
        for (engine, precision) in precisions(self.devices.gpu) {
            self.begin(engine);
            self.add(&mut outcome, engine, self.wgsl(engine, precision));
        }
        self.begin(if self.devices.onnxruntime.is_some() { "cpu and onnxruntime" } else { "cpu" });
        for (engine, made) in self.on_processor() {
            self.add(&mut outcome, engine, made);
        }
        if self.devices.pytorch.is_asked_for() {
            self.begin("pytorch");
            self.add(&mut outcome, "pytorch", self.pytorch());
        }
        outcome
    }

    /// Which network at which size.
    pub fn name(&self) -> String {
        let [width, height] = self.size;
        format!("{} at {width}x{height}", self.subject.name)
    }

    fn begin(&self, engine: &str) {
        note!("{}: {engine}", self.name());
    }

    fn add(
        &self,
        outcome: &mut EngineMeasurements,
        engine: &str,
        made: Result<impl IntoIterator<Item = Measurement>>,
    ) {
        match made {
            Ok(made) => outcome.made.extend(made),
            Err(error) => outcome.failed.push(format!("{}: {engine}: {error:#}", self.name())),
        }
    }

    fn input(&self) -> Planes {
        let [width, height] = self.size;
        parity::noise(self.subject.model.spec.input_channels(), height, width, 1)
    }

    fn wgsl(&self, engine: &str, precision: Precision) -> Result<[Measurement; 1]> {
        let (gpu, input) = (self.devices.gpu, self.input());
        let network = layers::network(gpu, &self.subject.model, precision, self.size)?;
        let kept = network.precision();
        ensure!(
            kept == precision,
            "no kernel works in {precision:?}; it would be that in {kept:?} once more"
        );
        gpu::warm_up(&gpu.device, &gpu.queue, WARM_UP_TIME)?;
        let (_, once) = network.run_timed(&gpu.queue, &input, 1, 1)?;
        let fitting = self.effort.time.as_secs_f64() * 1e3 / once.milliseconds;
        let runs = (fitting as usize).clamp(FEWEST, self.effort.most);
        let (_, timing) = network.run_timed(&gpu.queue, &input, 1, runs)?;
        let bytes = if precision == Precision::F16 { Bytes { map: 2, other: 4 } } else { SINGLE };
        Ok([self.measurement(engine, &timing, Some(Device::Adapter), bytes)])
    }

    /// Our engine and, where there is one, onnxruntime, in turns: what disturbs the machine disturbs both.
    fn on_processor(&self) -> Vec<(&'static str, Result<[Measurement; 1]>)> {
        let input = self.input();
        let mut engines = vec![("cpu", self.cpu(&input))];
        if let Some(library) = self.devices.onnxruntime {
            engines.push(("onnxruntime", self.onnxruntime(library, &input)));
        }
        let made = |(engine, timing): (&'static str, Result<Timing>)| {
            let made = |timing| [self.measurement(engine, &timing, Some(Device::Processor), SINGLE)];
            (engine, timing.map(made))
        };
        in_turns(engines, self.effort).into_iter().map(made).collect()
    }

    fn cpu<'a>(&self, input: &'a Planes) -> Result<EngineRun<'a>> {
        let Model { spec, weights } = &self.subject.model;
        let [width, height] = self.size;
        let mut plan = cpu::Network::new(spec, weights)?.plan(height, width)?;
        Ok(Box::new(move || Ok(plan.run(input).map(drop)?)))
    }

    fn onnxruntime<'a>(&self, library: &onnxruntime::Args, input: &'a Planes) -> Result<EngineRun<'a>> {
        let mut session = library.session(&self.subject.onnx, self.devices.threads)?;
        Ok(Box::new(move || session.image(input).map(drop)))
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
            let device = on_processor.then_some(Device::Processor);
            let bytes = if on_processor { SINGLE } else { Bytes { map: 2, other: 2 } };
            self.measurement(&row.engine, &timing, device, bytes)
        };
        Ok(report.made.iter().map(made).collect())
    }

    fn measurement(
        &self,
        engine: &str,
        timing: &Timing,
        device: Option<Device>,
        bytes: Bytes,
    ) -> Measurement {
        let [width, height] = self.size;
        let cost: Cost = self.subject.model.spec.costs(height, width).into_iter().sum();
        let seconds = timing.milliseconds * 1e-3;
        let operations = 2.0 * cost.multiply_adds as f64 / seconds;
        let moved = (bytes.map * cost.maps + bytes.other * cost.others) as f64 / seconds;
        Measurement {
            network: self.subject.name.clone(),
            trained: self.subject.trained,
            size: self.size,
            engine: engine.to_owned(),
            milliseconds: timing.milliseconds,
            p95: timing.p95,
            clock: if timing.by_gpu { "timestamps" } else { "wall clock" },
            device,
            gflops: operations * 1e-9,
            gigabytes: moved * 1e-9,
            share_flops: None,
            share_bytes: None,
        }
    }
}

/// The ways of keeping feature maps that are measured on a device: half floats bring nothing on the
/// processor.
fn precisions(gpu: &Gpu) -> Vec<(&'static str, Precision)> {
    let single = ("wgsl", Precision::F32);
    match layers::half_where_there_is(gpu) {
        Precision::F16 if !gpu.is_software() => vec![single, ("wgsl_half", Precision::F16)],
        _ => vec![single],
    }
}
