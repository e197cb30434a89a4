//! PyTorch as a rival, where a Python has it.

use anyhow::{Context, Result, ensure};
use deepshade_infer::{BlockSource, HALF_GATE, Head, Model, NetSpec, parity, reference};
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

/// The program that PyTorch runs.
const SCRIPT: &str = include_str!("pytorch.py");

/// Columns and rows of the image on which it is checked; odd, so that padding is too.
const CHECKED: [usize; 2] = [53, 37];
/// What a report calls the processor.
pub const PROCESSOR: &str = "CPU";

/// Command-line arguments of benchmarks beside PyTorch.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// A Python that has PyTorch, to be measured in the same run (`pip install torch`)
    #[arg(long, value_name = "PROGRAM")]
    python: Option<String>,
}

/// What PyTorch measured.
#[derive(Debug, Deserialize)]
pub struct Report {
    /// PyTorch's version.
    pub version: String,
    /// What it ran on: a graphics card's name, or `CPU`.
    pub device: String,
    /// The measurements.
    pub made: Vec<Row>,
}

/// A measurement.
#[derive(Debug, Deserialize)]
pub struct Row {
    /// `pytorch` or `pytorch_compiled`, with `_half` in half floats.
    pub engine: String,
    /// Median, milliseconds.
    pub milliseconds: f64,
    /// 95th percentile, milliseconds.
    pub p95: f64,
}

impl Args {
    /// Whether a Python is named.
    pub const fn is_asked_for(&self) -> bool {
        self.python.is_some()
    }

    /// Runs a job, where a Python is named: `more` is what [`SCRIPT`] wants to know beside the network. It
    /// refuses to measure a network that does not make the image that the reference makes.
    ///
    /// # Errors
    /// If that Python does not run, has no PyTorch, or fails.
    pub fn run(&self, model: &Model, threads: usize, more: Value) -> Result<Option<Report>> {
        let Some(python) = &self.python else { return Ok(None) };
        let Model { spec, weights } = model;
        let mut job = network(spec);
        let [width, height] = CHECKED;
        let input = parity::noise(spec.input_channels(), height, width, 1);
        let output = reference::forward(spec, weights, &input);
        job["weights"] = weights.0.iter().map(|layer| json!([layer.weight, layer.bias])).collect();
        job["check"] = json!({ "size": CHECKED, "input": input.data(), "output": output.data() });
        for (key, value) in more.as_object().into_iter().flatten() {
            job[key] = value.clone();
        }
        job["threads"] = json!(threads);
        let mut child = Command::new(python)
            .args(["-c", SCRIPT])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("--python {python}"))?;
        let mut stdin = child.stdin.take().context("its input")?;
        // A Python without PyTorch ends before it has read all: what it says tells more than that.
        let _ = stdin.write_all(job.to_string().as_bytes());
        drop(stdin);
        let output = child.wait_with_output()?;
        let complaint = String::from_utf8_lossy(&output.stderr);
        let last = complaint.lines().last().unwrap_or_default();
        ensure!(output.status.success(), "--python {python}: {last}");
        let report = serde_json::from_slice(&output.stdout);
        Ok(Some(report.with_context(|| format!("--python {python}: no Python, or it printed no figures"))?))
    }
}

