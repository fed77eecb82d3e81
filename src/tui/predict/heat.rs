//! A map of magnitudes: dark blue to yellow, even in lightness and safe for the colour-blind (cividis).

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};

use super::super::image::Raster;
use super::super::paint::put;
use super::super::theme::{Depth, Rgb};

/// Values that have the full colour, the smallest that holds the data is taken: the range is steady, and printed.
const RANGES: [f32; 6] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0];

/// Colours at equal distances.
const CIVIDIS: [Rgb; 6] = [
    (0, 34, 78),
    (53, 69, 108),
    (102, 105, 112),
    (148, 143, 120),
    (200, 184, 102),
    (254, 232, 56),
];

/// The range for these values.
pub fn range(values: &[f32]) -> f32 {
    let most = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .fold(0.0, f32::max);
    RANGES
        .into_iter()
        .find(|&range| most <= range)
        .unwrap_or(1.0)
}

/// Draws a map of so many columns, as large as it fits; nothing where the size lies.
pub fn draw(buf: &mut Buffer, pane: Rect, (width, values): (usize, &[f32]), depth: Depth) {
    let range = range(values);
    let height = values.len() / width.max(1);
    if pane.is_empty() || values.is_empty() || height * width != values.len() {
        return;
    }
    let raster = Raster {
        width,
        height,
        values: values
            .iter()
            .map(|value| (value / range).clamp(0.0, 1.0))
            .collect(),
        signed: false,
    };
    if !depth.has_shades() {
        raster.draw(buf, pane, depth);
        return;
    }
    let (columns, rows) = raster.fit(pane.width, pane.height);
    let small = raster.resize(columns, rows);
    for row in 0..rows.div_ceil(2) {
        for column in 0..columns {
            let color = |row: usize| {
                let value = small.values.get(row * columns + column);
                value.map_or(Color::Reset, |&value| depth.color(rgb(value)))
            };
            let style = Style::new().fg(color(2 * row)).bg(color(2 * row + 1));
            put(buf, pane, column as u16, row as u16, '▀', style);
        }
    }
}

/// The colour of a part of the range.
fn rgb(value: f32) -> Rgb {
    let at = value.clamp(0.0, 1.0) * (CIVIDIS.len() - 1) as f32;
    let low = (at as usize).min(CIVIDIS.len() - 2);
    let part = at - low as f32;
    let mix = |a: u8, b: u8| (f32::from(a) + (f32::from(b) - f32::from(a)) * part).round() as u8;
    let (a, b) = (CIVIDIS[low], CIVIDIS[low + 1]);
    (mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_rises_all_along_the_ramp() {
        let light = |i: u8| {
            let (r, g, b) = rgb(f32::from(i) / 20.0);
            0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
        };
        assert!((0..20).all(|i| light(i) < light(i + 1)));
    }

    #[test]
    fn the_range_is_the_smallest_that_holds_the_values() {
        assert!((range(&[0.03, f32::NAN]) - 0.05).abs() < 1e-6);
        assert!((range(&[7.0]) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_map_whose_size_lies_is_not_drawn() {
        let mut buf = Buffer::empty(Rect::new(0, 0, 4, 2));
        let pane = buf.area;
        draw(&mut buf, pane, (3, &[0.1; 4]), Depth::True);
        draw(&mut buf, pane, (0, &[0.1; 4]), Depth::True);
        assert_eq!(buf, Buffer::empty(pane));
    }
}
