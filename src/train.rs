//! `deepshade train`: a network from a dataset.

use crate::arguments::positive;
use crate::figures::Figures;
use crate::place::Place;
use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use deepshade_dataset::recipe::Resolution;
use deepshade_dataset::{Manifest, Radius};
use deepshade_infer::{ChannelOrder, NetSpec, Reach};
use deepshade_shaders::Effect;
use deepshade_shaders::similarity::TILE;
use deepshade_train::config::MOST_MINUTES;
use deepshade_train::{Ending, Loss, Optimiser, Outcome, TrainConfig};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Trains a network on a dataset; the same command resumes a run that was interrupted.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade dataset generate dataset/recipes/ao.toml --out data/ao\n  \
    deepshade train --dataset data/ao --out runs/ao --steps 20000\n\n\
    The run's folder gets `config.json`, checkpoints, `metrics.jsonl` and a plot of the loss.")]
pub struct Args {
    /// What `deepshade dataset generate` made: its folder or address.
    #[arg(long)]
    dataset: Place,
    /// Folder of the run, or an address such as s3://bucket/runs/ao.
    #[arg(long)]
    out: Place,
    /// Order of the channels after a concatenation.
    #[arg(long, value_enum, default_value_t = Order::Interleaved)]
    order: Order,
    /// What the last layer makes [default: kernels for dof, motion-blur, multi and sss, else the image].
    #[arg(long, value_enum)]
    last: Option<LastLayer>,
    /// What is made small.
    #[arg(long, value_enum, default_value_t = LossName::Dssim)]
    loss: LossName,
    /// Model whose weights the run begins with, in place of random ones; its last layer must be that of --last.
    #[arg(long, value_name = "FOLDER")]
    from: Option<Place>,
    /// How weights follow gradients: the practical default, or the paper's.
    #[arg(long, value_enum, default_value_t = Method::Adamw)]
    optimiser: Method,
    #[arg(long, help = rate_help())]
    rate: Option<f64>,
    #[arg(long, value_name = "SHARE", help = decay_help())]
    weight_decay: Option<f64>,
    /// Images a step.
    #[arg(long, default_value_t = defaults().batch)]
    batch: usize,
    /// Devices that share the images of each step: GPUs where it was built for them, threads of the processor else.
    #[arg(long, default_value_t = defaults().devices)]
    devices: usize,
    #[arg(long, help = crop_help())]
    crop: Option<usize>,
    /// Steps of the whole run.
    #[arg(long, default_value_t = defaults().steps)]
    steps: usize,
    /// At most so many of the pairs held apart are used for validation.
    #[arg(long, default_value_t = defaults().validation_pairs)]
    validation_pairs: usize,
    /// Steps between validations.
    #[arg(long, default_value_t = defaults().validate_every)]
    validate_every: usize,
    /// Validations without a better one after which the run ends; 0 for never.
    #[arg(long, default_value_t = defaults().patience)]
    patience: usize,
    /// Chooses first weights, order, crops and symmetries.
    #[arg(long, default_value_t = defaults().seed)]
    seed: u64,
    /// Minutes after which the run stops; the same command goes on.
    #[arg(long, value_parser = minutes)]
    minutes: Option<f64>,
    /// Threads that decode pairs.
    #[arg(long, default_value_t = defaults().workers)]
    workers: usize,
    /// Megabytes of decoded pairs kept in memory.
    #[arg(long, default_value_t = defaults().cache_megabytes)]
    cache_megabytes: usize,
    /// The network's default radius as a share of a scene's diagonal, where it is not to be the recipe's.
    #[arg(long, value_parser = positive)]
    diagonal_share: Option<f32>,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Radius of the effect in the units of the network's input: positions, some ten radii away, then are about as large
/// as the components of normals.
pub const INPUT_RADIUS: f32 = 0.25;

/// Order of the channels after a concatenation.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Order {
    /// Every group sees both sources.
    Interleaved,
    /// As in the paper's framework: most groups see one source.
    Contiguous,
}

impl From<Order> for ChannelOrder {
    fn from(order: Order) -> Self {
        match order {
            Order::Interleaved => Self::Interleaved,
            Order::Contiguous => Self::Contiguous,
        }
    }
}

/// The weight decay of networks that predict kernels.
const KERNELS_DECAY: f64 = 0.05;

/// What the last layer makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LastLayer {
    /// The image, as in the paper.
    Image,
    /// Weights of the light, which the image is the sum of: of 3x3 pixels at several resolutions, for aa 5x5 at one, for multi
    /// of black too, for sss of each colour by itself.
    Kernels,
}

