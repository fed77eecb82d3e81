//! A small plot: round numbers beside two axes, lines of braille dots, marks in cells.
//!
//! ```text
//! 30│   ⢀⠤⠤⠤⣀
//! 25│●⠤⠔⠁    ⠉◆
//!   └+1   +5   +11
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::braille::{Canvas, Stroke};
use super::paint::{put, right, text, width};
use super::scale::Scale;
use super::theme::dim;

/// The smallest plane that says anything, in cells.
const SMALLEST: (u16, u16) = (6, 2);

/// What has been drawn so far.
pub struct Plot {
    pane: Rect,
    plane: Rect,
    gutter: u16,
    x: Scale,
    y: Scale,
    canvas: Canvas,
    marks: Vec<(u16, u16, char, Style)>,
}

impl Plot {
    /// An empty plot over a pane, its labels included; none where there is no room for one.
    pub fn new(pane: Rect, x: Scale, y: Scale) -> Option<Self> {
        let rows = pane.height.checked_sub(1)?;
        let widest = y.ticks(usize::from(rows / 2).max(1));
        let gutter = widest.iter().map(|(_, label)| width(label)).max()? + 1;
        let plane = Rect {
            x: pane.x + gutter.min(pane.width),
            width: pane.width.saturating_sub(gutter),
            height: rows,
            ..pane
        };
        (plane.width >= SMALLEST.0 && plane.height >= SMALLEST.1).then(|| Self {
            pane,
            plane,
            gutter,
            x,
            y,
            canvas: Canvas::new(plane.width, plane.height),
            marks: Vec::new(),
        })
    }

    /// The dots of a point.
    fn dot(&self, (x, y): (f32, f32)) -> (f32, f32) {
        let (width, height) = self.canvas.dots();
        (
            self.x.part(x) * (width - 1) as f32,
            (1.0 - self.y.part(y)) * (height - 1) as f32,
        )
    }

    /// A line through the points; one that is not finite breaks it.
    pub fn line(&mut self, points: &[(f32, f32)], stroke: Stroke, style: Style) {
        let dots: Vec<(f32, f32)> = points.iter().map(|&point| self.dot(point)).collect();
        self.canvas.path(&dots, stroke, style);
    }

    /// A character at a point, if it is within the plot.
    pub fn mark(&mut self, point: (f32, f32), symbol: char, style: Style) {
        let (x, y) = self.dot(point);
        let (width, height) = self.canvas.dots();
        let inside = |at: f32, size: usize| at.is_finite() && at > -0.5 && at < size as f32 - 0.4;
        if inside(x, width) && inside(y, height) {
            let (column, row) = ((x.round() / 2.0) as u16, (y.round() / 4.0) as u16);
            self.marks.push((column, row, symbol, style));
        }
    }

    /// A level all along the plot.
    pub fn level(&mut self, y: f32, stroke: Stroke, style: Style) {
        self.line(&[(self.x.low, y), (self.x.high, y)], stroke, style);
    }

    /// A thin line from bottom to top, behind everything that is drawn after it.
    pub fn upright(&mut self, x: f32, style: Style) {
        self.line(&[(x, self.y.low), (x, self.y.high)], Stroke::Dotted, style);
    }

    /// Marks the cells between two levels that are still empty with a dot each.
    pub fn shade(&mut self, low: f32, high: f32) {
        let (_, height) = self.canvas.dots();
        let rows = (height / 4) as u16;
        let level = |value: f32| self.dot((self.x.low, value)).1 / 4.0;
        let (top, bottom) = (level(high), level(low));
        let empty: Vec<(u16, u16)> = (0..rows)
            .filter(|&row| f32::from(row) + 0.6 > top && f32::from(row) + 0.4 < bottom)
            .flat_map(|row| (0..self.plane.width).map(move |column| (column, row)))
            .filter(|&(column, row)| self.canvas.is_empty(column, row))
            .collect();
        for (column, row) in empty {
            let (x, y) = (f32::from(column) * 2.0, f32::from(row) * 4.0 + 2.0);
            self.canvas.dot(x, y, dim());
        }
    }

    /// Draws everything, with these labels below; those that would touch another are left out.
    pub fn draw(self, buf: &mut Buffer, x_labels: &[(f32, String)]) {
        let rows = self.plane.height;
        for row in 0..rows {
            put(buf, self.pane, self.gutter - 1, row, '│', dim());
        }
        let mut last = None;
        for (value, label) in self.y.ticks(usize::from(rows / 2).max(1)) {
            let row = (self.dot((self.x.low, value)).1.max(0.0) / 4.0) as u16;
            if row < rows && last != Some(row) {
                right(buf, self.pane, self.gutter - 1, row, &label, dim());
                last = Some(row);
            }
        }
        put(buf, self.pane, self.gutter - 1, rows, '└', dim());
        let mut free = self.gutter;
        for (value, label) in x_labels {
            let centre = (self.dot((*value, self.y.low)).0.max(0.0) / 2.0) as u16 + self.gutter;
            let length = width(label);
            let latest = self.pane.width.saturating_sub(length);
            let at = centre
                .saturating_sub(length / 2)
                .clamp(self.gutter.min(latest), latest);
            if at >= free {
                free = text(buf, self.pane, at, rows, label, dim()) + 1;
            }
        }
        self.canvas.draw(buf, self.plane);
        for (column, row, symbol, style) in self.marks {
            put(buf, self.plane, column, row, symbol, style);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_marks_and_labels_meet_at_the_same_place() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 12, 4));
        let (x, y) = (Scale::linear(1.0, 3.0), Scale::linear(0.0, 10.0));
        if let Some(mut plot) = Plot::new(buf.area, x, y) {
            plot.line(
                &[(1.0, 0.0), (2.0, 0.0), (f32::NAN, 0.0), (3.0, 10.0)],
                Stroke::Solid,
                Style::new(),
            );
            plot.mark((3.0, 10.0), '◆', Style::new());
            plot.mark((9.0, 10.0), '×', Style::new());
            plot.draw(&mut buf, &[(1.0, "+1".to_owned()), (3.0, "+3".to_owned())]);
        }
        let expected = [
            "10│        ◆",
            "  │         ",
            " 0│⣀⣀⣀⣀⣀    ",
            "  └+1     +3",
        ];
        assert_eq!(
            super::super::print::to_text(&buf, false),
            super::super::print::to_text(&Buffer::with_lines(expected), false)
        );
    }

    #[test]
    fn there_is_no_plot_without_room() {
        let scale = Scale::linear(0.0, 1.0);
        for (width, height) in [(0, 0), (3, 9), (30, 2), (7, 3)] {
            assert!(Plot::new(Rect::new(0, 0, width, height), scale, scale).is_none());
        }
    }
}
