//! The sentences, and the numbers of the filtered belief beside those of the prediction.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::face::Face;
use super::super::paint::{below_title, eighth, right, text, title, width};
use super::super::theme::{PREDICTION, dim, strong};
use super::super::view::Pane;
use super::super::words::sentence;
use super::board;
use crate::measure::calibration::{Calibration, CoveragePoint, HorizonNees};
use crate::session::snapshot::Snapshot;

/// Where the two columns of numbers end.
const FILTERED: u16 = 23;
const PREDICTED: u16 = 35;

/// Draws the sentences, the most important first.
pub fn sentences(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    if pane.is_empty() {
        return;
    }
    let inner = below_title(pane);
    let read = board(snapshot);
    let note = read.as_ref().map_or_else(
        |_| String::new(),
        |board| {
            let of = format!(
                "{}, {}/{} episodes",
                board.split, board.episodes, board.total
            );
            if board.stale {
                return format!("{of}; still of before the last change");
            }
            let damaged = !snapshot.corruptions.is_empty();
            format!("{of}{}", if damaged { ", none damaged" } else { "" })
        },
    );
    title(
        buf,
        pane,
        "consistency",
        &note,
        face.is_focused(Pane::Verdict),
    );
    let board = match read {
        Ok(board) => board,
        Err(why) => {
            sentence(buf, inner, 0, &why, Style::new());
            return;
        }
    };
    let mut row = 0;
    for (i, line) in board.sentences.iter().enumerate() {
        let style = if i == 0 { strong() } else { Style::new() };
        row = sentence(buf, inner, row, line, style);
    }
    if board.sentences.is_empty() {
        text(buf, inner, 0, 0, "too few episodes so far", dim());
    }
}

/// Draws the numbers.
pub fn numbers(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let Ok(board) = board(snapshot) else { return };
    title(buf, pane, "numbers", "", face.is_focused(Pane::Numbers));
    let inner = below_title(pane);
    let ink = face.depth.ink(PREDICTION);
    right(buf, inner, FILTERED, 0, "● filtered", strong());
    right(buf, inner, PREDICTED, 0, "◆ predicted", strong().patch(ink));
    let both = [board.filtered.as_ref(), board.predicted.as_ref()];
    let first = board.by_head.first();
    // The other numbers of the prediction are of the last horizon that every episode has.
    let of_all =
        |at: &&HorizonNees| at.horizon > 0 && first.is_some_and(|f| f.episodes == at.episodes);
    let last = board.by_head.iter().rfind(of_all);
    let nees = [first, last].map(|at| at.map(|at| at.mean));
    let rows: [(&str, [Option<String>; 2], &str); 8] = [
        (
            "holds of 95 %",
            both.map(|c| {
                c.and_then(held)
                    .map(|held| format!("{:.0} %", 100.0 * held))
            }),
            "",
        ),
        (
            "NEES",
            nees.map(|nees| nees.map(|nees| format!("{nees:.1}"))),
            "2 is honest",
        ),
        (
            "  without R_p",
            [
                board.filtered_bare_nees.map(|nees| format!("{nees:.1}")),
                None,
            ],
            "probe taken as exact",
        ),
        (
            "off by",
            both.map(|c| c.map(|c| format!("{:.2}", c.area))),
            "area to the diagonal",
        ),
        (
            "tr P",
            both.map(|c| c.map(|c| format!("{:.1}", c.sharpness_cm2))),
            "cm², less is sharper",
        ),
        (
            "NLL",
            both.map(|c| c.map(|c| format!("{:.2}", c.nll))),
            "nats, lower is better",
        ),
        (
            "CRPS x, y",
            both.map(|c| c.map(|c| format!("{:.2} {:.2}", c.crps_cm[0], c.crps_cm[1]))),
            "cm",
        ),
        // Flat where calibrated, high at the right where oversure (D12).
        (
            "PIT",
            both.map(|c| c.map(|c| histogram(&c.pit))),
            "flat is honest",
        ),
    ];
    for (i, (name, values, note)) in rows.iter().enumerate() {
        let row = 1 + i as u16;
        text(buf, inner, 0, row, name, dim());
        for (value, end) in values.iter().zip([FILTERED, PREDICTED]) {
            right(
                buf,
                inner,
                end,
                row,
                value.as_deref().unwrap_or("–"),
                Style::new(),
            );
        }
        if PREDICTED + 2 + width(note) <= inner.width {
            text(buf, inner, PREDICTED + 2, row, note, dim());
        }
    }
    sentence(
        buf,
        inner,
        9,
        "Averages over episodes, not along time: steps of one episode are not independent.",
        dim(),
    );
}

/// The part held of a claimed 95 %.
fn held(calibration: &Calibration) -> Option<f64> {
    let near = |point: &&CoveragePoint| (point.claimed - 0.95).abs() < 0.01;
    calibration
        .coverage
        .iter()
        .find(near)
        .map(|point| point.held)
}

/// Shares of ten bins as columns, a tenth each in the middle.
fn histogram(shares: &[f64]) -> String {
    shares
        .iter()
        .map(|&share| eighth((5.0 * share) as f32))
        .collect()
}
