//! Every set of experts at once.
//!
//! ```text
//! sets sets sets sets
//! sets sets sets sets
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{Layout, Shape};
use crate::tui::view::Pane;

impl Layout {
    pub(super) fn lattice(&mut self, body: Rect, _shape: Shape) {
        let above = self.put_timeline(body, (body.height / 8).min(5));
        self.put(Pane::Sets, above);
    }
}
