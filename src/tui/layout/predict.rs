//! How sure the rollout is.
//!
//! ```text
//! spread            fan
//! samples
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, rows};
use crate::tui::view::Pane;

impl Layout {
    pub(super) fn predict(&mut self, body: Rect, _shape: Shape) {
        let above = self.put_timeline(body, (body.height / 5).min(5));
        let (left, fan) = columns(above, above.width.div_ceil(2), 2);
        let (spread, samples) = rows(left, above.height.div_ceil(2));
        self.put(Pane::Spread, spread);
        self.put(Pane::Samples, samples);
        self.put(Pane::Fan, fan);
    }
}
