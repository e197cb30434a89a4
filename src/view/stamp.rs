//! What tells one state of a file from another without reading it.

use std::path::Path;
use std::time::SystemTime;

/// When a file was changed, and its bytes; nothing where there is none.
pub type Stamp = Option<(SystemTime, u64)>;

/// The state that a file is in now.
pub fn stamp(path: &Path) -> Stamp {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}
