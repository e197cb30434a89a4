//! Files to objects and back, several at a time.

use super::commit::{Commit, Stored, hash};
use super::remote::Remote;
use anyhow::{Context, Result, bail, ensure};
use deepshade_dataset::progress;
use deepshade_shaders::{atomic_file, own_file};
use rayon::{ThreadPoolBuilder, prelude::*};
use std::path::Path;

/// Transfers under way at a time.
const TRANSFERS: usize = 8;

/// Puts the files of a folder into a store, but for those that it has.
///
/// # Errors
/// If one cannot be read or has changed since it was listed, or the store cannot be reached.
pub fn put(remote: &Remote, commit: &Commit, folder: &Path) -> Result<()> {
    each(commit, "files stored", |file| {
        if remote.size(&file.object())? == Some(file.bytes) {
            return Ok(());
        }
        let path = folder.join(&file.name);
        let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
        ensure!(hash(&bytes) == file.blake3, "{} has changed while it was stored", path.display());
        remote.put(&file.object(), bytes)
    })
}

/// Writes the files of a list into a folder, but for those that it has.
///
/// # Errors
/// If the store cannot be reached, an object is missing or damaged, or a file cannot be written.
pub fn fetch(remote: &Remote, commit: &Commit, folder: &Path) -> Result<()> {
    each(commit, "files fetched", |file| fetch_file(remote, file, &folder.join(&file.name)))
}

/// Writes a file of a list, if it is not there with its bytes.
fn fetch_file(remote: &Remote, file: &Stored, path: &Path) -> Result<()> {
    if std::fs::read(path).is_ok_and(|bytes| file.is(&bytes)) {
        return Ok(());
    }
    let object = remote.name(&file.object());
    let Some(bytes) = remote.get(&file.object(), file.bytes)? else {
        bail!("{object}, which holds `{}`, is gone", file.name)
    };
    ensure!(
        file.is(&bytes),
        "{object}, which holds `{}`, is damaged: delete that object and `commit.json` there, and make the data anew",
        file.name
    );
    let place = || path.display().to_string();
    std::fs::create_dir_all(own_file::folder(path)).with_context(place)?;
    atomic_file::write(path, &bytes).with_context(place)
}

fn each(commit: &Commit, what: &'static str, transfer: impl Fn(&Stored) -> Result<()> + Sync) -> Result<()> {
    let bar = progress::bar(what, commit.files.len(), 0);
    let pool = ThreadPoolBuilder::new().num_threads(TRANSFERS).build().context("threads for transfers")?;
    let done = pool.install(|| {
        commit.files.par_iter().try_for_each(|file| {
            transfer(file)?;
            bar.inc(1);
            Ok(())
        })
    });
    bar.finish_and_clear();
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::location::Location;
    use object_store::memory::InMemory;
    use std::sync::Arc;

    #[test]
    fn a_file_has_the_size_that_its_list_says() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("made")).expect("made");
        std::fs::write(path("made/a"), "text").expect("written");
        let Ok(Location::Store(address)) = "s3://bucket/data".parse() else { unreachable!("an address") };
        let remote = Remote::on(Arc::new(InMemory::new()), &address).expect("a remote");
        let mut list = Commit::of(&path("made")).expect("listed");
        put(&remote, &list, &path("made")).expect("stored");
        fetch(&remote, &list, &path("had")).expect("fetched");
        // Whoever wrote the list counted wrong, whether the file is there already or not.
        for bytes in [3, 5] {
            list.files[0].bytes = bytes;
            for name in ["had", "new"] {
                assert!(fetch(&remote, &list, &path(name)).is_err(), "{bytes} bytes, {name}");
            }
        }
    }
}
