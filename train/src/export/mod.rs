//! From a training run to a model folder: `weights.safetensors`, `net.json`, `parity.safetensors`,
//! `model.onnx` and `card.md`.

mod card;
pub mod onnx;
mod proto;

use card::Trained;
pub(crate) use card::last_layer;
pub use card::{Facts, measured};

use crate::checkpoint::{CHECKPOINT_FILE, Checkpoint};
use crate::training::RANGES_FILE;
use crate::{TrainConfig, TrainError, files};
use deepshade_infer::model::{PARITY, SPEC, WEIGHTS, withdraw};
use deepshade_infer::{Model, NetSpec, Parity, parity, reference};
use deepshade_shaders::atomic_file::{TEMPORARY_PREFIX, delete_temporaries, sync_folder};
use std::path::Path;

/// Name of the ONNX file.
pub const ONNX_FILE: &str = "model.onnx";
/// Name of the card.
pub const CARD_FILE: &str = "card.md";
/// Height and width of the image that a runtime is checked with: neither even nor square.
const PARITY_SIZE: [usize; 2] = [75, 101];

/// Exports the best of a run's validated networks into a model folder, in which only its own files are
/// replaced. Killed at any moment, the folder holds the old model, the new one, or none that loads, and never
/// a mixture.
///
/// # Errors
/// If the run has no checkpoint, none of its networks was validated, or a file cannot be read or written; an
/// older model is then still there, unless the new one's files cannot be moved to where its own are.
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
    // Features that half floats hold.
    let weights = weights.clone().balanced(&config.spec);
    let environment = facts.environment.clone();
    let spec = NetSpec { trained: ranges(run)?, environment, ..config.spec.clone() };
    let model = Model { spec, weights };
    let trained = Trained { step, of: checkpoint.progress.step, loss };
    std::fs::create_dir_all(folder).map_err(TrainError::io("create", folder))?;
    delete_temporaries(folder).map_err(TrainError::io("clean", folder))?;
    let [height, width] = PARITY_SIZE;
    let input = parity::noise(model.spec.input_channels(), height, width, 1);
    let output = reference::forward(&model.spec, &model.weights, &input);
    let new = tempfile::Builder::new().prefix(TEMPORARY_PREFIX).tempdir_in(folder);
    let new = new.map_err(TrainError::io("write into", folder))?;
    files::replace(&new.path().join(ONNX_FILE), &onnx::encode(&model))?;
    files::replace(&new.path().join(CARD_FILE), card::card(&config, trained, facts).as_bytes())?;
    Parity { input, output }.save(new.path())?;
    model.save(new.path())?;
    install(new.path(), folder)?;
    Ok(model)
}

/// What the frames of a run were like, where that was written down.
fn ranges(run: &Path) -> Result<Option<deepshade_infer::Trained>, TrainError> {
    let path = run.join(RANGES_FILE);
    match std::fs::read(&path) {
        Ok(bytes) => {
            serde_json::from_slice(&bytes).map(Some).map_err(|error| TrainError::damaged(&path, error))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(TrainError::io("read", &path)(error)),
    }
}

/// Moves a whole model's files into a folder that may hold an older model.
fn install(new: &Path, folder: &Path) -> Result<(), TrainError> {
    withdraw(folder)?;
    // The spec last: the folder holds a model again when it is there.
    for name in [ONNX_FILE, CARD_FILE, PARITY, WEIGHTS, SPEC] {
        let path = folder.join(name);
        std::fs::rename(new.join(name), &path).map_err(TrainError::io("write", &path))?;
    }
    sync_folder(folder).map_err(TrainError::io("write into", folder))
}
