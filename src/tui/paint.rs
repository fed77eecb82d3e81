//! Text and rules into a buffer, clipped to the pane they belong to.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::Span;

use super::theme::{dim, strong};

/// Columns that a text takes.
pub fn width(text: &str) -> u16 {
    Span::raw(text).width() as u16
}

/// Writes at a column and row of the pane; returns the column after it.
pub fn text(buf: &mut Buffer, pane: Rect, column: u16, row: u16, text: &str, style: Style) -> u16 {
    let pane = pane.intersection(buf.area);
    if row >= pane.height || column >= pane.width {
        return column;
    }
    let room = usize::from(pane.width - column);
    let (end, _) = buf.set_stringn(pane.x + column, pane.y + row, text, room, style);
    end - pane.x
}

/// Writes so that the text ends at the column (exclusive); returns the column it starts at.
pub fn right(buf: &mut Buffer, pane: Rect, end: u16, row: u16, content: &str, style: Style) -> u16 {
    let start = end.saturating_sub(width(content));
    text(buf, pane, start, row, content, style);
    start
}

/// Writes one character in place of what was there.
pub fn put(buf: &mut Buffer, pane: Rect, column: u16, row: u16, symbol: char, style: Style) {
    let pane = pane.intersection(buf.area);
    if row < pane.height
        && column < pane.width
        && let Some(cell) = buf.cell_mut((pane.x + column, pane.y + row))
    {
        cell.reset();
        cell.set_char(symbol).set_style(style);
    }
}

/// A number of four columns at most, five with a minus; a dash for what is no number.
pub fn short(value: f32) -> String {
    match value.abs() {
        size if !size.is_finite() => "–".to_owned(),
        size if size < 9.995 => format!("{value:.2}"),
        size if size < 99.95 => format!("{value:.1}"),
        size if size < 9999.5 => format!("{value:.0}"),
        _ => format!("{value:.0e}"),
    }
}

/// A pane's first row: its title, a note at the right end, a thin rule between them.
pub fn title(buf: &mut Buffer, pane: Rect, name: &str, note: &str, focused: bool) {
    let start = if focused {
        text(buf, pane, 0, 0, "▸ ", strong())
    } else {
        0
    };
    let mut from = text(buf, pane, start, 0, name, strong()) + 1;
    let to = if note.is_empty() || from + width(note) + 1 > pane.width {
        pane.width
    } else {
        right(buf, pane, pane.width, 0, note, Style::new()) - 1
    };
    while from < to {
        put(buf, pane, from, 0, '─', dim());
        from += 1;
    }
}

/// The rows of a pane below its title.
pub fn below_title(pane: Rect) -> Rect {
    Rect {
        y: pane.y + 1.min(pane.height),
        height: pane.height.saturating_sub(1),
        ..pane
    }
}

/// The part of a bar that is `fraction` full, as its fill repeated; at least one where there is anything.
pub fn bar(fill: char, fraction: f32, columns: u16) -> String {
    let full = (fraction.clamp(0.0, 1.0) * f32::from(columns)).round() as usize;
    let least = usize::from(fraction > 0.005);
    fill.to_string()
        .repeat(full.max(least).min(usize::from(columns)))
}

/// One of nine heights of a cell, empty to full.
pub fn eighth(fraction: f32) -> char {
    const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    EIGHTHS[(fraction.clamp(0.0, 1.0) * 8.0).round() as usize]
}

/// A column of bars: `fraction` of the pane's height from its lowest row upwards.
pub fn column(buf: &mut Buffer, pane: Rect, at: u16, fraction: f32, style: Style) {
    let eighths = fraction.clamp(0.0, 1.0) * f32::from(pane.height);
    for row in 0..pane.height {
        let above_floor = f32::from(pane.height - 1 - row);
        let fill = eighth(eighths - above_floor);
        if fill != ' ' {
            put(buf, pane, at, row, fill, style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_in_its_pane() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 10, 2));
        let pane = Rect::new(2, 0, 4, 1);
        assert_eq!(text(&mut buf, pane, 1, 0, "abcdef", Style::new()), 4);
        text(&mut buf, pane, 0, 1, "below", Style::new());
        text(
            &mut buf,
            Rect::new(8, 1, 40, 40),
            0,
            0,
            "edge",
            Style::new(),
        );
        assert_eq!(buf, Buffer::with_lines(["   abc    ", "        ed"]));
    }

    #[test]
    fn numbers_keep_to_their_column() {
        for value in [0.0, 0.123, 9.99, 9.999, 45.6, 99.97, 1234.0, 1e8, f32::NAN] {
            assert!(width(&short(value)) <= 4, "{value}: {}", short(value));
            assert!(width(&short(-value)) <= 5, "{value}");
        }
    }

    #[test]
    fn a_column_fills_from_the_floor() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 3, 2));
        let pane = buf.area;
        for (at, fraction) in [(0, 0.25), (1, 0.75), (2, 1.0)] {
            column(&mut buf, pane, at, fraction, Style::new());
        }
        assert_eq!(buf, Buffer::with_lines([" ▄█", "▄██"]));
    }
}
