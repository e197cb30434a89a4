//! A place for the newest order: who puts one there never waits, who takes one never sees one that is out of date.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

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

    /// Whether what is being done is out of date: there is a newer order, or nobody waits for the work any more.
    pub fn is_overtaken(&self) -> bool {
        let slot = self.slot();
        slot.closed || slot.newest.is_some()
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
        assert!(!mailbox.is_overtaken());
        (0..3).for_each(|order| mailbox.put(order));
        assert!(mailbox.is_overtaken());
        assert_eq!(mailbox.take(), Some(2));
        assert!(!mailbox.is_overtaken());
    }

    #[test]
    fn who_waits_is_woken_by_an_order_and_by_closing() {
        let mailbox = Arc::new(Mailbox::default());
        let taker = thread::spawn({
            let mailbox = Arc::clone(&mailbox);
            move || std::iter::from_fn(|| mailbox.take()).collect::<Vec<u32>>()
        });
        mailbox.put(7);
        while mailbox.is_overtaken() {
            thread::yield_now();
        }
        mailbox.close();
        assert_eq!(taker.join().expect("no panic"), [7]);
        assert_eq!(mailbox.take(), None);
    }
}
