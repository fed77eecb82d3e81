//! Who pulls the belief where, in numbers.
//!
//! ```text
//! pulls cm      x      y   without
//! V          0.31  -0.12      0.45
//! H         -0.05   0.40      0.61
//! D             –      –      1.20
//! sum        0.26   0.28
//!
//! off     belief 0.4 cm   prediction 1.2 cm
//! NEES     2.1, without R_p 9.7
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::super::face::Face;
use super::super::paint::{below_title, right, text, title};
use super::super::predict::edited;
use super::super::theme::{dim, strong};
use super::super::view::Pane;
use super::super::words::sentence;
use crate::session::snapshot::{Badge, Snapshot, estimate_at};

/// Where each column ends.
const X: u16 = 18;
const Y: u16 = 25;
const WITHOUT: u16 = 33;
/// Narrowest pane that has room for the names.
const NARROWEST: u16 = 20;

/// Draws the table and what is off.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Pulls);
    if pane.is_empty() || pane.width < NARROWEST {
        return;
    }
    title(buf, pane, "pulls", "cm", focused);
    let inner = below_title(pane);
    let row = table(buf, inner, snapshot, face);
    errors(buf, inner, row + 1, snapshot);
}

/// Returns the row after the table.
fn table(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) -> u16 {
    let Some(fusion) = &snapshot.fusion else {
        let why = match &snapshot.badge {
            Badge::NoProduct => "this model has no product of experts: nothing pulls",
            _ if snapshot.busy => "computing…",
            _ => "no product of experts at this step",
        };
        return sentence(buf, pane, 0, why, dim());
    };
    if fusion.prior_m.is_none() {
        return sentence(buf, pane, 0, "no probe: nothing can be said in cm", dim());
    }
    for (end, name) in [(X, "x"), (Y, "y"), (WITHOUT, "without")] {
        right(buf, pane, end, 0, name, dim());
    }
    let belief = snapshot
        .position
        .as_ref()
        .and_then(|position| estimate_at(&position.belief, snapshot.cursor));
    let mut row = 1;
    for (view, reading) in std::iter::zip(&snapshot.experts, &fusion.experts) {
        let expert = view.expert;
        let ink = strong().patch(face.depth.ink(expert.rgb()));
        let plain = if view.alpha > 0.0 {
            Style::new()
        } else {
            dim()
        };
        text(buf, pane, 0, row, &expert.letter().to_string(), ink);
        text(buf, pane, 2, row, expert.name(), plain);
        pair(buf, pane, row, reading.pull_m, plain);
        let shift = belief.and_then(|belief| reading.shift_m(belief));
        right(buf, pane, WITHOUT, row, &cm(shift), plain);
        row += 1;
    }
    text(buf, pane, 0, row, "Σ sum", strong());
    pair(buf, pane, row, fusion.correction_m, strong());
    row += 1;
    // Edited controls have more to say where there is little room.
    if pane.height < 20 && snapshot.control_edit.is_some() {
        return row;
    }
    let words = "sum: from the prior's position to the belief's; without: how far the belief moves when it leaves this step";
    sentence(buf, pane, row, words, dim())
}

fn pair(buf: &mut Buffer, pane: Rect, row: u16, value: Option<[f32; 2]>, style: Style) {
    right(buf, pane, X, row, &cm(value.map(|[x, _]| x)), style);
    right(buf, pane, Y, row, &cm(value.map(|[_, y]| y)), style);
}

fn cm(metres: Option<f32>) -> String {
    metres.map_or_else(|| "–".to_owned(), |metres| format!("{:.2}", metres * 100.0))
}

fn errors(buf: &mut Buffer, pane: Rect, first: u16, snapshot: &Snapshot) {
    let mut row = first;
    let mut line = |name: &str, value: &str, note: &str| {
        text(buf, pane, 0, row, name, dim());
        right(buf, pane, X, row, value, strong());
        text(buf, pane, X + 1, row, note, dim());
        row += 1;
    };
    if let Some(position) = &snapshot.position {
        line("belief off", &cm(position.belief_error_m), "cm");
        if position.prediction_error_m.is_some() {
            line("predicted", &cm(position.prediction_error_m), "cm off");
        }
    }
    if let Some(series) = &snapshot.series {
        let now = |values: &[f32]| {
            values
                .get(snapshot.cursor)
                .copied()
                .filter(|value| value.is_finite())
        };
        let shown = |value: Option<f32>| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1}"))
        };
        line("NEES", &shown(now(&series.nees)), "95 % below 6.0");
        line("  no R_p", &shown(now(&series.nees_bare)), "probe exact");
    }
    if let Some(edit) = &snapshot.control_edit {
        sentence(
            buf,
            pane,
            row + 1,
            &edited::words(edit, if pane.height < 20 { 0 } else { u16::MAX }),
            strong(),
        );
    }
}