/// A network, as [`SCRIPT`] reads it.
fn network(spec: &NetSpec) -> Value {
    let layers = spec.layers();
    let correction = match spec.head {
        Head::Correction(correction) => Some(correction),
        Head::Image | Head::Filter(_) => None,
    };
    // JSON knows no infinity; `None` is no bound.
    let finite = |bound: f32| bound.is_finite().then_some(bound);
    let layer = |layer: &deepshade_infer::Layer| {
        let (source, of) = match layer.source {
            BlockSource::Input => ("input", vec![]),
            BlockSource::Folded => ("folded", vec![]),
            BlockSource::Plain(of) => ("plain", vec![of]),
            BlockSource::Pooled(of) => ("pooled", vec![of]),
            BlockSource::Joined { coarse, skip, .. } => ("joined", vec![coarse, skip]),
        };
        let order = match layer.source {
            BlockSource::Joined { .. } => json!(layer.read_order(&layers)),
            BlockSource::Input | BlockSource::Folded | BlockSource::Plain(_) | BlockSource::Pooled(_) => {
                Value::Null
            }
        };
        let (inputs, outputs, groups) = (layer.inputs, layer.outputs, layer.groups);
        json!({
            "source": source, "of": of, "order": order, "inputs": inputs, "outputs": outputs, "groups": groups,
            "activation": layer.activation,
            "kernel": layer.kernel,
        })
    };
    json!({
        "leak": spec.leak, "alignment": spec.alignment(), "filter": spec.filter(),
        "lights": spec.pyramid_channels(), "square": 1 << spec.last_level(),
        "correction": correction.map(|correction| json!({
            "levels": correction.levels, "kernel": correction.kernel, "range": spec.effect.range().map(finite),
            "gain": correction.gain, "half_gate": correction.gated.then_some(HALF_GATE),
        })),
        "estimate": correction.map_or_else(Vec::new, |correction| spec.channels_of(correction.of)),
        "layers": layers.iter().map(layer).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{AnalyticEstimate, ChannelOrder, Reach, Weights};
    use deepshade_shaders::Effect;

    /// A Python that has PyTorch, where there is one; `cargo xtask test` says at its end whether there was.
    const PYTHON: &str = "DEEPSHADE_PYTHON";

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 64 };

    fn random(spec: NetSpec) -> Model {
        Model { weights: Weights::random(&spec, 1), spec }
    }

    #[test]
    fn pytorch_makes_the_references_image_and_is_timed() {
        let Ok(python) = std::env::var(PYTHON) else { return };
        let args = Args { python: Some(python) };
        let published =
            |effect| NetSpec::published(effect, ChannelOrder::Interleaved, REACH).expect("it has one");
        let [filtering, with_black] = [Effect::Dof, Effect::Multi]
            .map(|effect| published(effect).predicting_kernels().expect("it reads light"));
        let infer = json!({ "mode": "infer", "size": [64, 48], "runs": 3, "seconds": 0.1 });
        let train = json!({ "mode": "train", "batch": 1, "crop": 32, "runs": 3, "seconds": 0.1 });
        let estimate = || vec![AnalyticEstimate::new("any", "low")];
        let corrected = |effect| NetSpec::corrected(effect, 8, estimate(), REACH).expect("it is laid out");
        let [gained, gated] = [Effect::Gi, Effect::MotionBlur].map(corrected);
        let inferred = [filtering, with_black, gained, gated].map(|spec| (spec, infer.clone()));
        for (spec, job) in inferred.into_iter().chain([(published(Effect::Ao), train)]) {
            let report = args.run(&random(spec), 1, job).expect("runs").expect("a Python is named");
            let engines: Vec<&str> =
                report.made.iter().map(|row| row.engine.trim_end_matches("_half")).collect();
            assert_eq!(engines, ["pytorch", "pytorch_compiled"]);
            assert!(report.made.iter().all(|row| row.milliseconds > 0.0 && row.p95 >= row.milliseconds));
        }
    }

    #[test]
    fn a_program_that_is_no_python_with_pytorch_is_an_error_that_names_it() {
        let model = random(NetSpec::ao(ChannelOrder::Interleaved, REACH));
        // They end without reading the job, which is larger than a pipe holds.
        for program in ["true", "false", "/no/such/python"] {
            let args = Args { python: Some(program.to_owned()) };
            let error = args.run(&model, 1, json!({})).expect_err("no PyTorch");
            assert!(format!("{error:#}").contains(&format!("--python {program}")), "{error:#}");
            assert!(!crate::output::nobody_reads(&error), "{error:#}");
        }
    }
}
