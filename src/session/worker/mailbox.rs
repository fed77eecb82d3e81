//! A slot between two threads in which the newest replaces what was not taken yet: nothing queues, nobody waits to send.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::lock::lock;

/// Room for one value.
#[derive(Debug)]
pub struct Mailbox<T> {
    slot: Mutex<Slot<T>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Slot<T> {
    value: Option<T>,
    closed: bool,
}

impl<T> Default for Mailbox<T> {
    fn default() -> Self {
        Self {
            slot: Mutex::new(Slot {
                value: None,
                closed: false,
            }),
            changed: Condvar::new(),
        }
    }
}

impl<T> Mailbox<T> {
    /// Leaves a value; one that was not taken is dropped.
    pub fn put(&self, value: T) {
        self.lock().value = Some(value);
        self.changed.notify_all();
    }

    /// The value, if there is one.
    pub fn take(&self) -> Option<T> {
        self.lock().value.take()
    }

    /// Whether somebody waits to be heard: a value lies here, or the box is closed.
    pub fn calls(&self) -> bool {
        let slot = self.lock();
        slot.value.is_some() || slot.closed
    }

    /// Waits for a value; none once the box is closed.
    pub fn wait(&self) -> Option<T> {
        let mut slot = self.lock();
        loop {
            if slot.closed {
                return None;
            }
            if let Some(value) = slot.value.take() {
                return Some(value);
            }
            slot = self
                .changed
                .wait(slot)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Waits for a value until a deadline.
    pub fn wait_until(&self, deadline: Instant) -> Option<T> {
        let mut slot = self.lock();
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            if slot.value.is_some() || slot.closed || left == Duration::ZERO {
                return slot.value.take();
            }
            let woken = self.changed.wait_timeout(slot, left);
            slot = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Ends every wait, now and later.
    pub fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, Slot<T>> {
        lock(&self.slot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_replaces_what_was_not_taken() {
        let mailbox = Mailbox::default();
        mailbox.put(1);
        mailbox.put(2);
        assert_eq!((mailbox.take(), mailbox.take()), (Some(2), None));
    }

    #[test]
    fn closing_ends_the_wait() {
        let mailbox = Mailbox::<u8>::default();
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| mailbox.wait());
            mailbox.close();
            assert_eq!(waiting.join().ok(), Some(None));
        });
        assert!(mailbox.calls());
    }

    #[test]
    fn a_wait_ends_at_its_deadline() {
        let mailbox = Mailbox::<u8>::default();
        assert_eq!(mailbox.wait_until(Instant::now()), None);
    }
}
