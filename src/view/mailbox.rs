//! A place for the newest order: who puts one there never waits, who takes one never sees one that is out of date.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
#[cfg(feature = "train")]
use std::time::Duration;

/// Room for one order between two threads.
pub struct Mailbox<T> {
    slot: Mutex<Slot<T>>,
    filled: Condvar,
}

struct Slot<T> {
    newest: Option<T>,
    closed: bool,
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self { slot: Mutex::new(Slot { newest: None, closed: false }), filled: Condvar::new() }
    }
}

impl<T> Mailbox<T> {
    /// Puts an order there in place of the one that nobody has taken yet.
    pub fn put(&self, order: T) {
        self.slot().newest = Some(order);
        self.filled.notify_one();
    }

    /// Waits for an order; none comes any more once the mailbox is closed.
    pub fn take(&self) -> Option<T> {
        let waits = |slot: &mut Slot<T>| slot.newest.is_none() && !slot.closed;
        let mut slot = self.filled.wait_while(self.slot(), waits).unwrap_or_else(PoisonError::into_inner);
        if slot.closed { None } else { slot.newest.take() }
    }

    /// Whether an order comes, or the mailbox is closed, before a time is over.
    #[cfg(feature = "train")]
    pub fn fills_within(&self, time: Duration) -> bool {
        let waits = |slot: &mut Slot<T>| slot.newest.is_none() && !slot.closed;
        let waited = self.filled.wait_timeout_while(self.slot(), time, waits);
        !waited.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    /// Whether what is being done is out of date: there is a newer order that `differs`, or nobody waits for the work any more.
    pub fn is_overtaken_by(&self, differs: impl Fn(&T) -> bool) -> bool {
        let slot = self.slot();
        slot.closed || slot.newest.as_ref().is_some_and(differs)
    }

    /// Takes the newer order, if there is one, where the work that is being done suits it.
    pub fn take_where(&self, suits: impl FnOnce(&mut T) -> bool) -> Option<T> {
        self.slot().newest.take_if(suits)
    }

    /// Lets who waits go home.
    pub fn close(&self) {
        self.slot().closed = true;
        self.filled.notify_all();
    }

    /// A thread that panicked while it held the lock has left an order that is whole: it is moved in and out at once.
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
    fn only_the_newest_order_is_taken() {
        let mailbox = Mailbox::default();
        assert!(!mailbox.is_overtaken_by(|_| true));
        (0..3).for_each(|order| mailbox.put(order));
        assert!(mailbox.is_overtaken_by(|_| true));
        assert_eq!(mailbox.take(), Some(2));
        assert!(!mailbox.is_overtaken_by(|_| true));
    }

    #[test]
    fn work_goes_on_for_an_order_that_it_suits() {
        let mailbox = Mailbox::default();
        assert!(!mailbox.is_overtaken_by(|_| true));
        mailbox.put(4);
        assert!(
            !mailbox.is_overtaken_by(|order| *order != 4) && mailbox.is_overtaken_by(|order| *order != 5)
        );
        assert_eq!(mailbox.take_where(|order| *order == 5), None);
        assert_eq!(mailbox.take_where(|order| *order == 4), Some(4));
        assert!(!mailbox.is_overtaken_by(|_| true));
        mailbox.close();
        assert!(mailbox.is_overtaken_by(|_| false));
    }

    #[cfg(feature = "train")]
    #[test]
    fn an_order_ends_the_time_that_somebody_waits() {
        let mailbox = Mailbox::default();
        assert!(!mailbox.fills_within(Duration::from_millis(1)));
        mailbox.put(1);
        assert!(mailbox.fills_within(Duration::from_secs(600)));
        assert_eq!(mailbox.take(), Some(1), "it is still there");
        mailbox.close();
        assert!(mailbox.fills_within(Duration::from_secs(600)));
    }

    #[test]
    fn who_waits_is_woken_by_an_order_and_by_closing() {
        let mailbox = Arc::new(Mailbox::default());
        let taker = thread::spawn({
            let mailbox = Arc::clone(&mailbox);
            move || std::iter::from_fn(|| mailbox.take()).collect::<Vec<u32>>()
        });
        mailbox.put(7);
        while mailbox.is_overtaken_by(|_| true) {
            thread::yield_now();
        }
        mailbox.close();
        assert_eq!(taker.join().expect("no panic"), [7]);
        assert_eq!(mailbox.take(), None);
    }
}
