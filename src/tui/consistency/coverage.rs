//! Claimed against held: how often the truth lies within the ellipse that should hold it (D12).
//!
//! ```text
//! coverage ─────────────── held % of claimed %
//! 100│            ⢀⠔
//!  50│     ⢀⠔⠁  ●  │◆
//!   0│⢀⠔⠁ ●
//!    └0     50    100
//! ● filtered  ◆ predicted  ┈ honest  whiskers 95 %
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::braille::Stroke;
use super::super::face::Face;
use super::super::paint::{below_title, text, title};
use super::super::plot::Plot;
use super::super::scale::Scale;
use super::super::theme::{PREDICTION, dim, strong};
use super::super::view::Pane;
use super::super::words::{Entry, legend_below};
use super::board;
use crate::measure::calibration::{Calibration, CoveragePoint};
use crate::session::snapshot::Snapshot;

/// Every so many points have whiskers and a mark, so that both curves can be read.
const EVERY: usize = 4;

/// Draws the curves.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Coverage);
    let Ok(board) = board(snapshot) else { return };
    if pane.is_empty() {
        return;
    }
    title(buf, pane, "coverage", "held % of claimed %", focused);
    let inner = below_title(pane);
    if board.filtered.is_none() && board.predicted.is_none() {
        text(buf, inner, 0, 0, "no probe, or too few episodes", dim());
        return;
    }
    let ink = face.depth.ink(PREDICTION);
    let entries: [Entry; 4] = [
        ("─●", Style::new(), "filtered"),
        ("┈◆", ink, "predicted"),
        ("│", dim(), "95 %"),
        ("··", dim(), "honest"),
    ];
    let plot_pane = legend_below(buf, inner, &entries);

    let percent = Scale::linear(0.0, 100.0);
    let Some(mut plot) = Plot::new(plot_pane, percent, percent) else {
        return;
    };
    plot.line(&[(0.0, 0.0), (100.0, 100.0)], Stroke::Sparse, dim());
    let drawn = [
        (&board.predicted, Stroke::Dotted, ink, '◆', 1),
        (
            &board.filtered,
            Stroke::Solid,
            Style::new(),
            '●',
            EVERY / 2 + 1,
        ),
    ];
    for (calibration, stroke, style, _, offset) in &drawn {
        let points = points(calibration.as_ref());
        let line: Vec<(f32, f32)> = points.iter().map(|point| at(point, point.held)).collect();
        plot.line(&line, *stroke, *style);
        for point in points.iter().skip(*offset).step_by(EVERY) {
            plot.line(
                &[at(point, point.low), at(point, point.high)],
                Stroke::Solid,
                *style,
            );
        }
    }
    for (calibration, _, style, mark, offset) in drawn {
        for point in points(calibration.as_ref())
            .iter()
            .skip(offset)
            .step_by(EVERY)
        {
            plot.mark(at(point, point.held), mark, strong().patch(style));
        }
    }
    let label = |value: u8| (f32::from(value), value.to_string());
    plot.draw(buf, &[0, 25, 50, 75, 100].map(label));
}

fn points(calibration: Option<&Calibration>) -> &[CoveragePoint] {
    calibration.map_or(&[], |calibration| &calibration.coverage)
}

fn at(point: &CoveragePoint, held: f64) -> (f32, f32) {
    ((point.claimed * 100.0) as f32, (held * 100.0) as f32)
}
