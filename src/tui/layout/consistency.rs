//! Whether what is claimed is held.
//!
//! ```text
//! verdict verdict verdict verdict
//! horizons          coverage
//! numbers           dependence
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, rows};
use crate::tui::view::Pane;

/// Rows of the numbers.
const NUMBERS: u16 = 9;

impl Layout {
    pub(super) fn consistency(&mut self, body: Rect, _shape: Shape) {
        let is_roomy = body.height >= 32;
        let gap = u16::from(is_roomy);
        let above = self.put_timeline(body, 2);
        let above = rows(above, above.height.saturating_sub(gap)).0;
        let (verdict, rest) = rows(above, if is_roomy { 5 } else { 3 });
        self.put(Pane::Verdict, verdict);
        let rest = rows(rest, gap).1;
        let half = rest.width.saturating_sub(2).div_ceil(2);
        let numbers = if is_roomy { NUMBERS + 3 } else { NUMBERS };
        let plots = rest
            .height
            .saturating_sub(numbers + gap)
            .max(rest.height.min(7));
        let (plots, rest) = rows(rest, plots);
        let (horizons, coverage) = columns(plots, half, 2);
        self.put(Pane::Horizons, horizons);
        self.put(Pane::Coverage, coverage);
        let (numbers, dependence) = columns(rows(rest, gap).1, half, 2);
        self.put(Pane::Numbers, numbers);
        self.put(Pane::Dependence, dependence);
    }
}
