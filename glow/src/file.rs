//! Files of materials (TOML), and the presets: what the thesis measured.

use super::material::{Material, MaterialError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The thesis' tables as a file of materials.
const PRESETS: &str = include_str!("presets.toml");

/// A file of materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// The materials.
    #[serde(rename = "material")]
    pub materials: Vec<Material>,
    /// What is left of materials of which not enough is known to simulate them.
    #[serde(default, rename = "fragment", skip_serializing_if = "Vec::is_empty")]
    pub fragments: Vec<Fragment>,
}

/// What is left of a material of two states whose rates are lost: rows of the thesis' Table A.1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fragment {
    /// What it is called.
    pub name: String,
    /// What is not certain, and what is lost.
    pub doubt: String,
    /// The re-radiation function of each state, one value a band of the eight.
    pub emission: [[f64; 8]; 2],
}

/// Why a file of materials cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("cannot read the materials of {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not TOML of the right form.
    #[error("{} is no file of materials", path.display())]
    Form {
        /// The file.
        path: PathBuf,
        /// Why, with the line.
        source: Box<toml::de::Error>,
    },
    /// A material's values make no sense.
    #[error("a material of {} makes no sense", path.display())]
    Material {
        /// The file.
        path: PathBuf,
        /// Why.
        source: MaterialError,
    },
}

impl MaterialFile {
    /// The materials of a file.
    ///
    /// # Errors
    /// If it cannot be read, is not of the right form, or a material makes no sense.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| FileError::Read { path: path.into(), source })?;
        Self::parse(&text, path)
    }

    /// The materials that the thesis measured: Table 8.1, and of Table A.1 what is left.
    pub fn presets() -> Self {
        Self::parse(PRESETS, Path::new("presets.toml")).expect("the presets are checked by a test")
    }

    /// Its text, which [`Self::read`] makes the same of.
    pub fn text(&self) -> String {
        toml::to_string(self).expect("materials are tables of numbers and text")
    }

    /// The material of a name.
    pub fn named(&self, name: &str) -> Option<&Material> {
        self.materials.iter().find(|material| material.name == name)
    }

    /// The materials of a file's text; the path is for errors.
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let file: Self = toml::from_str(text)
            .map_err(|source| FileError::Form { path: path.into(), source: Box::new(source) })?;
        let materials = file.materials.into_iter().map(Material::checked).collect::<Result<_, _>>();
        let materials = materials.map_err(|source| FileError::Material { path: path.into(), source })?;
        Ok(Self { materials, ..file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error;

    #[test]
    fn presets_are_eleven_measured_materials_and_one_of_two_states() {
        let presets = MaterialFile::presets();
        let single = presets.materials.iter().filter(|material| material.states.len() == 1).count();
        assert_eq!((single, presets.materials.len(), presets.fragments.len()), (11, 12, 2));
        let chargeable = presets.materials.iter().filter(|material| material.excitation_is_known()).count();
        assert_eq!(chargeable, 8, "the others were measured in the dark only");
        assert!(presets.materials.iter().all(|material| material.doubt.is_some()), "bands were put together");
    }

    /// Table A.1 says of the same samples what Table 8.1 does: all emission of a material has one spectrum.
    #[test]
    fn what_is_left_of_both_tables_agrees() {
        let presets = MaterialFile::presets();
        for fragment in &presets.fragments {
            let single = &presets.named(&fragment.name).expect("a preset").states[0].emission;
            for emission in &fragment.emission {
                assert!(cosine(single, emission) > 0.999, "{}: {}", fragment.name, cosine(single, emission));
            }
        }
        let stickers = |name| &presets.named(name).expect("a preset").states;
        for state in stickers("stickers, two states") {
            assert!(cosine(&stickers("stickers")[0].emission, &state.emission) > 0.9999);
        }
        let other = &presets.named("blue").expect("a preset").states[0].emission;
        assert!(cosine(other, &presets.fragments[0].emission[0]) < 0.9, "not every spectrum is alike");
    }

    fn cosine(a: &[f64], b: &[f64]) -> f64 {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
    }

    #[test]
    fn what_is_written_is_read_again() {
        let presets = MaterialFile::presets();
        assert_eq!(MaterialFile::parse(&presets.text(), Path::new("written.toml")).expect("read"), presets);
    }

    #[test]
    fn own_materials_are_read_and_faults_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("mine.toml");
        let read = |text: &str| {
            std::fs::write(&path, text).expect("written");
            MaterialFile::read(&path)
        };
        let good = "[[material]]\nname = 'mine'\nbands = 'rgb'\n\
                    states = [{ decay = 0.1, excitation = [0.1, 0.2, 0.3], emission = [1, 2, 3] }]";
        assert_eq!(read(good).expect("read").materials[0].states[0].emission, [1.0, 2.0, 3.0]);
        let fault = read(&good.replace("0.1,", "-0.1,")).expect_err("negative");
        assert!(fault.to_string().contains("mine.toml"));
        assert!(fault.source().expect("a source").to_string().contains("mine, state 1: decay is -0.1"));
        let fault = read(&good.replace("decay", "decoy")).expect_err("misspelt");
        assert!(fault.source().expect("a source").to_string().contains("decoy"));
        assert!(MaterialFile::read(&folder.path().join("none.toml")).is_err());
    }
}
