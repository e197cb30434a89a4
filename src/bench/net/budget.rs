//! Which network fits into so many milliseconds: of those like the paper's with other numbers of kernels and
//! levels, the one with the most multiply-adds whose fastest run takes at most so long. What measured layers
//! predict only spares the runs of networks that are far too large.

use super::rivals::WARM_UP_TIME;
use super::subjects::{self, random};
use super::{Args, PAPER, layers};
use crate::engine::{self, Engine};
use crate::figures::Figures;
use anyhow::Result;
use deepshade_infer::{Cost, Model, NetSpec, parity};
use deepshade_shaders::gpu::{self, Gpu};
use deepshade_shaders::lists;
use glam::{DMat3, DVec3};

/// Kernels on level 0 of networks that are considered.
const WIDTHS: [usize; 13] = [2, 4, 6, 8, 12, 16, 24, 32, 48, 75, 150, 300, 450];
/// Most levels.
const MOST_LEVELS: usize = 6;
/// Most multiply-adds a pixel of a network that is considered: four times the paper's largest.
const MOST_WORK: u64 = 60_000;
/// Networks whose layers are measured.
const MEASURED: usize = 4;
/// How many times as long as predicted a network may fit in: predictions are off by less.
const SLACK: f64 = 2.0;
/// Runs that are timed, after one that is not.
const RUNS: usize = 9;

/// Finds the largest network of an effect's kind that fits, and says what it is.
///
/// # Errors
/// If not exactly one network and one size are asked for, or none fits.
pub fn run(args: &Args, gpu: &Gpu, budget: f32) -> Result<()> {
    let ([effect], [size]) = (args.networks.as_slice(), args.sizes.as_slice()) else {
        anyhow::bail!("--budget needs one of --networks and one of --sizes");
    };
    let size = [size.width, size.height];
    let published = subjects::published(*effect)?;
    let variants = variants(&published);
    let most = variants.iter().map(|spec| multiply_adds(spec, size)).max();
    note!("times of the layers of {MEASURED} networks, for predictions");
    let model = CostModel::measured(gpu, &variants)?;
    let runs = published.runs() as f64;
    let candidate = |spec: NetSpec| Candidate {
        predicted: runs * model.milliseconds(&spec, size),
        multiply_adds: multiply_adds(&spec, size),
        spec,
    };
    let candidates = variants.into_iter().map(candidate).collect();
    let (candidate, timed) = largest(candidates, budget, |tried| timed(gpu, tried, size))?;
    let is_largest = Some(candidate.multiply_adds) == most;
    let choice = Choice { budget, size, candidate, timed, is_largest };
    let written = choice.figures().write(args.json.as_deref());
    let said = choice.say();
    written.and(said)
}

/// What was found.
struct Choice {
    budget: f32,
    size: [usize; 2],
    candidate: Candidate,
    timed: Timed,
    /// Whether no larger network is considered.
    is_largest: bool,
}

impl Choice {
    fn multiply_adds_pixel(&self) -> f64 {
        let runs = self.candidate.spec.runs() as f64;
        let pixels = self.size.iter().product::<usize>() as f64;
        (runs * self.candidate.multiply_adds as f64 / pixels).round()
    }

    fn figures(&self) -> Figures {
        let Candidate { spec, predicted, .. } = &self.candidate;
        let mut figures = Figures::new("bench net --budget");
        figures.set("budget", self.budget.into());
        figures.set("predicted", *predicted);
        figures.set("actual", self.timed.milliseconds);
        figures.set("u0", spec.blocks[0].outputs as f64);
        figures.set("levels", spec.levels() as f64);
        figures.set("weights", spec.weight_count() as f64);
        figures.set("multiply_adds_pixel", self.multiply_adds_pixel());
        figures.detail("engine", self.timed.engine.into());
        figures.detail("device", self.timed.device.as_str().into());
        figures.detail("largest_considered", self.is_largest.into());
        figures
    }

    fn say(&self) -> Result<()> {
        let Self {
            budget, size: [width, height], candidate: Candidate { spec, predicted, .. }, timed, ..
        } = self;
        let (effect, u0, levels) = (spec.effect, spec.blocks[0].outputs, spec.levels());
        let (weights, work) = (spec.weight_count(), self.multiply_adds_pixel());
        say!("{effect} at {width}x{height} within {budget} ms: u0 {u0}, {levels} levels, {weights} weights")?;
        say!(
            "{u0} kernels on the first of {levels} resolutions; of all that fit the most multiply-adds: {work} a pixel"
        )?;
        if self.is_largest {
            say!("no larger network is considered")?;
        }
        let Timed { milliseconds, engine, device } = timed;
        say!("predicted {predicted:.2} ms, run {milliseconds:.2} ms, all colour channels together")?;
        say!("run by {engine} on {device}")
    }
}

