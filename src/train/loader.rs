//! Prepares batches ahead, on a thread of its own, so that a step never waits for data.
//!
//! ```text
//! loop ── orders, a few ahead ─► loader: read, scale, stack
//! loop ◄─ batches, in order ──── loader
//! ```
//! What an order says is all that a batch depends on, so a batch is the same however far ahead it was prepared.

use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, Scope};
use std::time::{Duration, Instant};

/// Batches that are prepared while one is trained on.
pub const AHEAD: usize = 2;

/// The thread's name, for those who look at threads.
pub const THREAD: &str = "poescope-loader";

/// The loop's end: orders out, batches in.
#[derive(Debug)]
pub struct Loader<O, B> {
    orders: SyncSender<O>,
    batches: Receiver<B>,
}

impl<O: Send, B: Send> Loader<O, B> {
    /// Starts the thread, which ends when this is dropped.
    pub fn start<'scope, 'env>(
        scope: &'scope Scope<'scope, 'env>,
        mut prepare: impl FnMut(O) -> B + Send + 'scope,
    ) -> io::Result<Self>
    where
        O: 'scope,
        B: 'scope,
    {
        let (orders, to_do) = sync_channel(AHEAD + 1);
        // One batch lies ready, the next is being made or waits to be handed over.
        let (done, batches) = sync_channel(AHEAD - 1);
        Builder::new()
            .name(THREAD.to_owned())
            .spawn_scoped(scope, move || {
                for order in to_do {
                    if done.send(prepare(order)).is_err() {
                        return;
                    }
                }
            })?;
        Ok(Self { orders, batches })
    }

    /// Asks for one more batch. No more than [`AHEAD`] may be on order beside the one that is taken next.
    pub fn order(&self, order: O) {
        // If the thread is gone, the next batch is missed.
        let _ = self.orders.send(order);
    }

    /// The batch ordered first, and how long it was waited for; none if the thread has died.
    pub fn next(&self) -> Option<(B, Duration)> {
        let asked = Instant::now();
        let batch = self.batches.recv().ok()?;
        Some((batch, asked.elapsed()))
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    use super::*;

    #[test]
    fn the_next_batches_are_made_while_one_is_worked_on_and_no_more() {
        let made = AtomicUsize::new(0);
        thread::scope(|scope| {
            let prepare = |order: usize| {
                made.fetch_add(1, Ordering::SeqCst);
                order
            };
            let loader = Loader::start(scope, prepare).unwrap();
            let mut ordered = 0;
            for wanted in 0..20 {
                while ordered <= wanted + AHEAD {
                    loader.order(ordered);
                    ordered += 1;
                }
                let (batch, _) = loader.next().unwrap();
                assert_eq!(batch, wanted);
                // While this one is worked on nobody asks, and yet what comes next gets ready.
                let patience = Instant::now() + Duration::from_secs(20);
                while made.load(Ordering::SeqCst) < wanted + 1 + AHEAD {
                    assert!(Instant::now() < patience, "nothing is prepared ahead");
                    thread::yield_now();
                }
                assert_eq!(made.load(Ordering::SeqCst), wanted + 1 + AHEAD);
            }
        });
    }

    #[test]
    fn dropping_it_ends_the_thread_with_orders_open() {
        thread::scope(|scope| {
            let loader = Loader::start(scope, |order: usize| order).unwrap();
            (0..=AHEAD).for_each(|order| loader.order(order));
        });
    }
}
