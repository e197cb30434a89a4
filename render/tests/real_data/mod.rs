//! Where the real scenes and images are that some tests read: the folder that the environment variable
//! `DEEPSHADE_DATA` names, else `../shared/data/open` beside the workspace. The tests of this crate and
//! xtask, which says whether the data were there, include this file by its path.

use std::path::{Path, PathBuf};

/// The folder, or `None` with a line on stderr where there is none.
pub fn data() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/open");
    let folder = std::env::var_os("DEEPSHADE_DATA").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("no real scenes and images are tested: {} is no folder (set DEEPSHADE_DATA)", folder.display());
    None
}