/// A network that is considered.
struct Candidate {
    spec: NetSpec,
    /// Milliseconds that it should take.
    predicted: f64,
    multiply_adds: u64,
}

/// The candidate with the most multiply-adds whose run takes at most `budget` milliseconds, with what it
/// took. Those predicted to take more than [`SLACK`] times as long are not run. For the same predictions and
/// times a greater budget never gives a smaller network, since whatever fits into the smaller one is also
/// tried with the greater.
///
/// # Errors
/// If a run fails, or none fits.
fn largest(
    mut candidates: Vec<Candidate>,
    budget: f32,
    mut run: impl FnMut(&Candidate) -> Result<Timed>,
) -> Result<(Candidate, Timed)> {
    let mut fastest = candidates.iter().map(|tried| tried.predicted).fold(f64::INFINITY, f64::min);
    candidates.retain(|tried| tried.predicted <= SLACK * f64::from(budget));
    candidates.sort_by_key(|tried| tried.multiply_adds);
    while let Some(tried) = candidates.pop() {
        let timed = run(&tried)?;
        if timed.milliseconds <= f64::from(budget) {
            return Ok((tried, timed));
        }
        fastest = fastest.min(timed.milliseconds);
    }
    anyhow::bail!("no network of this kind takes at most {budget} ms; the fastest takes about {fastest:.2}")
}

/// Networks like one, of other widths and depths.
fn variants(spec: &NetSpec) -> Vec<NetSpec> {
    let of =
        |levels: usize| WIDTHS.map(|u0| spec.clone().reshaped(|net| (net.u0, net.levels) = (u0, levels)));
    let most = if spec.levels() == 1 { 1 } else { MOST_LEVELS };
    let sensible = |spec: &NetSpec| {
        spec.validate().is_ok() && multiply_adds(spec, [1024, 1024]) <= MOST_WORK * 1024 * 1024
    };
    (1..=most).flat_map(of).filter(sensible).collect()
}

fn multiply_adds(spec: &NetSpec, [width, height]: [usize; 2]) -> u64 {
    spec.costs(height, width).into_iter().sum::<Cost>().multiply_adds
}

/// What the runs of a network came to.
struct Timed {
    /// Milliseconds of the fastest run, since what else the machine does only adds to it; all colour channels
    /// together.
    milliseconds: f64,
    engine: &'static str,
    device: String,
}

fn timed(gpu: &Gpu, tried: &Candidate, [width, height]: [usize; 2]) -> Result<Timed> {
    let Candidate { spec, predicted, .. } = tried;
    let engine = Engine::new(engine::card(gpu), &random(spec.clone()))?;
    let input = parity::noise(spec.input_channels(), height, width, 1);
    gpu::warm_up(&gpu.device, &gpu.queue, WARM_UP_TIME)?;
    engine.run(&input, 0, 1)?;
    let run = |_| Ok(engine.run(&input, 0, 1)?.1.milliseconds);
    let times = (0..RUNS).map(run).collect::<Result<Vec<f64>>>()?;
    let milliseconds = spec.runs() as f64 * times.into_iter().fold(f64::INFINITY, f64::min);
    let (u0, levels) = (spec.blocks[0].outputs, spec.levels());
    note!("u0 {u0}, {levels} levels: predicted {predicted:.2} ms, run {milliseconds:.2} ms");
    Ok(Timed { milliseconds, engine: engine.name(), device: engine.device() })
}

/// Milliseconds of a layer as a sum of shares of its multiply-adds, of the numbers that it moves, and of a
/// constant.
#[derive(Clone, Copy, Debug)]
struct CostModel(DVec3);

impl CostModel {
    /// Fitted to the layers of a few of some networks.
    fn measured(gpu: &Gpu, variants: &[NetSpec]) -> Result<Self> {
        let mut layers = Vec::new();
        for index in lists::spread(variants.len(), MEASURED) {
            let model = random(variants[index].clone());
            let [width, height] = PAPER;
            let costs = model.spec.costs(height, width);
            layers.extend(costs.into_iter().zip(times(gpu, &model)?).map(|(cost, (_, time))| (cost, time)));
        }
        Ok(Self::fitted(&layers))
    }

