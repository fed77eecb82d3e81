//! A canvas of braille dots, two by four to a cell: lines whole, dashed or dotted, in one colour a cell.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::paint::put;

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// Every dot.
    Solid,
    /// Three dots on, three off.
    Dashed,
    /// Every third dot.
    Dotted,
    /// Four dots on, a gap, one dot, a gap.
    DashDot,
    /// Every sixth dot.
    Sparse,
}

impl Stroke {
    fn has(self, dot: usize) -> bool {
        match self {
            Self::Solid => true,
            Self::Dashed => dot % 6 < 3,
            Self::Dotted => dot.is_multiple_of(3),
            Self::DashDot => matches!(dot % 9, 0..=3 | 6),
            Self::Sparse => dot.is_multiple_of(6),
        }
    }
}

/// Dots to be drawn over a pane.
#[derive(Debug)]
pub struct Canvas {
    columns: usize,
    rows: usize,
    cells: Vec<(u8, Style)>,
}

impl Canvas {
    /// An empty canvas of so many cells.
    pub fn new(columns: u16, rows: u16) -> Self {
        let (columns, rows) = (usize::from(columns), usize::from(rows));
        Self {
            columns,
            rows,
            cells: vec![(0, Style::new()); columns * rows],
        }
    }

    /// Its size in dots.
    pub fn dots(&self) -> (usize, usize) {
        (self.columns * 2, self.rows * 4)
    }

    /// Sets one dot; outside the canvas nothing happens. The last colour of a cell stays.
    pub fn dot(&mut self, x: f32, y: f32, style: Style) {
        // Bits of the dots of a cell, rows of left and right, as Unicode numbers them.
        const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
        let (width, height) = self.dots();
        let (x, y) = (x.round(), y.round());
        if x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32 {
            let (x, y) = (x as usize, y as usize);
            let cell = &mut self.cells[y / 4 * self.columns + x / 2];
            cell.0 |= BITS[y % 4][x % 2];
            cell.1 = style;
        }
    }

    /// Draws through the points, in dots; the stroke runs on from segment to segment.
    pub fn path(&mut self, points: &[(f32, f32)], stroke: Stroke, style: Style) {
        let (width, height) = self.dots();
        let mut drawn = 0;
        for pair in points.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            let length = (x1 - x0).abs().max((y1 - y0).abs());
            if !length.is_finite() {
                continue;
            }
            // A segment far outside need not be walked dot by dot.
            let steps = length.ceil().min(4.0 * (width + height) as f32).max(1.0) as usize;
            for i in 0..=steps {
                let t = i as f32 / steps as f32;
                if stroke.has(drawn + i) {
                    self.dot(x0 + (x1 - x0) * t, y0 + (y1 - y0) * t, style);
                }
            }
            drawn += steps;
        }
    }

    /// Whether nothing has been drawn in a cell.
    pub fn is_empty(&self, column: u16, row: u16) -> bool {
        let (column, row) = (usize::from(column), usize::from(row));
        column < self.columns
            && self
                .cells
                .get(row * self.columns + column)
                .is_some_and(|cell| cell.0 == 0)
    }

    /// Writes the dots into the pane's upper left corner.
    pub fn draw(&self, buf: &mut Buffer, pane: Rect) {
        for (i, &(bits, style)) in self.cells.iter().enumerate() {
            if bits != 0
                && let Some(symbol) = char::from_u32(0x2800 + u32::from(bits))
            {
                let (column, row) = (i % self.columns, i / self.columns);
                put(buf, pane, column as u16, row as u16, symbol, style);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(stroke: Stroke) -> Buffer {
        let mut canvas = Canvas::new(6, 1);
        canvas.path(&[(0.0, 3.0), (11.0, 3.0)], stroke, Style::new());
        let mut buf = Buffer::empty(Rect::new(0, 0, 6, 1));
        let pane = buf.area;
        canvas.draw(&mut buf, pane);
        buf
    }

    #[test]
    fn strokes_differ_without_colour() {
        assert_eq!(drawn(Stroke::Solid), Buffer::with_lines(["⣀⣀⣀⣀⣀⣀"]));
        assert_eq!(drawn(Stroke::Dashed), Buffer::with_lines(["⣀⡀ ⣀⡀ "]));
        assert_eq!(drawn(Stroke::Dotted), Buffer::with_lines(["⡀⢀ ⡀⢀ "]));
        assert_eq!(drawn(Stroke::DashDot), Buffer::with_lines(["⣀⣀ ⡀⢀⣀"]));
        assert_eq!(drawn(Stroke::Sparse), Buffer::with_lines(["⡀  ⡀  "]));
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let mut canvas = Canvas::new(1, 1);
        canvas.path(
            &[(-1e30, 0.0), (1e30, f32::NAN)],
            Stroke::Solid,
            Style::new(),
        );
        canvas.dot(2.0, 0.0, Style::new());
        canvas.dot(0.0, -1.0, Style::new());
        assert_eq!(canvas.cells[0].0, 0);
    }
}
