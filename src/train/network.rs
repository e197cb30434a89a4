//! Which network `deepshade train` trains, and its defaults.

use super::{Args, share};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use deepshade_dataset::{Radius, Recipe};
use deepshade_infer::{AnalyticEstimate, ChannelOrder, NetSpec, Reach, UNet};
use deepshade_render::methods::Quality;
use deepshade_render::methods::estimate::{EstimateError, Estimator};
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
/// Effects whose corrected network was measured to be ahead of the estimate that it reads.
const MEASURED: [Effect; 9] = [
    Effect::Aa,
    Effect::Ao,
    Effect::Do,
    Effect::Dof,
    Effect::Gi,
    Effect::MotionBlur,
    Effect::Multi,
    Effect::PhosphorGi,
    Effect::Sss,
];
/// Channels of the corrected network at half the resolution.
pub const CHANNELS: usize = 24;
/// The estimates that the corrected network reads of an effect, that which it corrects first.
fn usual_estimates(effect: Effect) -> Vec<AnalyticEstimate> {
    let of = AnalyticEstimate::new;
    match effect {
        Effect::Gi | Effect::PhosphorGi => vec![of("surfel", "medium"), of("gtao", "low").of(Effect::Ao)],
        Effect::Do => vec![of("ssdo", "medium"), of("gtao", "medium").of(Effect::Ao)],
        Effect::Path => vec![of("composed", "low"), of("gtao", "low").of(Effect::Ao)],
        Effect::Dof => vec![of("ring-gather", "high")],
        Effect::Multi => vec![of("occluded-gather", "high")],
        Effect::MotionBlur => vec![of("reconstruction", "high")],
        Effect::Sss => vec![of("separable", "ultra")],
        Effect::Aa => vec![of("fxaa", "high")],
        _ => vec![of("gtao", "high")],
    }
}

/// Whether a method of an effect makes it of the scene, and not of a g-buffer alone.
fn is_of_scene(effect: Effect, estimate: &AnalyticEstimate) -> bool {
    let AnalyticEstimate { method, quality, .. } = estimate;
    let estimator = Estimator::named(estimate.effect(effect), method, quality);
    estimator.is_ok_and(|estimator| estimator.reads_scene())
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
    /// The default: one that corrects an estimate, where that is better and the pairs have what of it only a
    /// scene tells; else the paper's. Views that are rendered get what a network reads.
    pub fn usual(recipe: &Recipe, streamed: bool) -> Self {
        let effect = recipe.effect;
        let of_scene = usual_estimates(effect).iter().any(|estimate| is_of_scene(effect, estimate));
        let has_all = streamed || !of_scene || !recipe.estimates.is_empty();
        // Where the paper has none, it is said what the pairs lack.
        let is_only_one = UNet::of(effect, ChannelOrder::Interleaved).is_none();
        if MEASURED.contains(&effect) && (has_all || is_only_one) { Self::Corrected } else { Self::Paper }
    }
}

/// Reads a number of channels.
pub fn channels(text: &str) -> Result<usize, String> {
    let channels = text.parse().map_err(|_| format!("`{text}` is no whole number"))?;
    if (4..=1024).contains(&channels) { Ok(channels) } else { Err(format!("{channels} is not 4 to 1024")) }
}

/// Reads an estimate.
pub fn estimate(text: &str) -> Result<AnalyticEstimate, String> {
    let form = || EstimateError::Form(text.to_owned()).to_string();
    let (method, quality) = text.split_once(':').ok_or_else(form)?;
    if Quality::ALL.iter().all(|known| known.name() != quality) {
        return Err(EstimateError::Quality(quality.to_owned()).to_string());
    }
    Ok(AnalyticEstimate::new(method, quality))
}

