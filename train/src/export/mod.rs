//! From a training run to a model folder: `weights.safetensors`, `net.json`, `parity.safetensors`, `model.onnx` and
//! `card.md`.

mod card;
pub mod onnx;
mod proto;

pub use card::Facts;
use card::Trained;

use crate::checkpoint::{CHECKPOINT_FILE, Checkpoint};
use crate::{TrainConfig, TrainError, files};
use deepshade_infer::{Model, Parity, parity, reference};
use std::path::Path;

/// Name of the ONNX file.
pub const ONNX_FILE: &str = "model.onnx";
/// Name of the card.
pub const CARD_FILE: &str = "card.md";
/// Height and width of the image that a runtime is checked with: neither even nor square.
const PARITY_SIZE: [usize; 2] = [75, 101];

/// Exports the best of a run's validated networks into a model folder.
///
/// # Errors
/// If the run has no checkpoint, none of its networks was validated, or a file cannot be read or written.
pub fn export(run: &Path, folder: &Path, facts: &Facts) -> Result<Model, TrainError> {
    let config = TrainConfig::load(run)?;
    let Some(checkpoint) = Checkpoint::load(run, &config.spec)? else {
        return Err(TrainError::damaged(
            &run.join(CHECKPOINT_FILE),
            "does not exist: nothing was trained yet",
        ));
    };
    let (Some((step, loss)), Some(weights)) = (checkpoint.progress.best(), checkpoint.best_weights()) else {
        return Err(TrainError::NotValidated { run: run.to_owned(), step: checkpoint.progress.step });
    };
    let model = Model { spec: config.spec.clone(), weights: weights.clone() };
    let trained = Trained { step, of: checkpoint.progress.step, loss };
    std::fs::create_dir_all(folder).map_err(TrainError::io("create", folder))?;
    let [height, width] = PARITY_SIZE;
    let input = parity::noise(model.spec.input_channels(), height, width, 1);
    let output = reference::forward(&model.spec, &model.weights, &input);
    files::replace(&folder.join(ONNX_FILE), &onnx::encode(&model))?;
    files::replace(&folder.join(CARD_FILE), card::card(&config, trained, facts).as_bytes())?;
    Parity { input, output }.save(folder)?;
    model.save(folder)?;
    Ok(model)
}
