//! A model's card: what it was made from, how good it is, what it is not good for.

use crate::TrainConfig;
use deepshade_infer::{Correction, Filter, Head, NetSpec, Scaling, TrainedUnder};
use deepshade_shaders::Channel;
use std::fmt::Write;

/// What a card says beyond what the run's own files hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// The recipe of the training data: its file, and what it describes in a few words.
    pub recipe: String,
    /// Results on scenes that were never trained on: name and value, in order.
    pub metrics: Vec<(String, String)>,
    /// What it was not trained for or fails at, a sentence each.
    pub limits: Vec<String>,
    /// Licence of the weights.
    pub licence: String,
    /// The environment of all images of training, where they had one.
    pub environment: Option<TrainedUnder>,
}

/// How a network was chosen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trained {
    /// Steps that its weights have behind them.
    pub step: usize,
    /// Steps of the run so far.
    pub of: usize,
    /// Its validation loss.
    pub loss: f32,
}

/// What the network's channels are multiplied by for lengths and light that are scaled so.
fn factors(spec: &NetSpec, length: f32, light: f32) -> Vec<(Channel, f32)> {
    let channels = spec.inputs.iter().flat_map(|attribute| attribute.channels());
    channels.map(|channel| (channel, NetSpec::factor(&channel, Scaling { length, light }))).collect()
}

/// What is done to the numbers that the network reads, in words.
fn scales(spec: &NetSpec) -> String {
    let plain = factors(spec, 1.0, 1.0);
    let mut said = Vec::new();
    if plain != factors(spec, 2.0, 1.0) {
        said.push(format!("lengths by {} over the radius in metres", spec.reach.radius));
    }
    if scales_light(spec) {
        said.push(format!("light such that 99 % of what is not black is at most {}", spec.brightness()));
    }
    said.extend(
        plain
            .iter()
            .filter(|(_, factor)| *factor != 1.0)
            .map(|(channel, factor)| format!("`{channel}` by {factor}")),
    );
    if said.is_empty() { "nothing".to_owned() } else { said.join("; ") }
}

/// Whether the network reads light, which is scaled, and its image with it.
fn scales_light(spec: &NetSpec) -> bool {
    factors(spec, 1.0, 1.0) != factors(spec, 1.0, 2.0)
}

/// What the last layer makes, in words.
pub(crate) fn last_layer(spec: &NetSpec) -> String {
    match spec.head {
        Head::Image => "makes the image".to_owned(),
        Head::Correction(Correction { of, over, levels, kernel, gain, gated }) => format!(
            "corrects `{}`: adds a {} and weights of `{}`, {kernel}x{kernel} at each of {levels} \
             resolutions{}",
            of.name(),
            if gain { "gain" } else { "bias" },
            over.name(),
            if gated { ", nothing where the two are alike" } else { "" }
        ),
        Head::Filter(Filter { levels, kernel, black }) => {
            let black = if black { ", and of black" } else { "" };
            let colour = if spec.runs() > 1 { ", for each colour by itself" } else { "" };
            format!(
                "makes weights of the light, {kernel}x{kernel} at each of {levels} resolutions{black}{colour}"
            )
        }
    }
}

/// The part of a card that says how good the network is, and the one after it.
const MEASURED: &str = "## On scenes never trained on";
const LIMITS: &str = "## Limits";

/// A table of results.
fn measurements(metrics: &[(String, String)]) -> String {
    if metrics.is_empty() {
        return "Not measured.\n".to_owned();
    }
    let rows = metrics.iter().map(|(name, value)| format!("| {name} | {value} |\n"));
    std::iter::once("| | |\n|---|---|\n".to_owned()).chain(rows).collect()
}

/// A card with other results; `None` if it is none that [`export`](super::export) wrote.
pub fn measured(card: &str, metrics: &[(String, String)]) -> Option<String> {
    let (before, rest) = card.split_once(MEASURED)?;
    let (_, after) = rest.split_once(LIMITS)?;
    Some(format!("{before}{MEASURED}\n\n{}\n{LIMITS}{after}", measurements(metrics)))
}

/// What the weights were before the first step, in words. Which network's is the matter of whoever trained.
fn first_weights(config: &TrainConfig) -> &'static str {
    if config.start.is_some() { "the weights of an earlier run" } else { "random weights" }
}