    /// The least squares of relative errors, with no share below zero.
    fn fitted(layers: &[(Cost, f64)]) -> Self {
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (cost, time) in layers {
            let row = features(*cost) / *time;
            matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
            right += row;
        }
        // A little of the diagonal keeps features that always go together from cancelling each other.
        let ridge = DMat3::from_diagonal(matrix.diagonal() * 1e-6);
        Self(((matrix + ridge).inverse() * right).max(DVec3::ZERO))
    }

    fn milliseconds(self, spec: &NetSpec, [width, height]: [usize; 2]) -> f64 {
        spec.costs(height, width).into_iter().map(|cost| features(cost).dot(self.0)).sum()
    }
}

fn features(cost: Cost) -> DVec3 {
    DVec3::new(cost.multiply_adds as f64 * 1e-6, cost.numbers() as f64 * 1e-6, 1.0)
}

/// Milliseconds of the layers on the engine that runs networks here.
fn times(gpu: &Gpu, model: &Model) -> Result<Vec<(String, f64)>> {
    if gpu.is_software() { layers::cpu_times(model, PAPER) } else { layers::wgsl(gpu, model, PAPER) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Effect;

    #[test]
    fn a_fit_finds_what_made_the_times() {
        let spec = subjects::spec(Effect::Ao).expect("it has one");
        let shares = DVec3::new(0.02, 0.3, 0.01);
        let costs = [4, 8, 16].map(|u0| spec.clone().reshaped(|net| net.u0 = u0).costs(512, 768)).concat();
        let layers: Vec<(Cost, f64)> =
            costs.iter().map(|cost| (*cost, features(*cost).dot(shares))).collect();
        let model = CostModel::fitted(&layers);
        assert!((model.0 - shares).abs().max_element() < 1e-3, "{model:?}");
        let expected: f64 = spec.costs(1080, 1920).iter().map(|cost| features(*cost).dot(shares)).sum();
        assert!((model.milliseconds(&spec, [1920, 1080]) / expected - 1.0).abs() < 1e-3);
    }

    /// Networks whose runs take other times than predicted, by multiply-adds.
    fn candidates() -> Vec<(Candidate, f64)> {
        let spec = subjects::spec(Effect::Ao).expect("it has one");
        let made = |(multiply_adds, predicted, actual)| {
            (Candidate { spec: spec.clone(), predicted, multiply_adds }, actual)
        };
        [(9, 9.0, 12.0), (1, 1.0, 0.5), (7, 6.0, 5.0), (3, 4.0, 2.5), (5, 2.0, 3.0)].map(made).into()
    }

    fn chosen(budget: f32) -> Result<u64> {
        let times: Vec<(u64, f64)> =
            candidates().into_iter().map(|(tried, actual)| (tried.multiply_adds, actual)).collect();
        let actual = |tried: &Candidate| {
            let found = times.iter().find(|(multiply_adds, _)| *multiply_adds == tried.multiply_adds);
            let milliseconds = found.expect("a candidate").1;
            Ok(Timed { milliseconds, engine: "cpu", device: String::new() })
        };
        let candidates = candidates().into_iter().map(|(tried, _)| tried).collect();
        Ok(largest(candidates, budget, actual)?.0.multiply_adds)
    }

    #[test]
    fn the_largest_is_chosen_by_what_it_took_and_more_time_never_gives_a_smaller_one() {
        let budgets = [0.5, 2.5, 3.0, 4.9, 5.0, 11.9, 12.0, 1e6];
        let sizes: Vec<u64> = budgets.map(|budget| chosen(budget).expect("one fits")).into();
        assert_eq!(sizes, [1, 3, 5, 5, 7, 7, 9, 9]);
        let error = chosen(0.4).expect_err("none fits").to_string();
        assert!(error.ends_with("the fastest takes about 1.00"), "{error}");
        assert!(chosen(0.49).is_err());
    }

    #[test]
    fn kin_are_valid_and_differ() {
        let spec = subjects::spec(Effect::Ao).expect("it has one");
        let variants = variants(&spec);
        assert!(variants.contains(&spec) && variants.len() > 30, "{}", variants.len());
        for effect in [Effect::Aa, Effect::Ibl] {
            let spec = subjects::spec(effect).expect("it has one");
            let variants = super::variants(&spec);
            assert!(variants.contains(&spec) && variants.iter().all(|spec| spec.levels() == 1), "{effect}");
        }
    }
}
