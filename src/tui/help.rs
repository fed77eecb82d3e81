//! The keys over the screen, by group, from the keymap's own table; several pages where one does not hold them.

use ratatui::buffer::Buffer;
use ratatui::layout::{Rect, Size};
use ratatui::style::Style;
use ratatui::widgets::{Clear, Widget};

use super::paint::{right, text};
use super::theme::{dim, strong};
use super::words::wrap;
use crate::session::keymap::groups;

/// The narrowest column of keys and what they do.
const COLUMN: u16 = 56;
/// Columns for the keys themselves.
const KEYS: u16 = 19;

enum Line {
    Group(&'static str),
    Key { label: String, help: String },
    Blank,
}

/// Pages that a screen of this size needs.
pub fn pages(screen: Size) -> usize {
    let (columns, rows) = grid(Rect::new(0, 0, screen.width, screen.height));
    let width = usize::from(screen.width.saturating_sub(2) / columns);
    lines(width)
        .len()
        .div_ceil(usize::from(columns * rows))
        .max(1)
}

/// Draws one page over the whole screen, with the address at which browsers may join.
pub fn draw(buf: &mut Buffer, screen: Rect, page: usize, address: Option<&str>) {
    Clear.render(screen, buf);
    let (columns, rows) = grid(screen);
    let inner = Rect {
        x: screen.x + 1,
        width: screen.width.saturating_sub(2),
        ..screen
    };
    let pages = pages(screen.as_size());
    text(buf, inner, 0, 0, "keys", strong());
    let note = if page + 1 < pages {
        format!("page {} of {pages}, ? for the next, Esc closes", page + 1)
    } else {
        "Esc closes".to_owned()
    };
    right(buf, inner, inner.width, 0, &note, dim());

    if let Some(address) = address {
        text(
            buf,
            inner,
            0,
            1,
            &format!("in a browser: {address}"),
            Style::new(),
        );
    }

    let column_width = inner.width / columns;
    let shown = usize::from(columns * rows);
    let lines = lines(usize::from(column_width));
    for (i, line) in lines.iter().skip(page * shown).take(shown).enumerate() {
        let column = Rect {
            x: inner.x + i as u16 / rows * column_width,
            width: column_width,
            ..inner
        };
        let row = 2 + i as u16 % rows;
        match line {
            Line::Group(name) => {
                text(buf, column, 0, row, name, strong());
            }
            Line::Key { label, help } => {
                text(buf, column, 2, row, label, Style::new());
                text(buf, column, KEYS, row, help, dim());
            }
            Line::Blank => {}
        }
    }
}

/// Columns of keys, and the rows of each.
fn grid(screen: Rect) -> (u16, u16) {
    (
        (screen.width.saturating_sub(2) / COLUMN).max(1),
        screen.height.saturating_sub(2).max(1),
    )
}

fn lines(column_width: usize) -> Vec<Line> {
    let room = column_width.saturating_sub(usize::from(KEYS) + 1).max(12);
    let mut lines = Vec::new();
    for (name, bindings) in groups() {
        if !lines.is_empty() {
            lines.push(Line::Blank);
        }
        lines.push(Line::Group(name));
        for binding in bindings {
            let mut label = binding.label();
            for help in wrap(binding.help, room as u16) {
                lines.push(Line::Key {
                    label: std::mem::take(&mut label),
                    help,
                });
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_stands_on_some_page() {
        for size in [Size::new(40, 12), Size::new(80, 24), Size::new(200, 60)] {
            let screen = Rect::new(0, 0, size.width, size.height);
            let mut all = String::new();
            for page in 0..pages(size) {
                let mut buf = Buffer::empty(screen);
                draw(&mut buf, screen, page, Some("http://here/"));
                all.push_str(&super::super::print::to_text(&buf, false));
            }
            for (_, bindings) in groups() {
                for binding in bindings {
                    let word = binding.help.split(' ').next().unwrap_or_default();
                    assert!(
                        all.contains(&binding.label()),
                        "{size}: {}",
                        binding.label()
                    );
                    assert!(all.contains(word), "{size}: {word}");
                }
            }
        }
    }
}
