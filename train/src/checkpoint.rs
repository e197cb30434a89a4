//! The state of a run on disk: one safetensors file, replaced as a whole, that a killed run continues from bit for
//! bit.

use crate::{TrainError, files};
use deepshade_infer::weights::LayerWeights;
use deepshade_infer::{NetSpec, Weights};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;

/// Name of the file in the run's folder.
pub const CHECKPOINT_FILE: &str = "checkpoint.safetensors";
/// The file's metadata entry that holds [`Progress`].
const PROGRESS: &str = "progress";
/// The tensor that holds the optimiser's state.
const OPTIMISER: &str = "optimiser";

/// How far a run has come. Random numbers need no state of their own: they are functions of seed and step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Progress {
    /// Steps done.
    pub step: usize,
    /// The step after which validation was best.
    pub best_step: usize,
    /// Validation loss there; none before the first validation.
    pub best_loss: Option<f32>,
    /// Validations since then.
    pub waited: usize,
    /// Whether the run ended early because validation got no better.
    pub stopped: bool,
}

/// Everything that a run continues from.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// How far it has come.
    pub progress: Progress,
    /// The weights.
    pub weights: Weights,
    /// The weights of the best validation.
    pub best: Weights,
    /// The optimiser's state, in burn's format.
    pub optimiser: Vec<u8>,
}

impl Checkpoint {
    /// Writes the checkpoint into a run's folder.
    ///
    /// # Errors
    /// If it cannot be written; the one before is still there then.
    pub fn save(&self, folder: &Path, spec: &NetSpec) -> Result<(), TrainError> {
        let mut tensors =
            vec![(OPTIMISER.to_owned(), Dtype::U8, vec![self.optimiser.len()], self.optimiser.clone())];
        for (prefix, weights) in [("now", &self.weights), ("best", &self.best)] {
            for (name, numbers) in named(prefix, spec).into_iter().zip(arrays(weights)) {
                let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
                tensors.push((name, Dtype::F32, vec![numbers.len()], bytes));
            }
        }
        let views = tensors.iter().map(|(name, dtype, shape, bytes)| {
            let view = TensorView::new(*dtype, shape.clone(), bytes).expect("the bytes fit the shape");
            (name.as_str(), view)
        });
        let progress = serde_json::to_string(&self.progress).expect("progress is plain data");
        let metadata = HashMap::from([(PROGRESS.to_owned(), progress)]);
        let bytes = safetensors::serialize(views, Some(metadata)).expect("names and sizes are in order");
        files::replace(&folder.join(CHECKPOINT_FILE), &bytes)
    }

    /// The checkpoint of a run's folder, if there is one.
    ///
    /// # Errors
    /// If it cannot be read, is damaged, or belongs to another network.
    pub fn load(folder: &Path, spec: &NetSpec) -> Result<Option<Self>, TrainError> {
        let path = folder.join(CHECKPOINT_FILE);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(TrainError::io("read", &path)(error)),
        };
        Self::parse(&bytes, spec).map(Some).map_err(|problem| TrainError::damaged(&path, problem))
    }

    fn parse(bytes: &[u8], spec: &NetSpec) -> Result<Self, String> {
        let error = |e: safetensors::SafeTensorError| format!("is not a whole checkpoint: {e}");
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(error)?;
        let tensors = SafeTensors::deserialize(bytes).map_err(error)?;
        let progress = metadata.metadata().as_ref().and_then(|entries| entries.get(PROGRESS));
        let progress = progress.ok_or("has no progress entry")?;
        let weights = |prefix| weights(&tensors, prefix, spec);
        Ok(Self {
            progress: serde_json::from_str(progress)
                .map_err(|e| format!("has a damaged progress entry: {e}"))?,
            weights: weights("now")?,
            best: weights("best")?,
            optimiser: tensors.tensor(OPTIMISER).map_err(error)?.data().to_vec(),
        })
    }
}

/// Names of the tensors of a network, weights and biases in turn.
fn named(prefix: &str, spec: &NetSpec) -> Vec<String> {
    let names = |name: String| ["weight", "bias"].map(|part| format!("{prefix}.{name}.{part}"));
    spec.layers().into_iter().flat_map(|layer| names(layer.name)).collect()
}

/// The arrays of a network, weights and biases in turn.
fn arrays(weights: &Weights) -> impl Iterator<Item = &[f32]> {
    weights.0.iter().flat_map(|layer| [&layer.weight[..], &layer.bias[..]])
}

fn weights(tensors: &SafeTensors, prefix: &str, spec: &NetSpec) -> Result<Weights, String> {
    let read = |name: &String| {
        let tensor = tensors.tensor(name).map_err(|_| format!("has no tensor `{name}`"))?;
        Ok(tensor.data().as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
    };
    let arrays: Vec<Vec<f32>> = named(prefix, spec).iter().map(read).collect::<Result<_, String>>()?;
    let layers =
        arrays.chunks_exact(2).map(|pair| LayerWeights { weight: pair[0].clone(), bias: pair[1].clone() });
    let weights = Weights(layers.collect());
    if weights.fit(spec) { Ok(weights) } else { Err("belongs to another network".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach};

    fn spec() -> NetSpec {
        let reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };
        NetSpec { levels: 2, u0: 4, ..NetSpec::ao(ChannelOrder::Interleaved, reach) }
    }

    fn checkpoint() -> Checkpoint {
        Checkpoint {
            progress: Progress { step: 7, best_step: 4, best_loss: Some(0.1), waited: 1, stopped: false },
            weights: Weights::random(&spec(), 1),
            best: Weights::random(&spec(), 2),
            optimiser: vec![1, 2, 3],
        }
    }

    #[test]
    fn what_was_saved_is_loaded_and_nothing_is_none() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(Checkpoint::load(folder.path(), &spec()).expect("no file, no error"), None);
        checkpoint().save(folder.path(), &spec()).expect("saves");
        assert_eq!(Checkpoint::load(folder.path(), &spec()).expect("loads"), Some(checkpoint()));
    }

    #[test]
    fn every_truncation_and_every_other_network_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        checkpoint().save(folder.path(), &spec()).expect("saves");
        let other = NetSpec { u0: 8, ..spec() };
        let error = Checkpoint::load(folder.path(), &other).expect_err("another network").to_string();
        assert!(error.contains("belongs to another network"), "{error}");
        let path = folder.path().join(CHECKPOINT_FILE);
        let whole = std::fs::read(&path).expect("reads");
        for length in [0, 7, 100, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&path, &whole[..length]).expect("writes");
            let error = Checkpoint::load(folder.path(), &spec()).expect_err("truncated").to_string();
            assert!(error.contains("checkpoint.safetensors is not a whole checkpoint"), "{error}");
        }
    }
}