impl LastLayer {
    /// What came nearer to truth in equal steps. For anti-aliasing kernels do, too, but by little, with ten times the weights.
    const fn best(effect: Effect) -> Self {
        match effect {
            Effect::Dof | Effect::MotionBlur | Effect::Multi | Effect::Sss => Self::Kernels,
            _ => Self::Image,
        }
    }

    /// The weight decay that it wants, if not the usual one. Without more of it what it makes grows until what half floats round
    /// away, which goes into exponents, shows.
    const fn weight_decay(self) -> Option<f64> {
        match self {
            Self::Image => None,
            Self::Kernels => Some(KERNELS_DECAY),
        }
    }

    /// The paper's network with that last layer.
    fn of(self, paper: NetSpec) -> Result<NetSpec> {
        match self {
            Self::Image => Ok(paper),
            Self::Kernels => paper.predicting_kernels().with_context(|| {
                format!("--last kernels: the network for `{}` reads no light", paper.effect)
            }),
        }
    }
}

/// What is made small.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum LossName {
    /// Structural dissimilarity, the paper's.
    Dssim,
    /// Mean absolute difference.
    L1,
    /// Mean squared difference.
    L2,
    /// Dissimilarity plus mean absolute difference.
    DssimL1,
    /// Dissimilarity plus mean squared difference.
    DssimL2,
    /// 0.84 of dissimilarity at five resolutions, 0.16 of the mean absolute difference.
    MsSsimL1,
}

impl From<LossName> for Loss {
    fn from(name: LossName) -> Self {
        match name {
            LossName::Dssim => Self::Dssim,
            LossName::L1 => Self::L1,
            LossName::L2 => Self::L2,
            LossName::DssimL1 => Self::DssimL1,
            LossName::DssimL2 => Self::DssimL2,
            LossName::MsSsimL1 => Self::MsSsimL1,
        }
    }
}

/// How weights follow gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    #[value(help = format!("The practical default: {}", Optimiser::ADAMW))]
    Adamw,
    #[value(help = format!("As in the paper: {}", Optimiser::ADADELTA))]
    Adadelta,
}

impl Method {
    const fn defaults(self) -> Optimiser {
        match self {
            Self::Adamw => Optimiser::ADAMW,
            Self::Adadelta => Optimiser::ADADELTA,
        }
    }
}

fn decay_help() -> String {
    let usual = Optimiser::ADAMW.weight_decay();
    format!(
        "Share of itself that a weight loses a step, times the rate, by adamw [default: {KERNELS_DECAY} where kernels are \
         predicted, else {usual}]"
    )
}

fn rate_help() -> String {
    let of = |method: Method| method.defaults().highest_rate();
    let (adamw, adadelta) = (of(Method::Adamw), of(Method::Adadelta));
    format!("The optimiser's rate, at its highest [default: {adamw} for adamw, {adadelta} for adadelta]")
}

fn crop_help() -> String {
    let most = defaults().crop;
    format!(
        "Height and width of the crops, pixels; a multiple of 8 [default: {most}, or the largest that fits into the pairs]"
    )
}

/// Crops of pairs of a size, where nobody says how large: as large as fits, at most the default.
fn usual_crop(Resolution { height, width }: Resolution) -> usize {
    let fits = height.min(width);
    (fits - fits % TILE).min(defaults().crop)
}

/// The settings that do not depend on network and data.
fn defaults() -> TrainConfig {
    let reach = Reach { radius: INPUT_RADIUS, diagonal_share: 1.0, height: 1 };
    TrainConfig::new(NetSpec::ao(ChannelOrder::Interleaved, reach), PathBuf::new())
}

/// Trains, and says how far it came.
///
/// # Errors
/// If the dataset or the run's folder cannot be used, a setting makes no sense, or training diverges.
pub fn run(args: &Args) -> Result<()> {
    ensure!(
        args.weight_decay.is_none() || args.optimiser == Method::Adamw,
        "--weight-decay is adamw's, and the optimiser is adadelta"
    );
    let (folder, pairs) = args.dataset.pairs()?;
    let start = args.from.as_ref().map(Place::read).transpose()?;
    let config = TrainConfig { start: start.as_deref().map(Path::to_owned), ..config(args, &folder)? };
    let out = args.out.begin()?;
    let Outcome { ending, progress, images_per_second } = deepshade_train::train_on(&config, pairs, &out)?;
    out.finish()?;
    let what = match ending {
        Ending::Finished => "all steps are done",
        Ending::Stopped => "validation has stopped becoming better",
        Ending::OutOfTime => "the time is up; the same command goes on",
    };
    let mut figures = Figures::new("train");
    figures.set("steps", progress.step as f64);
    let best = progress.best();
    figures.set("best_step", best.map_or(f64::NAN, |(step, _)| step as f64));
    figures.set("best_loss", best.map_or(f64::NAN, |(_, loss)| loss.into()));
    figures.set("images_per_second", images_per_second);
    figures.detail("config", json!(config));
    figures.write(args.json.as_deref())?;
    say!("{}: {what}, step {} of {}", args.out, progress.step, config.steps)?;
    if let Some((step, loss)) = best {
        say!("best validation DSSIM {loss:.5} at step {step}")?;
    }
    say!("{images_per_second:.2} images a second, {}", deepshade_train::device_name()?)
}

