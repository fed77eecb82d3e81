//! How good the rollout is, and how sure.
//!
//! ```text
//! strip strip strip strip strip
//! quality    spread     samples
//! timeline
//! ```

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, rows};
use crate::tui::view::Pane;

/// Rows of the plots, where there is room for frames that are large enough above them.
const PLOTS: u16 = 11;

impl Layout {
    pub(super) fn predict(&mut self, body: Rect, _shape: Shape) {
        let is_roomy = body.height >= 32;
        let gap = u16::from(is_roomy);
        let above = self.put_timeline(body, if is_roomy { 6 } else { 2 });
        let above = rows(above, above.height.saturating_sub(gap)).0;
        let strip = if is_roomy {
            above.height - PLOTS - gap
        } else {
            above.height * 2 / 3
        };
        let (strip, plots) = rows(above, strip);
        let plots = rows(plots, gap).1;
        self.put(Pane::Strip, strip);
        if plots.width < 60 {
            let (quality, spread) = columns(plots, plots.width / 2, 2);
            self.put(Pane::Quality, quality);
            self.put(Pane::Spread, spread);
            return;
        }
        // The one in the middle has the most to say.
        let third = (plots.width - 4) / 3;
        let (quality, rest) = columns(plots, third - 4, 2);
        let (spread, samples) = columns(rest, third + 5, 2);
        self.put(Pane::Quality, quality);
        self.put(Pane::Spread, spread);
        self.put(Pane::Samples, samples);
    }
}
