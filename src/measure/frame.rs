//! How far two frames are apart. Grey values count as 0 to 1, whatever they are stored as.

use crate::episode::Frame;

/// Below this mean squared error two frames count as equal, so that PSNR stays finite (100 dB).
pub const MSE_FLOOR: f64 = 1e-10;

/// The signed error that has the full colour, as a part of the grey range; beyond it the colour stays.
pub const ERROR_RANGE: f32 = 0.5;

/// The colour of a signed error, a part of [`ERROR_RANGE`]: blue where too dark, white where right, orange where too
/// bright.
pub fn error_rgb(part: f32) -> [u8; 3] {
    const BLUE: [u8; 3] = [33, 102, 172];
    const ORANGE: [u8; 3] = [230, 97, 1];
    let part = part.clamp(-1.0, 1.0);
    let end = if part < 0.0 { BLUE } else { ORANGE };
    end.map(|channel| (255.0 + (f32::from(channel) - 255.0) * part.abs()).round() as u8)
}

/// Sum of squared differences over all pixels; none where the sizes differ.
pub fn squared_error(a: &Frame, b: &Frame) -> Option<f64> {
    if (a.width, a.height) != (b.width, b.height) || a.pixels.len() != b.pixels.len() {
        return None;
    }
    let sum: u64 = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .map(|(&x, &y)| u64::from(x.abs_diff(y)).pow(2))
        .sum();
    Some(sum as f64 / (255.0 * 255.0))
}

/// Peak signal-to-noise ratio in dB for a data range of 1; none where the sizes differ or there is no pixel.
pub fn psnr_db(a: &Frame, b: &Frame) -> Option<f32> {
    if a.pixels.is_empty() {
        return None;
    }
    squared_error(a, b).map(|sum| psnr_db_from_mse(sum / a.pixels.len() as f64) as f32)
}

/// PSNR in dB of a mean squared error of values in 0 to 1; NaN stays NaN.
pub fn psnr_db_from_mse(mse: f64) -> f64 {
    // Not `max`, which would make the best score of it.
    let floored = if mse < MSE_FLOOR { MSE_FLOOR } else { mse };
    -10.0 * floored.log10()
}

/// `a - b` in grey levels, -255 to 255, row major; none where the sizes differ.
pub fn signed_difference(a: &Frame, b: &Frame) -> Option<Vec<i16>> {
    let same = (a.width, a.height) == (b.width, b.height) && a.pixels.len() == b.pixels.len();
    same.then(|| {
        a.pixels
            .iter()
            .zip(&b.pixels)
            .map(|(&x, &y)| i16::from(x) - i16::from(y))
            .collect()
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;

    fn grey(pixels: [u8; 4]) -> Frame {
        Frame {
            width: 2,
            height: 2,
            pixels: pixels.to_vec(),
        }
    }

    #[test]
    fn psnr_of_known_errors() {
        let black = grey([0; 4]);
        assert!((psnr_db(&black, &black).unwrap() - 100.0).abs() < 1e-4);
        assert!(psnr_db(&black, &grey([255; 4])).unwrap().abs() < 1e-4);
        // One of four pixels wrong by everything: MSE 1/4, 6.0206 dB.
        assert!((psnr_db(&black, &grey([255, 0, 0, 0])).unwrap() - 6.0206).abs() < 1e-4);
        assert!(psnr_db_from_mse(f64::NAN).is_nan());
    }

    #[test]
    fn frames_of_different_size_cannot_be_compared() {
        let flat = Frame {
            width: 4,
            height: 1,
            pixels: vec![0; 4],
        };
        assert_eq!(squared_error(&flat, &grey([0; 4])), None);
        assert_eq!(psnr_db(&flat, &grey([0; 4])), None);
        assert_eq!(signed_difference(&flat, &grey([0; 4])), None);
    }

    #[test]
    fn a_difference_keeps_its_sign() {
        let difference = signed_difference(&grey([0, 255, 7, 7]), &grey([255, 0, 7, 9]));
        assert_eq!(difference.unwrap(), [-255, 255, 0, -2]);
    }
}