/// Reads a number of minutes that a run may take.
pub fn minutes(text: &str) -> Result<f64, String> {
    let minutes: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match minutes > 0.0 && minutes <= MOST_MINUTES {
        true => Ok(minutes),
        false => Err(format!("{minutes} is not above 0 and at most {MOST_MINUTES}")),
    }
}

/// The defaults with what the command line changes.
fn config(args: &Args, dataset: &Path) -> Result<TrainConfig> {
    let manifest = Manifest::load(dataset)?;
    let share = match (args.diagonal_share, manifest.origin.recipe.radius) {
        (Some(share), _) | (None, Radius::Diagonal(share)) => share,
        (None, _) => bail!(
            "{}: the recipe states the radius as no share of the diagonal; --diagonal-share says what the network's default is to be",
            args.dataset
        ),
    };
    // Before the run's folder is claimed: what is refused leaves no folder that remembers it.
    let resolution = manifest.origin.recipe.resolution;
    let Resolution { height, width } = resolution;
    let crop = args.crop.unwrap_or_else(|| usual_crop(resolution));
    ensure!(
        crop <= height.min(width),
        "--crop {crop}: the pairs of {} are {width} x {height} pixels",
        args.dataset
    );
    let base = default_config(&manifest, dataset, args.order.into(), share)?;
    let last = args.last.unwrap_or(LastLayer::best(base.spec.effect));
    let optimiser = args.optimiser.defaults();
    let optimiser = args.rate.map_or(optimiser, |rate| optimiser.with_rate(rate));
    let decay = args.weight_decay.or(last.weight_decay());
    Ok(TrainConfig {
        spec: last.of(base.spec)?,
        loss: args.loss.into(),
        optimiser: decay.map_or(optimiser, |decay| optimiser.with_weight_decay(decay)),
        batch: args.batch,
        devices: args.devices,
        crop,
        steps: args.steps,
        validation_pairs: args.validation_pairs,
        validate_every: args.validate_every,
        patience: args.patience,
        seed: args.seed,
        minutes: args.minutes,
        workers: args.workers,
        cache_megabytes: args.cache_megabytes,
        ..base
    })
}

/// The defaults for a dataset, and a network that reaches `diagonal_share` of a scene's diagonal.
pub fn default_config(
    manifest: &Manifest,
    dataset: &Path,
    order: ChannelOrder,
    diagonal_share: f32,
) -> Result<TrainConfig> {
    let recipe = &manifest.origin.recipe;
    let reach = Reach { radius: INPUT_RADIUS, diagonal_share, height: recipe.resolution.height };
    let effect = recipe.effect;
    let spec = NetSpec::published(effect, order, reach)
        .with_context(|| format!("no network is laid out for effect `{effect}`"))?;
    Ok(TrainConfig::new(spec, dataset.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_are_for_effects_that_filter_light() {
        let best = [Effect::Ao, Effect::Sss, Effect::Dof, Effect::Multi, Effect::Aa].map(LastLayer::best);
        let [image, kernels] = [LastLayer::Image, LastLayer::Kernels];
        assert_eq!(best, [image, kernels, kernels, kernels, image]);
        assert!(
            kernels.weight_decay() > Some(Optimiser::ADAMW.weight_decay()) && image.weight_decay().is_none()
        );
        assert_eq!(Optimiser::ADAMW.with_weight_decay(0.05).weight_decay(), 0.05);
        assert_eq!(Optimiser::ADADELTA.with_weight_decay(0.05), Optimiser::ADADELTA);
    }

    #[test]
    fn crops_fit_into_small_pairs_and_are_as_ever_in_large_ones() {
        let crop = |height, width| usual_crop(Resolution { height, width });
        assert_eq!([crop(512, 512), crop(256, 300), crop(1080, 1920)], [defaults().crop; 3]);
        assert_eq!([crop(96, 96), crop(101, 64), crop(255, 400)], [96, 64, 248]);
    }
}
