//! NEES at each horizon, against the band in which the mean of so many episodes lies (D11).
//!
//! ```text
//! NEES by horizon ──────── 2 is honest
//! 10│        ○ ○ ○
//!  5│  ○ ○ ○
//!  2│●─●─●─●─●─●─●─   ⢀⢀ band
//!   └now  +5     +11
//! ○ head alone  ● A P Aᵀ+Q  ·· 95 % of honest means
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::braille::Stroke;
use super::super::face::Face;
use super::super::paint::{below_title, text, title};
use super::super::plot::Plot;
use super::super::scale::{Scale, round_up};
use super::super::theme::{PREDICTION, dim, strong};
use super::super::view::Pane;
use super::super::words::{Entry, legend, legend_rows};
use super::board;
use crate::measure::calibration::HorizonNees;
use crate::session::snapshot::Snapshot;

/// Expected of a position in the plane.
const HONEST: f32 = 2.0;
/// Means above this are drawn on an axis of factors.
const LARGE: f32 = 12.0;

/// Draws the plot.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Horizons);
    let Ok(board) = board(snapshot) else { return };
    if pane.is_empty() {
        return;
    }
    let inner = below_title(pane);
    let both = || board.by_head.iter().chain(&board.by_propagation);
    let means = || both().map(|at| at.mean as f32).filter(|mean| mean.is_finite());
    let most = means().fold(0.0, f32::max);
    let is_log = most > LARGE;
    let note = if is_log { "2 is honest, log" } else { "2 is honest" };
    title(buf, pane, "NEES by horizon", note, focused);
    let Some(last) = both().map(|at| at.horizon).max() else {
        text(buf, inner, 0, 0, "no probe, or too few episodes", dim());
        return;
    };

    let ink = face.depth.ink(PREDICTION);
    let entries: [Entry; 3] = [
        ("●", Style::new(), "A P Aᵀ+Q"),
        ("○", ink, "head alone"),
        ("⠂⠂", dim(), "95 % of honest means"),
    ];
    let rows = legend_rows(&entries, inner.width);
    let shown = (rows.len() as u16).min(inner.height / 3);
    let plot_pane = Rect {
        height: inner.height.saturating_sub(shown),
        ..inner
    };
    for (i, row) in rows.into_iter().take(usize::from(shown)).enumerate() {
        legend(buf, inner, plot_pane.height + i as u16, row);
    }

    let y = if is_log {
        let least = means().filter(|&mean| mean > 0.0).fold(1.0, f32::min);
        Scale::log(least, round_up(most))
    } else {
        Scale::from_zero(means().chain([4.0]))
    };
    let Some(mut plot) = Plot::new(plot_pane, Scale::linear(-0.5, last as f32 + 0.5), y) else {
        return;
    };
    let line = |of: &[HorizonNees], value: fn(&HorizonNees) -> f64| -> Vec<(f32, f32)> {
        of.iter().map(|at| (at.horizon as f32, value(at) as f32)).collect()
    };
    plot.level(HONEST, Stroke::Sparse, dim());
    plot.line(&line(&board.by_head, |at| at.mean), Stroke::Dotted, ink);
    plot.line(&line(&board.by_propagation, |at| at.mean), Stroke::Solid, Style::new());
    // The band is that of the most episodes; where fewer reach a horizon it would be wider there.
    if let Some(widest) = both().max_by_key(|at| at.episodes) {
        plot.shade(widest.low as f32, widest.high as f32);
    }
    for point in line(&board.by_head, |at| at.mean) {
        plot.mark(point, '○', ink);
    }
    for point in line(&board.by_propagation, |at| at.mean) {
        plot.mark(point, '●', strong());
    }
    let every = if last <= 6 { 1 } else { last.div_ceil(4) };
    let label = |h: usize| (h as f32, if h == 0 { "now".to_owned() } else { format!("+{h}") });
    let labels: Vec<_> = (0..=last).filter(|h| h.is_multiple_of(every)).map(label).collect();
    plot.draw(buf, &labels);
}
