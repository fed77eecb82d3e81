//! Where the object is, and who pulls it there.
//!
//! ```text
//! position                      pulls
//!                               experts, on a large screen
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{LEFT, Layout, Shape, columns, experts_rows, rows};
use crate::tui::view::Pane;

/// Columns of the numbers.
const PULLS: u16 = 33;

impl Layout {
    pub(super) fn position(&mut self, body: Rect, shape: Shape) {
        let is_roomy = body.height >= 32 && body.width >= 108;
        let gap = u16::from(is_roomy);
        let above = self.put_timeline(
            body,
            if is_roomy {
                6
            } else {
                (body.height / 5).min(4)
            },
        );
        let above = rows(above, above.height.saturating_sub(gap)).0;
        if above.width < PULLS + 2 + 24 {
            self.put(Pane::Position, above);
            return;
        }
        let numbers = if is_roomy { LEFT } else { PULLS };
        let (plane, right) = columns(above, above.width - numbers - 2, 2);
        self.put(Pane::Position, plane);
        if is_roomy {
            let experts = experts_rows(shape.experts);
            let (pulls, experts) = rows(right, right.height.saturating_sub(experts + 1));
            self.put(Pane::Pulls, pulls);
            self.put(Pane::Experts, rows(experts, 1).1);
        } else {
            self.put(Pane::Pulls, right);
        }
    }
}
