//! How a run is asked to end: after the step that is under way, which it keeps.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What whoever watches a run has in common with it.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<Flags>);

#[derive(Debug, Default)]
struct Flags {
    /// Whether the run is at its steps.
    at_steps: AtomicBool,
    asked: AtomicBool,
}

impl PartialEq for Stop {
    /// Who watches a run changes nothing of what it learns.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Stop {
    /// Asks the run to end. Whether it is at its steps, and will: before them there is nothing to be kept.
    pub fn ask(&self) -> bool {
        self.0.asked.store(true, Ordering::SeqCst);
        self.0.at_steps.load(Ordering::SeqCst)
    }

    /// Whether somebody has asked.
    pub(crate) fn is_asked(&self) -> bool {
        self.0.asked.load(Ordering::SeqCst)
    }

    /// Says that the run is at its steps from now on, until what is returned is dropped.
    pub(crate) fn guard(&self) -> StopGuard {
        self.0.at_steps.store(true, Ordering::SeqCst);
        StopGuard(self.clone())
    }
}

/// As long as it lives, the run is at its steps.
pub(crate) struct StopGuard(Stop);

impl Drop for StopGuard {
    fn drop(&mut self) {
        self.0.0.at_steps.store(false, Ordering::SeqCst);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_run_at_its_steps_stops_when_asked() {
        let (stop, other) = (Stop::default(), Stop::default());
        let guard = stop.guard();
        assert!(!stop.is_asked() && stop.clone().ask() && stop.is_asked());
        assert!(!other.is_asked() && !other.ask());
        drop(guard);
        assert!(!stop.ask());
    }
}
