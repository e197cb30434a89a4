//! What stores and folders have in common.

use anyhow::{Context, Result, ensure};
use deepshade_shaders::atomic_file;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

/// Objects by name, wherever they are.
pub trait Objects: Sync {
    /// Writes one, whole or not at all.
    ///
    /// # Errors
    /// If that cannot be done.
    fn put(&self, name: &str, bytes: Vec<u8>) -> Result<()>;

    /// Reads one of at most so many bytes; `None` where there is none.
    ///
    /// # Errors
    /// If it cannot be read, or is larger.
    fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>>;

    /// Deletes one.
    ///
    /// # Errors
    /// If that cannot be done.
    fn delete(&self, name: &str) -> Result<()>;
}

/// Files of a folder, which is there.
impl Objects for PathBuf {
    fn put(&self, name: &str, bytes: Vec<u8>) -> Result<()> {
        let path = self.join(name);
        atomic_file::write(&path, &bytes).with_context(|| path.display().to_string())
    }

    fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>> {
        let path = self.join(name);
        let read = || -> std::io::Result<Option<Vec<u8>>> {
            if !path.exists() {
                return Ok(None);
            }
            let mut bytes = Vec::new();
            File::open(&path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
            Ok(Some(bytes))
        };
        let bytes = read().with_context(|| path.display().to_string())?;
        ensure!(
            bytes.iter().all(|bytes| bytes.len() as u64 <= most),
            "{}: more than {most} bytes",
            path.display()
        );
        Ok(bytes)
    }

    fn delete(&self, name: &str) -> Result<()> {
        let path = self.join(name);
        std::fs::remove_file(&path).with_context(|| path.display().to_string())
    }
}
