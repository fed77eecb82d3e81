//! Images as cells: two pixels a half-block, or one character of an ASCII ramp where colours do not suffice.
//!
//! Pixels are shrunk by the mean of the area they cover and enlarged by whole factors, nearest neighbour.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};

use super::paint::put;
use super::theme::{Depth, Rgb};
use crate::episode::Frame;
use crate::measure::frame::{ERROR_RANGE, error_rgb};
use crate::session::snapshot::SignedFrame;

/// An image of numbers, row major.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Grey in [0, 1], or a signed error in [-1, 1].
    pub values: Vec<f32>,
    /// Whether the values are signed errors.
    pub signed: bool,
}

impl From<&Frame> for Raster {
    fn from(frame: &Frame) -> Self {
        Self {
            width: frame.width,
            height: frame.height,
            values: frame
                .pixels
                .iter()
                .map(|&grey| f32::from(grey) / 255.0)
                .collect(),
            signed: false,
        }
    }
}

impl From<&SignedFrame> for Raster {
    fn from(frame: &SignedFrame) -> Self {
        let scale = 1.0 / (255.0 * ERROR_RANGE);
        let unit = |&value: &i16| (f32::from(value) * scale).clamp(-1.0, 1.0);
        Self {
            width: frame.width,
            height: frame.height,
            values: frame.values.iter().map(unit).collect(),
            signed: true,
        }
    }
}

impl Raster {
    /// Whether the sizes agree and there is something to show.
    fn is_sound(&self) -> bool {
        !self.values.is_empty() && self.values.len() == self.width * self.height
    }

    /// The largest size in pixels that keeps the aspect within `columns` × `rows` cells of two pixels each.
    pub fn fit(&self, columns: u16, rows: u16) -> (usize, usize) {
        let (columns, rows) = (f32::from(columns), f32::from(rows) * 2.0);
        let (width, height) = (self.width.max(1) as f32, self.height.max(1) as f32);
        let scale = (columns / width).min(rows / height);
        let scale = if scale >= 1.0 { scale.floor() } else { scale };
        let pixels = |size: f32| ((size * scale).round() as usize).max(1);
        (pixels(width), pixels(height))
    }

    /// The same image in another size, by area means (whole factors upwards repeat pixels).
    pub fn resize(&self, width: usize, height: usize) -> Self {
        let columns = spans(self.width, width);
        let rows = spans(self.height, height);
        let mut values = Vec::with_capacity(width * height);
        for row in &rows {
            for column in &columns {
                let (mut sum, mut weight) = (0.0, 0.0);
                for &(y, row_weight) in row {
                    for &(x, column_weight) in column {
                        sum += self.values[y * self.width + x] * row_weight * column_weight;
                        weight += row_weight * column_weight;
                    }
                }
                values.push(sum / weight);
            }
        }
        Self {
            width,
            height,
            values,
            signed: self.signed,
        }
    }

    /// The colour of a value.
    pub fn rgb(&self, value: f32) -> Rgb {
        if self.signed {
            diverging(value)
        } else {
            let grey = (value * 255.0).round() as u8;
            (grey, grey, grey)
        }
    }

    /// Draws into the pane's upper left corner, as large as it fits.
    pub fn draw(&self, buf: &mut Buffer, pane: Rect, depth: Depth) {
        let pane = pane.intersection(buf.area);
        if pane.is_empty() || !self.is_sound() {
            return;
        }
        let (width, height) = self.fit(pane.width, pane.height);
        let small = self.resize(width, height);
        for row in 0..height.div_ceil(2) {
            for column in 0..width {
                let upper = small.values[2 * row * width + column];
                let lower = small.values.get((2 * row + 1) * width + column).copied();
                let (symbol, style) = self.cell(upper, lower, depth);
                put(buf, pane, column as u16, row as u16, symbol, style);
            }
        }
    }

    /// One cell: its upper pixel, and its lower one unless the image ends between them.
    fn cell(&self, upper: f32, lower: Option<f32>, depth: Depth) -> (char, Style) {
        if !depth.has_shades() {
            let mean = lower.map_or(upper, |lower| f32::midpoint(upper, lower));
            // A sign that the character already shows; greys stay in the terminal's own foreground.
            let end = diverging(if mean < 0.0 { -1.0 } else { 1.0 });
            let character = self.character(mean);
            let style = if self.signed && character != ' ' {
                depth.ink(end)
            } else {
                Style::new()
            };
            return (character, style);
        }
        let color = |value: f32| depth.color(self.rgb(value));
        let below = lower.map_or(Color::Reset, color);
        ('▀', Style::new().fg(color(upper)).bg(below))
    }

