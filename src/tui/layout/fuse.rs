//! What the belief at the cursor is made of.
//!
//! ```text
//! 80×24                              120×40
//! status                             status
//! experts experts experts experts    experts experts experts experts
//! pairs             dims             dims              pairs
//! timeline                                             KL
//! series                             timeline
//! message                            series
//!                                    message
//! ```
//! Timeline and series share their axis, so that what is read at a step stands below its contact force.

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, experts_rows, rows};
use crate::tui::fuse::series;
use crate::tui::view::Pane;

/// Rows of the pairs: who, three of distances, the conflict and what it means.
const PAIRS_ROWS: u16 = 7;
/// Columns of the pairs, and of sixteen stacks of three columns.
const PAIRS: u16 = 37;
const DIMS: u16 = 56;

impl Layout {
    pub(super) fn fuse(&mut self, body: Rect, shape: Shape) {
        let roomy = u16::from(body.height >= 32);
        let notes = u16::from(body.height >= 20 && body.width >= 60) + roomy;
        let most = body.height.saturating_sub(2);
        let (experts, rest) = rows(body, (experts_rows(shape.experts) + notes).min(most));
        self.put(Pane::Experts, experts);
        let rest = rows(rest, roomy).1;

        let timeline = if rest.height >= 6 { 3 } else { 2 };
        let room = rest.height.saturating_sub(timeline + roomy);
        let least = series::rows(shape.experts) + PAIRS_ROWS;
        let middle = match room.checked_sub(least) {
            Some(spare) if body.width >= 70 => PAIRS_ROWS + spare * 3 / 5,
            _ => 0,
        };
        let (middle, below) = rows(rest, middle);
        self.middle(middle, shape);
        let below = if middle.is_empty() {
            below
        } else {
            rows(below, roomy).1
        };
        let (timeline, series) = rows(below, timeline);
        self.put(Pane::Timeline, timeline);
        self.put(Pane::Series, series);
    }

    fn middle(&mut self, pane: Rect, shape: Shape) {
        if !shape.product {
            self.put(Pane::Pairs, pane);
        } else if pane.width >= DIMS + 50 && pane.height >= 2 * PAIRS_ROWS {
            let (dims, right) = columns(pane, DIMS, 3);
            let (pairs, divergence) = rows(right, PAIRS_ROWS);
            self.put(Pane::Dims, dims);
            self.put(Pane::Pairs, pairs);
            self.put(Pane::Divergence, rows(divergence, 1).1);
        } else {
            let (pairs, dims) = columns(pane, PAIRS, 2);
            self.put(Pane::Pairs, pairs);
            self.put(Pane::Dims, dims);
        }
    }
}
