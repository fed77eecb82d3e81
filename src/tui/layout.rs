//! Which pane stands where: arithmetic on the size of the screen, nothing else.
//!
//! ```text
//! 80×24                              120×40                             200×60
//! status                             status                             status
//! frames frames frames frames        frames frames frames frames        frames ×4            position
//! experts            position        experts    latents    position     strip strip strip strip strip
//! shares                             shares                             experts   timeline   latents
//! timeline                           timeline                           shares
//! message                            message                            message
//! ```

use ratatui::layout::Rect;

use super::axis::{LABELS, VALUES};
use super::face::Focus;
use super::strip;

/// The smallest screen that is drawn at all.
pub const SMALLEST: (u16, u16) = (40, 12);

/// Columns of the left half of a small screen.
pub const LEFT: u16 = 47;
/// Images in the frame row.
const IMAGES: u16 = 4;
/// Rows of the smallest timeline: header, track, force, two of shares.
const TIMELINE_ROWS: u16 = 5;
/// Rows of the smallest stacks of shares per latent dimension.
const SHARE_ROWS: u16 = 2;

/// Where each pane is; one that is not shown is empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Panes {
    /// Dataset, model, episode.
    pub status: Rect,
    /// Truth, belief, prediction, error.
    pub frames: Rect,
    /// Frames of every k-th step.
    pub strip: Rect,
    /// One line an expert.
    pub experts: Rect,
    /// Shares per latent dimension.
    pub shares: Rect,
    /// Means and deviations.
    pub latents: Rect,
    /// The table.
    pub position: Rect,
    /// Steps, force, shares over time.
    pub timeline: Rect,
    /// Message, prompt or key hints.
    pub message: Rect,
}

impl Panes {
    /// Lays out a screen of at least [`SMALLEST`] for an episode of `steps` and a model of `experts`.
    pub fn of(screen: Rect, steps: usize, experts: usize, zoom: Option<Focus>) -> Self {
        let margin = u16::from(screen.width >= 60);
        let inner = Rect {
            x: screen.x + margin,
            width: screen.width - 2 * margin,
            ..screen
        };
        let (status, rest) = rows(inner, 1);
        let (body, message) = rows(rest, rest.height - 1);
        let mut panes = Self {
            status,
            message,
            ..Self::default()
        };
        match zoom {
            Some(pane) => panes.zoom(body, pane, experts),
            None if screen.width >= 170 && screen.height >= 50 => panes.wide(body, steps, experts),
            None => panes.stacked(body, steps, experts),
        }
        panes
    }

    fn zoom(&mut self, body: Rect, pane: Focus, experts: usize) {
        match pane {
            Focus::Frames => self.frames = body,
            Focus::Latents => self.latents = body,
            Focus::Position => self.position = body,
            Focus::Timeline => self.timeline = body,
            Focus::Experts => {
                let (upper, lower) = rows(body, experts_rows(experts));
                self.experts = upper;
                self.shares = rows(lower, 1).1;
            }
        }
    }

    fn stacked(&mut self, body: Rect, steps: usize, experts: usize) {
        let roomy = body.width >= 108 && body.height >= 32;
        let least = experts_rows(experts) + TIMELINE_ROWS;
        let lower_rows = if body.height >= least + SHARE_ROWS + 6 {
            least + SHARE_ROWS
        } else {
            least
        };
        let widest = image_columns(body.width).div_ceil(2) + 1;
        let spare = body.height.saturating_sub(lower_rows);
        let frame_rows = if spare >= 5 { spare.min(widest) } else { 0 };
        let (frames, lower) = rows(body, frame_rows);
        self.frames = frames;
        let lower = if roomy { rows(lower, 1).1 } else { lower };

        if body.width < 68 {
            self.column(lower, experts, false);
            return;
        }
        let left_columns = if roomy { 54 } else { LEFT };
        let (left, right) = columns(lower, left_columns, 2);
        let long = steps > usize::from(left_columns - LABELS - VALUES);
        if roomy {
            (self.latents, self.position) = columns(right, 24, 2);
        } else {
            self.position = right;
        }
        if long {
            // An episode that needs the whole width: one column a step, rather than a coarser axis.
            let timeline = (lower.height / 3).clamp(TIMELINE_ROWS, 11);
            let (_, timeline) = rows(lower, lower.height - timeline);
            self.timeline = timeline;
            let cut = |pane: Rect| Rect {
                height: pane.height.saturating_sub(timeline.height),
                ..pane
            };
            self.position = cut(self.position);
            self.latents = cut(self.latents);
            (self.experts, self.shares) = rows(cut(left), experts_rows(experts));
        } else {
            self.column(left, experts, roomy);
        }
    }

