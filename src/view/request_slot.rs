//! A slot for the newest request to a worker: putting one there never waits, and what is taken is never out
//! of date.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
#[cfg(feature = "train")]
use std::time::Duration;

/// Room for one request between two threads.
pub struct RequestSlot<T> {
    slot: Mutex<Slot<T>>,
    filled: Condvar,
}

struct Slot<T> {
    newest: Option<T>,
    closed: bool,
}

impl<T> Default for RequestSlot<T> {
    fn default() -> Self {
        Self { slot: Mutex::new(Slot { newest: None, closed: false }), filled: Condvar::new() }
    }
}

impl<T> RequestSlot<T> {
    /// Puts a request there in place of one that was not taken yet.
    pub fn put(&self, request: T) {
        self.slot().newest = Some(request);
        self.filled.notify_one();
    }

    /// Waits for a request; none comes any more once the slot is closed.
    pub fn take(&self) -> Option<T> {
        let waits = |slot: &mut Slot<T>| slot.newest.is_none() && !slot.closed;
        let mut slot = self.filled.wait_while(self.slot(), waits).unwrap_or_else(PoisonError::into_inner);
        if slot.closed { None } else { slot.newest.take() }
    }

    /// Whether a request comes, or the slot is closed, before a time is over.
    #[cfg(feature = "train")]
    pub fn fills_within(&self, time: Duration) -> bool {
        let waits = |slot: &mut Slot<T>| slot.newest.is_none() && !slot.closed;
        let waited = self.filled.wait_timeout_while(self.slot(), time, waits);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    /// Whether what is being done is out of date: there is a newer request that `differs`, or the slot is
    /// closed.
    pub fn is_overtaken_by(&self, differs: impl Fn(&T) -> bool) -> bool {
        let slot = self.slot();
        slot.closed || slot.newest.as_ref().is_some_and(differs)
    }

    /// Takes the newer request, if there is one, where the work that is being done suits it.
    pub fn take_where(&self, suits: impl FnOnce(&mut T) -> bool) -> Option<T> {
        self.slot().newest.take_if(suits)
    }

    /// Ends the work: no request is taken any more.
    pub fn close(&self) {
        self.slot().closed = true;
        self.filled.notify_all();
    }

    /// A thread that panicked while it held the lock has left a request that is whole: it is moved in and out
    /// at once.
    fn slot(&self) -> MutexGuard<'_, Slot<T>> {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::thread;

    #[test]
    fn only_the_newest_request_is_taken() {
        let slot = RequestSlot::default();
        assert!(!slot.is_overtaken_by(|_| true));
        (0..3).for_each(|request| slot.put(request));
        assert!(slot.is_overtaken_by(|_| true));
        assert_eq!(slot.take(), Some(2));
        assert!(!slot.is_overtaken_by(|_| true));
    }

    #[test]
    fn work_goes_on_for_a_request_that_it_suits() {
        let slot = RequestSlot::default();
        assert!(!slot.is_overtaken_by(|_| true));
        slot.put(4);
        assert!(
            !slot.is_overtaken_by(|request| *request != 4) && slot.is_overtaken_by(|request| *request != 5)
        );
        assert_eq!(slot.take_where(|request| *request == 5), None);
        assert_eq!(slot.take_where(|request| *request == 4), Some(4));
        assert!(!slot.is_overtaken_by(|_| true));
        slot.close();
        assert!(slot.is_overtaken_by(|_| false));
    }

    #[cfg(feature = "train")]
    #[test]
    fn a_request_ends_the_waiting() {
        let slot = RequestSlot::default();
        assert!(!slot.fills_within(Duration::from_millis(1)));
        slot.put(1);
        assert!(slot.fills_within(Duration::from_secs(600)));
        assert_eq!(slot.take(), Some(1), "it is still there");
        slot.close();
        assert!(slot.fills_within(Duration::from_secs(600)));
    }

    #[test]
    fn a_waiting_worker_is_woken_by_a_request_and_by_closing() {
        let slot = Arc::new(RequestSlot::default());
        let taker = thread::spawn({
            let slot = Arc::clone(&slot);
            move || std::iter::from_fn(|| slot.take()).collect::<Vec<u32>>()
        });
        slot.put(7);
        while slot.is_overtaken_by(|_| true) {
            thread::yield_now();
        }
        slot.close();
        assert_eq!(taker.join().expect("no panic"), [7]);
        assert_eq!(slot.take(), None);
    }
}
