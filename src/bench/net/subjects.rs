//! The networks that are measured: trained ones where there are some, else those of the paper's Table 7.1.

use anyhow::{Context, Result, ensure};
use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights};
use deepshade_shaders::Effect;
use std::path::{Path, PathBuf};

/// Where trained networks are by default, each in a folder with its effect's name.
pub const MODELS: &str = "models";
/// Chooses random weights.
const SEED: u32 = 1;

/// A network to be measured.
pub struct MeasuredNetwork {
    /// Its name in figures: the effect's, with underscores.
    pub name: String,
    /// The network.
    pub model: Model,
    /// Its ONNX file.
    pub onnx: PathBuf,
    /// Whether its weights are trained; else they are random.
    pub trained: bool,
}

/// The networks of some effects, or of all that the paper has one for: the trained ones of a folder, by
/// default [`MODELS`], others with random weights, whose files are written to `scratch`.
///
/// # Errors
/// If the paper has no network for an effect, a file cannot be read or written, or a folder that was named
/// has none of them.
pub fn subjects(effects: &[Effect], models: Option<&Path>, scratch: &Path) -> Result<Vec<MeasuredNetwork>> {
    let published: Vec<Effect> = Effect::ALL.into_iter().filter(|effect| spec(*effect).is_some()).collect();
    let effects = if effects.is_empty() { &published } else { effects };
    let folder = models.unwrap_or(Path::new(MODELS));
    let subjects: Vec<MeasuredNetwork> =
        effects.iter().map(|effect| subject(*effect, folder, scratch)).collect::<Result<_>>()?;
    let is_idle = models.is_some() && !subjects.iter().any(|subject| subject.trained);
    ensure!(!is_idle, "--models {}: no folder there holds a network of these effects", folder.display());
    Ok(subjects)
}

/// Names of those with trained weights.
pub fn trained(subjects: &[MeasuredNetwork]) -> Vec<&str> {
    subjects.iter().filter(|subject| subject.trained).map(|subject| subject.name.as_str()).collect()
}

/// The paper's network for an effect.
pub fn spec(effect: Effect) -> Option<NetSpec> {
    let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 512 };
    NetSpec::published(effect, ChannelOrder::Interleaved, reach)
}

/// As [`spec`].
///
/// # Errors
/// If there is none; the error names those that there are.
pub fn published(effect: Effect) -> Result<NetSpec> {
    spec(effect).with_context(|| {
        let known = Effect::ALL.into_iter().filter(|effect| spec(*effect).is_some());
        let known: Vec<&str> = known.map(Effect::name).collect();
        format!("the paper has no network for `{effect}`, only for {}", known.join(", "))
    })
}

/// A network with random weights.
pub fn random(spec: NetSpec) -> Model {
    Model { weights: Weights::random(&spec, SEED), spec }
}

/// A name as figures have it.
pub fn figure_name(effect: Effect) -> String {
    effect.name().replace('-', "_")
}

fn subject(effect: Effect, models: &Path, scratch: &Path) -> Result<MeasuredNetwork> {
    let folder = models.join(effect.name());
    let trained = folder.join("net.json").exists();
    let name = figure_name(effect);
    if trained {
        let onnx = folder.join("model.onnx");
        return Ok(MeasuredNetwork { name, model: Model::load(&folder)?, onnx, trained });
    }
    let model = random(published(effect)?);
    let onnx = scratch.join(format!("{name}.onnx"));
    std::fs::write(&onnx, deepshade_train::export::onnx::encode(&model))
        .with_context(|| onnx.display().to_string())?;
    Ok(MeasuredNetwork { name, model, onnx, trained })
}
