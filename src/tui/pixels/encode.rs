//! A raster as an image in the terminal's own format: the part of the work that takes time, done on a thread.

use image::{DynamicImage, Rgba, RgbaImage};
use ratatui::layout::Size;
use ratatui_image::Resize;
use ratatui_image::picker::{Picker, ProtocolType};

use super::ask::Graphics;
use super::cache::Made;
use super::kitty::Payload;
use crate::tui::image::Raster;

/// A pixel becomes at most so many on a side; what is missing then blurs an eighth of it.
const LARGEST: usize = 8;

/// Enlarges for so many cells, edges kept sharp, and encodes; none if that cannot be done.
pub fn encode(graphics: Graphics, raster: &Raster, cells: Size) -> Option<Made> {
    let room = [
        usize::from(cells.width) * usize::from(graphics.cell.0),
        usize::from(cells.height) * usize::from(graphics.cell.1),
    ];
    if graphics.protocol == ProtocolType::Kitty {
        // Without deflating, every repeated pixel would be sent.
        let most = if graphics.zlib { LARGEST } else { 1 };
        let large = by_whole_factor(raster, room, most);
        let rgb: Vec<u8> = pixels(&large).flatten().collect();
        let payload = Payload::new(large.width, large.height, &rgb, graphics.zlib);
        return Some(Made::Kitty(payload));
    }
    let large = to_fill(raster, room);
    let mut image = RgbaImage::new(room[0] as u32, room[1] as u32);
    for (i, [r, g, b]) in pixels(&large).enumerate() {
        let (column, row) = (i % large.width, i / large.width);
        if let Some(pixel) = image.get_pixel_mut_checked(column as u32, row as u32) {
            *pixel = Rgba([r, g, b, u8::MAX]);
        }
    }
    let image = DynamicImage::ImageRgba8(image);
    let encoded = picker(graphics).new_protocol(image, cells, Resize::Fit(None));
    encoded.ok().map(Made::Cells)
}

/// For a terminal that fits an image into its cells itself, smoothly. Repeated pixels deflate to almost nothing, while
/// mixed ones, as an uneven factor makes them, treble what is sent; so the terminal does what is left.
fn by_whole_factor(raster: &Raster, room: [usize; 2], most: usize) -> Raster {
    let factor = (room[0] / raster.width).min(room[1] / raster.height);
    if factor == 0 {
        return to_fill(raster, room);
    }
    let factor = factor.min(most);
    raster.resize(raster.width * factor, raster.height * factor)
}

/// In as many pixels of the room as its shape allows.
fn to_fill(raster: &Raster, room: [usize; 2]) -> Raster {
    let scale = (room[0] as f32 / raster.width as f32).min(room[1] as f32 / raster.height as f32);
    let pixels = |side: usize| ((side as f32 * scale) as usize).max(1);
    raster.resize(pixels(raster.width), pixels(raster.height))
}

fn pixels(raster: &Raster) -> impl Iterator<Item = [u8; 3]> {
    raster.values.iter().map(|&value| {
        let (r, g, b) = raster.rgb(value);
        [r, g, b]
    })
}

/// A picker that has not read the terminal's input, as every other way to one would.
fn picker(graphics: Graphics) -> Picker {
    #[expect(deprecated, reason = "the terminal has been asked already")]
    let mut picker = Picker::from_fontsize(graphics.cell.into());
    picker.set_protocol_type(graphics.protocol);
    picker
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    fn raster(width: usize, height: usize) -> Raster {
        Raster {
            width,
            height,
            values: (0..width * height).map(|i| (i % 5) as f32 / 4.0).collect(),
            signed: false,
        }
    }

    #[test]
    fn sixel_and_iterm2_fill_the_cells_they_were_asked_for() {
        for protocol in [ProtocolType::Sixel, ProtocolType::Iterm2] {
            let graphics = Graphics {
                protocol,
                cell: (10, 20),
                zlib: false,
                tmux: false,
            };
            let made = encode(graphics, &raster(2, 2), Size::new(8, 4)).unwrap();
            let Made::Cells(encoded) = made else {
                panic!("{protocol:?} is written into cells");
            };
            assert_eq!(encoded.size(), Size::new(8, 4), "{protocol:?}");
        }
    }

    #[test]
    fn enlarging_is_by_whole_factors_where_the_terminal_does_the_rest() {
        let size = |room| {
            let large = by_whole_factor(&raster(64, 32), room, LARGEST);
            (large.width, large.height)
        };
        assert_eq!(size([180, 180]), (128, 64));
        assert_eq!(size([64, 32]), (64, 32));
        assert_eq!(size([32, 60]), (32, 16));
        assert_eq!(size([5000, 5000]), (512, 256));
        let exact = to_fill(&raster(64, 32), [180, 180]);
        assert_eq!((exact.width, exact.height), (180, 90));
    }
}
