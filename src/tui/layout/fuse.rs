//! What the belief at the cursor is made of.
//!
//! ```text
//! experts
//! pairs             dims
//!                   KL
//! timeline
//! series
//! ```

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, experts_rows, rows};
use crate::tui::view::Pane;

impl Layout {
    pub(super) fn fuse(&mut self, body: Rect, shape: Shape) {
        let most = body.height.saturating_sub(2);
        let (experts, rest) = rows(body, experts_rows(shape.experts).min(most));
        self.put(Pane::Experts, experts);
        let series = (rest.height / 2).min(16);
        let (middle, below) = rows(rest, rest.height.saturating_sub(series));
        let (timeline, series) = rows(below, 3);
        self.put(Pane::Timeline, timeline);
        self.put(Pane::Series, series);
        let (pairs, right) = columns(middle, 32, 2);
        self.put(Pane::Pairs, pairs);
        let (dims, divergence) = rows(right, right.height / 2);
        self.put(Pane::Dims, dims);
        self.put(Pane::Divergence, divergence);
    }
}
