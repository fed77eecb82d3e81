//! What is read of each expert at the cursor, right of the table: NIS against both spreads of the prediction (D8),
//! information (D5), and how far the belief moves without the expert (D6), in its own σ and in cm.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use crate::measure::chi2::Bounds;
use crate::session::snapshot::reading::ExpertReading;
use crate::session::snapshot::{Snapshot, estimate_at};
use crate::tui::face::Face;
use crate::tui::fuse::{mark, range};
use crate::tui::paint::{put, right, short, text, width};
use crate::tui::theme::{WARNING, dim, strong};
use crate::tui::words::sentence;

/// Where each column ends, and what stands above it.
type Columns = [(u16, &'static str); 5];

const NARROW: Columns = [
    (8, "NIS head"),
    (15, "prop"),
    (21, "nats"),
    (27, "w/o σ"),
    (33, "cm"),
];
const WIDE: Columns = [
    (10, "NIS head"),
    (24, "NIS A P Aᵀ+Q"),
    (35, "info nats"),
    (46, "without σ"),
    (58, "without cm"),
];

/// Columns that the readings take out of so many; none where they do not fit.
pub fn columns_of(room: u16) -> u16 {
    let fitting = [WIDE, NARROW].map(|columns| columns[4].0);
    let found = fitting.into_iter().find(|&columns| columns <= room);
    found.unwrap_or(0)
}

/// Draws the columns, a row an expert.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let columns = if pane.width >= WIDE[4].0 {
        WIDE
    } else {
        NARROW
    };
    for (end, name) in columns {
        right(buf, pane, end, 0, name, dim());
    }
    let fusion = snapshot.fusion.as_deref();
    let position = snapshot.position.as_ref();
    let belief = position.and_then(|position| estimate_at(&position.belief, snapshot.cursor));
    for (i, view) in snapshot.experts.iter().enumerate() {
        let row = 1 + i as u16;
        let none = ExpertReading::default();
        let reading = fusion
            .and_then(|fusion| fusion.experts.get(i))
            .unwrap_or(&none);
        let plain = if view.alpha > 0.0 {
            Style::new()
        } else {
            dim()
        };
        let is_sensor = i + 1 < snapshot.experts.len();
        if is_sensor {
            let nis = reading.nis;
            let head = nis.map(|nis| nis.head);
            let propagated = nis.and_then(|nis| nis.propagated);
            let bounds = nis.and_then(|nis| nis.bounds);
            for ((end, _), value) in columns.into_iter().zip([head, propagated]) {
                right(buf, pane, end, row, &number(value), plain);
                let sign = value.map_or(' ', |value| mark(value, bounds));
                if sign != ' ' {
                    let warning = strong().patch(face.depth.ink(WARNING));
                    put(buf, pane, end, row, sign, warning);
                }
            }
        }
        let shift = belief.and_then(|belief| reading.shift_m(belief));
        let shift_cm = shift.map(|metres| metres * 100.0);
        let others = [reading.information_nats, reading.mahalanobis, shift_cm];
        for ((end, _), value) in columns.into_iter().skip(2).zip(others) {
            right(buf, pane, end, row, &number(value), plain);
        }
    }
}

fn number(value: Option<f32>) -> String {
    value.map_or_else(|| "–".to_owned(), short)
}

/// What the marks mean, and what a share does not mean, as far as there are rows.
pub fn notes(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot) {
    let mut parts = vec![bounds_note(snapshot)];
    parts.extend(["○ off: removed".to_owned(), "~ input damaged".to_owned()]);
    let mut at = 0;
    for part in parts.iter().filter(|part| !part.is_empty()) {
        if at + width(part) <= pane.width {
            at = text(buf, pane, at, 0, part, dim()) + 3;
        }
    }
    if pane.height > 1 {
        let scale = "Shares also follow the loss's scale (one σ² a pixel or sensor value); only NEES and coverage tie \
                     them to cm.";
        let below = Rect {
            y: pane.y + 1,
            height: pane.height - 1,
            ..pane
        };
        sentence(buf, below, 0, scale, dim());
    }
}

/// The bounds of NIS, or why there are none.
fn bounds_note(snapshot: &Snapshot) -> String {
    let Some(fusion) = &snapshot.fusion else {
        return String::new();
    };
    let mut readings = fusion.experts.iter().filter_map(|reading| reading.nis);
    match readings.next() {
        Some(nis) => match nis.bounds {
            Some(bounds) => bounds_text(bounds, nis.dof),
            None => "NIS: no bounds where an α is neither 0 nor 1".to_owned(),
        },
        None => String::new(),
    }
}

fn bounds_text(bounds: Bounds, dof: usize) -> String {
    format!("NIS ▲▼ outside 95 %: {}, {dof} dims", range(bounds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_fit_their_columns() {
        for columns in [NARROW, WIDE] {
            let mut before = 0;
            for (end, name) in columns {
                assert!(before + width(name) <= end, "{name}");
                before = end + 1;
            }
        }
    }

    #[test]
    fn readings_stand_only_where_all_fit() {
        assert_eq!(columns_of(32), 0);
        assert_eq!(columns_of(33), 33);
        assert_eq!(columns_of(200), 58);
    }
}
