//! A network's WGSL files in a folder, of one network only: `network.json`, which lists them, goes first and
//! comes last.

use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_infer::forward::File;
use serde_json::Value;
use std::io::ErrorKind;
use std::path::{Component, Path};

/// The file that lists the others.
const LIST: &str = "network.json";

/// Writes the files of [`wgsl_files`](deepshade_infer::forward::wgsl_files) into a folder in place of those
/// that an older list there names. Killed at any moment, the folder holds the old network, the new one, or no
/// list.
///
/// # Errors
/// If a file cannot be deleted or written.
pub fn replace(folder: &Path, files: &[File]) -> Result<()> {
    let old = listed(&folder.join(LIST));
    for name in std::iter::once(LIST).chain(old.iter().map(String::as_str)) {
        let path = folder.join(name);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(error).with_context(|| path.display().to_string());
            }
            _ => {}
        }
    }
    let (lists, others): (Vec<&File>, Vec<&File>) = files.iter().partition(|(name, _)| name == LIST);
    others.into_iter().chain(lists).try_for_each(|(name, bytes)| write_atomically(&folder.join(name), bytes))
}

/// Names of the files that a list's passes and buffers have; of a file that is no list, or not there, none.
fn listed(list: &Path) -> Vec<String> {
    let network: Value =
        std::fs::read(list).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
    let passes = network["passes"].as_array().into_iter().flatten();
    let buffers = network["buffers"].as_object().into_iter().flat_map(|buffers| buffers.values());
    // Lists of older versions name the files of weights beside the shader.
    let keys =
        |listed: &'_ Value| ["file", "reads", "weights"].map(|key| listed[key].as_str().map(str::to_owned));
    let files = passes.chain(buffers).flat_map(keys).flatten().flat_map(|file| in_any_language(&file));
    let attributes = network["attributes"].as_array().into_iter().flatten();
    let checks = attributes.filter_map(Value::as_str).map(|attribute| format!("check.{attribute}.bin"));
    files.chain(checks).filter(|name| is_plain(name)).collect()
}

/// A file, and where it is a shader the same in other languages.
fn in_any_language(file: &str) -> Vec<String> {
    let others = file
        .strip_suffix(".wgsl")
        .into_iter()
        .flat_map(|stem| ["hlsl", "glsl", "spv"].map(|ending| format!("{stem}.{ending}")));
    [file.to_owned()].into_iter().chain(others).collect()
}

/// Whether a name is that of a file in the same folder.
fn is_plain(name: &str) -> bool {
    matches!(Path::new(name).components().collect::<Vec<_>>()[..], [Component::Normal(_)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_infer::forward::{Precision, wgsl_files};
    use deepshade_infer::{ChannelOrder, Model, NetSpec, Reach, Weights};
    use std::collections::BTreeSet;

    fn files(levels: usize) -> Vec<File> {
        let reach = Reach { radius: 1.0, diagonal_share: 0.1, height: 64 };
        let spec = NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| net.levels = levels);
        let model = Model { weights: Weights::random(&spec, 1), spec };
        wgsl_files(&model, Precision::F32, &[]).expect("files").files
    }

    fn names(folder: &Path) -> BTreeSet<String> {
        let entries = std::fs::read_dir(folder).expect("listed");
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn an_older_networks_files_are_replaced_and_no_others() {
        let scratch = tempfile::tempdir().expect("a folder");
        let folder = scratch.path().join("shaders");
        replace(&folder, &files(4)).expect("written");
        for own in [folder.join("own.wgsl"), scratch.path().join("outside")] {
            std::fs::write(own, "mine").expect("written");
        }
        replace(&folder, &files(2)).expect("written");
        let expected = files(2).into_iter().map(|(name, _)| name).chain(["own.wgsl".to_owned()]);
        assert_eq!(names(&folder), expected.collect());
        let list = r#"{"passes": [{"file": "../outside"}], "buffers": {"own": {"file": "own.wgsl"}}}"#;
        std::fs::write(folder.join(LIST), list).expect("written");
        replace(&folder, &files(2)).expect("written");
        assert!(scratch.path().join("outside").exists() && !names(&folder).contains("own.wgsl"));
    }

    #[test]
    fn a_folder_whose_files_are_not_all_written_has_no_list() {
        let folder = tempfile::tempdir().expect("a folder");
        replace(folder.path(), &files(2)).expect("written");
        // A file cannot be written where a folder is.
        let host = folder.path().join("HOST.md");
        std::fs::remove_file(&host).expect("deleted");
        std::fs::create_dir(&host).expect("made");
        replace(folder.path(), &files(2)).expect_err("in the way");
        assert!(!folder.path().join(LIST).exists());
    }
}
