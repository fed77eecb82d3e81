//! Rows of frames over the episode: truth, belief, prediction and error of every k-th step, k printed.
//!
//! ```text
//! every 2nd       1     3     5     7  ◆  9
//! truth         ▀▀▀▀▀ ▀▀▀▀▀ ▀▀▀▀▀│▀▀▀▀▀ ▀▀▀▀▀
//! belief              ▀▀▀▀▀ ▀▀▀▀▀│▀▀▀▀▀ ▀▀▀▀▀
//! prediction    context          │▀▀▀▀▀ ▀▀▀▀▀
//! error ±0.50         ▀▀▀▀▀ ▀▀▀▀▀│▀▀▀▀▀ ▀▀▀▀▀
//! ```
//! The bar stands where the rollout begins; the cursor's step is reversed, or a diamond between two that are shown.
//! Where four rows have no room, belief and prediction share one: the belief before the bar, the prediction after it.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};

use super::face::Face;
use super::image::Raster;
use super::paint::{put, text, width};
use super::predict::edited;
use super::theme::{PREDICTION, dim, strong};
use super::view::{Pane, View};
use super::words;
use crate::measure::frame::ERROR_RANGE;
use crate::session::snapshot::{SignedFrame, Snapshot, StripCell};

/// Columns of the labels.
const LABELS: u16 = 12;
/// The smallest side of a frame that still shows something, in columns.
const SMALLEST: u16 = 10;

/// One row of the strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Row {
    Truth,
    Belief,
    Prediction,
    /// The belief up to the start, the prediction after it.
    Model,
    Error,
}

const THREE: &[Row] = &[Row::Truth, Row::Belief, Row::Prediction];
const FOUR: &[Row] = &[Row::Truth, Row::Belief, Row::Prediction, Row::Error];
const SHARED: &[Row] = &[Row::Truth, Row::Model, Row::Error];

/// Where the frames stand.
#[derive(Clone, Copy, Debug)]
struct Grid {
    rows: &'static [Row],
    /// Side of a frame in columns.
    side: u16,
    /// Rows from one frame to the one below.
    pitch: u16,
    /// The first step, and the one after the last.
    from: usize,
    until: usize,
    /// k.
    every: usize,
}

impl Grid {
    fn of(pane: (u16, u16), (from, until): (usize, usize), rows: &'static [Row], gap: u16) -> Self {
        let (width, height) = pane;
        let steps = until.saturating_sub(from);
        let count = rows.len() as u16;
        let tallest = height.saturating_sub(1 + gap * (count - 1)) / count * 2;
        let room = usize::from(width.saturating_sub(LABELS));
        let all_at_once = (room / steps.max(1)).saturating_sub(1) as u16;
        let side = if all_at_once >= SMALLEST {
            all_at_once.min(tallest)
        } else {
            tallest
        };
        let every = (steps * usize::from(side + 1)).div_ceil(room.max(1));
        Self {
            rows,
            side,
            pitch: side.div_ceil(2) + gap,
            from,
            until,
            every: every.max(1),
        }
    }

    /// The predict view's: four rows if they can be read, else three.
    fn with_error(pane: (u16, u16), steps: (usize, usize)) -> Self {
        let four = Self::of(pane, steps, FOUR, 0);
        if four.side >= SMALLEST {
            four
        } else {
            Self::of(pane, steps, SHARED, 0)
        }
    }
}

/// Rows that are of use out of so many, without the error.
pub fn rows(width: u16, height: u16, steps: usize) -> u16 {
    let grid = Grid::of((width, height), (0, steps), THREE, 1);
    if grid.side == 0 { 0 } else { grid.pitch * 3 }
}

/// The steps of the rollout, and half as many before it.
fn rollout(snapshot: &Snapshot) -> (usize, usize) {
    let from = snapshot.start.saturating_sub(snapshot.horizon / 2);
    let until = (snapshot.start + snapshot.horizon + 1).min(snapshot.steps());
    (from.min(until), until)
}

/// Draws truth, belief and prediction; in the predict view the error, too.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    if face.view == View::Predict {
        with_error(buf, pane, snapshot, face);
        return;
    }
    let grid = Grid::of((pane.width, pane.height), (0, snapshot.steps()), THREE, 1);
    grid.draw(buf, pane, snapshot, face, false);
}

/// Draws the same with the error; where controls are edited, the last row says how.
fn with_error(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Strip);
    let said = u16::from(snapshot.control_edit.is_some() && pane.height > 4);
    let frames = Rect {
        height: pane.height - said,
        ..pane
    };
    let grid = Grid::with_error((frames.width, frames.height), rollout(snapshot));
    grid.draw(buf, frames, snapshot, face, focused);
    if let Some(edit) = snapshot.control_edit.as_ref().filter(|_| said > 0) {
        let row = (1 + grid.pitch * grid.rows.len() as u16).min(frames.height);
        text(
            buf,
            pane,
            0,
            row,
            &edited::words(edit, pane.width),
            strong(),
        );
    }
}

