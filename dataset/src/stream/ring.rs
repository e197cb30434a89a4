//! The pairs of a stream that are in memory, and who waits for whom.

use crate::{DatasetError, Pair};
use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A window on numbered pairs that goes on as those before it are forgotten.
#[derive(Debug)]
pub struct Ring {
    state: Mutex<State>,
    /// Something of the state changed.
    changed: Condvar,
    room: usize,
    views: usize,
}

#[derive(Debug)]
struct State {
    pairs: BTreeMap<usize, Arc<Pair>>,
    /// Numbers below are forgotten.
    from: usize,
    /// The next scene to be begun.
    scene: usize,
    /// Scenes that were begun and are not finished.
    under_way: usize,
    /// Why nothing more is rendered.
    ended: Option<String>,
    waited: Duration,
}

impl Ring {
    /// An empty ring from a number on, with room for so many pairs, of scenes with so many views.
    pub fn new(first: usize, room: usize, views: usize) -> Self {
        let state = State {
            pairs: BTreeMap::new(),
            from: first,
            scene: first / views,
            under_way: 0,
            ended: None,
            waited: Duration::ZERO,
        };
        Self { state: Mutex::new(state), changed: Condvar::new(), room, views }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    /// The end of the last scene for which there is room.
    const fn end_of_room(&self, from: usize) -> usize {
        (from + self.room) / self.views * self.views
    }

    /// Waits until there is room for another scene and fewer than `at_once` are under way. `None` when the
    /// stream ends.
    pub fn begin_scene(&self, at_once: usize) -> Option<usize> {
        let mut state = self.lock();
        loop {
            if state.ended.is_some() {
                return None;
            }
            // What was forgotten before it was begun is not rendered.
            state.scene = state.scene.max(state.from / self.views);
            let has_room = (state.scene + 1) * self.views <= self.end_of_room(state.from);
            if has_room && state.under_way < at_once {
                state.scene += 1;
                state.under_way += 1;
                return Some(state.scene - 1);
            }
            state = self.wait(state);
        }
    }

    /// Says that a scene that was begun is done with.
    pub fn finish_scene(&self) {
        self.lock().under_way -= 1;
        self.changed.notify_all();
    }

    /// Whether a pair is still of use.
    pub fn wants(&self, number: usize) -> bool {
        let state = self.lock();
        state.ended.is_none() && number >= state.from
    }

    /// Keeps a pair, if it is still of use.
    pub fn put(&self, number: usize, pair: Pair) {
        let mut state = self.lock();
        if number >= state.from {
            state.pairs.insert(number, Arc::new(pair));
            self.changed.notify_all();
        }
    }

    /// Waits for a pair.
    ///
    /// # Errors
    /// If it was forgotten, is further ahead than there is room, or nothing more is rendered.
    pub fn pair(&self, number: usize) -> Result<Arc<Pair>, DatasetError> {
        let failed = |what: String| Err(DatasetError::Stream { number, what });
        let start = Instant::now();
        let mut state = self.lock();
        loop {
            if let Some(pair) = state.pairs.get(&number).map(Arc::clone) {
                state.waited += start.elapsed();
                return Ok(pair);
            }
            let (from, end) = (state.from, self.end_of_room(state.from));
            if number < from {
                return failed(format!("all before {from} are forgotten"));
            }
            if number >= end {
                return failed(format!("there is room for {from} to {} alone", end - 1));
            }
            if let Some(why) = &state.ended {
                return failed(why.clone());
            }
            state = self.wait(state);
        }
    }

    /// Drops all pairs before a number.
    pub fn forget_before(&self, number: usize) {
        let mut state = self.lock();
        if number > state.from {
            state.from = number;
            state.pairs = state.pairs.split_off(&number);
            self.changed.notify_all();
        }
    }

    /// How long [`Ring::pair`] has waited in all.
    pub fn waited(&self) -> Duration {
        self.lock().waited
    }

    /// Ends the rendering, for the first reason that is given.
    pub fn end(&self, why: &str) {
        self.lock().ended.get_or_insert_with(|| why.to_owned());
        self.changed.notify_all();
    }

    /// Pairs in memory.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.lock().pairs.len()
    }
}
