//! How sure the rollout is, told in three ways in one plot (D20).
//!
//! ```text
//! σ of the position cm ─ ─1.90 ○1.81 ┈0.40
//! 2│        ○━○━○━○
//! 1│  ○━○━○━
//! 0│┈┈┈┈┈┈┈┈┈┈┈┈┈┈┈
//!  └+1   +5   +11
//! ─ A P Aᵀ+Q  ○ samples  ┈ head  without R_p
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
use super::super::words::{Entry, legend_below};
use super::{cursor_ahead, labels};
use crate::measure::spread::distance_sigma;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::spread::SpreadView;

/// σ at each step of the horizon: head, propagated, sampled; the unit is the title's.
fn sigmas(spread: &SpreadView) -> (bool, Vec<[f32; 3]>) {
    let positions = std::iter::zip(
        &spread.head,
        std::iter::zip(&spread.propagated, &spread.sampled),
    );
    let sigma = |covariance: &[f32; 3]| 100.0 * distance_sigma(*covariance);
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
        let why = if snapshot.busy {
            "computing…"
        } else {
            "not computed yet"
        };
        text(buf, inner, 0, 0, why, dim());
        return;
    };
    let (is_position, sigmas) = sigmas(spread);
    // Index 0 is the first step ahead.
    let now = cursor_ahead(snapshot).and_then(|h| Some((h, *sigmas.get(h.checked_sub(1)?)?)));
    let name = match (is_position, pane.width < 36) {
        (true, false) => "σ of the position cm",
        (true, true) => "σ cm",
        (false, _) => "σ of z",
    };
    let note = now.map(|(_, [head, propagated, sampled])| {
        format!("─{propagated:.2} ○{sampled:.2} ┈{head:.2}")
    });
    title(buf, pane, name, &note.unwrap_or_default(), focused);
    let Some(last) = sigmas.len().checked_sub(1) else {
        text(buf, inner, 0, 0, "nothing was predicted yet", dim());
        return;
    };

    let ink = face.depth.ink(PREDICTION);
    let entries: [Entry; 4] = [
        ("─", Style::new(), "A P Aᵀ+Q"),
        ("○", ink, "samples"),
        ("┈", ink, "head"),
        (
            "",
            dim(),
            if is_position {
                "without R_p"
            } else {
                "no probe: latent"
            },
        ),
    ];
    let plot_pane = legend_below(buf, inner, &entries);

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
