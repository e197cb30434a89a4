//! The networks that are measured: those of the paper's Table 7.1, with shipped weights where there are some.

use anyhow::{Context, Result};
use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights};
use deepshade_shaders::Effect;
use std::path::{Path, PathBuf};

/// Chooses random weights.
const SEED: u32 = 1;

/// A network to be measured.
pub struct Subject {
    /// Its name in figures: the effect's, with underscores.
    pub name: String,
    /// The network.
    pub model: Model,
    /// Its ONNX file.
    pub onnx: PathBuf,
    /// Whether its weights are shipped; else they are random, which takes as long.
    pub shipped: bool,
}

/// The networks of some effects, or of all that the paper has one for. Files that are not shipped are written to
/// `scratch`.
///
/// # Errors
/// If the paper has no network for an effect, or a file cannot be read or written.
pub fn subjects(effects: &[Effect], models: &Path, scratch: &Path) -> Result<Vec<Subject>> {
    let published: Vec<Effect> = Effect::ALL.into_iter().filter(|effect| spec(*effect).is_some()).collect();
    let effects = if effects.is_empty() { &published } else { effects };
    effects.iter().map(|effect| subject(*effect, models, scratch)).collect()
}

/// Names of those with shipped weights.
pub fn shipped(subjects: &[Subject]) -> Vec<&str> {
    subjects.iter().filter(|subject| subject.shipped).map(|subject| subject.name.as_str()).collect()
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

fn subject(effect: Effect, models: &Path, scratch: &Path) -> Result<Subject> {
    let folder = models.join(effect.name());
    let shipped = folder.join("net.json").exists();
    let name = figure_name(effect);
    if shipped {
        let onnx = folder.join("model.onnx");
        return Ok(Subject { name, model: Model::load(&folder)?, onnx, shipped });
    }
    let model = random(published(effect)?);
    let onnx = scratch.join(format!("{name}.onnx"));
    std::fs::write(&onnx, deepshade_train::export::onnx::encode(&model))
        .with_context(|| onnx.display().to_string())?;
    Ok(Subject { name, model, onnx, shipped })
}
