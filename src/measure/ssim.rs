//! Structural similarity of two images (Wang et al. 2004), as scikit-image's `structural_similarity` has it by default.

/// Side of the uniform window.
const WINDOW: usize = 7;
/// `(K1 L)²` and `(K2 L)²` for a data range L of 1.
const STABLE: [f64; 2] = [0.01 * 0.01, 0.03 * 0.03];

/// Mean over all windows of 7 × 7 pixels that lie within the image, of values in [0, 1]; sample covariances, uniform
/// weights.
///
/// Both are row major of `width` columns. None where their sizes differ, or an image is smaller than a window.
pub fn ssim(a: &[f32], b: &[f32], width: usize) -> Option<f64> {
    let height = a.len() / width.max(1);
    if a.len() != b.len() || a.len() != width * height || width.min(height) < WINDOW {
        return None;
    }
    let pairs = || a.iter().zip(b).map(|(&a, &b)| (f64::from(a), f64::from(b)));
    let sums = [
        window_sums(pairs().map(|(a, _)| a), width),
        window_sums(pairs().map(|(_, b)| b), width),
        window_sums(pairs().map(|(a, _)| a * a), width),
        window_sums(pairs().map(|(_, b)| b * b), width),
        window_sums(pairs().map(|(a, b)| a * b), width),
    ];
    let count = (WINDOW * WINDOW) as f64;
    let windows = sums[0].len();
    let total: f64 = (0..windows)
        .map(|i| {
            let [a, b, aa, bb, ab] = [0, 1, 2, 3, 4].map(|k| sums[k][i] / count);
            // Divided by one less than the pixels of a window.
            let unbiased = count / (count - 1.0);
            let variance = unbiased * (aa - a * a + bb - b * b);
            let covariance = unbiased * (ab - a * b);
            let [c1, c2] = STABLE;
            (2.0 * a * b + c1) * (2.0 * covariance + c2) / ((a * a + b * b + c1) * (variance + c2))
        })
        .sum();
    Some(total / windows as f64)
}

/// The sum over each window that lies within the image, row major.
fn window_sums(values: impl Iterator<Item = f64>, width: usize) -> Vec<f64> {
    let values: Vec<f64> = values.collect();
    let inside = width - WINDOW + 1;
    // Along rows, then down columns.
    let rows: Vec<f64> = values
        .chunks_exact(width)
        .flat_map(|row| row.windows(WINDOW).map(|window| window.iter().sum()))
        .collect();
    let height = rows.len() / inside;
    (0..=height - WINDOW)
        .flat_map(|top| (0..inside).map(move |left| (top, left)))
        .map(|(top, left)| {
            (top..top + WINDOW)
                .map(|row| rows[row * inside + left])
                .sum()
        })
        .collect()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use serde::Deserialize;

    use super::*;
    use crate::measure::frame::psnr_db_from_mse;

    #[derive(Deserialize)]
    struct Known {
        width: usize,
        a: Vec<f32>,
        b: Vec<f32>,
        squared_error: f64,
        ssim: f64,
        psnr_db: f64,
    }

    #[test]
    fn scores_are_those_of_scikit_image() {
        // Written by tests/data/make_image_scores.py.
        let text = include_str!("../../tests/data/image_scores.json");
        let known: Vec<Known> = serde_json::from_str(text).unwrap();
        assert!(known.len() >= 4);
        for k in known {
            let ours = ssim(&k.a, &k.b, k.width).unwrap();
            assert!((ours - k.ssim).abs() < 1e-6, "{ours} {}", k.ssim);
            let pairs = k.a.iter().zip(&k.b);
            let se: f64 = pairs
                .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
                .sum();
            assert!((se - k.squared_error).abs() < 1e-6 * k.squared_error.max(1.0));
            let psnr = psnr_db_from_mse(se / k.a.len() as f64);
            assert!((psnr - k.psnr_db).abs() < 1e-6, "{psnr} {}", k.psnr_db);
        }
    }

    #[test]
    fn an_image_is_itself_and_sizes_must_fit() {
        let image: Vec<f32> = (0..80).map(|i| (i as f32 * 0.7).sin().abs()).collect();
        assert!((ssim(&image, &image, 10).unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(ssim(&image, &image[..70], 10), None);
        assert_eq!(ssim(&image, &image, 20), None, "four rows are no window");
        assert_eq!(ssim(&image, &image, 11), None);
        assert_eq!(ssim(&[], &[], 0), None);
    }
}
