//! Frames to a model's size: each new pixel is the mean of the area it covers.

use crate::episode::Frame;

/// `frame` as a square of `size` pixels; as it is where it has that size.
pub(in crate::data) fn square(frame: &Frame, size: usize) -> Frame {
    if (frame.width, frame.height) == (size, size) {
        return frame.clone();
    }
    let columns = cover(frame.width, size);
    let rows = cover(frame.height, size);
    // Across each row first: (height, size).
    let narrow: Vec<f32> = frame
        .pixels
        .chunks_exact(frame.width.max(1))
        .flat_map(|row| {
            columns.iter().map(|cover| {
                let covered = row.iter().skip(cover.start);
                let parts = covered.zip(&cover.weights);
                parts
                    .map(|(&pixel, weight)| f32::from(pixel) * weight)
                    .sum::<f32>()
            })
        })
        .collect();
    let mut pixels = Vec::with_capacity(size * size);
    for cover in &rows {
        let mut sums = vec![0.0_f32; size];
        let covered = narrow.chunks_exact(size.max(1)).skip(cover.start);
        for (row, weight) in covered.zip(&cover.weights) {
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += value * weight;
            }
        }
        pixels.extend(sums.iter().map(|sum| sum.round() as u8));
    }
    Frame {
        width: size,
        height: size,
        pixels,
    }
}

/// Which old pixels a new one covers, and each one's share; the shares sum to 1.
struct Cover {
    start: usize,
    weights: Vec<f32>,
}

fn cover(from: usize, to: usize) -> Vec<Cover> {
    let scale = from as f64 / to as f64;
    (0..to)
        .map(|i| {
            let (left, right) = (i as f64 * scale, (i + 1) as f64 * scale);
            let start = left as usize;
            let end = (right.ceil() as usize).min(from);
            let share = |p: usize| (right.min((p + 1) as f64) - left.max(p as f64)) / scale;
            Cover {
                start,
                weights: (start..end).map(|p| share(p) as f32).collect(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(width: usize, height: usize, pixels: &[u8]) -> Frame {
        Frame {
            width,
            height,
            pixels: pixels.to_vec(),
        }
    }

    #[test]
    fn areas_are_averaged() {
        let four = frame(4, 2, &[0, 10, 20, 30, 40, 50, 60, 70]);
        assert_eq!(square(&four, 2).pixels, [5, 25, 45, 65]);
        assert_eq!(square(&four, 1).pixels, [35]);
        let three = frame(3, 3, &[0, 90, 0, 0, 90, 0, 0, 90, 0]);
        // Each half covers one and a half columns.
        assert_eq!(square(&three, 2).pixels, [30, 30, 30, 30]);
    }

    #[test]
    fn the_mean_and_the_size_are_kept() {
        let flat = frame(5, 7, &[77; 35]);
        assert_eq!(square(&flat, 3).pixels, [77; 9]);
        assert_eq!(square(&flat, 16).pixels, [77; 256]);
        let same = frame(2, 2, &[1, 2, 3, 4]);
        assert_eq!(square(&same, 2), same);
    }
}
