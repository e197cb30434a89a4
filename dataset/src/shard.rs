//! Parts of a dataset that are made apart, on whatever machines and in whatever order: `shard-2-of-5.json`
//! lists the pairs of one, [`merge()`](merge::merge) puts them together to the bytes of a dataset that one
//! run makes.

pub mod merge;

use crate::manifest::MANIFEST;
use crate::plan::PlannedScene;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

/// One of so many parts of a dataset, written like `2/5`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    /// Which one, from 1.
    number: usize,
    /// Of how many.
    count: usize,
}

/// Most shards of a dataset.
const MOST: usize = 1_000_000;

impl Shard {
    /// Which one, from 1.
    pub const fn number(self) -> usize {
        self.number
    }

    /// Of how many.
    pub const fn count(self) -> usize {
        self.count
    }

    /// The file that lists its pairs, in its folder.
    pub fn file_name(self) -> String {
        format!("shard-{}-of-{}.json", self.number, self.count)
    }

    /// Its scenes and views of a plan: views that follow each other, so that few scenes are in more than one
    /// shard.
    pub(crate) fn of(self, plan: Vec<PlannedScene>) -> Vec<PlannedScene> {
        let total: usize = plan.iter().map(|scene| scene.views.len()).sum();
        let own = self.places(total);
        let mut first = 0;
        let cut = plan.into_iter().map(|mut scene| {
            let before = first;
            first += scene.views.len();
            let mut place = before..;
            scene.views.retain(|_| place.next().is_some_and(|place| own.contains(&place)));
            scene
        });
        cut.filter(|scene| !scene.views.is_empty()).collect()
    }

    /// Which of so many views, counted through all scenes, are its.
    fn places(self, total: usize) -> Range<usize> {
        // Without overflow, whatever the numbers.
        let begin = |number: usize| (number as u128 * total as u128 / self.count as u128) as usize;
        begin(self.number - 1)..begin(self.number)
    }

    /// The shard that a folder holds, if its list is there and no manifest.
    pub fn in_folder(folder: &Path) -> Option<Self> {
        if folder.join(MANIFEST).exists() {
            return None;
        }
        let entries = std::fs::read_dir(folder).ok()?.flatten();
        entries.into_iter().find_map(|entry| Self::by_file(&entry.file_name().to_string_lossy()))
    }

    /// What is said to who takes it for a dataset.
    pub fn is_no_dataset(self) -> String {
        format!("it is shard {self}: merge it with the others first, by `deepshade dataset merge`")
    }

    /// The shard of which that is the list's name.
    pub fn by_file(name: &str) -> Option<Self> {
        let (number, count) = name.strip_prefix("shard-")?.strip_suffix(".json")?.split_once("-of-")?;
        format!("{number}/{count}").parse().ok()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no shard: the second of five is 2/5");
        let (number, count) = text.split_once('/').ok_or_else(wrong)?;
        let [number, count] = [number, count].map(|number| number.trim().parse::<usize>());
        match (number, count) {
            (Ok(number), Ok(count)) if (1..=count).contains(&number) && count <= MOST => {
                Ok(Self { number, count })
            }
            _ => Err(wrong()),
        }
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests;
