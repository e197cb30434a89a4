//! One address of an object store, object by object.

use crate::location::{Address, Kind};
use anyhow::{Context, Result, anyhow, bail};
use object_store::aws::{AmazonS3Builder, Checksum};
use object_store::azure::MicrosoftAzureBuilder;
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::path::Path;
use object_store::{ClientOptions, Error, ObjectStore, ObjectStoreExt, PutMode, UpdateVersion};
use std::sync::{Arc, LazyLock};
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};

/// The longest that one request may take: an object on a slow line.
const SLOWEST: Duration = Duration::from_mins(5);

/// What all transfers run on.
static RUNTIME: LazyLock<std::io::Result<Runtime>> =
    LazyLock::new(|| Builder::new_multi_thread().worker_threads(1).enable_all().build());

/// A store below an address.
pub struct Remote {
    runtime: &'static Runtime,
    objects: Arc<dyn ObjectStore>,
    address: Address,
}

/// What tells an object from those that take its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Version(UpdateVersion);

impl Remote {
    /// Nothing is sent before the first object is asked for.
    ///
    /// # Errors
    /// If what the environment says of the store makes no sense.
    pub fn open(address: &Address) -> Result<Self> {
        Self::on(client(address).with_context(|| address.to_string())?, address)
    }

    /// The objects of a store below an address.
    ///
    /// # Errors
    /// If there are no threads for it.
    pub fn on(objects: Arc<dyn ObjectStore>, address: &Address) -> Result<Self> {
        let runtime = RUNTIME.as_ref().map_err(|error| anyhow!("threads for transfers: {error}"))?;
        Ok(Self { runtime, objects, address: address.clone() })
    }

    /// Writes an object, whole or not at all.
    ///
    /// # Errors
    /// If the store cannot be reached or refuses it.
    pub fn put(&self, name: &str, bytes: Vec<u8>) -> Result<()> {
        let path = self.path(name);
        let put = self.objects.put(&path, bytes.into());
        self.runtime.block_on(put).map(drop).with_context(|| self.name(name))
    }

    /// Writes an object in place of an earlier one, or of none, whole; `false` where something else is there.
    ///
    /// # Errors
    /// If the store cannot be reached or refuses it.
    pub fn replace(&self, name: &str, bytes: Vec<u8>, earlier: Option<&Version>) -> Result<bool> {
        let mode = match earlier {
            None => PutMode::Create,
            Some(Version(version)) => PutMode::Update(version.clone()),
        };
        let path = self.path(name);
        match self.runtime.block_on(self.objects.put_opts(&path, bytes.into(), mode.into())) {
            Ok(_) => Ok(true),
            Err(Error::AlreadyExists { .. } | Error::Precondition { .. }) => Ok(false),
            Err(error) => Err(error).with_context(|| self.name(name)),
        }
    }

    /// An object of at most so many bytes; `None` where there is none.
    ///
    /// # Errors
    /// If the store cannot be reached, or the object is larger.
    pub fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>> {
        Ok(self.get_versioned(name, most)?.map(|(bytes, _)| bytes))
    }

    /// [`Self::get`], with what tells the object from later ones.
    ///
    /// # Errors
    /// As there.
    pub fn get_versioned(&self, name: &str, most: u64) -> Result<Option<(Vec<u8>, Version)>> {
        let path = self.path(name);
        let read = async {
            let found = self.objects.get(&path).await?;
            // Before memory is taken for it.
            if found.meta.size > most {
                return Ok(Err(found.meta.size));
            }
            let (e_tag, version) = (found.meta.e_tag.clone(), found.meta.version.clone());
            let bytes = found.bytes().await?;
            Ok(Ok((bytes.into(), Version(UpdateVersion { e_tag, version }))))
        };
        match self.runtime.block_on(read) {
            Ok(Ok(found)) => Ok(Some(found)),
            Ok(Err(size)) => bail!("{} has {size} bytes, more than {most}", self.name(name)),
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(error).with_context(|| self.name(name)),
        }
    }

    /// Bytes of an object; `None` where there is none.
    ///
    /// # Errors
    /// If the store cannot be reached.
    pub fn size(&self, name: &str) -> Result<Option<u64>> {
        match self.runtime.block_on(self.objects.head(&self.path(name))) {
            Ok(found) => Ok(Some(found.size)),
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(error).with_context(|| self.name(name)),
        }
    }

    /// An object as people name it.
    pub fn name(&self, name: &str) -> String {
        format!("{}/{name}", self.address)
    }

    fn path(&self, name: &str) -> Path {
        Path::from(format!("{}/{name}", self.address.path))
    }
}

fn client(address: &Address) -> object_store::Result<Arc<dyn ObjectStore>> {
    // Without encryption only where the environment allows it, as it does for servers of one's own.
    let plain = ["AWS_ALLOW_HTTP", "GOOGLE_ALLOW_HTTP", "AZURE_ALLOW_HTTP"]
        .iter()
        .any(|name| std::env::var(name).is_ok_and(|value| value == "true"));
    let options = ClientOptions::new().with_timeout(SLOWEST).with_allow_http(plain);
    let bucket = address.bucket.as_str();
    Ok(match address.kind {
        Kind::S3 => Arc::new(
            AmazonS3Builder::from_env()
                .with_bucket_name(bucket)
                .with_checksum_algorithm(Checksum::SHA256)
                .with_client_options(options)
                .build()?,
        ),
        Kind::Gcs => Arc::new(
            GoogleCloudStorageBuilder::from_env()
                .with_bucket_name(bucket)
                .with_client_options(options)
                .build()?,
        ),
        Kind::Azure => Arc::new(
            MicrosoftAzureBuilder::from_env()
                .with_container_name(bucket)
                .with_client_options(options)
                .build()?,
        ),
    })
}
