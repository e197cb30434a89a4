//! `deepshade train`: a network from a dataset.

use crate::arguments::positive;
use crate::figures::Figures;
use crate::place::Place;
use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use deepshade_dataset::recipe::Resolution;
use deepshade_dataset::{Manifest, Radius, Recipe};
use deepshade_infer::{ChannelOrder, Estimate, NetSpec, Reach};
use deepshade_render::methods::estimate::Estimator;
use deepshade_shaders::Effect;
use deepshade_shaders::similarity::TILE;
use deepshade_train::config::MOST_MINUTES;
use deepshade_train::{Ending, Endless, Loss, Optimiser, Outcome, TrainConfig};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Trains a network on a dataset; the same command resumes a run that was interrupted.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade dataset generate dataset/recipes/ao.toml --out data/ao\n  \
    deepshade train --dataset data/ao --out runs/ao --steps 20000\n\n\
    Views that are rendered while the network trains, and are on no disk:\n  \
    deepshade train --recipe dataset/recipes/ao.toml --out runs/ao\n  \
    deepshade train --recipe dataset/recipes/ao.toml --network corrected --channels 12 --estimate gtao:low --out runs/small\n\n\
    The run's folder gets `config.json`, checkpoints, `metrics.jsonl` and a plot of the loss.")]
pub struct Args {
    /// What `deepshade dataset generate` made: its folder or address.
    #[arg(long, required_unless_present = "recipe", conflicts_with = "recipe")]
    dataset: Option<Place>,
    /// A recipe whose views are rendered while the network trains, without end, in place of a dataset.
    #[arg(long)]
    recipe: Option<PathBuf>,
    /// How often a view of --recipe is used, on average.
    #[arg(long, default_value_t = Endless::USUAL.uses, requires = "recipe")]
    uses: usize,
    /// The network [default: corrected where an analytic method estimates the effect, else paper].
    #[arg(long, value_enum)]
    network: Option<Network>,
    /// Channels of the corrected network at half the resolution.
    #[arg(long, default_value_t = CHANNELS)]
    channels: usize,
    /// The estimate that the corrected network reads, METHOD:QUALITY.
    #[arg(long, default_value = ESTIMATE, value_parser = estimate)]
    estimate: Estimate,
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
    #[arg(long, value_enum, default_value_t = LossName::DssimL2)]
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
    #[arg(long, help = steps_help())]
    steps: Option<usize>,
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
    /// Minutes that the run may take. Without --steps it has as many steps as fit into them; with --steps it stops then, and
    /// the same command goes on.
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

/// Radius of the effect in the units of the input of corrected networks: lengths are in radii.
const RADII: f32 = 1.0;
/// The default radius of networks that know all radii, as a share of the scene's diagonal.
const USUAL_SHARE: f32 = 0.03;
/// Channels of the corrected network at half the resolution.
const CHANNELS: usize = 24;
/// The estimate that the corrected network reads.
const ESTIMATE: &str = "gtao:high";

/// Which network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Network {
    /// The paper's U-net, from positions alone.
    Paper,
    /// One that reads what an analytic method estimates, and corrects it.
    Corrected,
}

impl Network {
    /// The one that is nearer to truth.
    fn best(effect: Effect) -> Self {
        let estimate = Estimate { method: String::new(), quality: String::new() };
        let reach = Reach { radius: RADII, diagonal_share: USUAL_SHARE, height: 1 };
        match NetSpec::corrected(effect, CHANNELS, estimate, reach) {
            Some(_) => Self::Corrected,
            None => Self::Paper,
        }
    }
}

/// Reads an estimate.
fn estimate(text: &str) -> Result<Estimate, String> {
    let (method, quality) = text.split_once(':').ok_or_else(|| format!("`{text}` is not METHOD:QUALITY"))?;
    Estimator::named(method, quality).map_err(|error| error.to_string())?;
    Ok(Estimate { method: method.to_owned(), quality: quality.to_owned() })
}

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

fn steps_help() -> String {
    format!("Steps of the whole run [default: as many as fit into --minutes, else {}]", defaults().steps)
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
    let start = args.from.as_ref().map(Place::read).transpose()?;
    let from = start.as_deref().map(Path::to_owned);
    let out = args.out.begin()?;
    let (config, outcome) = match (&args.recipe, &args.dataset) {
        (Some(path), _) => {
            let recipe = Recipe::load(path)?;
            let config = TrainConfig { start: from, ..config(args, &recipe, path)? };
            let config = within_minutes(config, args, &out)?;
            (config.clone(), deepshade_train::train_streamed(&config, &recipe, &out)?)
        }
        (None, Some(dataset)) => {
            let (folder, pairs) = dataset.pairs()?;
            let recipe = Manifest::load(&folder)?.origin.recipe;
            let config = TrainConfig { start: from, ..config(args, &recipe, &folder)? };
            let config = within_minutes(config, args, &out)?;
            (config.clone(), deepshade_train::train_on(&config, pairs, &out)?)
        }
        (None, None) => bail!("--dataset or --recipe says what is trained on"),
    };
    let Outcome { ending, progress, waiting, images_per_second } = outcome;
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
    figures.set("waiting_share", waiting);
    figures.detail("config", json!(config));
    figures.write(args.json.as_deref())?;
    say!("{}: {what}, step {} of {}", args.out, progress.step, config.steps)?;
    if let Some((step, loss)) = best {
        say!("best validation DSSIM {loss:.5} at step {step}")?;
    }
    if config.stream.is_some() {
        say!("{:.1} % of the time went by waiting for views to be rendered", 100.0 * waiting)?;
    }
    say!("{images_per_second:.2} images a second, {}", deepshade_train::device_name()?)
}

