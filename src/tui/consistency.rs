//! Whether what is claimed is held, over a split: sentences first, then the pictures they come from.
//!
//! ```text
//! consistency ───────────────────────── test, 12/32 episodes
//! filtered: claims 95 %, holds 81 % [65, 91] of 32: overconfident
//! NEES by horizon      coverage %          numbers, correlation, α
//! ```

pub mod coverage;
pub mod dependence;
pub mod horizons;
pub mod verdict;

use crate::session::snapshot::Snapshot;
use crate::session::snapshot::board::BoardView;

/// The board where there is something to read, else why there is nothing.
fn board(snapshot: &Snapshot) -> Result<&BoardView, String> {
    match snapshot.board.as_deref() {
        Some(BoardView {
            why_not: Some(why), ..
        }) => Err(why.clone()),
        Some(board) => Ok(board),
        None if snapshot.busy => Err("computing…".to_owned()),
        None => Err("not measured yet".to_owned()),
    }
}
