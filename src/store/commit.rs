//! The list of what is at an address: names, sizes and hashes of all files, written when all of them are
//! there.

use super::remote::{Remote, Version};
use anyhow::{Context, Result, bail, ensure};
use deepshade_shaders::atomic_file::TEMPORARY_PREFIX;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::{Component, Path};

/// The list's object.
pub const NAME: &str = "commit.json";
/// Form of the list.
const VERSION: u32 = 1;
/// Largest list that is read, bytes: some millions of files.
const LARGEST: u64 = 1 << 30;
/// Largest file, bytes: what S3 takes in one request.
const LARGEST_FILE: u64 = 5 << 30;

/// All files of a folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Commit {
    version: u32,
    /// By name.
    pub files: Vec<Stored>,
}

/// A file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stored {
    /// Relative to the folder, parts joined by `/`.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// Its hash, in hexadecimal.
    pub blake3: String,
}

impl Stored {
    /// The object that holds it.
    pub fn object(&self) -> String {
        format!("objects/{}", self.blake3)
    }

    /// Whether bytes are its own: the list may have been written by anybody, and its sizes are relied upon,
    /// too.
    pub fn is(&self, bytes: &[u8]) -> bool {
        bytes.len() as u64 == self.bytes && hash(bytes) == self.blake3
    }
}

impl Commit {
    /// The list at an address, with its own hash and what tells its object from later ones; `None` where
    /// there is none.
    ///
    /// # Errors
    /// If the store cannot be reached, or what lies there is no such list.
    pub fn at(remote: &Remote) -> Result<Option<(Self, String, Version)>> {
        let Some((bytes, version)) = remote.get_versioned(NAME, LARGEST)? else { return Ok(None) };
        let commit = Self::parse(&bytes).with_context(|| remote.name(NAME))?;
        Ok(Some((commit, hash(&bytes), version)))
    }

    /// [`Self::at`] where there has to be one.
    ///
    /// # Errors
    /// As there, and if there is none.
    pub fn whole(remote: &Remote) -> Result<(Self, String)> {
        match Self::at(remote)? {
            Some((commit, hash, _)) => Ok((commit, hash)),
            None => bail!("nothing is there, or nothing finished: no `{NAME}`"),
        }
    }

    /// Reads a list, which anybody may have written.
    fn parse(bytes: &[u8]) -> Result<Self> {
        let commit: Self = serde_json::from_slice(bytes).context("no list of files")?;
        ensure!(commit.version == VERSION, "a list of form {}, where {VERSION} is read", commit.version);
        let mut names = HashSet::new();
        for file in &commit.files {
            let name = file.name.escape_debug();
            ensure!(is_inside(&file.name), "`{name}` is no name of a file below a folder");
            ensure!(names.insert(&file.name), "`{name}` is listed twice");
            let hexadecimal = file.blake3.len() == 64 && file.blake3.bytes().all(|b| b.is_ascii_hexdigit());
            ensure!(hexadecimal && file.bytes <= LARGEST_FILE, "`{name}` has no sound hash or size");
        }
        Ok(commit)
    }

    /// What a folder holds, but for what is half-written.
    ///
    /// # Errors
    /// If something cannot be read, or is neither a file nor a folder.
    pub fn of(folder: &Path) -> Result<Self> {
        let mut names = Vec::new();
        collect(folder, "", &mut names)?;
        names.sort();
        let files = names.into_par_iter().map(|name| stored(folder, name)).collect::<Result<Vec<_>>>()?;
        ensure!(!files.is_empty(), "{} holds nothing to be stored", folder.display());
        Ok(Self { version: VERSION, files })
    }

    /// Writes the list, in place of an earlier one or of none; whether it is there, and not somebody else's.
    /// All objects have to be there.
    ///
    /// # Errors
    /// If the store cannot be reached or refuses it.
    pub fn publish(&self, remote: &Remote, earlier: Option<&Version>) -> Result<bool> {
        if remote.replace(NAME, self.text()?, earlier)? {
            return Ok(true);
        }
        // Another that made the same is no other; neither is an answer that was lost, after which it is sent
        // again.
        Ok(Self::at(remote)?.is_some_and(|(there, ..)| there == *self))
    }

