//! Which network fits into so many milliseconds: predicted from measured layers, then run.

use super::rivals::WAKING;
use super::subjects::{self, random};
use super::{Args, PAPER, layers};
use crate::engine::Engine;
use crate::figures::Figures;
use anyhow::{Context, Result};
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

/// Finds the largest network of an effect's kind that fits, and runs it.
///
/// # Errors
/// If not exactly one network and one size are asked for, or none fits.
pub fn run(args: &Args, gpu: &Gpu, budget: f32) -> Result<()> {
    let ([effect], [size]) = (args.networks.as_slice(), args.sizes.as_slice()) else {
        anyhow::bail!("--budget needs one of --networks and one of --sizes");
    };
    let size = [size.width, size.height];
    let published = subjects::published(*effect)?;
    let kin = kin(&published);
    let model = CostModel::measured(gpu, &kin)?;
    let runs = published.runs() as f64;
    let predicted = |spec: NetSpec| (runs * model.milliseconds(&spec, size), spec);
    let mut candidates: Vec<(f64, NetSpec)> = kin.into_iter().map(predicted).collect();
    let least = candidates.iter().map(|(milliseconds, _)| *milliseconds).fold(f64::INFINITY, f64::min);
    candidates.retain(|(milliseconds, _)| *milliseconds <= budget.into());
    candidates.sort_by_key(|(_, spec)| multiply_adds(spec, size));
    // The largest first; what takes longer than predicted makes room for the next smaller one.
    let (predicted, actual, spec) = loop {
        let none =
            || format!("no network of this kind takes at most {budget} ms; the fastest, about {least:.2}");
        let (predicted, spec) = candidates.pop().with_context(none)?;
        let actual = runs * actual(gpu, &spec, size)?;
        note!("u0 {}, {} levels: predicted {predicted:.2} ms, run {actual:.2} ms", spec.u0, spec.levels);
        if actual <= budget.into() {
            break (predicted, actual, spec);
        }
    };

    let mut figures = Figures::new("bench net --budget");
    figures.set("budget", budget.into());
    figures.set("predicted", predicted);
    figures.set("actual", actual);
    figures.set("u0", spec.u0 as f64);
    figures.set("levels", spec.levels as f64);
    figures.set("weights", spec.weight_count() as f64);
    figures.write(args.json.as_deref())?;
    let [width, height] = size;
    let (u0, levels, weights) = (spec.u0, spec.levels, spec.weight_count());
    say!("{effect} at {width}x{height} within {budget} ms: u0 {u0}, {levels} levels, {weights} weights")?;
    say!("predicted {predicted:.2} ms, run {actual:.2} ms, all colour channels together")
}

/// Networks like one, of other widths and depths.
fn kin(spec: &NetSpec) -> Vec<NetSpec> {
    let of = |levels: usize| WIDTHS.map(|u0| NetSpec { u0, levels, ..spec.clone() });
    let most = if spec.levels == 1 { 1 } else { MOST_LEVELS };
    let sensible = |spec: &NetSpec| {
        spec.validate().is_ok() && multiply_adds(spec, [1024, 1024]) <= MOST_WORK * 1024 * 1024
    };
    (1..=most).flat_map(of).filter(sensible).collect()
}

fn multiply_adds(spec: &NetSpec, [width, height]: [usize; 2]) -> u64 {
    spec.costs(height, width).into_iter().sum::<Cost>().multiply_adds
}

/// Median of some runs, milliseconds.
fn actual(gpu: &Gpu, spec: &NetSpec, [width, height]: [usize; 2]) -> Result<f64> {
    let engine = Engine::new(Some(gpu), &random(spec.clone()))?;
    let input = parity::noise(spec.input_channels(), height, width, 1);
    gpu::wake(&gpu.device, &gpu.queue, WAKING)?;
    Ok(engine.run(&input, 1, 5)?.1.milliseconds)
}

/// Milliseconds of a layer as a sum of shares of its multiply-adds, of the numbers that it moves, and of a constant.
#[derive(Clone, Copy, Debug)]
struct CostModel(DVec3);

impl CostModel {
    /// Fitted to the layers of a few of some networks.
    fn measured(gpu: &Gpu, kin: &[NetSpec]) -> Result<Self> {
        let mut layers = Vec::new();
        for index in lists::spread(kin.len(), MEASURED) {
            let model = random(kin[index].clone());
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
        let costs = [4, 8, 16].map(|u0| NetSpec { u0, ..spec.clone() }.costs(512, 768)).concat();
        let layers: Vec<(Cost, f64)> =
            costs.iter().map(|cost| (*cost, features(*cost).dot(shares))).collect();
        let model = CostModel::fitted(&layers);
        assert!((model.0 - shares).abs().max_element() < 1e-3, "{model:?}");
        let expected: f64 = spec.costs(1080, 1920).iter().map(|cost| features(*cost).dot(shares)).sum();
        assert!((model.milliseconds(&spec, [1920, 1080]) / expected - 1.0).abs() < 1e-3);
    }

    #[test]
    fn kin_are_valid_and_differ() {
        let spec = subjects::spec(Effect::Ao).expect("it has one");
        let kin = kin(&spec);
        assert!(kin.contains(&spec) && kin.len() > 30, "{}", kin.len());
        for effect in [Effect::Aa, Effect::Ibl] {
            let spec = subjects::spec(effect).expect("it has one");
            let kin = super::kin(&spec);
            assert!(kin.contains(&spec) && kin.iter().all(|spec| spec.levels == 1), "{effect}");
        }
    }
}
