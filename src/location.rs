//! Where data, runs and models are: a folder of this machine, or an address of an object store
//! (`s3://bucket/path`, `gs://bucket/path`, `az://container/path`).
//!
//! Work is done in folders alone. What is read from an address is a copy in the user's cache folder, checked
//! file by file. What is written to one is made in a folder there, which is nobody else's as long as the
//! [`WorkingFolder`] lives, and put into the store when it is whole (`store`).

mod working_folder;

pub use working_folder::WorkingFolder;

use anyhow::Result;
#[cfg(not(feature = "store"))]
use anyhow::bail;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

#[cfg(feature = "store")]
use crate::store;

/// A folder or an address.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Location {
    /// A folder of this machine.
    Folder(PathBuf),
    /// In an object store.
    Store(Address),
}

/// A place in an object store. Credentials are never part of it: they come from the environment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// Which kind of store.
    pub kind: Kind,
    /// The bucket, or Azure's container.
    pub bucket: String,
    /// Names joined by `/`, at least one.
    pub path: String,
}

/// A kind of store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Amazon's S3 and what speaks its protocol.
    S3,
    /// Google Cloud Storage.
    Gcs,
    /// Azure Blob Storage.
    Azure,
}

impl Kind {
    const ALL: [Self; 3] = [Self::S3, Self::Gcs, Self::Azure];

    const fn scheme(self) -> &'static str {
        match self {
            Self::S3 => "s3",
            Self::Gcs => "gs",
            Self::Azure => "az",
        }
    }
}

impl FromStr for Location {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once("://") {
            None if text.is_empty() => Err("no name is given".to_owned()),
            None => Ok(Self::Folder(text.into())),
            Some((scheme, rest)) => Address::parse(scheme, rest).map(Self::Store),
        }
    }
}

impl TryFrom<String> for Location {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Location> for String {
    fn from(location: Location) -> Self {
        location.to_string()
    }
}

impl Address {
    fn parse(scheme: &str, rest: &str) -> Result<Self, String> {
        let kind = Kind::ALL.into_iter().find(|kind| kind.scheme() == scheme).ok_or_else(|| {
            format!(
                "`{scheme}://` is no kind of store: s3://, gs:// and az:// are, and folders have no `://`"
            )
        })?;
        let allowed = |character: char| character.is_alphanumeric() || "-_.+=,/ ".contains(character);
        if let Some(character) = rest.chars().find(|character| !allowed(*character)) {
            let what = character.escape_debug();
            return Err(format!(
                "`{what}` in an address: it is {scheme}://BUCKET/PATH, and no credentials are in it"
            ));
        }
        let (bucket, path) = rest.trim_end_matches('/').split_once('/').unwrap_or((rest, ""));
        if bucket.is_empty() || path.split('/').any(|name| matches!(name, "" | "." | "..")) {
            return Err(format!("not of the form {scheme}://BUCKET/PATH"));
        }
        Ok(Self { kind, bucket: bucket.to_owned(), path: path.to_owned() })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}://{}/{}", self.kind.scheme(), self.bucket, self.path)
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(folder) => folder.display().fmt(f),
            Self::Store(address) => address.fmt(f),
        }
    }
}

impl Location {
    /// The folder of this machine that it is, if it is one.
    pub const fn folder_mut(&mut self) -> Option<&mut PathBuf> {
        match self {
            Self::Folder(folder) => Some(folder),
            Self::Store(_) => None,
        }
    }

    /// A place in this one.
    #[must_use]
    pub fn join(&self, name: &str) -> Self {
        match self {
            Self::Folder(folder) => Self::Folder(folder.join(name)),
            Self::Store(address) => {
                Self::Store(Address { path: format!("{}/{name}", address.path), ..address.clone() })
            }
        }
    }

    /// A folder with what is there, to be read.
    ///
    /// # Errors
    /// If the store cannot be reached, or holds nothing there or something damaged. A folder is not looked
    /// at.
    pub fn read(&self) -> Result<PathBuf> {
        match self {
            Self::Folder(folder) => Ok(folder.clone()),
            #[cfg(feature = "store")]
            Self::Store(address) => store::read(address),
            #[cfg(not(feature = "store"))]
            Self::Store(address) => without_stores(address),
        }
    }

    /// Whether a file is there, or whatever it may be that an address holds: there is nothing by halves.
    ///
    /// # Errors
    /// If the store cannot be reached.
    pub fn holds(&self, file: &str) -> Result<bool> {
        match self {
            Self::Folder(folder) => Ok(folder.join(file).is_file()),
            #[cfg(feature = "store")]
            Self::Store(address) => store::holds(address),
            #[cfg(not(feature = "store"))]
            Self::Store(address) => without_stores(address),
        }
    }

    /// A folder to write into, with what is there already. [`WorkingFolder::finish`] puts it where it
    /// belongs.
    ///
    /// # Errors
    /// If the store cannot be reached, what it holds there is damaged, or another program of this machine is
    /// at work on it.
    pub fn begin(&self) -> Result<WorkingFolder> {
        match self {
            Self::Folder(folder) => Ok(WorkingFolder::Folder(folder.clone())),
            #[cfg(feature = "store")]
            Self::Store(address) => {
                let copy = store::WorkingCopy::begin(address)?;
                let folder = copy.folder();
                Ok(WorkingFolder::Store(Box::new(copy), folder))
            }
            #[cfg(not(feature = "store"))]
            Self::Store(address) => without_stores(address),
        }
    }
}

#[cfg(not(feature = "store"))]
fn without_stores<T>(address: &Address) -> Result<T> {
    bail!(
        "{address}: this program was built without object stores; `cargo install --path . --features store` has them"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_addresses_are_told_apart() {
        assert_eq!("data/ao".parse(), Ok(Location::Folder("data/ao".into())));
        let location: Location = "s3://bucket/sets/ao/".parse().expect("an address");
        assert_eq!(location.to_string(), "s3://bucket/sets/ao");
        assert_eq!(location.join("1-of-2").to_string(), "s3://bucket/sets/ao/1-of-2");
        assert!(matches!("az://c/x".parse(), Ok(Location::Store(Address { kind: Kind::Azure, .. }))));
    }

    #[test]
    fn what_is_no_address_is_refused_and_says_why() {
        for (text, why) in [
            ("", "no name"),
            ("http://host/x", "no kind of store"),
            ("s3://bucket", "BUCKET/PATH"),
            ("s3:///x", "BUCKET/PATH"),
            ("s3://bucket/a/../b", "BUCKET/PATH"),
            ("s3://bucket//b", "BUCKET/PATH"),
            ("s3://user:secret@bucket/x", "no credentials"),
            ("gs://bucket/x?token=1", "no credentials"),
        ] {
            let error = text.parse::<Location>().expect_err(text);
            assert!(error.contains(why) && !error.contains("secret"), "{text}: {error}");
        }
    }
}