    /// Experts, shares per dimension and timeline below one another.
    fn column(&mut self, pane: Rect, experts: usize, spaced: bool) {
        let gap = u16::from(spaced);
        let (upper, rest) = rows(pane, experts_rows(experts));
        self.experts = upper;
        let rest = rows(rest, gap).1;
        let spare = rest.height.saturating_sub(TIMELINE_ROWS + SHARE_ROWS + gap);
        if rest.height < TIMELINE_ROWS + SHARE_ROWS {
            self.timeline = rest;
            return;
        }
        let (shares, rest) = rows(rest, SHARE_ROWS + (spare / 3).min(6));
        self.shares = shares;
        self.timeline = rows(rest, gap).1;
    }

    fn wide(&mut self, body: Rect, steps: usize, experts: usize) {
        // 2×2 pixels of a 64×64 frame to one of the screen.
        const SIDE: u16 = 32;
        let (upper, rest) = rows(body, SIDE / 2 + 1);
        let frame_columns = IMAGES * SIDE + (IMAGES - 1) * 2;
        (self.frames, self.position) = columns(upper, frame_columns, 3);
        let rest = rows(rest, 1).1;
        let strip_rows = strip::rows(rest.width, rest.height.saturating_sub(20), steps);
        let (strip, rest) = rows(rest, strip_rows);
        self.strip = strip;
        let lower = rows(rest, 1).1;
        let (left, rest) = columns(lower, 60, 3);
        let (middle, right) = columns(rest, rest.width.saturating_sub(53), 3);
        self.latents = right;
        self.timeline = middle;
        let (upper, lower) = rows(left, experts_rows(experts));
        self.experts = upper;
        (self.shares, _) = rows(rows(lower, 1).1, 10);
    }
}

/// Side in columns of one of the four images of a row with gaps of at least one column.
fn image_columns(width: u16) -> u16 {
    width.saturating_sub(IMAGES - 1) / IMAGES
}

fn experts_rows(experts: usize) -> u16 {
    1 + experts.clamp(1, 8) as u16
}

/// The upper so many rows, and the rest.
pub fn rows(pane: Rect, upper: u16) -> (Rect, Rect) {
    let upper = upper.min(pane.height);
    let first = Rect {
        height: upper,
        ..pane
    };
    let rest = Rect {
        y: pane.y + upper,
        height: pane.height - upper,
        ..pane
    };
    (first, rest)
}

/// The left so many columns, a gap, and the rest.
pub fn columns(pane: Rect, left: u16, gap: u16) -> (Rect, Rect) {
    let left = left.min(pane.width);
    let from = (left + gap).min(pane.width);
    let first = Rect {
        width: left,
        ..pane
    };
    let rest = Rect {
        x: pane.x + from,
        width: pane.width - from,
        ..pane
    };
    (first, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(panes: &Panes) -> Vec<Rect> {
        let shown = [
            panes.status,
            panes.frames,
            panes.strip,
            panes.experts,
            panes.shares,
            panes.latents,
            panes.position,
            panes.timeline,
            panes.message,
        ];
        shown.into_iter().filter(|pane| !pane.is_empty()).collect()
    }

    #[test]
    fn panes_never_overlap_nor_leave_the_screen() {
        for width in SMALLEST.0..=210 {
            for height in SMALLEST.1..=70 {
                for steps in [0, 16, 48, 500] {
                    let screen = Rect::new(0, 0, width, height);
                    let panes = all(&Panes::of(screen, steps, 4, None));
                    for (i, pane) in panes.iter().enumerate() {
                        assert_eq!(pane.intersection(screen), *pane, "{width}x{height}");
                        let after = &panes[i + 1..];
                        assert!(
                            after.iter().all(|other| !pane.intersects(*other)),
                            "{width}x{height}, {steps} steps: {panes:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_small_terminal_shows_all_but_latents_and_strip() {
        let panes = Panes::of(Rect::new(0, 0, 80, 24), 16, 4, None);
        assert_eq!(panes.frames, Rect::new(1, 1, 78, 10));
        assert_eq!(panes.timeline.height, TIMELINE_ROWS);
        assert!(!panes.position.is_empty() && !panes.shares.is_empty());
        assert!(panes.latents.is_empty() && panes.strip.is_empty());
    }
}