impl Grid {
    fn draw(self, buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face, focused: bool) {
        if self.from >= self.until || self.side == 0 || pane.width <= LABELS {
            return;
        }
        let mark = if focused { "▸ " } else { "" };
        let at = text(buf, pane, 0, 0, mark, strong());
        text(buf, pane, at, 0, &every_text(self.every), dim());
        for (i, row) in self.rows.iter().enumerate() {
            let predicted = words::prediction(snapshot).0;
            let at = 1 + i as u16 * self.pitch;
            row.label(buf, pane, (at, self.pitch), predicted, face);
        }
        for (place, step) in (self.from..self.until).step_by(self.every).enumerate() {
            let at = LABELS + place as u16 * (self.side + 1);
            self.heading(buf, pane, at, step, snapshot);
            if step <= snapshot.start && step + self.every > snapshot.start {
                for row in 1..=(self.pitch * self.rows.len() as u16) {
                    put(buf, pane, at + self.side, row, '│', strong());
                }
            }
            let Some(cell) = snapshot.strip.get(step) else {
                continue;
            };
            for (i, row) in self.rows.iter().enumerate() {
                let image = Rect {
                    x: pane.x + at,
                    y: pane.y + 1 + i as u16 * self.pitch,
                    width: self.side,
                    height: self.side.div_ceil(2),
                };
                if let Some(raster) = row.image(cell, snapshot.start) {
                    raster.draw(buf, image.intersection(pane), face.depth);
                }
            }
        }
        if let Some(i) = self.rows.iter().position(|&row| row == Row::Prediction) {
            text(
                buf,
                pane,
                LABELS,
                1 + i as u16 * self.pitch,
                "context",
                dim(),
            );
        }
    }

    /// The step's number, counted from 1; the one under the cursor reversed, and a diamond where it is not shown.
    fn heading(self, buf: &mut Buffer, pane: Rect, at: u16, step: usize, snapshot: &Snapshot) {
        let number = format!(" {} ", step + 1);
        let style = if step == snapshot.cursor {
            Style::new().add_modifier(Modifier::REVERSED)
        } else {
            dim()
        };
        let indent = self.side.saturating_sub(width(&number)) / 2;
        text(buf, pane, at + indent, 0, &number, style);
        let beyond = snapshot.cursor.saturating_sub(step);
        if beyond > 0 && beyond < self.every {
            let first = at + indent + width(&number);
            let next = at + self.side + 1 + indent;
            let room = usize::from(next.saturating_sub(first + 1));
            let column = first + ((beyond - 1) * room / (self.every - 1)) as u16;
            put(buf, pane, column, 0, '◆', strong());
        }
    }
}

impl Row {
    /// At a row of the pane, of which it has so many.
    fn label(self, buf: &mut Buffer, pane: Rect, at: (u16, u16), predicted: &str, face: &Face) {
        let (row, rows) = at;
        let prediction = strong().patch(face.depth.ink(PREDICTION));
        let range = format!("±{ERROR_RANGE:.2}");
        let (name, style, below) = match self {
            Self::Truth => ("truth", strong(), ""),
            Self::Belief => ("belief", strong(), ""),
            Self::Prediction => (predicted, prediction, ""),
            Self::Model => ("belief│", strong(), predicted),
            Self::Error => ("error", strong(), range.as_str()),
        };
        text(buf, pane, 0, row, name, style);
        if rows >= 2 && !below.is_empty() {
            let style = if self == Self::Model {
                prediction
            } else {
                dim()
            };
            text(buf, pane, 0, row + 1, below, style);
        }
    }

    fn image(self, cell: &StripCell, start: usize) -> Option<Raster> {
        let model = if cell.step <= start {
            &cell.belief
        } else {
            &cell.prediction
        };
        let frame = match self {
            Self::Truth => Some(&cell.truth),
            Self::Belief => cell.belief.as_ref(),
            Self::Prediction => cell.prediction.as_ref(),
            Self::Model => model.as_ref(),
            Self::Error => {
                let difference = SignedFrame::between(model.as_ref()?, &cell.truth)?;
                return Some(Raster::from(&difference));
            }
        };
        frame.map(|frame| Raster::from(&**frame))
    }
}

fn every_text(every: usize) -> String {
    match every {
        1 => "every step".to_owned(),
        2 => "every 2nd".to_owned(),
        3 => "every 3rd".to_owned(),
        _ => format!("every {every}th"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_low_pane_lets_belief_and_prediction_share_a_row() {
        assert_eq!(Grid::with_error((118, 25), (0, 16)).rows, FOUR);
        let low = Grid::with_error((78, 13), (0, 16));
        assert_eq!((low.rows, low.side, low.every), (SHARED, 8, 3));
    }
}
