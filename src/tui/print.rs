//! One frame as text: what `--print` writes, with the colours as escape sequences or without any.

use std::fmt::Write;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

use super::draw;
use super::face::Face;
use super::paint::width;
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
        // Behind a wide letter stands a cell that it covers.
        let mut covered = 0;
        for cell in &cells[..end] {
            if covered > 0 {
                covered -= 1;
                continue;
            }
            covered = width(cell.symbol()).saturating_sub(1);
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
        codes.extend(color_code(color, kind));
    }
    if codes.is_empty() {
        String::new()
    } else {
        format!("\x1b[{}m", codes.join(";"))
    }
}

/// The code of a colour as foreground (`kind` 38) or background (48); none for the terminal's own.
fn color_code(color: Color, kind: u8) -> Option<String> {
    // The first eight have codes of their own at 30 and 40, their bright versions at 90 and 100.
    let named = |n: u8| (kind - 8 + n).to_string();
    let bright = |n: u8| (kind + 52 + n).to_string();
    Some(match color {
        Color::Reset => return None,
        Color::Black => named(0),
        Color::Red => named(1),
        Color::Green => named(2),
        Color::Yellow => named(3),
        Color::Blue => named(4),
        Color::Magenta => named(5),
        Color::Cyan => named(6),
        Color::Gray => named(7),
        Color::DarkGray => bright(0),
        Color::LightRed => bright(1),
        Color::LightGreen => bright(2),
        Color::LightYellow => bright(3),
        Color::LightBlue => bright(4),
        Color::LightMagenta => bright(5),
        Color::LightCyan => bright(6),
        Color::White => bright(7),
        Color::Indexed(index) => format!("{kind};5;{index}"),
        Color::Rgb(r, g, b) => format!("{kind};2;{r};{g};{b}"),
    })
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

    #[test]
    fn a_wide_letter_takes_its_two_columns() {
        let mut buf = Buffer::empty(ratatui::layout::Rect::new(0, 0, 6, 1));
        buf.set_string(0, 0, "実x実", Style::new());
        assert_eq!(to_text(&buf, false), "実x実\n");
    }

    #[test]
    fn every_colour_has_its_code() {
        let codes = |color| [38, 48].map(|kind| color_code(color, kind).unwrap_or_default());
        assert_eq!(codes(Color::Reset), ["", ""]);
        assert_eq!(codes(Color::Red), ["31", "41"]);
        assert_eq!(codes(Color::Gray), ["37", "47"]);
        assert_eq!(codes(Color::DarkGray), ["90", "100"]);
        assert_eq!(codes(Color::White), ["97", "107"]);
        assert_eq!(codes(Color::Indexed(9)), ["38;5;9", "48;5;9"]);
    }
}
