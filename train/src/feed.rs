//! Which pair each image of a training is cut from, and where it comes from: a folder, or a stream that never
//! ends. Both depend on seed and position alone, not on who is fast.

use crate::loader;
use crate::pairs::{Cache, HalfPair};
use crate::rng::{Purpose, Rng};
use crate::{TrainConfig, TrainError};
use deepshade_dataset::Stream;
use deepshade_infer::NetSpec;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Pairs that a stream may be ahead of those that are kept.
const AHEAD: usize = 16;
/// Pairs that a training begins with. Rendering all of a window first took minutes.
const FIRST_PAIRS: usize = 24;
/// Images for each pair that a window then grows by.
const IMAGES_A_PAIR: usize = 8;

/// How a run takes pairs from a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Endless {
    /// How often a pair is used, on average.
    pub uses: usize,
    /// Pairs in memory, of which each image is cut from any; less at the beginning.
    pub window: usize,
}

impl Endless {
    /// A pair that is used often teaches little more, and one that is used once costs as much as rendering
    /// it.
    pub const USUAL: Self = Self { uses: 8, window: 192 };

    /// The first pair of the window at a position of the training.
    const fn first(self, position: usize) -> usize {
        position / self.uses
    }

    /// The pair that the image at a position of the training is cut from.
    fn pair(self, seed: u64, position: usize) -> usize {
        let window = self.window.min(FIRST_PAIRS + position / IMAGES_A_PAIR);
        self.first(position) + Rng::new(seed, Purpose::Order, position as u64).below(window)
    }
}

/// Where the pairs of a run come from.
pub enum Feed {
    /// Pairs of a folder, of which these are trained on, each once an epoch, every epoch in another order.
    Folder {
        /// The pairs.
        cache: Cache,
        /// Indices of those that are trained on.
        training: Vec<usize>,
    },
    /// Pairs that are rendered while a network trains.
    Streamed(Streamed),
}

/// A stream with the pairs that are in use.
pub struct Streamed {
    stream: Stream,
    spec: NetSpec,
    endless: Endless,
    /// Pairs that are kept though the window has left them: workers are some batches apart.
    behind: usize,
    kept: Mutex<Kept>,
}

/// Pairs from a number on.
struct Kept {
    first: usize,
    pairs: VecDeque<Arc<HalfPair>>,
}

impl Streamed {
    /// Pairs of a recipe for a training that goes on at a position.
    ///
    /// # Errors
    /// If the stream does not begin.
    pub fn start(
        recipe: &deepshade_dataset::Recipe,
        config: &TrainConfig,
        endless: Endless,
        position: usize,
    ) -> Result<Self, TrainError> {
        let first = endless.first(position);
        let room = AHEAD.max(2 * recipe.views_per_scene);
        let stream =
            Stream::start(recipe, first, room).map_err(|error| TrainError::Data(error.to_string()))?;
        let batches = (loader::AHEAD + 2) * config.workers;
        let behind = (batches * config.batch).div_ceil(endless.uses) + 1;
        let spec = config.spec.clone();
        Ok(Self { stream, spec, endless, behind, kept: Mutex::new(Kept { first, pairs: VecDeque::new() }) })
    }

    /// How long the training waited for pairs to be rendered, seconds.
    pub fn waited(&self) -> f64 {
        self.stream.waited().as_secs_f64()
    }

    /// The pair of a number in the window that begins with `first`, which may be the first of it to be read.
    fn pair(&self, first: usize, number: usize) -> Result<Arc<HalfPair>, TrainError> {
        let failed = |index, problem| TrainError::Pair { index, problem };
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        while kept.first + self.behind < first && !kept.pairs.is_empty() {
            kept.pairs.pop_front();
            kept.first += 1;
        }
        while kept.first + kept.pairs.len() <= number {
            let next = kept.first + kept.pairs.len();
            let pair = self.stream.pair(next).map_err(|error| failed(next, error.to_string()))?;
            let half =
                HalfPair::new(&pair, &self.spec, next as u32).map_err(|problem| failed(next, problem))?;
            kept.pairs.push_back(Arc::new(half));
            self.stream.forget_before(next + 1);
        }
        let index = number.checked_sub(kept.first);
        index
            .and_then(|index| kept.pairs.get(index))
            .cloned()
            .ok_or_else(|| failed(number, "was forgotten: workers are too far apart".to_owned()))
    }
}

impl Feed {
    /// The pair that the image at a position of the training is cut from, with its number.
    ///
    /// # Errors
    /// If it cannot be read or is not what the network needs.
    pub fn pair(&self, seed: u64, position: usize) -> Result<(usize, Arc<HalfPair>), TrainError> {
        match self {
            Self::Folder { cache, training } => {
                let (epoch, at) = (position / training.len(), position % training.len());
                let order = Rng::new(seed, Purpose::Order, epoch as u64).permutation(training.len());
                let index = training[order[at]];
                Ok((index, cache.pair(index)?))
            }
            Self::Streamed(streamed) => {
                let endless = streamed.endless;
                let number = endless.pair(seed, position);
                Ok((number, streamed.pair(endless.first(position), number)?))
            }
        }
    }

    /// How long the training waited for pairs to be rendered, seconds.
    pub fn waited(&self) -> f64 {
        match self {
            Self::Folder { .. } => 0.0,
            Self::Streamed(streamed) => streamed.waited(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_is_used_as_often_as_is_said() {
        let endless = Endless { uses: 6, window: 20 };
        let mut counts = vec![0usize; 400];
        for position in 0..6 * 300 {
            counts[endless.pair(7, position)] += 1;
        }
        // Those that the window has held from its end to its beginning.
        let whole = &counts[20..280];
        let mean = whole.iter().sum::<usize>() as f64 / whole.len() as f64;
        assert!((mean - 6.0).abs() < 0.2, "{mean}");
    }

    #[test]
    fn a_training_begins_with_few_pairs_and_ends_with_its_whole_window() {
        let endless = Endless { uses: 32, window: 192 };
        let most = |positions: std::ops::Range<usize>| {
            positions.map(|position| endless.pair(7, position) - endless.first(position)).max()
        };
        assert!(most(0..8).is_some_and(|most| most < FIRST_PAIRS));
        assert!(most(10_000..20_000).is_some_and(|most| most > 180 && most < 192));
    }
}
