//! Where the object is, and who pulls it there.
//!
//! ```text
//! position                      pulls
//!                               experts
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{LEFT, Layout, Shape, columns, experts_rows, rows};
use crate::tui::view::Pane;

impl Layout {
    pub(super) fn position(&mut self, body: Rect, shape: Shape) {
        let above = self.put_timeline(body, (body.height / 5).min(5));
        let plane = if above.width >= 60 {
            (above.width.saturating_sub(LEFT + 2)).max(above.width / 2)
        } else {
            above.width
        };
        let (plane, right) = columns(above, plane, 2);
        self.put(Pane::Position, plane);
        let experts = experts_rows(shape.experts);
        let (pulls, experts) = rows(right, right.height.saturating_sub(experts + 1));
        self.put(Pane::Pulls, pulls);
        self.put(Pane::Experts, rows(experts, 1).1);
    }
}
