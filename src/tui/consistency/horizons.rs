//! NEES at each horizon, and of the belief that goes on seeing, against the band in which the mean of so many episodes
//! lies (D11).
//!
//! ```text
//! NEES ──────── mean over episodes, not time
//! 10│        ○ ○ ○
//!  5│  ○ ○ ○
//!  2│●─●─●─●─●─●─●─   ⢀⢀ band
//!  1│  □ □ □ □ □ □
//!   └now  +5     +11
//! ● A P Aᵀ+Q  ○ head  □ seeing on  ⠂⠂ 95 % if honest
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
use crate::measure::calibration::HorizonNees;
use crate::session::snapshot::Snapshot;

/// Means above this are drawn on an axis of factors.
const LARGE: f32 = 5.0;

/// Draws the plot.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Horizons);
    let Ok(board) = board(snapshot) else { return };
    if pane.is_empty() {
        return;
    }
    let inner = below_title(pane);
    let predicted = || board.by_head.iter().chain(&board.by_propagation);
    let means = || {
        predicted()
            .chain(&board.by_filter)
            .map(|at| at.mean as f32)
            .filter(|mean| mean.is_finite())
    };
    let most = means().fold(0.0, f32::max);
    let is_log = most > LARGE;
    title(buf, pane, "NEES", "mean over episodes, not time", focused);
    let Some(last) = predicted().map(|at| at.horizon).max() else {
        text(buf, inner, 0, 0, "no probe, or too few episodes", dim());
        return;
    };

    let ink = face.depth.ink(PREDICTION);
    let entries: [Entry; 4] = [
        ("●", Style::new(), "A P Aᵀ+Q"),
        ("○", ink, "head"),
        ("□", dim(), "seeing on"),
        ("⠂⠂", dim(), "95 % if honest"),
    ];
    let plot_pane = legend_below(buf, inner, &entries);

    let y = if is_log {
        let least = means().filter(|&mean| mean > 0.0).fold(1.0, f32::min);
        Scale::log(least, most * 1.2)
    } else {
        Scale::from_zero(means().chain([4.0]))
    };
    let Some(mut plot) = Plot::new(plot_pane, Scale::linear(-0.5, last as f32 + 0.5), y) else {
        return;
    };
    let line = |of: &[HorizonNees], value: fn(&HorizonNees) -> f64| -> Vec<(f32, f32)> {
        of.iter()
            .map(|at| (at.horizon as f32, value(at) as f32))
            .collect()
    };
    plot.line(&line(&board.by_head, |at| at.mean), Stroke::Dotted, ink);
    plot.line(
        &line(&board.by_propagation, |at| at.mean),
        Stroke::Solid,
        Style::new(),
    );
    // The band is that of the most episodes; where fewer reach a horizon it would be wider there.
    if let Some(widest) = predicted().max_by_key(|at| at.episodes) {
        plot.level(widest.low as f32, Stroke::Sparse, dim());
        plot.level(widest.high as f32, Stroke::Sparse, dim());
        plot.shade(widest.low as f32, widest.high as f32);
    }
    // At the first the three are one belief.
    let mut later = line(&board.by_filter, |at| at.mean);
    later.retain(|&(horizon, _)| horizon > 0.0);
    for point in later {
        plot.mark(point, '□', dim());
    }
    for point in line(&board.by_head, |at| at.mean) {
        plot.mark(point, '○', ink);
    }
    for point in line(&board.by_propagation, |at| at.mean) {
        plot.mark(point, '●', strong());
    }
    let every = if last <= 6 { 1 } else { last.div_ceil(4) };
    let label = |h: usize| {
        (
            h as f32,
            if h == 0 {
                "now".to_owned()
            } else {
                format!("+{h}")
            },
        )
    };
    let labels: Vec<_> = (0..=last)
        .filter(|h| h.is_multiple_of(every))
        .map(label)
        .collect();
    plot.draw(buf, &labels);
}
