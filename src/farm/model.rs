//! How long a farm takes and what holds it up, by a simulation of its tasks: a scheduler that starts one
//! after the other, workers that render, a store that takes what they made. Its numbers are measured or said
//! ([`super::cost`], `deepshade-studies farm`).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What the parts of a farm take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Seconds that the scheduler is busy with the start of a task.
    pub launch: f64,
    /// Seconds from a task's start to its first pair.
    pub start: f64,
    /// Seconds of one core that a pair takes.
    pub pair: f64,
    /// Bytes of a pair.
    pub bytes: f64,
    /// Seconds a pair that putting shards together takes.
    pub merge: f64,
    /// Where shards are written to.
    pub store: Store,
}

/// What a store takes of all workers together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Store {
    /// Bytes a second.
    pub bytes: f64,
    /// Requests a second.
    pub requests: f64,
}

/// A folder of the machine itself, whose time is in that of pairs.
pub const NO_STORE: Store = Store { bytes: f64::INFINITY, requests: f64::INFINITY };

/// Requests of a shard beside one for each of its pairs: its claim, its lists, what says that it is whole.
const REQUESTS_OF_A_SHARD: f64 = 4.0;

/// What works on what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Farm {
    /// Tasks at a time, of one thread each.
    pub workers: usize,
    /// Cores that they share; infinitely many where each has its own.
    pub cores: f64,
    /// Tasks of all.
    pub shards: usize,
    /// Pairs of all.
    pub pairs: usize,
}

/// What holds a farm up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// There are too few workers, or cores for them.
    Workers,
    /// Tasks are not started fast enough.
    Scheduler,
    /// The store does not take what is made.
    Store,
    /// Shards are put together by one process.
    Merge,
}

impl Limit {
    /// It in a word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Workers => "workers",
            Self::Scheduler => "scheduler",
            Self::Store => "store",
            Self::Merge => "merge",
        }
    }
}

/// How it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// From the first task to a dataset in one piece, seconds.
    pub seconds: f64,
    /// Time of all workers from the first to the last task, waiting included, seconds.
    pub worked: f64,
    /// What takes most of the time.
    pub limit: Limit,
}

impl Outcome {
    /// That of a farm.
    pub fn of(farm: &Farm, parts: &Parts) -> Self {
        let workers = farm.workers.min(farm.shards).max(1);
        let slowed = (workers as f64 / farm.cores).max(1.0);
        let (mut launched, mut stored, mut rendered) = (0.0f64, 0.0f64, 0.0);
        let (mut next, mut last) = (0, 0.0f64);
        // A worker is free, or has made a shard of so many pairs.
        let mut events: BinaryHeap<Reverse<Event>> =
            (0..workers).map(|_| Reverse(Event { at: 0.0, made: None })).collect();
        let mut transfers = 0.0;
        while let Some(Reverse(Event { at, made })) = events.pop() {
            if let Some(pairs) = made {
                let seconds = parts.store.seconds(pairs, parts.bytes);
                transfers += seconds;
                stored = stored.max(at) + seconds;
                last = last.max(stored);
                events.push(Reverse(Event { at: stored, made: None }));
            } else if next < farm.shards {
                let begin = at.max(launched);
                launched = begin + parts.launch;
                let pairs = (next + 1) * farm.pairs / farm.shards - next * farm.pairs / farm.shards;
                next += 1;
                let seconds = slowed * (parts.start + pairs as f64 * parts.pair);
                rendered += seconds;
                events.push(Reverse(Event { at: launched + seconds, made: Some(pairs) }));
            }
        }
        let merge = parts.merge * farm.pairs as f64;
        let times = [
            (Limit::Workers, rendered / workers as f64),
            (Limit::Scheduler, parts.launch * farm.shards as f64),
            (Limit::Store, transfers),
            (Limit::Merge, merge),
        ];
        let limit =
            times.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(Limit::Workers, |(limit, _)| limit);
        Self { seconds: last + merge, worked: last * workers as f64, limit }
    }
}

impl Store {
    /// How long it takes a shard.
    fn seconds(&self, pairs: usize, bytes: f64) -> f64 {
        let pairs = pairs as f64;
        (pairs * bytes / self.bytes).max((pairs + REQUESTS_OF_A_SHARD) / self.requests)
    }
}

/// Something that happens to a worker.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Event {
    at: f64,
    made: Option<usize>,
}

impl Eq for Event {}

impl PartialOrd for Event {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Event {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.at.total_cmp(&other.at).then(self.made.cmp(&other.made))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARTS: Parts =
        Parts { launch: 0.0, start: 3.0, pair: 2.0, bytes: 1e6, merge: 0.0, store: NO_STORE };
    const FARM: Farm = Farm { workers: 1, cores: f64::INFINITY, shards: 10, pairs: 100 };

    #[test]
    fn one_worker_does_all_one_after_the_other_and_more_share_it() {
        let one = Outcome::of(&FARM, &PARTS);
        assert_eq!((one.seconds, one.limit), (10.0 * 3.0 + 200.0, Limit::Workers));
        // Ten shards on four workers are three rounds of a shard; on two cores each takes twice as long.
        let four = Farm { workers: 4, ..FARM };
        assert_eq!(Outcome::of(&four, &PARTS).seconds, 3.0 * 23.0);
        assert_eq!(Outcome::of(&four, &PARTS).worked, 4.0 * 69.0);
        assert_eq!(Outcome::of(&Farm { cores: 2.0, ..four }, &PARTS).seconds, 6.0 * 23.0);
        // More workers than shards wait.
        assert_eq!(Outcome::of(&Farm { workers: 99, ..FARM }, &PARTS).seconds, 23.0);
    }

    #[test]
    fn what_is_done_one_after_the_other_holds_many_workers_up() {
        let many = Farm { workers: 1000, shards: 1000, pairs: 10_000, ..FARM };
        let scheduler = Outcome::of(&many, &Parts { launch: 0.5, ..PARTS });
        assert_eq!((scheduler.seconds, scheduler.limit), (1000.0 * 0.5 + 23.0, Limit::Scheduler));
        // All shards come at once: ten pairs of a megabyte each at ten megabytes a second.
        let store = Outcome::of(&many, &Parts { store: Store { bytes: 1e7, ..NO_STORE }, ..PARTS });
        assert!((store.seconds - (23.0 + 1000.0)).abs() < 1e-6 && store.limit == Limit::Store);
        let requests = Outcome::of(&many, &Parts { store: Store { requests: 7.0, ..NO_STORE }, ..PARTS });
        assert!((requests.seconds - (23.0 + 2000.0)).abs() < 1e-6, "ten pairs and four more a shard");
        let merge = Outcome::of(&many, &Parts { merge: 0.01, ..PARTS });
        assert_eq!((merge.seconds, merge.limit), (23.0 + 100.0, Limit::Merge));
    }
}
