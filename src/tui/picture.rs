//! One frame as a picture: what a terminal of 24-bit colours shows, in cells of 8 x 16 pixels.

mod glyph;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};
use ratatui::style::{Color, Modifier};

use self::glyph::{HEIGHT, WIDTH, coverage};
use super::draw;
use super::face::Face;
use crate::session::snapshot::Snapshot;

/// Letters and ground of a terminal that says nothing else.
const INK: [u8; 3] = [208; 3];
const PAPER: [u8; 3] = [18; 3];

/// A picture, row major.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `height * width` pixels: red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

/// Draws one frame of so many columns and rows.
pub fn picture(snapshot: &Snapshot, face: &Face, (columns, rows): (u16, u16)) -> Picture {
    let Ok(mut terminal) = Terminal::new(TestBackend::new(columns, rows));
    let Ok(_) = terminal.draw(|frame| draw(frame, snapshot, face));
    of_cells(terminal.backend().buffer())
}

fn of_cells(buf: &Buffer) -> Picture {
    let (columns, rows) = (usize::from(buf.area.width), usize::from(buf.area.height));
    let mut picture = Picture {
        width: columns * WIDTH,
        height: rows * HEIGHT,
        pixels: vec![PAPER; columns * WIDTH * rows * HEIGHT],
    };
    for (i, cell) in buf.content.iter().enumerate() {
        let (left, top) = (i % columns * WIDTH, i / columns * HEIGHT);
        let (ink, paper) = colors(cell);
        let symbol = cell.symbol().chars().next().unwrap_or(' ');
        let underlined = cell.modifier.contains(Modifier::UNDERLINED);
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let line = underlined && y == HEIGHT - 1;
                let part = if line { 1.0 } else { coverage(symbol, x, y) };
                let at = (top + y) * picture.width + left + x;
                picture.pixels[at] = mixed(paper, ink, part);
            }
        }
    }
    picture
}

/// Of letters and of the ground.
fn colors(cell: &Cell) -> ([u8; 3], [u8; 3]) {
    let ink = rgb(cell.fg).unwrap_or(INK);
    let paper = rgb(cell.bg).unwrap_or(PAPER);
    let (ink, paper) = if cell.modifier.contains(Modifier::REVERSED) {
        (paper, ink)
    } else {
        (ink, paper)
    };
    let is_dim = cell.modifier.contains(Modifier::DIM);
    let ink = if is_dim { mixed(paper, ink, 0.6) } else { ink };
    (ink, paper)
}

fn mixed(paper: [u8; 3], ink: [u8; 3], part: f32) -> [u8; 3] {
    std::array::from_fn(|i| {
        let (from, to) = (f32::from(paper[i]), f32::from(ink[i]));
        (from + (to - from) * part).round() as u8
    })
}

/// None for the terminal's own.
fn rgb(color: Color) -> Option<[u8; 3]> {
    Some(match color {
        Color::Reset => return None,
        Color::Rgb(r, g, b) => [r, g, b],
        Color::Indexed(index @ 16..=231) => {
            let level = |steps: u8| [0, 95, 135, 175, 215, 255][usize::from(steps % 6)];
            let index = index - 16;
            [level(index / 36), level(index / 6), level(index)]
        }
        Color::Indexed(index @ 232..) => [8 + 10 * (index - 232); 3],
        Color::Black | Color::Indexed(0) => [0, 0, 0],
        Color::Red | Color::Indexed(1) => [205, 0, 0],
        Color::Green | Color::Indexed(2) => [0, 205, 0],
        Color::Yellow | Color::Indexed(3) => [205, 205, 0],
        Color::Blue | Color::Indexed(4) => [0, 0, 238],
        Color::Magenta | Color::Indexed(5) => [205, 0, 205],
        Color::Cyan | Color::Indexed(6) => [0, 205, 205],
        Color::Gray | Color::Indexed(7) => [229, 229, 229],
        Color::DarkGray | Color::Indexed(8) => [127, 127, 127],
        Color::LightRed | Color::Indexed(9) => [255, 0, 0],
        Color::LightGreen | Color::Indexed(10) => [0, 255, 0],
        Color::LightYellow | Color::Indexed(11) => [255, 255, 0],
        Color::LightBlue | Color::Indexed(12) => [92, 92, 255],
        Color::LightMagenta | Color::Indexed(13) => [255, 0, 255],
        Color::LightCyan | Color::Indexed(14) => [0, 255, 255],
        Color::White | Color::Indexed(15) => [255, 255, 255],
    })
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;
    use ratatui::style::Style;

    use super::*;

    #[test]
    fn a_half_block_is_two_pixels_of_the_frame_in_their_own_colours() {
        let mut buf = Buffer::with_lines(["▀ "]);
        let style = Style::new().fg(Color::Rgb(1, 2, 3)).bg(Color::Rgb(4, 5, 6));
        buf.set_style(Rect::new(0, 0, 1, 1), style);
        let picture = of_cells(&buf);
        assert_eq!((picture.width, picture.height), (16, 16));
        let at = |x: usize, y: usize| picture.pixels[y * 16 + x];
        assert_eq!([at(0, 0), at(7, 7)], [[1, 2, 3]; 2]);
        assert_eq!([at(0, 8), at(7, 15)], [[4, 5, 6]; 2]);
        assert_eq!(at(8, 0), PAPER);
    }

    #[test]
    fn colours_of_every_kind_have_values() {
        assert_eq!(rgb(Color::Reset), None);
        assert_eq!(rgb(Color::Indexed(16)), Some([0; 3]));
        assert_eq!(rgb(Color::Indexed(231)), Some([255; 3]));
        assert_eq!(rgb(Color::Indexed(208)), Some([255, 135, 0]));
        assert_eq!(rgb(Color::Indexed(255)), Some([238; 3]));
        assert_eq!(rgb(Color::Indexed(9)), rgb(Color::LightRed));
    }
}
