//! The files of a model folder: reading with limits, writing as a whole, tensors of 32-bit floats.

use super::ModelError;
use deepshade_shaders::{Planes, atomic_file};
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The spec.
pub const SPEC: &str = "net.json";
/// The weights.
pub const WEIGHTS: &str = "weights.safetensors";
/// An input and its output.
pub const PARITY: &str = "parity.safetensors";

/// Largest spec that is read, bytes.
pub const MOST_SPEC_BYTES: u64 = 1 << 20;
/// Largest part of a tensor file that is not tensors, bytes.
pub const MOST_HEADER_BYTES: u64 = 1 << 20;
/// Largest parity file that is read, bytes: an input and an output of some thousand pixels squared.
pub const MOST_PARITY_BYTES: u64 = 1 << 30;

/// A file's content, if it has at most `most` bytes.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, ModelError> {
    let failed = |source| ModelError::Io { action: "read", path: path.to_owned(), source };
    let file = File::open(path).map_err(failed)?;
    let found = file.metadata().map_err(failed)?.len();
    if found > most {
        return Err(ModelError::TooLarge { path: path.to_owned(), found, most });
    }
    let mut bytes = Vec::with_capacity(found as usize);
    file.take(most).read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

/// Makes a file, or replaces it as a whole. Its folder is made where there is none.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), ModelError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)
        .and_then(|()| atomic_file::write(path, bytes))
        .map_err(|source| ModelError::Io { action: "write", path: path.to_owned(), source })
}

/// Writes named tensors, `(name, shape, elements)`.
pub fn write_tensors(path: &Path, tensors: &[(String, Vec<usize>, &[f32])]) -> Result<(), ModelError> {
    let failed = |source| ModelError::Tensors { path: path.to_owned(), source };
    let bytes: Vec<Vec<u8>> = tensors
        .iter()
        .map(|(_, _, data)| data.iter().flat_map(|value| value.to_le_bytes()).collect())
        .collect();
    let views = tensors.iter().zip(&bytes).map(|((name, shape, _), bytes)| {
        Ok((name.clone(), TensorView::new(Dtype::F32, shape.clone(), bytes)?))
    });
    let views: Vec<_> = views.collect::<Result<_, _>>().map_err(failed)?;
    write(path, &safetensors::serialize(views, None).map_err(failed)?)
}

/// A tensor file in memory.
pub struct Tensors {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Tensors {
    /// Reads a file of at most `most` bytes and checks that it is whole.
    pub fn open(path: &Path, most: u64) -> Result<Self, ModelError> {
        Self::of(path, read(path, most)?)
    }

    /// A file of that name that was read, if it is whole.
    pub fn of(path: &Path, bytes: Vec<u8>) -> Result<Self, ModelError> {
        let tensors = Self { path: path.to_owned(), bytes };
        tensors.parse()?;
        Ok(tensors)
    }

    /// Makes sure that there is no tensor besides these.
    pub fn hold_only(&self, names: &[String]) -> Result<(), ModelError> {
        match self.names()?.into_iter().find(|name| !names.contains(name)) {
            None => Ok(()),
            Some(tensor) => Err(ModelError::Unknown { path: self.path.clone(), tensor }),
        }
    }

    /// A tensor's elements, if it has that shape.
    pub fn of_shape(&self, name: &str, shape: &[usize]) -> Result<Vec<f32>, ModelError> {
        let (found, elements) = self.tensor(name)?;
        match found == shape {
            true => Ok(elements),
            false => Err(self.shape_error(name, shape.to_vec(), found)),
        }
    }

    /// A tensor of three dimensions.
    pub fn image(&self, name: &str) -> Result<Planes, ModelError> {
        let (shape, elements) = self.tensor(name)?;
        match shape[..] {
            [channels, height, width] => Ok(Planes::from_data(channels, height, width, elements)),
            _ => Err(self.shape_error(name, vec![0; 3], shape)),
        }
    }

    /// The error of a wrong shape.
    pub fn shape_error(&self, name: &str, expected: Vec<usize>, found: Vec<usize>) -> ModelError {
        ModelError::Shape { path: self.path.clone(), tensor: name.to_owned(), expected, found }
    }

    fn parse(&self) -> Result<SafeTensors<'_>, ModelError> {
        SafeTensors::deserialize(&self.bytes)
            .map_err(|source| ModelError::Tensors { path: self.path.clone(), source })
    }

    fn names(&self) -> Result<Vec<String>, ModelError> {
        let mut names: Vec<_> = self.parse()?.names().into_iter().map(str::to_owned).collect();
        names.sort();
        Ok(names)
    }

    /// A tensor's shape and elements.
    fn tensor(&self, name: &str) -> Result<(Vec<usize>, Vec<f32>), ModelError> {
        let (path, tensor) = (self.path.clone(), name.to_owned());
        let tensors = self.parse()?;
        let Ok(view) = tensors.tensor(name) else {
            return Err(ModelError::Missing { path, tensor, held: self.names()?.join(", ") });
        };
        if view.dtype() != Dtype::F32 {
            return Err(ModelError::Kind { path, tensor, found: view.dtype().to_string() });
        }
        let elements: Vec<f32> =
            view.data().as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        match elements.iter().position(|value| !value.is_finite()) {
            None => Ok((view.shape().to_vec(), elements)),
            Some(index) => Err(ModelError::NotFinite { path, tensor, index }),
        }
    }
}