    /// The character that stands for a value: dark to light, or minus to plus.
    fn character(&self, value: f32) -> char {
        const GREYS: [char; 10] = [' ', '.', ':', '-', '=', '+', '*', '#', '%', '@'];
        const SIGNED: [char; 5] = ['=', '-', ' ', '+', '#'];
        if self.signed {
            SIGNED[((value.clamp(-1.0, 1.0) + 1.0) * 2.0).round() as usize]
        } else {
            GREYS[(value.clamp(0.0, 1.0) * 9.0).round() as usize]
        }
    }
}

/// Blue below zero, white at zero, orange above.
fn diverging(value: f32) -> Rgb {
    error_rgb(value).into()
}

/// For each of `target` pixels the source pixels it covers, with the length covered of each.
fn spans(source: usize, target: usize) -> Vec<Vec<(usize, f32)>> {
    // In units of 1 / target of a source pixel, so that every length is a whole number.
    (0..target)
        .map(|i| {
            let (from, to) = (i * source, (i + 1) * source);
            (from / target..to.div_ceil(target))
                .map(|pixel| {
                    let overlap = to.min((pixel + 1) * target) - from.max(pixel * target);
                    (pixel, overlap as f32)
                })
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raster(width: usize, height: usize, values: &[f32]) -> Raster {
        Raster {
            width,
            height,
            values: values.to_vec(),
            signed: false,
        }
    }

    #[test]
    fn shrinking_takes_the_mean_of_the_area() {
        let image = raster(3, 1, &[0.0, 0.6, 0.9]);
        let small = image.resize(2, 1);
        assert!((small.values[0] - 0.2).abs() < 1e-6);
        assert!((small.values[1] - 0.8).abs() < 1e-6);
    }

    #[test]
    fn enlarging_repeats_pixels_by_whole_factors() {
        let image = raster(2, 2, &[0.0, 1.0, 1.0, 0.0]);
        assert_eq!(image.fit(5, 9), (4, 4));
        let large = image.resize(4, 4);
        assert_eq!(large.values[..4], [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(large.values[12..], [1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_half_block_holds_two_pixels_and_leaves_an_odd_last_row_open() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 1, 2));
        let pane = buf.area;
        raster(1, 3, &[0.0, 1.0, 1.0]).draw(&mut buf, pane, Depth::True);
        assert_eq!(buf[(0, 0)].fg, Color::Rgb(0, 0, 0));
        assert_eq!(buf[(0, 0)].bg, Color::Rgb(255, 255, 255));
        assert_eq!(buf[(0, 1)].fg, Color::Rgb(255, 255, 255));
        assert_eq!(buf[(0, 1)].bg, Color::Reset);
    }

    #[test]
    fn without_colours_signs_and_greys_are_characters() {
        let grey = raster(1, 1, &[1.0]);
        assert_eq!(grey.cell(1.0, Some(1.0), Depth::Plain), ('@', Style::new()));
        let signed = Raster {
            signed: true,
            ..grey
        };
        let shown = |value: f32| signed.cell(value, None, Depth::Plain).0;
        assert_eq!(
            [-1.0, -0.5, 0.0, 0.5, 1.0].map(shown),
            ['=', '-', ' ', '+', '#']
        );
        let colored = |value: f32| signed.cell(value, None, Depth::Sixteen);
        assert_eq!(colored(-1.0), ('=', Style::new().fg(Color::Blue)));
        assert_eq!(colored(1.0), ('#', Style::new().fg(Color::Red)));
    }

    #[test]
    fn errors_are_white_at_zero_and_saturate_at_the_range() {
        assert_eq!(diverging(0.0), (255, 255, 255));
        let error = SignedFrame {
            width: 2,
            height: 1,
            values: vec![-255, 128],
        };
        let raster = Raster::from(&error);
        assert_eq!(raster.rgb(raster.values[0]), diverging(-1.0));
        assert_eq!(raster.rgb(raster.values[1]), diverging(1.0));
    }

    #[test]
    fn a_frame_whose_size_lies_is_not_drawn() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 4, 2));
        let pane = buf.area;
        raster(3, 3, &[0.5]).draw(&mut buf, pane, Depth::True);
        assert_eq!(buf, Buffer::empty(pane));
    }
}