/// The default radius of a network: the recipe's, where it has one.
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
    let height = recipe.smallest.unwrap_or(recipe.resolution).height;
    let diagonal_share = if let Radius::Diagonal(share) = recipe.radius { share } else { USUAL_SHARE };
    let reach = Reach { radius: RADII, diagonal_share, height };
    let corrected = NetSpec::corrected(recipe.effect, CHANNELS, usual_estimates(recipe.effect), reach);
    match (corrected.filter(|_| Network::usual(recipe, false) == Network::Corrected), recipe.radius) {
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
    let diagonal_share = diagonal_share(args, recipe, data)?;
    let reach =
        Reach { radius: RADII, diagonal_share, height: recipe.smallest.unwrap_or(recipe.resolution).height };
    let mut estimates = usual_estimates(effect);
    if let Some(estimate) = &args.estimate {
        estimates[0] = estimate.clone();
    }
    let spec = NetSpec::corrected(effect, args.channels, estimates, reach)
        .with_context(|| format!("--network corrected: no such network is laid out for `{effect}`"))?;
    let AnalyticEstimate { method, quality, .. } = &spec.estimates[0];
    Estimator::named(effect, method, quality).context("--estimate")?;
    check_data(&spec.estimates, recipe, args.dataset.is_some(), data)?;
    Ok(correcting(spec, data))
}

/// Whether data hold the estimate as the network reads it. Where they do not it is made, unless only a scene
/// tells it and they are on disk. An estimate that their recipe names would take its place.
fn check_data(estimates: &[AnalyticEstimate], recipe: &Recipe, on_disk: bool, data: &Path) -> Result<()> {
    let Some(estimate) = estimates.first() else {
        return Ok(());
    };
    let (data, wanted) = (data.display(), format!("{}:{}", estimate.method, estimate.quality));
    match recipe.estimates.first() {
        Some(held) if *held != wanted => bail!(
            "{data}: it has `{held}`, and the network reads `{wanted}`: give --estimate {held}, or have \
             `estimates = [\"{wanted}\"]` in the recipe"
        ),
        None if on_disk && is_of_scene(recipe.effect, estimate) => bail!(
            "{data}: the network reads `{wanted}`, which pairs hold whose recipe has \
             `estimates = [\"{wanted}\"]`: generate them anew, or train with --recipe, which makes it"
        ),
        _ => Ok(()),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_another_estimate_than_the_networks_are_refused() {
        let recipe = |estimates: &str| -> Recipe {
            let text = format!(
                "effect = \"gi\"\nsplit = \"train\"\nseed = 1\nsamples = 8\nviews_per_scene = 1\n\
                 resolution = {{ height = 64, width = 64 }}\nradius = {{ diagonal = 0.1 }}\n{estimates}\n\
                 vary = {{ light = true }}\nfamilies = [{{ name = \"room\", scenes = 1 }}]"
            );
            toml::from_str(&text).expect("a recipe")
        };
        let check = |estimates: &str, on_disk| {
            let reads = usual_estimates(Effect::Gi);
            let checked = check_data(&reads, &recipe(estimates), on_disk, Path::new("pairs"));
            checked.map_err(|error| error.to_string())
        };
        assert_eq!(check("estimates = [\"surfel:medium\"]", true), Ok(()));
        assert_eq!(check("", false), Ok(()), "views are rendered with it");
        assert!(check("", true).is_err_and(|error| error.contains("`estimates = [\"surfel:medium\"]`")));
        for (held, on_disk) in [("surfel:high", false), ("surfel:high", true), ("bounced-z:low", false)] {
            let other = check(&format!("estimates = [\"{held}\"]"), on_disk);
            assert!(other.is_err_and(|error| error.contains(&format!("--estimate {held}"))));
        }
        let kept: Recipe = Recipe { effect: Effect::PhosphorGi, ..recipe("") };
        assert_eq!(Network::usual(&kept, false), Network::Corrected, "the paper has none");
        assert_eq!(Network::usual(&recipe(""), false), Network::Paper, "the paper has one");
        assert!(check_data(&usual_estimates(Effect::Ao), &recipe(""), true, Path::new("pairs")).is_ok());
    }
}
