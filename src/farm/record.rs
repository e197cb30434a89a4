//! How the making of a shard went, try by try: one file a shard in the folder of jobs, for `farm status`.

use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_dataset::Shard;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// All tries of a shard.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// In their order. The last one may be under way.
    pub tries: Vec<Try>,
}

/// One try. What a killed one came to nobody wrote down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Try {
    /// Which process it was, and where.
    pub worker: String,
    /// What it came to; `None` while it is under way, and where it was killed.
    pub end: Option<End>,
}

/// What a try came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The shard is whole.
    Made {
        /// How long this try took.
        seconds: f64,
        /// Pairs that it rendered; others were there.
        rendered: usize,
        /// Pairs of the shard.
        pairs: usize,
        /// Their size.
        bytes: u64,
    },
    /// It failed.
    Failed {
        /// How long this try took.
        seconds: f64,
        /// Why.
        error: String,
    },
}

impl Record {
    /// The record of a shard; an empty one where there is none.
    ///
    /// # Errors
    /// If it cannot be read or is damaged.
    pub fn load(jobs: &Path, shard: Shard) -> Result<Self> {
        let path = file(jobs, shard);
        match std::fs::read(&path) {
            Ok(bytes) => serde_json::from_slice(&bytes).with_context(|| path.display().to_string()),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Self::default()),
            Err(error) => Err(error).with_context(|| path.display().to_string()),
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, jobs: &Path, shard: Shard) -> Result<()> {
        let text = serde_json::to_string_pretty(self).context("a record as JSON")?;
        write_atomically(&file(jobs, shard), text.as_bytes())
    }

    /// Whether the shard was made.
    pub fn made(&self) -> bool {
        self.tries.iter().any(|one| matches!(one.end, Some(End::Made { .. })))
    }

    /// Why the last try failed, if it did.
    pub fn error(&self) -> Option<&str> {
        match self.tries.last()?.end.as_ref()? {
            End::Failed { error, .. } => Some(error),
            End::Made { .. } => None,
        }
    }

    /// Seconds of all tries that came to an end.
    pub fn seconds(&self) -> f64 {
        let ends = self.tries.iter().filter_map(|one| one.end.as_ref());
        ends.map(|(End::Made { seconds, .. } | End::Failed { seconds, .. })| seconds).sum()
    }
}

fn file(jobs: &Path, shard: Shard) -> PathBuf {
    jobs.join("records").join(format!("{}.json", shard.number()))
}