/// The card as Markdown.
pub(super) fn card(config: &TrainConfig, trained: Trained, facts: &Facts) -> String {
    let spec = &config.spec;
    let inputs: Vec<&str> = spec.inputs.iter().map(|attribute| attribute.name()).collect();
    let hashed = match config.stream {
        Some(_) => "the recipe and the version of its data",
        None => "the dataset's manifest.json",
    };
    let rows = [
        ("Effect", spec.effect.to_string()),
        ("Reads", inputs.join(", ")),
        ("Scaled by", scales(spec)),
        ("Last layer", last_layer(spec)),
        ("Weights", spec.weight_count().to_string()),
        ("Trained radius", format!("{} (in scaled positions)", spec.reach.radius)),
        ("Default radius", format!("{} of the scene's diagonal", spec.reach.diagonal_share)),
        ("Data", facts.recipe.clone()),
        ("Data hash", format!("`{}` (BLAKE3 of {hashed})", config.data_hash)),
        ("Begun with", first_weights(config).to_owned()),
        ("Seed", config.seed.to_string()),
        ("Loss", config.loss.to_string()),
        ("Optimiser", config.optimiser.to_string()),
        ("Batch", format!("{} crops of {} by {}", config.batch, config.crop, config.crop)),
        ("Steps", format!("{} (best of {})", trained.step, trained.of)),
        ("Validation DSSIM", format!("{:.4}", trained.loss)),
        ("Licence", facts.licence.clone()),
    ];
    let mut card = format!("# {}\n\n| | |\n|---|---|\n", spec.effect);
    for (name, value) in rows {
        let _ = writeln!(card, "| {name} | {value} |");
    }
    let _ = write!(card, "\n{MEASURED}\n\n{}", measurements(&facts.metrics));
    let _ = write!(card, "\n{LIMITS}\n\n");
    for limit in &facts.limits {
        let _ = writeln!(card, "- {limit}");
    }
    let everywhere = spec.inputs.iter().any(|input| spec.is_everywhere(*input));
    let but = if everywhere { ", but for `estimate`" } else { "" };
    let of = if scales_light(spec) { "; its image is of the light as scaled" } else { "" };
    let _ = write!(
        card,
        "\n## Files\n\n\
        - `weights.safetensors`, `net.json`: the weights and the network's spec.\n\
        - `model.onnx`: the same network, any batch, height and width; it reads what the WGSL pass reads:\n  \
        channels scaled as said above, 0 where nothing is seen{but}{of}.\n\
        - `parity.safetensors`: an input and its output, to check a runtime with.\n"
    );
    card
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach};
    use deepshade_shaders::Effect;

    #[test]
    fn a_last_layer_that_predicts_kernels_is_told_with_black() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let told = |effect| {
            let published = NetSpec::published(effect, ChannelOrder::Interleaved, reach).expect("it has one");
            last_layer(&published.predicting_kernels().expect("it reads light"))
        };
        assert_eq!(told(Effect::Dof), "makes weights of the light, 3x3 at each of 5 resolutions");
        assert_eq!(
            told(Effect::Sss),
            "makes weights of the light, 3x3 at each of 5 resolutions, for each colour by itself"
        );
        assert_eq!(
            told(Effect::Multi),
            "makes weights of the light, 3x3 at each of 5 resolutions, and of black"
        );
    }

    #[test]
    fn only_what_reads_light_makes_images_of_scaled_light() {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        let told = |effect| {
            let published = NetSpec::published(effect, ChannelOrder::Interleaved, reach).expect("it has one");
            scales_light(&published)
        };
        assert!([Effect::Dof, Effect::Gi, Effect::Multi].into_iter().all(told));
        assert!(![Effect::Ao, Effect::Ibl, Effect::Real].into_iter().any(told));
    }

    #[test]
    fn other_results_change_nothing_else() {
        let first = [("frames".to_owned(), "200".to_owned()), ("ssim_learned".to_owned(), "0.5".to_owned())];
        let card = format!("# ao\n\n{MEASURED}\n\n{}\n{LIMITS}\n\n- One.\n", measurements(&[]));
        let filled = measured(&card, &first).expect("a card");
        assert!(filled.contains("| ssim_learned | 0.5 |") && !filled.contains("Not measured"), "{filled}");
        assert_eq!(measured(&filled, &[]).as_deref(), Some(card.as_str()), "and back");
        assert_eq!(measured("# ao\n\nNothing.\n", &first), None);
    }
}
