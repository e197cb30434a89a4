//! A model's card: what it was made from, how good it is, what it is not good for.

use crate::TrainConfig;
use crate::checkpoint::Progress;
use crate::optim::Optimiser;
use std::fmt::Write;

/// What a card says beyond what the run's own files hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facts {
    /// The recipe of the training data: its name, and what it describes in a few words.
    pub recipe: String,
    /// Hash of the training data's manifest.
    pub data_hash: String,
    /// Results on scenes that were never trained on: name and value, in order.
    pub metrics: Vec<(String, String)>,
    /// What it was not trained for or fails at, a sentence each.
    pub limits: Vec<String>,
    /// Licence of the weights.
    pub licence: String,
}

/// The card as Markdown.
pub(super) fn card(config: &TrainConfig, progress: &Progress, facts: &Facts) -> String {
    let spec = &config.spec;
    let inputs: Vec<&str> = spec.inputs.iter().map(|attribute| attribute.name()).collect();
    let optimiser = match config.optimiser {
        Optimiser::Adadelta { rate, decay, epsilon } => {
            format!("ADADELTA, decay {decay}, epsilon {epsilon}, rate {rate}")
        }
        Optimiser::Adamw { rate, weight_decay, warm_up } => {
            format!("AdamW, rate {rate} (warm-up {warm_up} steps, cosine), weight decay {weight_decay}")
        }
    };
    let loss = progress.best_loss.map_or("not measured".to_owned(), |loss| format!("{loss:.4}"));
    let rows = [
        ("Effect", spec.effect.to_string()),
        ("Reads", inputs.join(", ")),
        ("Weights", spec.weight_count().to_string()),
        ("Trained radius", format!("{} (in scaled positions)", spec.reach.radius)),
        (
            "Default radius",
            format!("{} of the scene's diagonal at {} rows", spec.reach.diagonal_share, spec.reach.height),
        ),
        ("Data", facts.recipe.clone()),
        ("Data hash", format!("`{}`", facts.data_hash)),
        ("Seed", config.seed.to_string()),
        ("Optimiser", optimiser),
        ("Batch", format!("{} crops of {} by {}", config.batch, config.crop, config.crop)),
        ("Steps", format!("{} (best of {})", progress.best_step, progress.step)),
        ("Validation DSSIM", loss),
        ("Licence", facts.licence.clone()),
    ];
    let mut card = format!("# {}\n\n| | |\n|---|---|\n", spec.effect);
    for (name, value) in rows {
        let _ = writeln!(card, "| {name} | {value} |");
    }
    card += "\n## On scenes never trained on\n\n";
    if facts.metrics.is_empty() {
        card += "Not measured.\n";
    } else {
        card += "| | |\n|---|---|\n";
        for (name, value) in &facts.metrics {
            let _ = writeln!(card, "| {name} | {value} |");
        }
    }
    card += "\n## Limits\n\n";
    for limit in &facts.limits {
        let _ = writeln!(card, "- {limit}");
    }
    card += "\n## Files\n\n\
        - `weights.safetensors`, `net.json`: the weights and the network's spec.\n\
        - `model.onnx`: the same network, any batch, height and width; it reads what the WGSL pass reads, so\n  \
        positions are multiplied by trained radius over wanted radius before.\n\
        - `parity.safetensors`: an input and its output, to check a runtime with.\n";
    card
}
