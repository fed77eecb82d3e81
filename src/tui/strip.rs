//! Rows of frames over the episode: truth, belief and prediction of every k-th step, k printed.
//!
//! ```text
//! every 2nd       1     3     5  │  7     9
//! truth         ▀▀▀▀▀ ▀▀▀▀▀ ▀▀▀▀▀│▀▀▀▀▀ ▀▀▀▀▀
//! belief              ▀▀▀▀▀ ▀▀▀▀▀│▀▀▀▀▀ ▀▀▀▀▀
//! prediction       context       │▀▀▀▀▀ ▀▀▀▀▀
//! ```
//! The bar stands where the rollout begins.

use std::sync::Arc;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::face::Face;
use super::image::Raster;
use super::paint::{put, text, width};
use super::theme::{PREDICTION, dim, strong};
use crate::episode::Frame;
use crate::session::snapshot::{Snapshot, StripCell};

/// Columns of the labels.
const LABELS: u16 = 11;
/// The smallest side of a frame that still shows something, in columns.
const SMALLEST: u16 = 10;

/// Side of a frame in columns, and k, for so many columns and rows of screen.
fn sizes(width: u16, height: u16, steps: usize) -> (u16, usize) {
    let tallest = height.saturating_sub(3) / 3 * 2;
    let room = usize::from(width.saturating_sub(LABELS));
    let all_at_once = (room / steps.max(1)).saturating_sub(1) as u16;
    let side = if all_at_once >= SMALLEST {
        all_at_once.min(tallest)
    } else {
        tallest
    };
    let every = (steps * usize::from(side + 1)).div_ceil(room.max(1));
    (side, every.max(1))
}

/// Rows that are of use out of so many.
pub fn rows(width: u16, height: u16, steps: usize) -> u16 {
    let (side, _) = sizes(width, height, steps);
    if side == 0 {
        0
    } else {
        3 + 3 * side.div_ceil(2)
    }
}

/// Draws the rows.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let steps = snapshot
        .episode
        .as_ref()
        .map_or(0, |episode| episode.secs.len());
    let (side, every) = sizes(pane.width, pane.height, steps);
    if steps == 0 || side == 0 || pane.width <= LABELS {
        return;
    }
    let image_rows = side.div_ceil(2);
    // A blank row between truth, belief and prediction.
    let pitch = image_rows + 1;

    text(buf, pane, 0, 0, &every_text(every), dim());
    let prediction = strong().patch(face.depth.ink(PREDICTION));
    let names = [
        ("truth", strong()),
        ("belief", strong()),
        ("prediction", prediction),
    ];
    for (i, (name, style)) in names.into_iter().enumerate() {
        text(buf, pane, 0, 1 + i as u16 * pitch, name, style);
    }

    for (place, step) in (0..steps).step_by(every).enumerate() {
        let at = LABELS + place as u16 * (side + 1);
        heading(buf, pane, at, side, step, snapshot);
        if step <= snapshot.start && step + every > snapshot.start {
            for row in 0..3 * pitch {
                put(buf, pane, at + side, row, '│', strong());
            }
        }
        if let Some(cell) = snapshot.strip.iter().find(|cell| cell.step == step) {
            for (i, frame) in images(cell).into_iter().enumerate() {
                let Some(frame) = frame else { continue };
                let cell_pane = Rect {
                    x: pane.x + at,
                    y: pane.y + 1 + i as u16 * pitch,
                    width: side,
                    height: image_rows,
                };
                Raster::from(&**frame).draw(buf, cell_pane.intersection(pane), face.depth);
            }
        }
    }
    text(buf, pane, LABELS, 1 + 2 * pitch, "context", dim());
}

fn images(cell: &StripCell) -> [Option<&Arc<Frame>>; 3] {
    [
        Some(&cell.truth),
        cell.belief.as_ref(),
        cell.prediction.as_ref(),
    ]
}

/// The step's number, counted from 1; the one under the cursor reversed.
fn heading(buf: &mut Buffer, pane: Rect, at: u16, side: u16, step: usize, snapshot: &Snapshot) {
    let number = format!(" {} ", step + 1);
    let style = if step == snapshot.cursor {
        Style::new().add_modifier(Modifier::REVERSED)
    } else {
        dim()
    };
    let indent = side.saturating_sub(width(&number)) / 2;
    text(buf, pane, at + indent, 0, &number, style);
}

fn every_text(every: usize) -> String {
    match every {
        1 => "every step".to_owned(),
        2 => "every 2nd".to_owned(),
        3 => "every 3rd".to_owned(),
        _ => format!("every {every}th"),
    }
}
