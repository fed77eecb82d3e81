//! What the belief at the cursor is made of.
//!
//! ```text
//! 80×24                              120×40
//! status                             status
//! experts experts experts experts    experts experts experts experts
//! pairs             dims             pairs       dims        KL
//! timeline                           timeline
//! series                             series
//! message                            message
//! ```
//! Timeline and series share their axis, so that what is read at a step stands below its contact force.

use ratatui::layout::Rect;

use super::{Layout, Shape, columns, experts_rows, rows};
use crate::tui::fuse::{response, series};
use crate::tui::view::Pane;

/// Rows of the pairs: who, three of distances, the conflict and what it means; and the most that are of use.
const PAIRS_ROWS: u16 = 6;
const MOST: u16 = 13;
/// Columns of the pairs, of sixteen stacks of two columns, and of KL terms with bars worth a look.
const PAIRS: u16 = 38;
const DIMS: u16 = 39;
const DIVERGENCE: u16 = 36;
/// Rows of the latents that are worth a pane, with the blank one above them.
const LATENTS: u16 = 14;

/// Rows of the KL terms of three sensors, with their title.
const KL_ROWS: u16 = 8;

impl Layout {
    pub(super) fn fuse(&mut self, body: Rect, shape: Shape) {
        let roomy = u16::from(body.height >= 32);
        let notes = u16::from(body.height >= 20 && body.width >= 60) + roomy;
        let most = body.height.saturating_sub(2);
        let (experts, rest) = rows(body, (experts_rows(shape.experts) + notes).min(most));
        self.put(Pane::Experts, experts);
        let rest = rows(rest, roomy).1;

        if !shape.product {
            // Nothing to take apart: why, in the place of all readings.
            let above = self.put_timeline(rest, (rest.height / 3).min(3));
            self.put(Pane::Pairs, above);
            return;
        }
        let timeline = if rest.height >= 6 { 3 } else { 2 };
        let room = rest.height.saturating_sub(timeline + roomy);
        let least = series::rows(shape.experts) + PAIRS_ROWS;
        let middle = match room.checked_sub(least) {
            // Damage has something to say below the KL terms.
            Some(spare) if body.width >= 70 && shape.damaged && spare > PAIRS_ROWS => {
                (PAIRS_ROWS + spare * 3 / 5).clamp(KL_ROWS + response::ROWS, MOST + 1)
            }
            Some(spare) if body.width >= 70 => (PAIRS_ROWS + spare * 3 / 5).min(MOST),
            _ => 0,
        };
        let (middle, below) = rows(rest, middle);
        self.middle(middle, shape);
        let below = if middle.is_empty() {
            below
        } else {
            rows(below, roomy).1
        };
        let (timeline, rest) = rows(below, timeline);
        self.put(Pane::Timeline, timeline);
        // A tall screen has room for the latents too, once the curves are as high as makes a calm picture.
        let high = 3 * series::rows(shape.experts) - 3;
        let series = if rest.height >= high + LATENTS {
            high
        } else {
            rest.height
        };
        let (series, latents) = rows(rest, series);
        self.put(Pane::Series, series);
        self.put(Pane::Latents, rows(latents, 1).1);
    }

    fn middle(&mut self, pane: Rect, shape: Shape) {
        let gap = if pane.width > PAIRS + DIMS + 1 { 2 } else { 1 };
        let (pairs, rest) = columns(pane, PAIRS, gap);
        self.put(Pane::Pairs, pairs);
        match rest.width.checked_sub(DIMS + 3 + DIVERGENCE) {
            Some(spare) => {
                let (dims, divergence) = columns(rest, DIMS + spare / 2, 3);
                self.put(Pane::Dims, dims);
                let least = KL_ROWS + response::ROWS;
                let split = shape.damaged && divergence.height >= least;
                let below = if split { response::ROWS } else { 0 };
                let (divergence, response) = rows(divergence, divergence.height - below);
                self.put(Pane::Divergence, divergence);
                self.put(Pane::Response, response);
            }
            None => self.put(Pane::Dims, rest),
        }
    }
}