/// The settings with as many steps as fit into the minutes that are stated, where no number of them is; a run that goes on has
/// those that it began with.
fn within_minutes(config: TrainConfig, args: &Args, run: &Path) -> Result<TrainConfig> {
    let Some(minutes) = args.minutes.filter(|_| args.steps.is_none()) else { return Ok(config) };
    let steps = match TrainConfig::load(run) {
        Ok(begun) => begun.steps,
        Err(_) => fitting_steps(&config, minutes)?,
    };
    Ok(TrainConfig { steps, minutes: None, ..config })
}

/// Steps that are tried to tell how long one takes.
const TRIED: usize = 4;
/// The shares of the time that steps take, beside validation, and beside views that are rendered at the same time.
const STEPS_SHARE: f64 = 0.9;
const STREAMED_SHARE: f64 = 0.6;

/// How many steps fit into so many minutes.
///
/// # Errors
/// If the device fails.
pub fn fitting_steps(config: &TrainConfig, minutes: f64) -> Result<usize> {
    let speed = deepshade_train::bench::bench(config, TRIED)?.images_per_second;
    let share = if config.stream.is_some() { STREAMED_SHARE } else { STEPS_SHARE };
    Ok(((60.0 * minutes * share * speed / config.batch as f64) as usize).max(1))
}

/// Reads a number of minutes that a run may take.
pub fn minutes(text: &str) -> Result<f64, String> {
    let minutes: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match minutes > 0.0 && minutes <= MOST_MINUTES {
        true => Ok(minutes),
        false => Err(format!("{minutes} is not above 0 and at most {MOST_MINUTES}")),
    }
}

/// The defaults with what the command line changes, for data that a recipe makes.
fn config(args: &Args, recipe: &Recipe, data: &Path) -> Result<TrainConfig> {
    let network = args.network.unwrap_or_else(|| Network::best(recipe.effect));
    // Before the run's folder is claimed: what is refused leaves no folder that remembers it.
    let resolution = recipe.smallest.unwrap_or(recipe.resolution);
    let Resolution { height, width } = resolution;
    let crop = args.crop.unwrap_or_else(|| usual_crop(resolution));
    ensure!(
        crop <= height.min(width),
        "--crop {crop}: pairs of {} may have {width} x {height} pixels",
        data.display()
    );
    let base = match network {
        Network::Paper => default_config(recipe, data, args.order.into(), share(args, recipe, data)?)?,
        Network::Corrected => corrected_config(args, recipe, data)?,
    };
    let last = args.last.unwrap_or(LastLayer::best(base.spec.effect));
    let optimiser = args.optimiser.defaults();
    let optimiser = args.rate.map_or(optimiser, |rate| optimiser.with_rate(rate));
    let decay = args.weight_decay.or(last.weight_decay());
    Ok(TrainConfig {
        spec: if network == Network::Paper { last.of(base.spec)? } else { base.spec },
        stream: args.recipe.is_some().then_some(Endless { uses: args.uses, ..Endless::USUAL }),
        loss: args.loss.into(),
        optimiser: decay.map_or(optimiser, |decay| optimiser.with_weight_decay(decay)),
        batch: args.batch,
        devices: args.devices,
        crop,
        steps: args.steps.unwrap_or(defaults().steps),
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

/// The default radius of a network of the paper's: the recipe's, where it has one.
fn share(args: &Args, recipe: &Recipe, data: &Path) -> Result<f32> {
    match (args.diagonal_share, recipe.radius) {
        (Some(share), _) | (None, Radius::Diagonal(share)) => Ok(share),
        (None, Radius::Pixels(_) | Radius::MetresBetween(_)) => Ok(USUAL_SHARE),
        (None, Radius::Metres(_)) => bail!(
            "{}: the recipe states the radius in metres; --diagonal-share says what the network's default is to be",
            data.display()
        ),
    }
}

/// The defaults for data that a recipe makes, and the network that is nearest to truth.
pub fn usual_config(recipe: &Recipe, data: &Path) -> Result<TrainConfig> {
    let reach = |share| Reach { radius: RADII, diagonal_share: share, height: recipe.resolution.height };
    let estimate = estimate(ESTIMATE).map_err(anyhow::Error::msg)?;
    match (NetSpec::corrected(recipe.effect, CHANNELS, estimate, reach(USUAL_SHARE)), recipe.radius) {
        (Some(spec), _) => Ok(TrainConfig::new(spec, data.to_owned())),
        (None, Radius::Diagonal(share)) => default_config(recipe, data, ChannelOrder::Interleaved, share),
        (None, _) => {
            bail!("the paper's networks want a recipe that states its radius as a share of the diagonal")
        }
    }
}

/// The defaults for a network that corrects an estimate.
fn corrected_config(args: &Args, recipe: &Recipe, data: &Path) -> Result<TrainConfig> {
    let effect = recipe.effect;
    let diagonal_share = args.diagonal_share.unwrap_or(USUAL_SHARE);
    let reach =
        Reach { radius: RADII, diagonal_share, height: recipe.smallest.unwrap_or(recipe.resolution).height };
    let spec = NetSpec::corrected(effect, args.channels, args.estimate.clone(), reach)
        .with_context(|| format!("--network corrected: no method estimates `{effect}` for networks"))?;
    Ok(TrainConfig::new(spec, data.to_owned()))
}

/// The defaults for data that a recipe makes, and a network that reaches `diagonal_share` of a scene's diagonal.
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
