//! Cells that stand for the pieces of an image that the terminal holds (kitty's Unicode placeholders). They are text,
//! so tmux moves and redraws them like any other.
//!
//! The colour of a cell is the image's id, combining marks give the row and the column of its piece. A cell without
//! marks is the piece to the right of its left neighbour's, so only the first of each visible run needs them.

use ratatui::buffer::{Buffer, CellDiffOption};
use ratatui::layout::Rect;
use ratatui::style::Color;

use super::diacritics::diacritic;

/// The character that kitty keeps for it.
const PLACEHOLDER: char = '\u{10EEEE}';

/// An image of the terminal's. The id is sent as one of the 256 colours and a mark, since tmux may well turn a colour
/// of 24 bits into another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Id {
    /// The highest byte, the same for one process.
    pub high: u8,
    /// The lowest byte.
    pub color: u8,
}

impl Id {
    /// The number that the protocol knows it by.
    pub fn number(self) -> u32 {
        u32::from(self.high) << 24 | u32::from(self.color)
    }
}

/// An image and where it is on this frame.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// Which.
    pub id: Id,
    /// Its cells, from its upper left corner on.
    pub area: Rect,
}

impl Placed {
    /// Writes the cells.
    pub fn write(&self, buf: &mut Buffer) {
        for position in self.area.intersection(buf.area).positions() {
            if let Some(cell) = buf.cell_mut(position) {
                cell.reset();
                cell.set_char(PLACEHOLDER)
                    .set_fg(Color::Indexed(self.id.color))
                    .set_diff_option(CellDiffOption::ForcedWidth(std::num::NonZeroU16::MIN));
            }
        }
    }

    /// Marks the first cell of each run, once everything that may cover part of the image has been drawn.
    pub fn mark(&self, buf: &mut Buffer) {
        let area = self.area.intersection(buf.area);
        for y in area.top()..area.bottom() {
            let mut in_run = false;
            for x in area.left()..area.right() {
                let Some(cell) = buf.cell_mut((x, y)) else {
                    continue;
                };
                let is_ours = cell.symbol().starts_with(PLACEHOLDER)
                    && cell.fg == Color::Indexed(self.id.color);
                if is_ours && !in_run {
                    let marks = [y - self.area.y, x - self.area.x, u16::from(self.id.high)];
                    let marks = marks.into_iter().filter_map(diacritic);
                    let symbol: String = std::iter::once(PLACEHOLDER).chain(marks).collect();
                    cell.set_symbol(&symbol);
                }
                in_run = is_ours;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::paint::put;

    fn marks(buf: &Buffer, x: u16, y: u16) -> Vec<Option<char>> {
        let marks = buf[(x, y)].symbol().chars().skip(1);
        marks.map(Some).collect()
    }

    #[test]
    fn each_visible_run_says_where_in_the_image_it_begins() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 8, 4));
        let placed = Placed {
            id: Id {
                high: 9,
                color: 200,
            },
            area: Rect::new(1, 1, 6, 2),
        };
        placed.write(&mut buf);
        let whole = buf.area;
        put(&mut buf, whole, 1, 2, 'x', ratatui::style::Style::new());
        put(&mut buf, whole, 4, 2, 'x', ratatui::style::Style::new());
        placed.mark(&mut buf);
        let at = |row, column| [row, column, 9].map(diacritic).to_vec();
        assert_eq!(marks(&buf, 1, 1), at(0, 0));
        assert_eq!(marks(&buf, 2, 1), []);
        assert_eq!(marks(&buf, 2, 2), at(1, 1));
        assert_eq!(marks(&buf, 3, 2), []);
        assert_eq!(marks(&buf, 5, 2), at(1, 4));
        assert_eq!(buf[(6, 2)].fg, Color::Indexed(200));
        assert_eq!(buf[(7, 1)].symbol(), " ");
        assert_eq!(placed.id.number(), 0x0900_00C8);
    }

    #[test]
    fn two_images_side_by_side_do_not_run_together() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 4, 1));
        let placed = [16, 17].map(|color| Placed {
            id: Id { high: 1, color },
            area: Rect::new((u16::from(color) - 16) * 2, 0, 2, 1),
        });
        for it in placed {
            it.write(&mut buf);
        }
        for it in placed {
            it.mark(&mut buf);
        }
        assert_eq!(marks(&buf, 0, 0).len(), 3);
        assert_eq!(marks(&buf, 1, 0).len(), 0);
        assert_eq!(marks(&buf, 2, 0).len(), 3);
    }
}
