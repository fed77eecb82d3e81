//! Pictures as PNG, each pixel so large that nothing smooths it.

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use crate::episode::Frame;
use crate::measure::frame::{ERROR_RANGE, error_rgb};
use crate::session::snapshot::SignedFrame;

/// Pixels of the file along a pixel of the picture.
pub const TIMES: usize = 4;

/// A grey picture.
pub fn grey(frame: &Frame) -> Option<Vec<u8>> {
    let pixels = enlarged::<1>(
        frame.width,
        frame.height,
        frame.pixels.iter().map(|&grey| [grey]),
    );
    encode(frame.width, frame.height, &pixels, ExtendedColorType::L8)
}

/// An error: blue where it is too dark, white where it is right, orange where it is too bright.
pub fn signed(frame: &SignedFrame) -> Option<Vec<u8>> {
    let colors = frame.values.iter();
    let colors = colors.map(|&value| error_rgb(f32::from(value) / (255.0 * ERROR_RANGE)));
    let pixels = enlarged::<3>(frame.width, frame.height, colors);
    encode(frame.width, frame.height, &pixels, ExtendedColorType::Rgb8)
}

fn enlarged<const N: usize>(
    width: usize,
    height: usize,
    pixels: impl Iterator<Item = [u8; N]>,
) -> Vec<u8> {
    let mut out = Vec::with_capacity(width * height * N * TIMES * TIMES);
    let pixels: Vec<[u8; N]> = pixels.collect();
    for row in pixels.chunks(width.max(1)) {
        let start = out.len();
        for pixel in row {
            for _ in 0..TIMES {
                out.extend(pixel);
            }
        }
        let end = out.len();
        for _ in 1..TIMES {
            out.extend_from_within(start..end);
        }
    }
    out
}

/// None for a picture whose pixels do not fit its size.
fn encode(width: usize, height: usize, pixels: &[u8], color: ExtendedColorType) -> Option<Vec<u8>> {
    let side = |pixels: usize| u32::try_from(pixels * TIMES).ok().filter(|&side| side > 0);
    let (width, height) = (side(width)?, side(height)?);
    let expected = u64::from(width) * u64::from(height) * u64::from(color.bits_per_pixel() / 8);
    if pixels.len() as u64 != expected {
        return None;
    }
    let mut file = Vec::new();
    // Most rows are the one above once more.
    let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Up);
    encoder.write_image(pixels, width, height, color).ok()?;
    Some(file)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use super::*;

    #[test]
    fn each_pixel_becomes_a_square() {
        let frame = Frame {
            width: 2,
            height: 1,
            pixels: vec![7, 200],
        };
        let file = grey(&frame).unwrap();
        let picture = image::load_from_memory(&file).unwrap().to_luma8();
        assert_eq!(picture.dimensions(), (8, 4));
        assert_eq!((picture[(3, 3)][0], picture[(4, 0)][0]), (7, 200));
    }

    #[test]
    fn right_is_white_and_both_ways_of_wrong_have_a_colour() {
        let frame = SignedFrame {
            width: 3,
            height: 1,
            values: vec![-255, 0, 255],
        };
        let picture = image::load_from_memory(&signed(&frame).unwrap())
            .unwrap()
            .to_rgb8();
        let color = |x: u32| picture[(4 * x, 0)].0;
        assert_eq!(
            [color(0), color(1), color(2)],
            [[33, 102, 172], [255; 3], [230, 97, 1]]
        );
    }

    #[test]
    fn what_has_no_size_is_no_picture() {
        assert_eq!(
            grey(&Frame {
                width: 0,
                height: 0,
                pixels: Vec::new()
            }),
            None
        );
        assert_eq!(
            grey(&Frame {
                width: 2,
                height: 2,
                pixels: vec![0]
            }),
            None
        );
    }
}
