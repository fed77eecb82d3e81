//! Sampled predictions as images (D22): their mean, their spread, and whether a prediction is a blurry average.
//!
//! Which samples is the caller's choice: the same seed for every variant that is compared.

use crate::episode::Frame;

/// The mean of frames of one size, rounded to grey levels; none for no frame, different sizes or pixels that do not
/// fill their frame.
pub fn mean_frame(frames: &[&Frame]) -> Option<Frame> {
    let first = common(frames)?;
    let pixels = (0..first.pixels.len())
        .map(|i| mean_at(frames, i).round() as u8)
        .collect();
    Some(Frame {
        width: first.width,
        height: first.height,
        pixels,
    })
}

/// The standard deviation of each pixel over frames (squares divided by their number less one), in grey 0 to 1, row
/// major; none for fewer than two frames or where [`mean_frame`] has none.
pub fn spread_frame(frames: &[&Frame]) -> Option<Vec<f32>> {
    let first = common(frames).filter(|_| frames.len() > 1)?;
    let spread = |i: usize| {
        let mean = mean_at(frames, i);
        let squares: f64 = frames
            .iter()
            .map(|frame| (f64::from(frame.pixels[i]) - mean).powi(2))
            .sum();
        ((squares / (frames.len() - 1) as f64).sqrt() / 255.0) as f32
    };
    Some((0..first.pixels.len()).map(spread).collect())
}

/// ∇-energy: the sum of squared differences between neighbouring pixels, to the right and below, in grey 0 to 1.
/// Zero for a frame whose pixels do not fill it.
pub fn gradient_energy(frame: &Frame) -> f64 {
    let Some(width) = common(&[frame]).map(|frame| frame.width) else {
        return 0.0;
    };
    let squared = |a: &u8, b: &u8| u64::from(a.abs_diff(*b)).pow(2);
    let right: u64 = frame
        .pixels
        .chunks_exact(width)
        .flat_map(|row| row.iter().zip(&row[1..]))
        .map(|(a, b)| squared(a, b))
        .sum();
    let below: u64 = frame
        .pixels
        .iter()
        .zip(&frame.pixels[width..])
        .map(|(a, b)| squared(a, b))
        .sum();
    (right + below) as f64 / (255.0 * 255.0)
}

/// ∇-energy of the prediction over that of the truth: below one, the prediction is blurrier than what was recorded.
/// None where the sizes differ or the truth is flat.
pub fn blur_index(predicted: &Frame, truth: &Frame) -> Option<f32> {
    common(&[predicted, truth])?;
    let energy = gradient_energy(truth);
    (energy > 0.0).then(|| (gradient_energy(predicted) / energy) as f32)
}

/// The first frame, where all have its size, at least one pixel, and as many pixels as that says.
fn common<'a>(frames: &[&'a Frame]) -> Option<&'a Frame> {
    let first = frames.first()?;
    let count = first.width.checked_mul(first.height).filter(|&n| n > 0)?;
    frames
        .iter()
        .all(|f| (f.width, f.height, f.pixels.len()) == (first.width, first.height, count))
        .then_some(first)
}

/// Mean grey level, 0 to 255, of pixel `i`.
fn mean_at(frames: &[&Frame], i: usize) -> f64 {
    let sum: u64 = frames.iter().map(|frame| u64::from(frame.pixels[i])).sum();
    sum as f64 / frames.len() as f64
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;

    fn grey<const N: usize>(width: usize, pixels: [u8; N]) -> Frame {
        Frame {
            width,
            height: N / width,
            pixels: pixels.to_vec(),
        }
    }

    #[test]
    fn mean_and_spread_of_two() {
        let (a, b) = (grey(2, [0, 100, 255, 7]), grey(2, [255, 103, 255, 7]));
        assert_eq!(mean_frame(&[&a, &b]).unwrap().pixels, [128, 102, 255, 7]);
        let spread = spread_frame(&[&a, &b]).unwrap();
        // Two values are √2/2 of their difference apart from each other in this sense.
        let expected = [1.0, 3.0 / 255.0, 0.0, 0.0].map(|x| x * 0.5_f32.sqrt());
        for (ours, expected) in spread.iter().zip(expected) {
            assert!((ours - expected).abs() < 1e-6);
        }
        assert_eq!(spread_frame(&[&a]), None);
        assert_eq!(mean_frame(&[&a]), Some(a));
    }

    #[test]
    fn a_blurred_edge_has_less_gradient() {
        let edge = grey(4, [0, 0, 255, 255, 0, 0, 255, 255]);
        let blurred = grey(4, [0, 85, 170, 255, 0, 85, 170, 255]);
        assert!((gradient_energy(&edge) - 2.0).abs() < 1e-12);
        // Three steps of a third in each of two rows.
        assert!((gradient_energy(&blurred) - 2.0 / 3.0).abs() < 1e-12);
        assert!((blur_index(&blurred, &edge).unwrap() - 1.0 / 3.0).abs() < 1e-6);
        assert!((gradient_energy(&grey(1, [0, 255, 255])) - 1.0).abs() < 1e-12);
        assert_eq!(blur_index(&edge, &grey(4, [9; 8])), None);
    }

    #[test]
    fn frames_that_do_not_fit_have_nothing() {
        let (a, b) = (grey(2, [0; 4]), grey(1, [0; 4]));
        let short = Frame {
            width: 2,
            height: 2,
            pixels: vec![1; 3],
        };
        let vast = Frame {
            width: usize::MAX,
            height: 2,
            pixels: vec![],
        };
        let empty = Frame {
            width: 0,
            height: 0,
            pixels: vec![],
        };
        assert_eq!(mean_frame(&[]), None);
        assert_eq!(mean_frame(&[&a, &b]), None);
        assert_eq!(spread_frame(&[&a, &b]), None);
        assert_eq!(blur_index(&a, &b), None);
        for odd in [&short, &vast, &empty] {
            assert_eq!(mean_frame(&[odd]), None);
            assert!(gradient_energy(odd).abs() < 1e-300);
        }
    }
}
