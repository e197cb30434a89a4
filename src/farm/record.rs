//! How the making of shards went, try by try: one file a try in the folder of jobs, which the worker alone writes, for `farm
//! status` and `farm submit`.
//!
//! A worker notes now and then that it is at work, so that of a try that was killed it is known how long it took. What a record says
//! of a shard is what was so when it was written: whether the shard is there is looked for where it is.

use crate::figures::write_atomically;
use anyhow::{Context, Result};
use deepshade_dataset::{Shard, holder};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// The folder of records.
const RECORDS: &str = "records";
/// How often a worker notes that it is at work.
const SIGN: Duration = Duration::from_secs(30);

/// One try.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Try {
    /// Which process it was, and where.
    pub worker: String,
    /// When it began, by its machine's clock: seconds since 1970.
    pub began: f64,
    /// For how long it worked, as far as it was noted.
    pub seconds: f64,
    /// What it came to; `None` while it is under way, and where it was killed.
    pub end: Option<End>,
}

/// What a try came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// The shard is whole.
    Made {
        /// Pairs that it rendered; others were there.
        rendered: usize,
        /// Pairs of the shard.
        pairs: usize,
        /// Their size.
        bytes: u64,
    },
    /// It failed.
    Failed {
        /// Why.
        error: String,
    },
}

/// All tries of a shard, in the order in which they began.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// The last ones may be under way.
    pub tries: Vec<Try>,
}

impl Record {
    /// The records of all shards that were tried, by their numbers.
    ///
    /// # Errors
    /// If one cannot be read or is damaged.
    pub fn all(jobs: &Path) -> Result<HashMap<usize, Self>> {
        let folder = jobs.join(RECORDS);
        let mut records: HashMap<usize, Self> = HashMap::new();
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(records),
            Err(error) => return Err(error).with_context(|| folder.display().to_string()),
        };
        for path in entries.flatten().map(|entry| entry.path()) {
            let Some(shard) = shard_of(&path) else { continue };
            let place = || path.display().to_string();
            let bytes = std::fs::read(&path).with_context(place)?;
            let one = serde_json::from_slice(&bytes).with_context(place)?;
            records.entry(shard).or_default().tries.push(one);
        }
        records.values_mut().for_each(|record| record.tries.sort_by(|a, b| a.began.total_cmp(&b.began)));
        Ok(records)
    }

    /// What the last try that made the shard says of it: pairs and bytes.
    pub fn made(&self) -> Option<(usize, u64)> {
        self.tries.iter().rev().find_map(|one| match one.end {
            Some(End::Made { pairs, bytes, .. }) => Some((pairs, bytes)),
            _ => None,
        })
    }

    /// Why the last try failed, if it did.
    pub fn error(&self) -> Option<&str> {
        match self.tries.last()?.end.as_ref()? {
            End::Failed { error } => Some(error),
            End::Made { .. } => None,
        }
    }

    /// Seconds of all tries, those included that were killed, until they were last heard of.
    pub fn seconds(&self) -> f64 {
        self.tries.iter().map(|one| one.seconds).sum()
    }
}

/// Which shard a record is of, by its file's name, `7-...json`.
fn shard_of(path: &Path) -> Option<usize> {
    let name = path.file_name()?.to_str()?;
    name.strip_suffix(".json")?.split_once('-')?.0.parse().ok()
}

/// The record of a try under way, with a thread that notes how long it takes.
pub struct Entry {
    path: PathBuf,
    one: Try,
    start: Instant,
    stop: Sender<()>,
    signs: JoinHandle<()>,
}

impl Entry {
    /// Notes that a try begins.
    ///
    /// # Errors
    /// If that cannot be written.
    pub fn begin(jobs: &Path, shard: Shard) -> Result<Self> {
        Self::with_signs(jobs, shard, SIGN)
    }

    fn with_signs(jobs: &Path, shard: Shard, every: Duration) -> Result<Self> {
        let worker = holder::this_process();
        let began = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        // No two tries have the same name: not on one machine, nor at one time on two.
        let who = blake3::hash(worker.as_bytes()).to_hex();
        let name = format!("{}-{:015}-{who:.8}.json", shard.number(), began.as_micros());
        let path = jobs.join(RECORDS).join(name);
        let one = Try { worker, began: began.as_secs_f64(), seconds: 0.0, end: None };
        save(&path, &one)?;
        let (start, (stop, stopped)) = (Instant::now(), channel());
        let (own, mut sign) = (path.clone(), one.clone());
        let signs = spawn(move || {
            while stopped.recv_timeout(every) == Err(RecvTimeoutError::Timeout) {
                sign.seconds = start.elapsed().as_secs_f64();
                // One that cannot be written now is made up for by the next.
                let _ = save(&own, &sign);
            }
        });
        Ok(Self { path, one, start, stop, signs })
    }

    /// Notes what it came to; gives the seconds that it took.
    ///
    /// # Errors
    /// If that cannot be written.
    pub fn end(self, end: End) -> Result<f64> {
        drop(self.stop);
        // It has not panicked; if it had, nothing would be written by it any more.
        let _ = self.signs.join();
        let seconds = self.start.elapsed().as_secs_f64();
        save(&self.path, &Try { seconds, end: Some(end), ..self.one })?;
        Ok(seconds)
    }
}

fn save(path: &Path, one: &Try) -> Result<()> {
    let text = serde_json::to_string_pretty(one).context("a record as JSON")?;
    write_atomically(path, text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(text: &str) -> Shard {
        text.parse().expect("a shard")
    }

    #[test]
    fn two_tries_at_once_do_not_write_over_each_other() {
        let jobs = tempfile::tempdir().expect("a folder");
        let begin = |text| Entry::begin(jobs.path(), shard(text)).expect("begun");
        let (first, second, other) = (begin("7/9"), begin("7/9"), begin("1/9"));
        let made = End::Made { rendered: 3, pairs: 4, bytes: 5 };
        first.end(made).expect("written");
        second.end(End::Failed { error: "it is in use".to_owned() }).expect("written");
        let records = Record::all(jobs.path()).expect("read");
        let seventh = &records[&7];
        assert_eq!((seventh.tries.len(), seventh.made()), (2, Some((4, 5))));
        assert_eq!(records[&1].tries[0].end, None);
        assert_eq!(records.len(), 2);
        drop(other);
        assert!(Record::all(&jobs.path().join("none")).expect("read").is_empty());
    }

    #[test]
    fn how_long_a_killed_try_took_is_known_to_its_last_sign() {
        let jobs = tempfile::tempdir().expect("a folder");
        let entry = Entry::with_signs(jobs.path(), shard("1/2"), Duration::from_millis(5)).expect("begun");
        let seconds = || Record::all(jobs.path()).expect("read")[&1].seconds();
        let start = Instant::now();
        while seconds() < 0.02 {
            assert!(start.elapsed() < Duration::from_mins(1), "no sign of it");
        }
        assert!(seconds() <= start.elapsed().as_secs_f64() + 1.0);
        let taken = entry.end(End::Failed { error: "no light".to_owned() }).expect("written");
        let records = Record::all(jobs.path()).expect("read");
        assert_eq!((records[&1].seconds(), records[&1].error()), (taken, Some("no light")));
    }
}
