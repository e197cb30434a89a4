//! A shard of a dataset in a store, of which pairs are fetched one by one where they are wanted, and nothing is kept.

use super::commit::{Commit, Stored};
use super::remote::Remote;
use super::transfer::fetched;
use crate::place::Address;
use anyhow::{Context, Result};
use deepshade_dataset::ShardFiles;
use std::collections::HashMap;
use std::io::{Error, Result as IoResult};
use std::path::PathBuf;

/// A shard at an address.
pub struct Shard {
    address: Address,
    remote: Remote,
    /// By name.
    files: HashMap<String, Stored>,
}

impl Shard {
    /// The one that is there.
    ///
    /// # Errors
    /// If the store cannot be reached, or holds nothing there.
    pub fn open(address: &Address) -> Result<Self> {
        let remote = Remote::open(address)?;
        let (list, _) = Commit::whole(&remote).with_context(|| address.to_string())?;
        Ok(Self::new(remote, list, address))
    }

    fn new(remote: Remote, list: Commit, address: &Address) -> Self {
        let files = list.files.into_iter().map(|file| (file.name.clone(), file)).collect();
        Self { address: address.clone(), remote, files }
    }
}

impl ShardFiles for Shard {
    fn place(&self) -> PathBuf {
        self.address.to_string().into()
    }

    fn names(&self) -> IoResult<Vec<String>> {
        Ok(self.files.keys().filter(|name| !name.contains('/')).cloned().collect())
    }

    fn read(&self, name: &str) -> IoResult<Vec<u8>> {
        let file = self.files.get(name).ok_or_else(|| Error::other("it is not in the list of files"))?;
        fetched(&self.remote, file).map_err(|error| Error::other(format!("{error:#}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::Place;
    use deepshade_dataset::{Recipe, generate, generate_shard, merge};
    use object_store::memory::InMemory;
    use std::path::Path;
    use std::sync::Arc;

    #[test]
    fn shards_in_a_store_are_put_together_file_by_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let tiny = Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes/ao-tiny.toml");
        let text = std::fs::read_to_string(tiny).expect("a recipe").replace("= 64", "= 16");
        std::fs::write(path("recipe.toml"), text).expect("written");
        let recipe = Recipe::load(&path("recipe.toml")).expect("a recipe");
        generate(&recipe, &path("whole")).expect("a dataset");
        let store = Arc::new(InMemory::new());
        let shards: Vec<Shard> = (1..=3)
            .map(|number| {
                let out = path(&number.to_string());
                let shard = format!("{number}/3").parse().expect("a shard");
                generate_shard(&recipe, &out, None, shard).expect("made");
                let Ok(Place::Store(address)) = format!("s3://bucket/{number}").parse() else {
                    unreachable!("an address")
                };
                let remote = Remote::on(Arc::clone(&store) as _, &address).expect("a remote");
                let list = Commit::of(&out).expect("listed");
                crate::store::transfer::put(&remote, &list, &out).expect("stored");
                Shard::new(remote, list, &address)
            })
            .collect();
        merge(&shards, &path("merged")).expect("merged");
        let list = |name: &str| Commit::of(&path(name)).expect("listed");
        assert_eq!(list("merged"), list("whole"));
        // What is gone is named by its address.
        let gone = shards[1].files.keys().find(|name| name.ends_with(".exr")).expect("a pair").clone();
        let object = shards[1].files[&gone].object();
        shards[1].remote.put(&object, b"other".to_vec()).expect("put");
        let error = merge(&shards, &path("again")).expect_err("damaged").to_string();
        assert!(error.contains(&format!("s3://bucket/2/{gone}")) && error.contains("is damaged"), "{error}");
    }
}
