//! One frame as text: what `--print` writes, with the colours as escape sequences or without any.

use std::fmt::Write;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

use super::draw;
use super::face::Face;
use super::theme::Depth;
use crate::session::snapshot::Snapshot;

const RESET: &str = "\x1b[0m";

/// Draws one frame of so many columns and rows; lines end in a newline, styles are reset before it.
pub fn print(snapshot: &Snapshot, face: &Face, (columns, rows): (u16, u16)) -> String {
    let Ok(mut terminal) = Terminal::new(TestBackend::new(columns, rows));
    let Ok(_) = terminal.draw(|frame| draw(frame, snapshot, face));
    to_text(terminal.backend().buffer(), face.depth != Depth::Plain)
}

/// A buffer as lines of text.
pub fn to_text(buf: &Buffer, styled: bool) -> String {
    let mut out = String::new();
    for row in buf.area.top()..buf.area.bottom() {
        let cells: Vec<&Cell> = (buf.area.left()..buf.area.right())
            .filter_map(|column| buf.cell((column, row)))
            .collect();
        let blank = |cell: &Cell| cell.symbol() == " " && (!styled || is_plain(cell));
        let end = cells
            .iter()
            .rposition(|cell| !blank(cell))
            .map_or(0, |last| last + 1);
        let mut current = String::new();
        for cell in &cells[..end] {
            if styled {
                let codes = codes(cell);
                if codes != current {
                    let _ = write!(out, "{RESET}{codes}");
                    current = codes;
                }
            }
            out.push_str(cell.symbol());
        }
        if !current.is_empty() {
            out.push_str(RESET);
        }
        out.push('\n');
    }
    out
}

fn is_plain(cell: &Cell) -> bool {
    cell.bg == Color::Reset
        && !cell
            .modifier
            .intersects(Modifier::REVERSED | Modifier::UNDERLINED)
}

/// The escape sequence that turns the default style into the cell's; empty for the default.
fn codes(cell: &Cell) -> String {
    let mut codes = Vec::new();
    let modifiers = [
        (Modifier::BOLD, "1"),
        (Modifier::DIM, "2"),
        (Modifier::UNDERLINED, "4"),
        (Modifier::REVERSED, "7"),
    ];
    for (modifier, code) in modifiers {
        if cell.modifier.contains(modifier) {
            codes.push(code.to_owned());
        }
    }
    for (color, kind) in [(cell.fg, 38), (cell.bg, 48)] {
        match color {
            Color::Rgb(r, g, b) => codes.push(format!("{kind};2;{r};{g};{b}")),
            Color::Indexed(index) => codes.push(format!("{kind};5;{index}")),
            _ => {}
        }
    }
    if codes.is_empty() {
        String::new()
    } else {
        format!("\x1b[{}m", codes.join(";"))
    }
}

#[cfg(test)]
mod tests {
    use ratatui::style::Style;

    use super::*;

    #[test]
    fn styles_begin_where_they_change_and_end_with_the_line() {
        let mut buf = Buffer::with_lines(["ab ", "c  "]);
        buf.set_style(
            ratatui::layout::Rect::new(1, 0, 1, 1),
            Style::new().fg(Color::Rgb(1, 2, 3)).bold(),
        );
        assert_eq!(
            to_text(&buf, true),
            "a\x1b[0m\x1b[1;38;2;1;2;3mb\x1b[0m\nc\n"
        );
        assert_eq!(to_text(&buf, false), "ab\nc\n");
    }
}
