//! Every episode over the whole screen, with what the model makes of it: sorted, filtered, to be chosen from.
//!
//! ```text
//! episodes                                    24 of 24
//!    # id          split steps error        RMSE▼    cm  gain  NEES confl  esc  !
//!    1 push-00000  test     16 ▁▂▃▄▅▆▇█▇▆    7.1   1.2     –   3.1  44.0    9  ·
//! ▸  3 push-00002  test     16 ▁▁▁▂▂▃▃▄▄▄    5.0   0.9     –   1.1  31.2    –  ·
//! scored 20/24  failures by error: 3 of 20               ⏎ open  / filter  < > sort  o order
//! ```

pub mod list;

use std::borrow::Cow;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::widgets::{Clear, Widget};

use super::face::Face;
use super::paint::{eighth, right, text, width};
use super::theme::{WARNING, dim, strong};
use crate::measure::failure::Scores;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::table::{Column, EpisodeRow, EpisodeScore, TableView};
use list::List;

/// Columns of the sparkline on a narrow screen.
const SPARK: u16 = 10;
/// Columns of the name on a narrow screen.
const ID: u16 = 11;
/// Columns that everything else takes, gaps included.
const REST: u16 = 57;

/// Where everything stands, for a screen of some width.
struct Places {
    id: u16,
    spark: u16,
    spark_columns: u16,
    /// Where the numbers after the sparkline end.
    ends: [u16; 7],
}

impl Places {
    fn of(columns: u16) -> Self {
        let spare = columns.saturating_sub(REST + ID + SPARK);
        let id = ID + (spare / 3).min(20);
        let spark_columns = SPARK + (spare - (id - ID)).min(39);
        // Mark and number, name, split, steps.
        let spark = 7 + id + 6 + 6 + 2;
        let mut at = spark + spark_columns;
        let ends = [6, 5, 5, 6, 6, 5, 2].map(|step| {
            at += step;
            at
        });
        Self {
            id,
            spark,
            spark_columns,
            ends,
        }
    }
}

/// A name that fits into so many columns: of names that begin alike the ends tell them apart.
fn tail(name: &str, columns: u16) -> Cow<'_, str> {
    if width(name) <= columns {
        return name.into();
    }
    let mut ends = name.char_indices().map(|(at, _)| &name[at..]);
    let end = ends.find(|end| width(end) < columns).unwrap_or_default();
    format!("…{end}").into()
}

