//! `deepshade train`: a network from a dataset.

mod choices;
mod network;
mod notes;
mod share;
mod source;

pub use choices::LossName;
pub use network::{INPUT_RADIUS, default_config, usual_config};

use crate::arguments::positive;
use crate::dataset::warn_of_files;
use crate::figures::Figures;
use crate::interrupt::{self, Interrupted};
use crate::location::Location;
use anyhow::{Result, ensure};
use choices::{KERNELS_DECAY, LastLayer, Method, Order};
use deepshade_dataset::Recipe;
use deepshade_dataset::recipe::Resolution;
use deepshade_infer::{AnalyticEstimate, ChannelOrder, NetSpec, Reach};
use deepshade_shaders::similarity::TILE;
use deepshade_train::config::MOST_MINUTES;
use deepshade_train::{Ending, Endless, Optimiser, TrainConfig, TrainingOutcome};
use network::{CHANNELS, Network, channels, corrected_config, diagonal_share, estimate};
use serde_json::json;
use source::TrainingSource;
use std::path::{Path, PathBuf};

/// Trains a network on a dataset; the same command resumes a run that was interrupted.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade dataset generate dataset/recipes/ao.toml --out data/ao\n  \
    deepshade train --dataset data/ao --out runs/ao --steps 20000\n\n\
    Views that are rendered while the network trains, and are on no disk:\n  \
    deepshade train --recipe dataset/recipes/ao.toml --out runs/ao\n  \
    deepshade train --recipe dataset/recipes/ao.toml --network corrected --channels 12 --estimate gtao:low --out runs/small\n\n\
    The run's folder gets `config.json`, checkpoints, `metrics.jsonl`, a plot of the loss, and a file of \
    events, which `tensorboard --logdir` shows beside those of other runs.")]
pub struct Args {
    /// What `deepshade dataset generate` made: its folder or address.
    #[arg(long, required_unless_present = "recipe", conflicts_with = "recipe")]
    dataset: Option<Location>,
    /// A recipe whose views are rendered while the network trains, without end, in place of a dataset.
    #[arg(long)]
    recipe: Option<PathBuf>,
    /// How often a view of --recipe is used, on average.
    #[arg(long, default_value_t = Endless::USUAL.uses, requires = "recipe")]
    uses: usize,
    /// The network [default: corrected for aa, ao, dof, motion-blur, multi and sss, and for do and gi where
    /// the data have what it reads, else paper].
    #[arg(long, value_enum)]
    network: Option<Network>,
    /// Channels of the corrected network at half the resolution.
    #[arg(long, default_value_t = CHANNELS, value_parser = channels)]
    channels: usize,
    /// The estimate that the corrected network reads, METHOD:QUALITY [default: gtao:high for ao,
    /// surfel:medium for gi, ssdo:medium for do, ring-gather:high for dof, reconstruction:high for
    /// motion-blur, separable:ultra for sss, occluded-gather:high for multi, fxaa:high
    /// for aa].
    #[arg(long, value_parser = estimate)]
    estimate: Option<AnalyticEstimate>,
    /// Folder of the run, or an address such as s3://bucket/runs/ao.
    #[arg(long)]
    out: Location,
    /// Order of the channels after a concatenation.
    #[arg(long, value_enum, default_value_t = Order::Interleaved)]
    order: Order,
    /// What the last layer makes [default: kernels for dof, motion-blur, multi and sss, else the image].
    #[arg(long, value_enum)]
    last: Option<LastLayer>,
    /// What is made small [default: dssim-l2-means for a network that corrects an estimate, else dssim-l2].
    #[arg(long, value_enum)]
    loss: Option<LossName>,
    /// Model whose weights the run begins with, in place of random ones; its last layer must be that of
    /// --last.
    #[arg(long, value_name = "FOLDER")]
    from: Option<Location>,
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
    /// Devices that share the images of each step: GPUs where it was built for them, threads of the processor
    /// else.
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
    /// Minutes that the run may take. Without --steps it has as many steps as fit into them; with --steps it
    /// stops then, and the same command goes on.
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
    let start = args.from.as_ref().map(Location::read).transpose()?;
    let from = start.as_deref().map(Path::to_owned);
    let source = TrainingSource::open(args)?;
    // Before the run's folder is begun: what is refused leaves nothing.
    let config = TrainConfig { start: from, ..config(args, &source.recipe, &source.path)? };
    note!("{}", notes::beginning(&config, &source.path));
    // Those of a dataset were warned of when it was made.
    if args.recipe.is_some() {
        warn_of_files(&source.recipe)?;
    }
    if let Some(warning) = source.warning(&config) {
        note!("{warning}");
    }
    let out = args.out.begin()?;
    let config = within_minutes(config, args, &out)?;
    let stop = config.stop.clone();
    interrupt::ask_first(move || stop.ask());
    let outcome = source.train(&config, &out)?;
    let TrainingOutcome { ending, progress, waiting, images_per_second } = outcome;
    out.finish()?;
    let what = match ending {
        Ending::Finished => "all steps are done",
        Ending::Stopped => "validation has stopped becoming better",
        Ending::OutOfTime => "the time is up; the same command goes on",
        Ending::Interrupted => return Err(interrupted(args, progress.step, &config)),
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

/// Why a run ended that was asked to, and what it has kept.
fn interrupted(args: &Args, step: usize, config: &TrainConfig) -> anyhow::Error {
    let (run, steps) = (&args.out, config.steps);
    Interrupted {
        kept: format!(
            "{run}: interrupted at step {step} of {steps}, which is kept; the same command goes on"
        ),
    }
    .into()
}

/// The settings with as many steps as fit into the minutes that are stated, where no number of them is; a run
/// that goes on has those that it began with.
fn within_minutes(config: TrainConfig, args: &Args, run: &Path) -> Result<TrainConfig> {
    let Some(minutes) = args.minutes.filter(|_| args.steps.is_none()) else { return Ok(config) };
    let steps = match TrainConfig::load(run) {
        Ok(begun) => begun.steps,
        Err(_) => {
            note!("trying how many steps fit into {minutes} minutes");
            fitting_steps(&config, minutes)?
        }
    };
    Ok(TrainConfig { steps, minutes: None, fitted: Some(minutes), ..config })
}

/// Steps that are tried to tell how long one takes.
const TRIED: usize = 4;
/// The shares of the time that steps take, beside validation, and beside views that are rendered at the same
/// time.
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
    let network = args.network.unwrap_or_else(|| Network::usual(recipe, args.recipe.is_some()));
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
        Network::Paper => {
            default_config(recipe, data, args.order.into(), diagonal_share(args, recipe, data)?)?
        }
        Network::Corrected => corrected_config(args, recipe, data)?,
    };
    ensure!(
        network == Network::Paper || args.last.is_none(),
        "--last is of the paper's networks, and the network is the corrected one"
    );
    let last = args.last.unwrap_or(LastLayer::best(base.spec.effect));
    let optimiser = args.optimiser.defaults();
    let optimiser = args.rate.map_or(optimiser, |rate| optimiser.with_rate(rate));
    let usual_decay = if network == Network::Paper { last.weight_decay() } else { None };
    let decay = args.weight_decay.or(usual_decay);
    Ok(TrainConfig {
        spec: if network == Network::Paper { last.of(base.spec)? } else { base.spec },
        stream: args.recipe.is_some().then_some(Endless { uses: args.uses, ..Endless::USUAL }),
        loss: args.loss.map_or(base.loss, Into::into),
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

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Effect;

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
