//! Compiled pipelines, kept in a file for the next start of the program.
//!
//! All unsafe code of the library crates is here: wgpu hands what the file holds to the driver, which trusts
//! it.

use super::adapter_key;
use crate::{atomic_file, own_file};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What every file begins with.
const MAGIC: &str = "deepshade pipeline cache 1";
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 28;

/// A device's memory of compiled pipelines, and the file that keeps it.
#[derive(Clone, Debug)]
pub struct PipelineCache {
    cache: Option<wgpu::PipelineCache>,
    path: PathBuf,
    key: String,
}

impl PipelineCache {
    /// Opens a cache with what its file holds, and says in words why a file was of no use. Where the device
    /// has no such caches (the feature `PIPELINE_CACHE` is Vulkan's) nothing is remembered.
    ///
    /// The driver trusts what the file holds. So the file is to be in a folder that is the user's own, such
    /// as the user's cache folder: one that others may have written is not used, which on Unix is checked,
    /// elsewhere left to the caller.
    pub fn open(device: &wgpu::Device, path: &Path) -> (Self, Option<String>) {
        let key = key(&device.adapter_info());
        let (data, note) = match read(path, &key) {
            Ok(data) => (Some(data), None),
            Err(Unusable::Missing) => (None, None),
            Err(unusable) => (None, Some(format!("{}: {unusable}; it will be made anew", path.display()))),
        };
        let offered = device.features().contains(wgpu::Features::PIPELINE_CACHE);
        let cache = offered.then(|| create(device, data.as_deref()));
        (Self { cache, path: path.to_owned(), key }, note)
    }

    /// Writes what is remembered by now into the file, unless it holds that already. Its folder is made where
    /// there is none; nobody but the user may read or write either.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self) -> io::Result<()> {
        let Some(data) = self.cache.as_ref().and_then(wgpu::PipelineCache::get_data) else { return Ok(()) };
        if read(&self.path, &self.key).is_ok_and(|kept| kept == data) {
            return Ok(());
        }
        own_file::create_folder(own_file::folder(&self.path))?;
        atomic_file::write_private(&self.path, &file(&self.key, &data))
    }

    /// wgpu's cache, where the device has such.
    pub(super) const fn get(&self) -> Option<&wgpu::PipelineCache> {
        self.cache.as_ref()
    }
}

/// A cache that begins with `data`, which [`read`] has accepted.
#[expect(unsafe_code, reason = "there is no other way to give a driver what it compiled before")]
fn create(device: &wgpu::Device, data: Option<&[u8]>) -> wgpu::PipelineCache {
    let descriptor =
        wgpu::PipelineCacheDescriptor { label: Some("deepshade.pipelines"), data, fallback: true };
    // SAFETY: `data` must come from `get_data` of a cache of the same adapter. `read` accepts only files that
    // name this adapter, its driver and this version of the program, and whose data have the checksum beside
    // them: so they are what `save` wrote when it had them from `get_data`, unless somebody forged the file,
    // since the checksum has no key. On Unix only this user's own programs, and root, can have written it;
    // these are trusted, as they could run anything in this user's name. Elsewhere the caller has to choose
    // such a folder. wgpu checks its own header, and the driver its own, once more.
    unsafe { device.create_pipeline_cache(&descriptor) }
}

/// Why a file is of no use.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
enum Unusable {
    #[error("no such file")]
    Missing,
    #[error("cannot be read")]
    Unreadable,
    #[error("may have been written by others, or its folder")]
    Exposed,
    #[error("is no pipeline cache")]
    Strange,
    #[error("is of another adapter, driver or version")]
    Foreign,
    #[error("is damaged")]
    Damaged,
}

/// Whose pipelines a file holds: one line.
fn key(info: &wgpu::AdapterInfo) -> String {
    format!("{} {}", env!("CARGO_PKG_VERSION"), adapter_key(info))
}

/// A file: three lines, magic, key and checksum, then the data.
fn file(key: &str, data: &[u8]) -> Vec<u8> {
    let head = format!("{MAGIC}\n{key}\n{}\n", blake3::hash(data).to_hex());
    [head.as_bytes(), data].concat()
}

