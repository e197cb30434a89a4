//! A trained network on disk: a folder with `net.json` (the spec) and `weights.safetensors`, beside which the
//! export puts `parity.safetensors`, `model.onnx` and `card.md`.

pub(crate) mod file;

pub use file::{PARITY, SPEC, WEIGHTS};

use crate::{LayerWeights, NetSpec, SpecError, Weights};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A trained network.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Its shape.
    pub spec: NetSpec,
    /// Its weights.
    pub weights: Weights,
}

/// Why a model folder cannot be read or written.
#[derive(Debug, Error)]
pub enum ModelError {
    /// A file cannot be read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// `read`, `write` or `delete`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The spec is not what a `net.json` holds.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong and where.
        source: serde_json::Error,
    },
    /// No network can have this spec.
    #[error("{}: {source}", path.display())]
    Spec {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SpecError,
    },
    /// A file is far larger than what it is for.
    #[error("{} has {found} bytes; at most {most} are expected", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size, bytes.
        found: u64,
        /// The largest size that makes sense, bytes.
        most: u64,
    },
    /// A tensor file is truncated or not a safetensors file.
    #[error("{} is not a whole safetensors file: {source}", path.display())]
    Tensors {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: safetensors::SafeTensorError,
    },
    /// A tensor is missing.
    #[error("{} has no tensor `{tensor}`; it holds {held}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// Name of the tensor.
        tensor: String,
        /// Names of those that are there.
        held: String,
    },
    /// A tensor that no layer has.
    #[error("{} holds tensor `{tensor}`, which the network of net.json does not have", path.display())]
    Unknown {
        /// The file.
        path: PathBuf,
        /// Name of the tensor.
        tensor: String,
    },
    /// A tensor has another shape than the spec asks for.
    #[error("{}: tensor `{tensor}` has shape {found:?}, expected {expected:?}", path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// Name of the tensor.
        tensor: String,
        /// The shape that the spec asks for.
        expected: Vec<usize>,
        /// The shape in the file.
        found: Vec<usize>,
    },
    /// A tensor does not hold 32-bit floats.
    #[error("{}: tensor `{tensor}` holds {found}, expected F32", path.display())]
    Kind {
        /// The file.
        path: PathBuf,
        /// Name of the tensor.
        tensor: String,
        /// What it holds.
        found: String,
    },
    /// A tensor holds NaN or infinity.
    #[error("{}: tensor `{tensor}` holds a number that is not finite, at index {index}", path.display())]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// Name of the tensor.
        tensor: String,
        /// Index of the first such number.
        index: usize,
    },
    /// The weights do not belong to the spec.
    #[error("the weights for {} do not fit the network's spec", path.display())]
    Unfit {
        /// The folder.
        path: PathBuf,
    },
}

impl Model {
    /// Reads a model folder.
    ///
    /// # Errors
    /// If a file is missing, truncated, absurdly large or does not fit the other, each with the file, and
    /// where it applies the tensor and both shapes.
    pub fn load(folder: &Path) -> Result<Self, ModelError> {
        let path = folder.join(SPEC);
        let spec = spec_of(&path, &file::read(&path, file::MOST_SPEC_BYTES)?)?;
        let path = folder.join(WEIGHTS);
        let most = (spec.weight_count() * size_of::<f32>()) as u64 + file::MOST_HEADER_BYTES;
        let weights = weights_of(&file::Tensors::open(&path, most)?, &spec)?;
        Ok(Self { spec, weights })
    }

    /// Reads the two files of a model folder of that name where they are in memory, as in a web page.
    ///
    /// # Errors
    /// As [`Model::load`].
    pub fn from_bytes(folder: &Path, spec: &[u8], weights: Vec<u8>) -> Result<Self, ModelError> {
        let spec = spec_of(&folder.join(SPEC), spec)?;
        let weights = weights_of(&file::Tensors::of(&folder.join(WEIGHTS), weights)?, &spec)?;
        Ok(Self { spec, weights })
    }

    /// Writes the two files into a model folder, which is made where there is none. The spec of an older
    /// network there goes first and the new one comes last: a folder without a spec does not load, so that
    /// one network's weights never stand beside another's spec.
    ///
    /// # Errors
    /// If the network is not valid or a file cannot be written; no file is then half written.
    pub fn save(&self, folder: &Path) -> Result<(), ModelError> {
        let path = folder.join(SPEC);
        self.spec.validate().map_err(|source| ModelError::Spec { path: path.clone(), source })?;
        if !self.weights.fit(&self.spec) {
            return Err(ModelError::Unfit { path: folder.to_owned() });
        }
        let layers = self.spec.layers();
        let tensors: Vec<_> = layers
            .iter()
            .zip(&self.weights.0)
            .flat_map(|(layer, weights)| {
                let shape = layer.weight_shape().to_vec();
                [
                    (format!("{}.weight", layer.name), shape, &weights.weight[..]),
                    (format!("{}.bias", layer.name), vec![layer.outputs], &weights.bias[..]),
                ]
            })
            .collect();
        withdraw(folder)?;
        file::write_tensors(&folder.join(WEIGHTS), &tensors)?;
        let mut json = serde_json::to_vec_pretty(&self.spec)
            .map_err(|source| ModelError::Json { path: path.clone(), source })?;
        json.push(b'\n');
        file::write(&path, &json)
    }
}

/// Makes a folder hold no model, by deleting its spec, so that its files can be replaced one by one.
///
/// # Errors
/// If there is a spec that cannot be deleted.
pub fn withdraw(folder: &Path) -> Result<(), ModelError> {
    let path = folder.join(SPEC);
    match std::fs::remove_file(&path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(ModelError::Io { action: "delete", path, source })
        }
        _ => Ok(()),
    }
}

fn spec_of(path: &Path, bytes: &[u8]) -> Result<NetSpec, ModelError> {
    let spec: NetSpec =
        serde_json::from_slice(bytes).map_err(|source| ModelError::Json { path: path.to_owned(), source })?;
    spec.validate().map_err(|source| ModelError::Spec { path: path.to_owned(), source })?;
    Ok(spec)
}

fn weights_of(tensors: &file::Tensors, spec: &NetSpec) -> Result<Weights, ModelError> {
    let layers = spec.layers();
    let names: Vec<_> =
        layers.iter().flat_map(|l| [format!("{}.weight", l.name), format!("{}.bias", l.name)]).collect();
    tensors.hold_only(&names)?;
    let layers = layers.iter().map(|layer| {
        Ok(LayerWeights {
            weight: tensors.of_shape(&format!("{}.weight", layer.name), &layer.weight_shape())?,
            bias: tensors.of_shape(&format!("{}.bias", layer.name), &[layer.outputs])?,
        })
    });
    Ok(Weights(layers.collect::<Result<_, ModelError>>()?))
}

#[cfg(test)]
mod tests;
