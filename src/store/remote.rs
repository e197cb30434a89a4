//! One address of an object store, object by object.

use crate::place::{Address, Kind};
use anyhow::{Context, Result, bail};
use object_store::aws::{AmazonS3Builder, Checksum};
use object_store::azure::MicrosoftAzureBuilder;
use object_store::gcp::GoogleCloudStorageBuilder;
use object_store::path::Path;
use object_store::{ClientOptions, Error, ObjectStore, ObjectStoreExt, RetryConfig};
use std::sync::Arc;
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};

/// A request that fails for a reason that may pass is sent again so often, for so long.
const TRIES: usize = 8;
const PATIENCE: Duration = Duration::from_mins(3);
/// The longest that one request may take: an object on a slow line.
const SLOWEST: Duration = Duration::from_mins(5);

/// A store below an address.
pub struct Remote {
    runtime: Runtime,
    objects: Arc<dyn ObjectStore>,
    address: Address,
}

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
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        Ok(Self { runtime: runtime.context("threads for transfers")?, objects, address: address.clone() })
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

    /// An object of at most so many bytes; `None` where there is none.
    ///
    /// # Errors
    /// If the store cannot be reached, or the object is larger.
    pub fn get(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>> {
        let path = self.path(name);
        let read = async {
            let found = self.objects.get(&path).await?;
            // Before memory is taken for it.
            if found.meta.size > most { Ok(Err(found.meta.size)) } else { found.bytes().await.map(Ok) }
        };
        match self.runtime.block_on(read) {
            Ok(Ok(bytes)) => Ok(Some(bytes.into())),
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
    let retry = RetryConfig { max_retries: TRIES, retry_timeout: PATIENCE, ..RetryConfig::default() };
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
                .with_retry(retry)
                .build()?,
        ),
        Kind::Gcs => Arc::new(
            GoogleCloudStorageBuilder::from_env()
                .with_bucket_name(bucket)
                .with_client_options(options)
                .with_retry(retry)
                .build()?,
        ),
        Kind::Azure => Arc::new(
            MicrosoftAzureBuilder::from_env()
                .with_container_name(bucket)
                .with_client_options(options)
                .with_retry(retry)
                .build()?,
        ),
    })
}
