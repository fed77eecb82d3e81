//! How sure the rollout is, told in three ways in one plot (D20).
//!
//! ```text
//! σ of the position cm ────── no R_p
//! 2│        ○━○━○━○
//! 1│  ○━○━○━
//! 0│┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈
//!  └+1   +5   +11
//! ─ A P Aᵀ+Q 1.9  ○ 32 samples 1.8  ┈ head 0.4
//! ```
//! The head states one step's spread and does not accumulate; the other two should agree, and grow.

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
use super::super::words::{Entry, legend, legend_rows};
use super::{cursor_ahead, labels};
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::spread::SpreadView;

/// σ at each step of the horizon: head, propagated, sampled; the unit is the title's.
fn sigmas(spread: &SpreadView) -> (bool, Vec<[f32; 3]>) {
    let positions = std::iter::zip(&spread.head, std::iter::zip(&spread.propagated, &spread.sampled));
    let sigma = |[xx, _, yy]: &[f32; 3]| (xx + yy).max(0.0).sqrt() * 100.0;
    let positions: Vec<[f32; 3]> = positions
        .map(|(head, (propagated, sampled))| [sigma(head), sigma(propagated), sigma(sampled)])
        .collect();
    if positions.is_empty() {
        (false, spread.latent_sigma.clone())
    } else {
        (true, positions)
    }
}

/// Draws the plot with its legend.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Spread);
    if pane.is_empty() {
        return;
    }
    let inner = below_title(pane);
    let Some(spread) = &snapshot.spread else {
        title(buf, pane, "σ of the rollout", "", focused);
        let why = if snapshot.busy { "computing…" } else { "nothing was predicted yet" };
        text(buf, inner, 0, 0, why, dim());
        return;
    };
    let (is_position, sigmas) = sigmas(spread);
    if is_position {
        title(buf, pane, "σ of the position cm", "without R_p", focused);
    } else {
        title(buf, pane, "σ of the latent", "no probe", focused);
    }
    let Some(last) = sigmas.len().checked_sub(1) else {
        text(buf, inner, 0, 0, "nothing was predicted yet", dim());
        return;
    };

    // Index 0 is the first step ahead.
    let now = cursor_ahead(snapshot).and_then(|h| Some((h, sigmas.get(h.checked_sub(1)?)?)));
    let said = |name: String, i: usize| match now {
        Some((_, sigma)) => format!("{name} {:.2}", sigma[i]),
        None => name,
    };
    let names = [
        said("A P Aᵀ+Q".to_owned(), 1),
        said(format!("{} samples", spread.samples), 2),
        said("head alone".to_owned(), 0),
    ];
    let ink = face.depth.ink(PREDICTION);
    let entries: [Entry; 3] = [
        ("─", Style::new(), &names[0]),
        ("○", ink, &names[1]),
        ("┈", ink, &names[2]),
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

    let y = Scale::from_zero(sigmas.iter().flatten().copied());
    let Some(mut plot) = Plot::new(plot_pane, Scale::linear(1.0, (last + 1) as f32), y) else {
        return;
    };
    if let Some((h, _)) = now {
        plot.upright(h as f32, dim());
    }
    let of = |which: usize| -> Vec<(f32, f32)> {
        let point = |(i, sigma): (usize, &[f32; 3])| ((i + 1) as f32, sigma[which]);
        sigmas.iter().enumerate().map(point).collect()
    };
    plot.line(&of(0), Stroke::Dotted, ink);
    plot.line(&of(1), Stroke::Solid, Style::new());
    for point in of(2) {
        plot.mark(point, '○', ink);
    }
    if let Some((h, sigma)) = now {
        plot.mark((h as f32, sigma[2]), '◆', strong().patch(ink));
    }
    plot.draw(buf, &labels(last + 1));
}
