//! What rising damage does (D17): position error, NEES and the damaged expert's share, from severity 0 to 1.
//!
//! ```text
//! response ─────────────── severity 0 to 1
//! H cm     ▁▁▂▂▃▄▅▅▆▇█  0.4 → 2.4
//!   NEES   ▁▂▂▃▄▄▅▆▆▇█  2.0 → 11.0
//!   share  █▇▇▇▆▆▆▅▅▅▅  14 → 9 %
//! haptic doubts itself: under noise its share falls from 14 % to 9 %
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use crate::session::snapshot::Snapshot;
use crate::session::snapshot::response::ResponseView;
use crate::tui::face::Face;
use crate::tui::paint::{below_title, eighth, text, title};
use crate::tui::theme::{dim, strong};
use crate::tui::view::Pane;
use crate::tui::words::sentence;

/// Rows of one damage: three curves and a sentence of up to two rows; the title stands above all.
pub const ROWS: u16 = 6;
/// Columns before the names of the curves, and before the curves.
const NAMES: u16 = 2;
const CURVES: u16 = 9;

/// Draws each damage in turn, as many as there is room for.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let focused = face.is_focused(Pane::Response);
    title(buf, pane, "response", "severity 0 to 1", focused);
    let inner = below_title(pane);
    if snapshot.responses.is_empty() {
        let why = if snapshot.corruptions.is_empty() {
            "Nothing is damaged: x damages the input of the expert whose digit was pressed last."
        } else {
            "computing…"
        };
        sentence(buf, inner, 0, why, dim());
        return;
    }
    let mut row = 0;
    for response in snapshot.responses.iter() {
        if row + 3 > inner.height {
            return;
        }
        row = curves(buf, inner, row, response, face);
    }
}

fn curves(buf: &mut Buffer, pane: Rect, row: u16, response: &ResponseView, face: &Face) -> u16 {
    let ink = face.depth.ink(response.expert.rgb());
    let letter = response.expert.letter();
    text(buf, pane, 0, row, &letter.to_string(), strong().patch(ink));
    let lines: [(&str, &[f32], f32, usize, &str); 3] = [
        ("cm", &response.rmse_m, 100.0, 1, ""),
        ("NEES", &response.nees, 1.0, 1, ""),
        ("share", &response.share, 100.0, 0, " %"),
    ];
    for (i, (name, values, factor, decimals, unit)) in lines.into_iter().enumerate() {
        let row = row + i as u16;
        text(buf, pane, NAMES, row, name, dim());
        let most = values.iter().copied().fold(0.0, f32::max);
        let curve: String = values.iter().map(|value| eighth(value / most)).collect();
        let at = text(buf, pane, CURVES, row, &curve, ink) + 2;
        let number = |value: Option<&f32>| match value {
            Some(value) if value.is_finite() => format!("{:.decimals$}", factor * value),
            _ => "–".to_owned(),
        };
        let (first, last) = (number(values.first()), number(values.last()));
        let change = format!("{first} → {last}{unit}");
        text(buf, pane, at, row, &change, Style::new());
    }
    sentence(buf, pane, row + 3, &response.sentence, Style::new())
}
