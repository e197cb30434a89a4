//! How long rays take, for benchmarks: a stopwatch around every query of a hierarchy, which stands still
//! unless somebody measures.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;
use web_time::Instant;

static RUNNING: AtomicBool = AtomicBool::new(false);
static NANOSECONDS: AtomicU64 = AtomicU64::new(0);
static QUERIES: AtomicU64 = AtomicU64::new(0);

/// What rays took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayTime {
    /// All queries together, over all threads, without what the stopwatch itself takes.
    pub time: Duration,
    /// Rays, and bundles of them.
    pub queries: u64,
}

/// Runs some work and says how long its rays took. Work of others at the same time is counted too; the
/// stopwatch makes the work slower, so that its whole time is to be taken without it.
pub fn timed<R>(work: impl FnOnce() -> R) -> (R, RayTime) {
    /// Queries that the stopwatch's own time is the mean of.
    const EMPTY: u32 = 100_000;
    RUNNING.store(true, Ordering::Relaxed);
    let before = read();
    (0..EMPTY).for_each(|_| around(|| {}));
    let own = read().0.saturating_sub(before.0) / u64::from(EMPTY);
    let before = read();
    let result = work();
    let after = read();
    RUNNING.store(false, Ordering::Relaxed);
    let queries = after.1 - before.1;
    let nanoseconds = (after.0 - before.0).saturating_sub(own * queries);
    (result, RayTime { time: Duration::from_nanos(nanoseconds), queries })
}

fn read() -> (u64, u64) {
    (NANOSECONDS.load(Ordering::Relaxed), QUERIES.load(Ordering::Relaxed))
}

/// Runs a query, with the stopwatch around it where somebody measures.
#[inline]
pub(super) fn around<R>(query: impl FnOnce() -> R) -> R {
    let start = RUNNING.load(Ordering::Relaxed).then(Instant::now);
    let result = query();
    if let Some(start) = start {
        NANOSECONDS.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        QUERIES.fetch_add(1, Ordering::Relaxed);
    }
    result
}
