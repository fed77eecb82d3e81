//! Camera messages to grey frames.

use std::io::Cursor;

use image::{DynamicImage, ImageReader};

use super::cdr;
use crate::episode::Frame;

/// No camera's sides; a header that claims more is nonsense.
const SIDE_LIMIT: u32 = 1 << 14;
/// Bytes a decoded picture may take.
const MEMORY_LIMIT: u64 = 1 << 30;

/// A raw image in grey.
///
/// # Errors
/// A phrase that says what does not fit.
pub(super) fn grey(image: &cdr::Image<'_>) -> Result<Frame, String> {
    let sides = 1..=SIDE_LIMIT;
    if !sides.contains(&image.width) || !sides.contains(&image.height) {
        return Err(format!(
            "an image of {} x {} pixels",
            image.width, image.height
        ));
    }
    let (width, height) = (image.width as usize, image.height as usize);
    let step = image.step as usize;
    let (bytes, value): (usize, fn(&[u8]) -> u8) = match (image.encoding, image.is_bigendian) {
        ("mono8" | "8UC1", _) => (1, |p| p[0]),
        ("rgb8", _) => (3, |p| luma(p[0], p[1], p[2])),
        ("bgr8", _) => (3, |p| luma(p[2], p[1], p[0])),
        ("rgba8", _) => (4, |p| luma(p[0], p[1], p[2])),
        ("bgra8", _) => (4, |p| luma(p[2], p[1], p[0])),
        ("mono16" | "16UC1", 0) => (2, |p| high(u16::from_le_bytes([p[0], p[1]]))),
        ("mono16" | "16UC1", _) => (2, |p| high(u16::from_be_bytes([p[0], p[1]]))),
        (other, _) => {
            return Err(format!(
                "image encoding {other:?}; mono8, mono16, rgb8, bgr8, rgba8 and bgra8 can be read"
            ));
        }
    };
    // The last row need not be padded to the step.
    let needed = step * (height - 1) + width * bytes;
    if step < width * bytes || image.data.len() < needed {
        return Err(format!(
            "an image of {width} x {height} in {} with rows of {step} bytes holds {} bytes",
            image.encoding,
            image.data.len()
        ));
    }
    let mut pixels = Vec::with_capacity(width * height);
    for row in image.data.chunks(step).take(height) {
        match bytes {
            1 => pixels.extend_from_slice(&row[..width]),
            _ => pixels.extend(row[..width * bytes].chunks_exact(bytes).map(value)),
        }
    }
    Ok(Frame {
        width,
        height,
        pixels,
    })
}

/// A PNG or JPEG picture in grey; its bytes say which.
///
/// # Errors
/// A phrase that says what does not fit.
pub(super) fn grey_from_compressed(bytes: &[u8]) -> Result<Frame, String> {
    let said = |error: &dyn std::fmt::Display| format!("a picture that is no PNG or JPEG: {error}");
    let mut reader = ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| said(&error))?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(SIDE_LIMIT);
    limits.max_image_height = Some(SIDE_LIMIT);
    limits.max_alloc = Some(MEMORY_LIMIT);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| said(&error))?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = match picture {
        DynamicImage::ImageLuma8(grey) => grey.into_raw(),
        DynamicImage::ImageLuma16(grey) => grey.into_raw().into_iter().map(high).collect(),
        colour => colour
            .to_rgb8()
            .pixels()
            .map(|p| luma(p[0], p[1], p[2]))
            .collect(),
    };
    Ok(Frame {
        width,
        height,
        pixels,
    })
}

/// Rec. 601 luma, rounded.
fn luma(r: u8, g: u8, b: u8) -> u8 {
    ((u32::from(r) * 299 + u32::from(g) * 587 + u32::from(b) * 114 + 500) / 1000) as u8
}

/// The nearest 8-bit grey.
fn high(value: u16) -> u8 {
    ((u32::from(value) + 128) / 257) as u8
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;

    fn raw<'a>(encoding: &'a str, step: u32, data: &'a [u8]) -> cdr::Image<'a> {
        cdr::Image {
            header: cdr::Header::new(0, "").unwrap(),
            height: 2,
            width: 2,
            encoding,
            is_bigendian: u8::from(step == 5),
            step,
            data,
        }
    }

    #[test]
    fn every_encoding_and_the_row_step_are_read() {
        let frame = |encoding, step, data: &[u8]| grey(&raw(encoding, step, data)).unwrap().pixels;
        assert_eq!(frame("mono8", 3, &[1, 2, 9, 3, 4]), [1, 2, 3, 4]);
        let red_blue = [255, 0, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0];
        assert_eq!(frame("rgb8", 6, &red_blue), [76, 29, 255, 0]);
        assert_eq!(frame("bgr8", 6, &red_blue), [29, 76, 255, 0]);
        let with_alpha = [255, 0, 0, 7, 0, 0, 255, 7, 255, 255, 255, 7, 0, 0, 0, 7];
        assert_eq!(frame("rgba8", 8, &with_alpha), [76, 29, 255, 0]);
        assert_eq!(frame("bgra8", 8, &with_alpha), [29, 76, 255, 0]);
        let little = [0, 0, 255, 255, 0, 128, 1, 0];
        assert_eq!(frame("mono16", 4, &little), [0, 255, 128, 0]);
        let big = [0, 0, 255, 255, 9, 128, 0, 0, 1];
        assert_eq!(frame("mono16", 5, &big), [0, 255, 128, 0]);
    }

    #[test]
    fn an_image_that_is_too_short_is_refused() {
        assert!(grey(&raw("mono8", 2, &[1, 2, 3])).is_err());
        assert!(grey(&raw("mono8", 1, &[1, 2, 3, 4])).is_err());
        assert!(
            grey(&raw("bayer_rggb8", 2, &[1, 2, 3, 4]))
                .unwrap_err()
                .contains("bayer")
        );
        assert!(grey_from_compressed(b"nothing of the kind").is_err());
    }

    #[test]
    fn compressed_pictures_are_read() {
        let picture = image::GrayImage::from_raw(2, 2, vec![0, 85, 170, 255]).unwrap();
        let mut png = Cursor::new(Vec::new());
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let frame = grey_from_compressed(png.get_ref()).unwrap();
        assert_eq!(frame.pixels, [0, 85, 170, 255]);
        let mut jpeg = Cursor::new(Vec::new());
        let flat = image::GrayImage::from_pixel(8, 8, image::Luma([90]));
        flat.write_to(&mut jpeg, image::ImageFormat::Jpeg).unwrap();
        let frame = grey_from_compressed(jpeg.get_ref()).unwrap();
        assert!(frame.pixels.iter().all(|p| p.abs_diff(90) <= 2));
    }
}
