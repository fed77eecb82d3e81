//! Whether what is claimed is held.
//!
//! ```text
//! coverage          horizons
//! dependence        episodes
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, rows};
use crate::tui::view::Pane;

impl Layout {
    pub(super) fn consistency(&mut self, body: Rect, _shape: Shape) {
        let above = self.put_timeline(body, (body.height / 8).min(5));
        let (upper, lower) = rows(above, above.height.div_ceil(2));
        let half = above.width.saturating_sub(2).div_ceil(2);
        let (coverage, horizons) = columns(upper, half, 2);
        let (dependence, episodes) = columns(lower, half, 2);
        self.put(Pane::Coverage, coverage);
        self.put(Pane::Horizons, horizons);
        self.put(Pane::Dependence, dependence);
        self.put(Pane::Episodes, episodes);
    }
}
