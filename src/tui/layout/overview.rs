//! A little of everything.
//!
//! ```text
//! 80×24                              120×40                             200×60
//! status                             status                             status
//! frames frames frames frames        frames frames frames frames        frames ×4            position
//! experts            position        experts    latents    position     strip strip strip strip strip
//! dims                               dims                               experts   timeline   latents
//! timeline                           timeline                           dims
//! message                            message                            message
//! ```

use ratatui::layout::Rect;

use super::{LEFT, Layout, Shape, columns, experts_rows, rows};
use crate::tui::axis::{LABELS, VALUES};
use crate::tui::strip;
use crate::tui::view::Pane;

/// Images in the frame row.
const IMAGES: u16 = 4;
/// Rows of the timeline: header, track, force, two of shares.
const TIMELINE_ROWS: u16 = 5;
/// Rows of the smallest stacks of shares per latent dimension.
const SHARE_ROWS: u16 = 2;

impl Layout {
    pub(super) fn overview(&mut self, body: Rect, screen: Rect, shape: Shape) {
        if screen.width >= 170 && screen.height >= 50 {
            self.wide(body, shape);
        } else {
            self.stacked(body, shape);
        }
    }

    fn stacked(&mut self, body: Rect, shape: Shape) {
        let roomy = body.width >= 108 && body.height >= 32;
        let least = experts_rows(shape.experts) + TIMELINE_ROWS;
        let lower_rows = if body.height >= least + SHARE_ROWS + 6 {
            least + SHARE_ROWS
        } else {
            least
        };
        let widest = image_columns(body.width).div_ceil(2) + 1;
        let spare = body.height.saturating_sub(lower_rows);
        let frame_rows = if spare >= 5 { spare.min(widest) } else { 0 };
        let (frames, lower) = rows(body, frame_rows);
        self.put(Pane::Frames, frames);
        let lower = if roomy { rows(lower, 1).1 } else { lower };

        if body.width < 68 {
            self.column(lower, shape, false);
            return;
        }
        let left_columns = if roomy { 54 } else { LEFT };
        let (left, right) = columns(lower, left_columns, 2);
        let (latents, position) = if roomy {
            columns(right, 24, 2)
        } else {
            (Rect::default(), right)
        };
        if shape.steps > usize::from(left_columns - LABELS - VALUES) {
            // An episode that needs the whole width: one column a step, rather than a coarser axis.
            let timeline = (lower.height / 3).clamp(TIMELINE_ROWS, 11);
            let (_, timeline) = rows(lower, lower.height - timeline);
            self.put(Pane::Timeline, timeline);
            let cut = |pane: Rect| Rect {
                height: pane.height.saturating_sub(timeline.height),
                ..pane
            };
            self.put(Pane::Position, cut(position));
            self.put(Pane::Latents, cut(latents));
            let (experts, dims) = rows(cut(left), experts_rows(shape.experts));
            self.put(Pane::Experts, experts);
            self.put(Pane::Dims, dims);
        } else {
            self.put(Pane::Position, position);
            self.put(Pane::Latents, latents);
            self.column(left, shape, roomy);
        }
    }

    /// Experts, shares per dimension and timeline below one another.
    fn column(&mut self, pane: Rect, shape: Shape, spaced: bool) {
        let gap = u16::from(spaced);
        // The steps come first: a model of many experts on a small screen shows only some of them.
        let most = pane.height.saturating_sub(2);
        let (experts, rest) = rows(pane, experts_rows(shape.experts).min(most));
        self.put(Pane::Experts, experts);
        let spare = rest
            .height
            .saturating_sub(TIMELINE_ROWS + SHARE_ROWS + 2 * gap);
        if rest.height < TIMELINE_ROWS + SHARE_ROWS + gap {
            self.put(Pane::Timeline, rest);
            return;
        }
        let (dims, rest) = rows(rows(rest, gap).1, SHARE_ROWS + (spare / 3).min(6));
        self.put(Pane::Dims, dims);
        self.put(Pane::Timeline, rows(rest, gap).1);
    }

    fn wide(&mut self, body: Rect, shape: Shape) {
        // 2×2 pixels of a 64×64 frame to one of the screen.
        const SIDE: u16 = 32;
        let (upper, rest) = rows(body, SIDE / 2 + 1);
        let frame_columns = IMAGES * SIDE + (IMAGES - 1) * 2;
        let (frames, position) = columns(upper, frame_columns, 3);
        self.put(Pane::Frames, frames);
        self.put(Pane::Position, position);
        let rest = rows(rest, 1).1;
        let strip_rows = strip::rows(rest.width, rest.height.saturating_sub(20), shape.steps);
        let (strip, rest) = rows(rest, strip_rows);
        self.put(Pane::Strip, strip);
        let lower = rows(rest, 1).1;
        let (left, rest) = columns(lower, 60, 3);
        let (middle, right) = columns(rest, rest.width.saturating_sub(53), 3);
        self.put(Pane::Latents, right);
        self.put(Pane::Timeline, middle);
        let (upper, lower) = rows(left, experts_rows(shape.experts));
        self.put(Pane::Experts, upper);
        self.put(Pane::Dims, rows(rows(lower, 1).1, 10).0);
    }
}

/// Side in columns of one of the four images of a row with gaps of at least one column.
fn image_columns(width: u16) -> u16 {
    width.saturating_sub(IMAGES - 1) / IMAGES
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_terminal_shows_all_but_latents_and_strip() {
        let shape = Shape {
            steps: 16,
            experts: 4,
            ..Shape::default()
        };
        let layout = Layout::of(Rect::new(0, 0, 80, 24), shape);
        assert_eq!(layout.get(Pane::Frames), Rect::new(1, 1, 78, 10));
        assert_eq!(layout.get(Pane::Timeline).height, TIMELINE_ROWS);
        assert!(!layout.get(Pane::Position).is_empty() && !layout.get(Pane::Dims).is_empty());
        assert!(layout.get(Pane::Latents).is_empty() && layout.get(Pane::Strip).is_empty());
    }
}
