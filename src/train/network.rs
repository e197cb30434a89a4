//! Which network `deepshade train` trains, and its defaults.

use super::{Args, share};
use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use deepshade_dataset::{Radius, Recipe};
use deepshade_infer::{AnalyticEstimate, ChannelOrder, Head, NetSpec, Reach};
use deepshade_render::methods::estimate::Estimator;
use deepshade_shaders::Effect;
use deepshade_train::{Loss, TrainConfig};
use std::path::Path;

/// Radius of the effect in the units of the network's input: positions, some ten radii away, then are about
/// as large as the components of normals.
pub const INPUT_RADIUS: f32 = 0.25;

/// Radius of the effect in the units of the input of corrected networks: lengths are in radii.
const RADII: f32 = 1.0;
/// The default radius of networks that know all radii, as a share of the scene's diagonal.
const USUAL_SHARE: f32 = 0.03;
/// Channels of the corrected network at half the resolution.
pub const CHANNELS: usize = 24;
/// The estimate that the corrected network reads of an effect.
fn usual_estimate(effect: Effect) -> AnalyticEstimate {
    let [method, quality] = match effect {
        Effect::Gi => ["surfel", "low"],
        _ => ["gtao", "high"],
    };
    AnalyticEstimate { method: method.to_owned(), quality: quality.to_owned() }
}

/// Which network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Network {
    /// The paper's U-net, from positions alone.
    Paper,
    /// One that reads what an analytic method estimates, and corrects it.
    Corrected,
}

impl Network {
    /// The default: one that corrects what is estimated of the g-buffer alone, else the paper's. What only a
    /// scene tells has to be in the pairs, so it has to be asked for.
    pub fn usual(effect: Effect) -> Self {
        let reach = Reach { radius: RADII, diagonal_share: USUAL_SHARE, height: 1 };
        let AnalyticEstimate { method, quality } = usual_estimate(effect);
        let of_scene = Estimator::named(&method, &quality).is_ok_and(|estimator| estimator.reads_scene());
        match NetSpec::corrected(effect, CHANNELS, usual_estimate(effect), reach) {
            Some(_) if !of_scene => Self::Corrected,
            _ => Self::Paper,
        }
    }
}

/// Reads a number of channels.
pub fn channels(text: &str) -> Result<usize, String> {
    let channels = text.parse().map_err(|_| format!("`{text}` is no whole number"))?;
    if (4..=1024).contains(&channels) { Ok(channels) } else { Err(format!("{channels} is not 4 to 1024")) }
}

/// Reads an estimate.
pub fn estimate(text: &str) -> Result<AnalyticEstimate, String> {
    Estimator::parse(text).map_err(|error| error.to_string())?;
    let (method, quality) = text.split_once(':').unwrap_or_default();
    Ok(AnalyticEstimate { method: method.to_owned(), quality: quality.to_owned() })
}

/// The default radius of a network of the paper's: the recipe's, where it has one.
///
/// # Errors
/// If it is in metres, and the recipe's scenes do not tell which share of their diagonals that is.
pub fn diagonal_share(args: &Args, recipe: &Recipe, data: &Path) -> Result<f32> {
    match (args.diagonal_share, recipe.radius) {
        (Some(share), _) | (None, Radius::Diagonal(share)) => Ok(share),
        (None, Radius::Pixels(_) | Radius::MetresBetween(_)) => Ok(USUAL_SHARE),
        (None, Radius::Metres(metres)) => {
            let share = share::of_metres(recipe, metres).with_context(|| {
                let data = data.display();
                format!("{data}: its radius is in metres; --diagonal-share states the network's default")
            })?;
            note!(
                "a radius of {metres} m is {:.1} % of the diagonal of the recipe's scenes: the network's default",
                100.0 * share
            );
            Ok(share)
        }
    }
}

/// The defaults for data that a recipe makes, and its [usual](Network::usual) network.
pub fn usual_config(recipe: &Recipe, data: &Path) -> Result<TrainConfig> {
    let reach = |share| Reach { radius: RADII, diagonal_share: share, height: recipe.resolution.height };
    let estimate = usual_estimate(recipe.effect);
    let corrected = NetSpec::corrected(recipe.effect, CHANNELS, estimate, reach(USUAL_SHARE));
    match (corrected.filter(|_| Network::usual(recipe.effect) == Network::Corrected), recipe.radius) {
        (Some(spec), _) => Ok(correcting(spec, data)),
        (None, Radius::Diagonal(share)) => default_config(recipe, data, ChannelOrder::Interleaved, share),
        (None, _) => {
            bail!("the paper's networks want a recipe that states its radius as a share of the diagonal")
        }
    }
}

/// The defaults for a network that corrects an estimate.
pub fn corrected_config(args: &Args, recipe: &Recipe, data: &Path) -> Result<TrainConfig> {
    let effect = recipe.effect;
    let diagonal_share = args.diagonal_share.unwrap_or(USUAL_SHARE);
    let reach =
        Reach { radius: RADII, diagonal_share, height: recipe.smallest.unwrap_or(recipe.resolution).height };
    let estimate = args.estimate.clone().unwrap_or_else(|| usual_estimate(effect));
    let makes = Estimator::named(&estimate.method, &estimate.quality)?.makes();
    let named = format!("--estimate {}:{}", estimate.method, estimate.quality);
    let spec = NetSpec::corrected(effect, args.channels, estimate, reach)
        .with_context(|| format!("--network corrected: no method estimates `{effect}` for networks"))?;
    let fits = matches!(spec.head, Head::Correction(correction) if makes.contains(&correction.of));
    ensure!(fits, "{named} does not estimate `{effect}`");
    Ok(correcting(spec, data))
}

/// The defaults for a spec that corrects an estimate. An estimate is so near to truth that what is left to
/// gain is small differences over wide areas, which the means of tiles show.
fn correcting(spec: NetSpec, data: &Path) -> TrainConfig {
    TrainConfig { loss: Loss::DssimL2Means, ..TrainConfig::new(spec, data.to_owned()) }
}

/// The defaults for data that a recipe makes, and a network that reaches `diagonal_share` of a scene's
/// diagonal.
pub fn default_config(
    recipe: &Recipe,
    dataset: &Path,
    order: ChannelOrder,
    diagonal_share: f32,
) -> Result<TrainConfig> {
    let reach = Reach {
        radius: INPUT_RADIUS,
        diagonal_share,
        height: recipe.smallest.unwrap_or(recipe.resolution).height,
    };
    let effect = recipe.effect;
    let spec = NetSpec::published(effect, order, reach)
        .with_context(|| format!("no network is laid out for effect `{effect}`"))?;
    Ok(TrainConfig::new(spec, dataset.to_owned()))
}