/// The header of each column with the column it sorts by, where it does.
fn headers(places: &Places) -> [(u16, &'static str, Option<Column>); 12] {
    let e = places.ends;
    let steps = places.spark - 2;
    [
        (5, "#", Some(Column::Index)),
        (9, "id", Some(Column::Id)),
        (7 + places.id + 6, "split", None),
        (steps, "steps", Some(Column::Steps)),
        (places.spark + 5, "error", None),
        (e[0], "RMSE", Some(Column::Rmse)),
        (e[1], "cm", Some(Column::Distance)),
        (e[2], "gain", Some(Column::Gain)),
        (e[3], "NEES", Some(Column::Nees)),
        (e[4], "confl", Some(Column::Conflict)),
        (e[5], "esc", None),
        (e[6], "!", Some(Column::Flags)),
    ]
}

/// Draws the list over the screen.
pub fn draw(buf: &mut Buffer, screen: Rect, snapshot: &Snapshot, face: &Face, list: &List) {
    Clear.render(screen, buf);
    let margin = u16::from(screen.width >= 60);
    let pane = Rect {
        x: screen.x + margin,
        width: screen.width.saturating_sub(2 * margin),
        ..screen
    };
    let table = &*snapshot.table;
    head(buf, pane, table, list);
    let places = Places::of(pane.width);
    for (end, name, column) in headers(&places) {
        let sorted = column == Some(table.sort);
        let style = if sorted { strong() } else { dim() };
        right(buf, pane, end, 1, name, style);
        if sorted {
            text(
                buf,
                pane,
                end,
                1,
                if table.descending { "▼" } else { "▲" },
                strong(),
            );
        }
    }
    let rows = pane.height.saturating_sub(3);
    let selected = list.place(table);
    let first = first_row(selected, table.shown.len(), usize::from(rows));
    let shown = table
        .shown
        .iter()
        .enumerate()
        .skip(first)
        .take(usize::from(rows));
    for (i, (place, &index)) in shown.enumerate() {
        let line = Rect {
            y: pane.y + 2 + i as u16,
            height: 1,
            ..pane
        };
        if let Some(row) = table.rows.get(index) {
            episode(buf, line, (index, row), &places, face);
        }
        if index == snapshot.episode_index {
            text(buf, line, 0, 0, "▸", strong());
        }
        if place == selected {
            // Dim and coloured cells would make patches of a reversed line.
            buf.set_style(
                line.intersection(buf.area),
                Style::reset().add_modifier(Modifier::REVERSED),
            );
        }
    }
    if table.shown.is_empty() {
        let why = if table.rows.is_empty() {
            "no episodes"
        } else {
            "no name or split contains the filter"
        };
        text(buf, pane, 2, 2, why, dim());
    }
    foot(buf, pane, table);
}

/// The first row to show, so that the selected one is seen with some of its neighbours.
fn first_row(selected: usize, count: usize, rows: usize) -> usize {
    let centred = selected.saturating_sub(rows / 2);
    centred.min(count.saturating_sub(rows))
}

fn head(buf: &mut Buffer, pane: Rect, table: &TableView, list: &List) {
    let at = text(buf, pane, 0, 0, "episodes", strong());
    let count = format!("{} of {}", table.shown.len(), table.rows.len());
    let at = text(buf, pane, at + 2, 0, &count, dim());
    if list.is_typing {
        let at = text(
            buf,
            pane,
            at + 2,
            0,
            &format!("/{}", table.filter),
            strong(),
        );
        text(buf, pane, at, 0, "▏", Style::new());
    } else if !table.filter.is_empty() {
        let filter = format!("/{}", table.filter);
        text(buf, pane, at + 2, 0, &filter, Style::new());
    }
}

fn foot(buf: &mut Buffer, pane: Rect, table: &TableView) {
    let Some(row) = pane.height.checked_sub(1) else {
        return;
    };
    let scored = if table.asked || table.scored > 0 {
        format!("scored {}/{}", table.scored, table.rows.len())
    } else {
        "not scored".to_owned()
    };
    let at = text(buf, pane, 0, row, &scored, Style::new());
    let place = table.place.map_or_else(
        || format!("{} in the queue", table.queue.len()),
        |place| format!("{} of {}", place + 1, table.queue.len()),
    );
    let keys = "⏎ open  / filter  < > sort  o order";
    let order = format!("failures by {}: {place}", table.order.name());
    let has_room = at + 2 + width(&order) + 2 + width(keys) <= pane.width;
    // The keys stand nowhere else.
    let order = if has_room {
        &order
    } else {
        &order["failures ".len()..]
    };
    let at = text(buf, pane, at + 2, row, order, Style::new());
    if at + 2 + width(keys) <= pane.width {
        right(buf, pane, pane.width, row, keys, dim());
    }
}

fn episode(
    buf: &mut Buffer,
    line: Rect,
    (index, row): (usize, &EpisodeRow),
    places: &Places,
    face: &Face,
) {
    right(buf, line, 5, 0, &(index + 1).to_string(), dim());
    let name = Rect {
        width: line.width.min(7 + places.id),
        ..line
    };
    text(buf, name, 7, 0, &tail(&row.id, places.id), Style::new());
    let split = row.split.map_or("–", crate::episode::Split::name);
    right(buf, line, 7 + places.id + 6, 0, split, dim());
    let Some(score) = &row.score else {
        return;
    };
    if score.steps > 0 {
        let steps = score.steps.to_string();
        right(buf, line, places.spark - 2, 0, &steps, Style::new());
    }
    if let Some(fault) = &score.fault {
        text(buf, line, places.spark, 0, fault, face.depth.ink(WARNING));
        return;
    }
    spark(buf, line, score, places);
    let values = values(&score.scores);
    for (value, end) in values.iter().zip(places.ends) {
        let style = if value == "–" { dim() } else { Style::new() };
        right(buf, line, end, 0, value, style);
    }
    let (flags, style) = if score.flags == 0 {
        ("·".to_owned(), dim())
    } else {
        (score.flags.to_string(), strong())
    };
    right(buf, line, places.ends[6], 0, &flags, style);
}

/// RMSE, distance in cm, gain, NEES, conflict, first step outside; in the order of the columns.
fn values(scores: &Scores) -> [String; 6] {
    let one = |value: Option<f32>| match value {
        Some(value) if value.abs() >= 999.5 => format!("{value:.0}"),
        Some(value) if value.is_finite() => format!("{value:.1}"),
        _ => "–".to_owned(),
    };
    [
        // Squared errors are summed over a frame's pixels and averaged over the horizon.
        one(scores.error.map(f32::sqrt)),
        one(scores.distance_m.map(|metres| metres * 100.0)),
        one(scores.gain),
        one(scores.nees),
        one(scores.conflict),
        scores
            .escape
            .map_or_else(|| "–".to_owned(), |step| (step + 1).to_string()),
    ]
}

/// The frames' error over the steps, from nothing to the episode's own worst.
fn spark(buf: &mut Buffer, line: Rect, score: &EpisodeScore, places: &Places) {
    let errors: Vec<f32> = score
        .by_step
        .iter()
        .map(|at| at.error.unwrap_or(f32::NAN))
        .collect();
    let most = errors
        .iter()
        .copied()
        .filter(|error| error.is_finite())
        .fold(1e-6, f32::max);
    let columns = usize::from(places.spark_columns - 1);
    if errors.is_empty() {
        return;
    }
    // A whole number of columns a step, or of some columns the worst of their steps.
    let shown = match columns / errors.len() {
        0 => columns,
        each => each * errors.len(),
    };
    for column in 0..shown {
        let first = column * errors.len() / shown;
        let steps = first..((column + 1) * errors.len() / shown).max(first + 1);
        let worst = errors[steps].iter().copied().fold(f32::NAN, f32::max);
        if worst.is_finite() {
            // Never a full cell, or the lines of the list would run into one another.
            let symbol = eighth((worst / most).clamp(0.125, 0.875)).to_string();
            text(buf, line, places.spark + column as u16, 0, &symbol, dim());
        }
    }
}

impl List {
    /// The column after or before the one that is sorted by; it stops at the ends.
    pub fn neighbour(sort: Column, by: isize) -> Column {
        let at = Column::ALL
            .iter()
            .position(|&column| column == sort)
            .unwrap_or(0);
        Column::ALL[at.saturating_add_signed(by).min(Column::ALL.len() - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_keep_their_ends() {
        assert_eq!(tail("push-0012", 9), "push-0012");
        assert_eq!(tail("pybullet-val-0012", 8), "…al-0012");
        assert_eq!(tail("実験-0012", 7), "…-0012");
    }

    #[test]
    fn the_selected_row_is_always_on_the_screen() {
        for (count, rows) in [(0, 5), (3, 5), (24, 5), (24, 1), (24, 0)] {
            for selected in 0..count {
                let first = first_row(selected, count, rows);
                assert!(rows == 0 || (first <= selected && selected < first + rows));
            }
        }
    }

    #[test]
    fn columns_end_within_the_screen() {
        for columns in [78, 118, 198] {
            assert!(Places::of(columns).ends[6] < columns, "{columns}");
        }
    }
}
