//! Networks that are part of the program, so that it has them wherever it was installed to: each is that of
//! its effect where no folder has one, and `--model ao` finds it by name. They are written to the user's
//! cache when they are asked for.

use crate::learned::folder::is_network;
use deepshade_infer::model::{SPEC, WEIGHTS};
use deepshade_shaders::atomic_file;
use etcetera::BaseStrategy;
use std::path::{Path, PathBuf};

/// A network's files.
struct EmbeddedNetwork {
    name: &'static str,
    spec: &'static [u8],
    weights: &'static [u8],
}

/// A network of `models`.
macro_rules! network {
    ($name:literal) => {
        EmbeddedNetwork {
            name: $name,
            spec: include_bytes!(concat!("../../models/", $name, "/net.json")),
            weights: include_bytes!(concat!("../../models/", $name, "/weights.safetensors")),
        }
    };
}

/// Those that were measured to be level with the best of their rivals or ahead.
const NETWORKS: [EmbeddedNetwork; 10] = [
    network!("aa"),
    network!("ao"),
    network!("ao-small"),
    network!("do"),
    network!("dof"),
    network!("gi"),
    network!("motion-blur"),
    network!("multi"),
    network!("phosphor-gi"),
    network!("sss"),
];

/// Their names.
pub fn names() -> impl Iterator<Item = &'static str> {
    NETWORKS.iter().map(|network| network.name)
}

/// The folder of a network of that name; none where there is none, or no cache can be written.
pub fn folder(name: &str) -> Option<PathBuf> {
    let network = NETWORKS.iter().find(|network| network.name == name)?;
    let cache = etcetera::choose_base_strategy().ok()?.cache_dir().join("deepshade/models");
    network.written(&cache)
}

impl EmbeddedNetwork {
    /// The folder below another that has its files. Each version of a network has one of its own.
    fn written(&self, cache: &Path) -> Option<PathBuf> {
        let hash = blake3::Hasher::new().update(self.spec).update(self.weights).finalize().to_hex();
        let folder = cache.join(&hash[..16]).join(self.name);
        if !is_network(&folder) || !folder.join(WEIGHTS).is_file() {
            std::fs::create_dir_all(&folder).ok()?;
            // What tells that a network is there comes last.
            atomic_file::write(&folder.join(WEIGHTS), self.weights).ok()?;
            atomic_file::write(&folder.join(SPEC), self.spec).ok()?;
        }
        Some(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_a_network_once_it_is_written_and_stays() {
        let cache = tempfile::tempdir().expect("a folder");
        for network in &NETWORKS {
            let folder = network.written(cache.path()).expect("written");
            let model = crate::learned::network(&folder, None).expect("a network");
            assert!(!model.spec.blocks.is_empty());
            let written = || folder.join(WEIGHTS).metadata().expect("there").modified().expect("a time");
            let before = written();
            assert_eq!(network.written(cache.path()), Some(folder.clone()));
            assert_eq!(written(), before, "written once");
        }
    }

    #[test]
    fn there_is_none_of_another_name() {
        assert_eq!(folder("aos"), None);
    }
}
