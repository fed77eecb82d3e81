//! What can be chosen while a line is typed, over the lower part of the screen.
//!
//! ```text
//! commands ──────────────────────────────────────── 3 of 118, ↑ ↓ choose, Tab completes, Esc closes
//! ▸ corrupt vision noise   damage an input; none mends it                             x
//!   corrupt vision none    damage an input; none mends it                             x
//! :corrupt vi▏
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::widgets::{Clear, Widget};

use super::paint::{below_title, right, text, title, width};
use super::theme::dim;
use crate::session::palette::{PaletteEntry, PaletteView};

/// Rows of entries at most.
const MOST: u16 = 10;
/// Rows above it that are always left.
const ABOVE: u16 = 2;

/// Where it is: the rows above the line that is typed.
pub fn pane(screen: Rect, line: Rect) -> Rect {
    let room = line.y.saturating_sub(screen.y + ABOVE);
    let height = room.min(1 + MOST);
    Rect {
        y: line.y - height,
        height,
        ..line
    }
}

/// Draws as many entries as there is room for, the chosen one among them.
pub fn draw(buf: &mut Buffer, pane: Rect, view: &PaletteView) {
    if pane.is_empty() {
        return;
    }
    let list = below_title(pane);
    let shown = usize::from(list.height);
    let pane = Rect {
        // No higher than its entries.
        y: pane.y + list.height.saturating_sub(view.entries.len() as u16),
        height: 1 + (view.entries.len().min(shown) as u16),
        ..pane
    };
    let list = below_title(pane);
    Clear.render(pane, buf);
    let place = match view.chosen {
        Some(chosen) => format!("{} of {}", chosen + 1, view.entries.len()),
        None => view.entries.len().to_string(),
    };
    let note = format!("{place}, ↑ ↓ choose, Tab completes, Esc closes");
    title(buf, pane, "commands", &note, false);
    let first = view
        .chosen
        .map_or(0, |chosen| (chosen + 1).saturating_sub(shown));
    let entries = view.entries.iter().enumerate().skip(first).take(shown);
    for (row, (i, entry)) in entries.enumerate() {
        let line = Rect {
            y: list.y + row as u16,
            height: 1,
            ..list
        };
        draw_entry(buf, line, entry, view.chosen == Some(i));
    }
}

/// Its keys at the right end whatever happens, its help where there is room between them.
fn draw_entry(buf: &mut Buffer, line: Rect, entry: &PaletteEntry, chosen: bool) {
    let style = if chosen {
        buf.set_style(line, Style::new().add_modifier(Modifier::REVERSED));
        text(buf, line, 0, 0, "▸", Style::new());
        Style::new().add_modifier(Modifier::REVERSED)
    } else {
        Style::new()
    };
    let end = right(buf, line, line.width, 0, &entry.keys, style);
    let room = Rect {
        width: end.saturating_sub(1).min(line.width),
        ..line
    };
    let at = text(buf, room, 2, 0, &entry.name, style) + 2;
    if at + width(&entry.help) <= room.width {
        text(buf, room, at, 0, &entry.help, style.patch(dim()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::print::to_text;

    fn entry(i: usize) -> PaletteEntry {
        PaletteEntry {
            name: format!("command {i}"),
            keys: "Ctrl+R".to_owned(),
            help: "does much".to_owned(),
        }
    }

    fn drawn(entries: usize, chosen: Option<usize>, (columns, rows): (u16, u16)) -> Vec<String> {
        let screen = Rect::new(0, 0, columns, rows);
        let mut buf = Buffer::empty(screen);
        let view = PaletteView {
            line: String::new(),
            entries: (0..entries).map(entry).collect(),
            chosen,
        };
        let line = Rect::new(1, rows - 1, columns - 2, 1);
        draw(&mut buf, pane(screen, line), &view);
        to_text(&buf, false).lines().map(str::to_owned).collect()
    }

    #[test]
    fn the_chosen_entry_is_in_sight_and_keys_stand_at_the_right() {
        let lines = drawn(30, Some(20), (80, 24));
        assert!(lines[12].starts_with(" commands ─") && lines[12].contains("21 of 30"));
        assert_eq!(lines[22].find("▸ command 20  does much"), Some(1));
        assert!(lines[22].ends_with("Ctrl+R") && lines[13].contains("command 11"));
        assert!(lines[11].is_empty() && lines[23].is_empty());
    }

    #[test]
    fn it_is_no_higher_than_its_entries_and_fits_the_smallest_screen() {
        let lines = drawn(2, None, (80, 24));
        assert!(lines[19].is_empty() && lines[20].contains("commands"));
        let lines = drawn(30, None, (40, 12));
        assert!(lines[1].is_empty() && lines[2].contains("commands"));
        assert!(lines[10].contains("command 7") && lines[10].ends_with("Ctrl+R"));
        assert!(drawn(0, None, (40, 12))[10].contains("commands"));
    }
}
