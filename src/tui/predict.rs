//! The panes of the rollout: how good its frames are, how sure it is, what its samples look like.
//!
//! ```text
//! frames        truth, belief, prediction, error of every k-th step      strip.rs
//! PSNR dB       σ of the position cm       samples                       horizon.rs, spread.rs, samples.rs
//! ```

pub mod edited;
pub mod horizon;
pub mod samples;
pub mod spread;

mod heat;

use crate::session::snapshot::Snapshot;

/// The steps of the horizon that the episode has: distance from the start, step.
fn ahead(snapshot: &Snapshot) -> impl Iterator<Item = (usize, usize)> {
    let steps = snapshot.steps();
    let (start, horizon) = (snapshot.start, snapshot.horizon);
    (0..=horizon)
        .map(move |h| (h, start.saturating_add(h)))
        .take_while(move |&(_, step)| step < steps)
}

/// The cursor's distance from the start, while it is within the horizon.
fn cursor_ahead(snapshot: &Snapshot) -> Option<usize> {
    let ahead = snapshot.cursor.checked_sub(snapshot.start)?;
    (ahead <= snapshot.horizon).then_some(ahead)
}

/// Labels below an axis of the horizon.
fn labels(last: usize) -> Vec<(f32, String)> {
    let every = match last {
        0..=6 => 1,
        7..=12 => 2,
        13..=30 => 5,
        _ => 10,
    };
    let step = |h: usize| (h as f32, format!("+{h}"));
    (1..=last)
        .filter(|&h| h == 1 || h.is_multiple_of(every))
        .map(step)
        .collect()
}