/// The data of a file of that key.
fn read(path: &Path, key: &str) -> Result<Vec<u8>, Unusable> {
    let failed = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => Unusable::Missing,
        _ => Unusable::Unreadable,
    };
    // Of the open file, which nobody can exchange any more.
    let mut opened = File::open(path).map_err(failed)?;
    let found = opened.metadata().map_err(failed)?;
    let folder = own_file::folder(path).metadata().map_err(failed)?;
    if !found.is_file() {
        return Err(Unusable::Unreadable);
    }
    if !(own_file::is_own(&found) && own_file::is_own(&folder)) {
        return Err(Unusable::Exposed);
    }
    if found.len() > MOST_BYTES {
        return Err(Unusable::Strange);
    }
    let mut bytes = Vec::new();
    opened.read_to_end(&mut bytes).map_err(failed)?;
    let mut parts = bytes.splitn(4, |byte| *byte == b'\n');
    if parts.next() != Some(MAGIC.as_bytes()) {
        return Err(Unusable::Strange);
    }
    if parts.next() != Some(key.as_bytes()) {
        return Err(Unusable::Foreign);
    }
    match (parts.next(), parts.next()) {
        (Some(sum), Some(data)) if sum == blake3::hash(data).to_hex().as_bytes() => Ok(data.to_vec()),
        _ => Err(Unusable::Damaged),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{Gpu, Pass};

    #[test]
    fn only_whole_files_of_the_same_key_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pipelines");
        assert_eq!(read(&path, "a"), Err(Unusable::Missing));
        assert_eq!(read(folder.path(), "a"), Err(Unusable::Unreadable));
        let data = b"one\ntwo\n\nthree".to_vec();
        let whole = file("a", &data);
        atomic_file::write_private(&path, &whole).expect("written");
        assert_eq!(read(&path, "a"), Ok(data));
        assert_eq!(read(&path, "b"), Err(Unusable::Foreign));
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).expect("written");
            assert!(read(&path, "a").is_err(), "cut off after {length} bytes");
        }
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 1;
            std::fs::write(&path, &changed).expect("written");
            assert!(read(&path, "a").is_err(), "byte {at} changed");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_others_may_have_written_is_not_used() {
        use std::fs::{Permissions, set_permissions};
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pipelines");
        atomic_file::write_private(&path, &file("a", b"data")).expect("written");
        for (changed, modes) in
            [(path.as_path(), [0o620, 0o602, 0o600]), (folder.path(), [0o770, 0o707, 0o700])]
        {
            for mode in modes {
                set_permissions(changed, Permissions::from_mode(mode)).expect("the user's own");
                let wanted = if mode & 0o022 == 0 { Ok(b"data".to_vec()) } else { Err(Unusable::Exposed) };
                assert_eq!(read(&path, "a"), wanted, "{} with mode {mode:o}", changed.display());
            }
        }
    }

    #[cfg(unix)]
    #[test]
    fn what_is_in_the_file_is_not_written_again() {
        use std::os::unix::fs::MetadataExt;
        let device = Gpu::new().expect("an adapter; lavapipe will do").device;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("new").join("pipelines");
        let (cache, _) = PipelineCache::open(&device, &path);
        if cache.get().is_none() {
            eprintln!("this device has no pipeline cache: whose files are used is not tested");
            return;
        }
        let save = || {
            cache.save().expect("written");
            let found = path.metadata().expect("it is there");
            (found.ino(), found.mode() & 0o777)
        };
        let (first, mode) = save();
        assert_eq!(mode, 0o600);
        assert_eq!(path.parent().expect("a folder").metadata().expect("it is there").mode() & 0o777, 0o700);
        // A name that stays keeps its inode from being given to another file.
        std::fs::hard_link(&path, folder.path().join("kept")).expect("linked");
        assert_eq!(save().0, first, "unchanged");
        atomic_file::write_private(&path, b"nonsense").expect("written");
        assert_ne!(save().0, first, "damaged");
        assert_eq!(PipelineCache::open(&device, &path).1, None);
    }

    #[test]
    fn a_useless_file_is_noted_and_made_anew() {
        let device = Gpu::new().expect("an adapter; lavapipe will do").device;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("new").join("pipelines");
        let (cache, note) = PipelineCache::open(&device, &path);
        assert_eq!(note, None);
        let compile =
            |cache| Pass::cached(&device, "one", "@compute @workgroup_size(1) fn main() {}", Some(cache));
        compile(&cache).expect("valid");
        cache.save().expect("written");
        let offered = device.features().contains(wgpu::Features::PIPELINE_CACHE);
        assert_eq!(path.exists(), offered);
        if !offered {
            eprintln!("this device has no pipeline cache: what files are used for is not tested");
            return;
        }
        assert_eq!(PipelineCache::open(&device, &path).1, None);
        std::fs::write(&path, "nonsense").expect("written");
        let (cache, note) = PipelineCache::open(&device, &path);
        assert!(note.expect("a note").contains("is no pipeline cache; it will be made anew"));
        compile(&cache).expect("valid");
        cache.save().expect("written");
        assert_eq!(PipelineCache::open(&device, &path).1, None);
    }
}
