//! The raw numbers: mean and standard deviation of every expert in every latent dimension, the belief's beside them.
//!
//! ```text
//!          belief       V vision     H haptic     D prior
//! dim        μ    σ      μ    σ       μ    σ       μ    σ
//!   0     0.12 0.21  -0.30 0.40    0.22 0.31    0.10 0.80
//!   5 ·   …                                                  inactive
//! ```
//! The expert in focus is underlined; one that is off, and a dimension that never moves, are dim.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use crate::session::snapshot::{LatentView, Snapshot};
use crate::tui::face::Face;
use crate::tui::paint::{put, right, short, text};
use crate::tui::theme::{dim, strong};

/// Columns of the dimension's number, and of one Gaussian.
const DIM: u16 = 5;
const GAUSSIAN: u16 = 13;

/// One Gaussian with its heading.
struct Column<'a> {
    name: String,
    latent: Option<&'a LatentView>,
    heading: Style,
    style: Style,
}

/// Columns of the table for so many experts.
pub fn width_of(experts: usize) -> u16 {
    DIM + GAUSSIAN * (1 + experts.min(15) as u16)
}

/// Draws the table: two rows of headings, then a row a dimension.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let Some(belief) = &snapshot.belief else {
        return;
    };
    let active = snapshot.fusion.as_ref().map(|fusion| &fusion.active);
    let mut columns = vec![Column {
        name: "belief".to_owned(),
        latent: Some(belief),
        heading: strong(),
        style: Style::new(),
    }];
    for (i, view) in snapshot.experts.iter().enumerate() {
        let ink = strong().patch(face.depth.ink(view.expert.rgb()));
        let heading = if i == face.expert {
            ink.underlined()
        } else {
            ink
        };
        columns.push(Column {
            name: format!("{} {}", view.expert.letter(), view.expert.name()),
            latent: view.latent.as_ref(),
            heading,
            style: if view.alpha > 0.0 {
                Style::new()
            } else {
                dim()
            },
        });
    }
    text(buf, pane, 0, 1, "dim", dim());
    for (i, column) in columns.iter().enumerate() {
        let end = DIM + GAUSSIAN * (i as u16 + 1);
        right(buf, pane, end, 0, &column.name, column.heading);
        right(buf, pane, end - 5, 1, "μ", dim());
        right(buf, pane, end, 1, "σ", dim());
    }
    for d in 0..belief.mean.len() {
        let row = 2 + d as u16;
        let moves = active.is_none_or(|active| active.get(d).copied().unwrap_or(true));
        right(buf, pane, 3, row, &d.to_string(), dim());
        if !moves {
            put(buf, pane, 4, row, '·', dim());
        }
        for (i, column) in columns.iter().enumerate() {
            let end = DIM + GAUSSIAN * (i as u16 + 1);
            let style = if moves { column.style } else { dim() };
            if let Some((mean, sigma)) = column.latent.and_then(|l| super::interval(l, d)) {
                right(buf, pane, end - 5, row, &short(mean), style);
                right(buf, pane, end, row, &short(sigma), style);
            }
        }
    }
    let last = belief.mean.len() as u16 + 2;
    if last < pane.height && active.is_some() {
        text(buf, pane, 0, last, "· does not move over the data", dim());
    }
}