    /// The list as it is written.
    fn text(&self) -> Result<Vec<u8>> {
        serde_json::to_vec_pretty(self).context("a list as JSON")
    }

    /// Its own hash.
    ///
    /// # Errors
    /// If it cannot be written down.
    pub fn hash(&self) -> Result<String> {
        Ok(hash(&self.text()?))
    }
}

/// Hash of bytes, in hexadecimal.
pub fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Whether a name stays below the folder that it is joined to, on any system.
fn is_inside(name: &str) -> bool {
    let parts_are_names = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    let plain = !name.contains(['\\', ':', '\0']);
    plain && parts_are_names && name.split('/').all(|part| !matches!(part, "" | "." | ".."))
}

fn collect(folder: &Path, prefix: &str, names: &mut Vec<String>) -> Result<()> {
    let place = || folder.display().to_string();
    for entry in std::fs::read_dir(folder).with_context(place)? {
        let entry = entry.with_context(place)?;
        let kind = entry.file_type().with_context(place)?;
        let Ok(name) = entry.file_name().into_string() else { bail!("{}: a name that is no text", place()) };
        if name.starts_with(TEMPORARY_PREFIX) {
            continue;
        }
        let whole = format!("{prefix}{name}");
        match (kind.is_dir(), kind.is_file()) {
            (true, _) => collect(&entry.path(), &format!("{whole}/"), names)?,
            (_, true) => names.push(whole),
            _ => bail!("{}: neither a file nor a folder", entry.path().display()),
        }
    }
    Ok(())
}

fn stored(folder: &Path, name: String) -> Result<Stored> {
    let path = folder.join(&name);
    let place = || path.display().to_string();
    ensure!(is_inside(&name), "{}: stores have no such names", place());
    let mut hasher = blake3::Hasher::new();
    let file = std::fs::File::open(&path).with_context(place)?;
    hasher.update_reader(&file).with_context(place)?;
    let bytes = hasher.count();
    ensure!(bytes <= LARGEST_FILE, "{}: larger than stores take at once", place());
    Ok(Stored { name, bytes, blake3: hasher.finalize().to_hex().to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(name: &str, blake3: &str) -> String {
        format!(r#"{{"version": 1, "files": [{{"name": "{name}", "bytes": 1, "blake3": "{blake3}"}}]}}"#)
    }

    #[test]
    fn lists_that_would_lead_elsewhere_are_refused() {
        let hash = hash(b"x");
        Commit::parse(list("pairs/a.exr", &hash).as_bytes()).expect("sound");
        for name in ["../a", "/etc/a", "a/../../b", "a//b", "./a", "c:a", "a\\\\b", ""] {
            let error = Commit::parse(list(name, &hash).as_bytes()).expect_err(name).to_string();
            assert!(error.contains("no name of a file below"), "{name}: {error}");
        }
        assert!(Commit::parse(list("a", "../x").as_bytes()).is_err());
        assert!(Commit::parse(list("a", &hash).replace('1', "2").as_bytes()).is_err(), "another form");
        assert!(Commit::parse(b"{}").is_err());
    }

    #[test]
    fn a_folder_is_listed_but_for_what_is_half_written() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::create_dir(folder.path().join("pairs")).expect("made");
        for name in ["b", "pairs/a", ".deepshade-x"] {
            std::fs::write(folder.path().join(name), name).expect("written");
        }
        let commit = Commit::of(folder.path()).expect("listed");
        let names: Vec<&str> = commit.files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names, ["b", "pairs/a"]);
        assert_eq!((commit.files[1].blake3.clone(), commit.files[1].bytes), (hash(b"pairs/a"), 7));
        assert!(Commit::of(&folder.path().join("gone")).is_err());
    }
}
