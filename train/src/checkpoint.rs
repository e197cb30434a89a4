//! The state of a run on disk: one safetensors file, replaced as a whole, that a killed run continues from
//! bit for bit.

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
/// What the names of the tensors of the weights begin with.
const NOW: &str = "now";
/// What the names of the tensors of the mean weights begin with.
const MEAN: &str = "mean";
/// What the names of the tensors of the best weights begin with.
const BEST: &str = "best";
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
    /// Validation loss at the step where a run paused between validations, so that a network of its can be
    /// exported. A run that goes on forgets it, since a pause must not change what is learned.
    pub pause_loss: Option<f32>,
}

impl Progress {
    /// Where a run begins.
    pub(crate) const START: Self =
        Self { step: 0, best_step: 0, best_loss: None, waited: 0, stopped: false, pause_loss: None };

    /// The step after which the best of all validated networks was, and its loss.
    pub fn best(&self) -> Option<(usize, f32)> {
        let validated = self.best_loss.map(|loss| (self.best_step, loss));
        let paused = self.pause_loss.map(|loss| (self.step, loss));
        validated.into_iter().chain(paused).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Everything that a run continues from.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// How far it has come.
    pub progress: Progress,
    /// The weights.
    pub weights: Weights,
    /// Their mean over the last steps, which is what is validated and exported.
    pub mean: Weights,
    /// The mean weights of [`Progress::best_step`]; none before the first validation.
    pub best: Option<Weights>,
    /// The optimiser's state, in burn's format.
    pub optimiser: Vec<u8>,
}

impl Checkpoint {
    /// The best of all validated networks: that of [`Progress::best`].
    pub fn best_weights(&self) -> Option<&Weights> {
        let (step, _) = self.progress.best()?;
        if step == self.progress.step { Some(&self.mean) } else { self.best.as_ref() }
    }

    /// Writes the checkpoint into a run's folder.
    ///
    /// # Errors
    /// If it cannot be written; the one before is still there then.
    pub fn save(&self, folder: &Path, spec: &NetSpec) -> Result<(), TrainError> {
        let mut tensors =
            vec![(OPTIMISER.to_owned(), Dtype::U8, vec![self.optimiser.len()], self.optimiser.clone())];
        let best = self.best.as_ref().map(|weights| (BEST, weights));
        for (prefix, weights) in [(NOW, &self.weights), (MEAN, &self.mean)].into_iter().chain(best) {
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
        let progress: Progress =
            serde_json::from_str(progress).map_err(|e| format!("has a damaged progress entry: {e}"))?;
        let weights = |prefix| weights(&tensors, prefix, spec);
        Ok(Self {
            progress,
            weights: weights(NOW)?,
            mean: weights(MEAN)?,
            best: progress.best_loss.map(|_| weights(BEST)).transpose()?,
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
        NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (2, 4))
    }

    fn checkpoint() -> Checkpoint {
        Checkpoint {
            progress: Progress { step: 7, best_step: 4, best_loss: Some(0.1), waited: 1, ..Progress::START },
            weights: Weights::random(&spec(), 1),
            mean: Weights::random(&spec(), 3),
            best: Some(Weights::random(&spec(), 2)),
            optimiser: vec![1, 2, 3],
        }
    }

    #[test]
    fn what_was_saved_is_loaded_and_nothing_is_none() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(Checkpoint::load(folder.path(), &spec()).expect("no file, no error"), None);
        checkpoint().save(folder.path(), &spec()).expect("saves");
        assert_eq!(Checkpoint::load(folder.path(), &spec()).expect("loads"), Some(checkpoint()));
        let early = Checkpoint { progress: Progress::START, best: None, ..checkpoint() };
        early.save(folder.path(), &spec()).expect("saves");
        assert_eq!(Checkpoint::load(folder.path(), &spec()).expect("loads"), Some(early));
    }

    #[test]
    fn the_best_network_is_that_of_the_lowest_loss_and_there_may_be_none() {
        let best = |best_loss, pause_loss| {
            let progress = Progress { best_loss, pause_loss, ..checkpoint().progress };
            let best = best_loss.and(checkpoint().best);
            let checkpoint = Checkpoint { progress, best, ..checkpoint() };
            (checkpoint.progress.best(), checkpoint.best_weights().cloned())
        };
        assert_eq!(best(None, None), (None, None));
        assert_eq!(best(Some(0.2), None), (Some((4, 0.2)), checkpoint().best));
        assert_eq!(best(None, Some(0.3)), (Some((7, 0.3)), Some(checkpoint().mean)));
        assert_eq!(best(Some(0.2), Some(0.3)), (Some((4, 0.2)), checkpoint().best));
        assert_eq!(best(Some(0.2), Some(0.1)), (Some((7, 0.1)), Some(checkpoint().mean)));
    }

    #[test]
    fn every_truncation_and_every_other_network_is_an_error_that_names_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        checkpoint().save(folder.path(), &spec()).expect("saves");
        let other = spec().reshaped(|net| net.u0 = 8);
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
