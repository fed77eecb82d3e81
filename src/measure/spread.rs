//! How the uncertainty of a rollout grows (D20), and what it comes to on the table.
//!
//! A transition `z' = A z + B u + w`, `w ~ N(0, Q)`, carries the whole covariance, `P' = A P Aᵀ + Q`; the network's
//! own one-step head says Q alone and does not accumulate. Sampled paths are the third way to say it.

/// The covariance `W P Wᵀ` of the position estimate as `[xx, xy, yy]`, in m².
///
/// `weights` is the probe's W, `(2, Z)` row major; `covariance` is P, `(Z, Z)` row major. None where the sizes do
/// not fit or a number is not finite.
pub fn plane(weights: &[f32], covariance: &[f64]) -> Option<[f32; 3]> {
    let latent = weights.len() / 2;
    if latent == 0 || weights.len() != 2 * latent || covariance.len() != latent * latent {
        return None;
    }
    let (x, y) = weights.split_at(latent);
    let between = |a: &[f32], b: &[f32]| -> f64 {
        covariance
            .chunks_exact(latent)
            .zip(a)
            .map(|(row, &a)| {
                let along: f64 = row.iter().zip(b).map(|(p, &b)| p * f64::from(b)).sum();
                f64::from(a) * along
            })
            .sum()
    };
    let plane = [between(x, x), between(x, y), between(y, y)].map(|v| v as f32);
    plane.iter().all(|v| v.is_finite()).then_some(plane)
}

/// One step `A P Aᵀ + Q` of D20, `(Z, Z)` row major and symmetric.
///
/// `transition` is A and `covariance` P, `(Z, Z)` row major; `noise_log_var` is the logarithm of Q's diagonal, Z.
/// Empty where the sizes do not fit.
pub fn propagate(transition: &[f32], covariance: &[f64], noise_log_var: &[f32]) -> Vec<f64> {
    let latent = noise_log_var.len();
    if latent == 0 || transition.len() != latent * latent || covariance.len() != latent * latent {
        return Vec::new();
    }
    let rows = || transition.chunks_exact(latent);
    let mut carried = vec![0.0; latent * latent];
    for (row, out) in rows().zip(carried.chunks_exact_mut(latent)) {
        for (&a, from) in row.iter().zip(covariance.chunks_exact(latent)) {
            for (out, p) in out.iter_mut().zip(from) {
                *out += f64::from(a) * p;
            }
        }
    }
    let mut next = diagonal(noise_log_var);
    for (i, carried) in carried.chunks_exact(latent).enumerate() {
        for (j, row) in rows().enumerate().take(i + 1) {
            let sum: f64 = carried
                .iter()
                .zip(row)
                .map(|(c, &a)| c * f64::from(a))
                .sum();
            next[i * latent + j] += sum;
            if i != j {
                next[j * latent + i] += sum;
            }
        }
    }
    next
}

/// The full covariance of a diagonal Gaussian, `(Z, Z)` row major.
pub fn diagonal(log_var: &[f32]) -> Vec<f64> {
    let latent = log_var.len();
    let mut covariance = vec![0.0; latent * latent];
    for (d, &log_var) in log_var.iter().enumerate() {
        covariance[d * latent + d] = f64::from(log_var).exp();
    }
    covariance
}

/// The covariance of points around their mean (divided by their number less one) as `[xx, xy, yy]`, in the square
/// of their unit. None for fewer than two, or where one is not finite.
pub fn sample_covariance(points: &[[f32; 2]]) -> Option<[f32; 3]> {
    if points.len() < 2 || points.as_flattened().iter().any(|x| !x.is_finite()) {
        return None;
    }
    let count = points.len() as f64;
    let mean = [0, 1].map(|k| points.iter().map(|p| f64::from(p[k])).sum::<f64>() / count);
    let mut sums = [0.0; 3];
    for point in points {
        let (x, y) = (f64::from(point[0]) - mean[0], f64::from(point[1]) - mean[1]);
        for (sum, product) in sums.iter_mut().zip([x * x, x * y, y * y]) {
            *sum += product;
        }
    }
    Some(sums.map(|sum| (sum / (count - 1.0)) as f32))
}

/// The distance that a covariance xx, xy, yy of the plane claims, as the root of its mean square: `√(xx + yy)`.
pub fn distance_sigma([xx, _, yy]: [f32; 3]) -> f32 {
    (xx + yy).max(0.0).sqrt()
}

/// Its standard deviations along x and y.
pub fn axis_sigmas([xx, _, yy]: [f32; 3]) -> [f32; 2] {
    [xx, yy].map(|variance| variance.max(0.0).sqrt())
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    fn close(a: &[f32], b: &[f32], within: f32) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= within)
    }

    #[test]
    fn a_known_step() {
        // A = [1 1; 0 1], P = diag(1, 2), Q = diag(3, 4): A P Aᵀ = [3 2; 2 2].
        let q = [3.0_f32.ln(), 4.0_f32.ln()];
        let next = propagate(&[1.0, 1.0, 0.0, 1.0], &[1.0, 0.0, 0.0, 2.0], &q);
        for (ours, expected) in next.iter().zip([6.0, 2.0, 2.0, 6.0]) {
            assert!((ours - expected).abs() < 1e-6, "{next:?}");
        }
        // Read by x = z₁ − z₂ and y = 2 z₂.
        let plane = plane(&[1.0, -1.0, 0.0, 2.0], &next).unwrap();
        assert!(close(&plane, &[8.0, -8.0, 24.0], 1e-5), "{plane:?}");
    }

    #[test]
    fn samples_and_propagation_agree_on_a_linear_model() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = |log_var: f32| -> f32 {
            let unit: f32 = StandardNormal.sample(&mut rng);
            unit * (0.5 * log_var).exp()
        };
        let transition = [0.9, 0.3, -0.2, 0.8];
        let (start, noise) = ([-1.0, 0.5], [-2.0, -1.0]);
        let mut covariance = diagonal(&start);
        let mut paths: Vec<[f32; 2]> = (0..6000).map(|_| start.map(&mut normal)).collect();
        for _ in 0..5 {
            covariance = propagate(&transition, &covariance, &noise);
            for z in &mut paths {
                let [a, b, c, d] = transition;
                *z = [
                    a * z[0] + b * z[1] + normal(noise[0]),
                    c * z[0] + d * z[1] + normal(noise[1]),
                ];
            }
        }
        let propagated = plane(&[1.0, 0.0, 0.0, 1.0], &covariance).unwrap();
        let sampled = sample_covariance(&paths).unwrap();
        assert!(
            close(&propagated, &sampled, 0.05 * propagated[0]),
            "{propagated:?} {sampled:?}"
        );
        // The head alone says far less.
        assert!(propagated[0] > 3.0 * noise[0].exp());
    }

    #[test]
    fn what_does_not_fit_has_no_spread() {
        assert_eq!(plane(&[], &[]), None);
        assert_eq!(plane(&[1.0], &[]), None);
        assert_eq!(plane(&[1.0; 3], &[1.0]), None);
        assert_eq!(plane(&[1.0; 4], &[1.0; 3]), None);
        assert_eq!(plane(&[1.0; 2], &[f64::NAN]), None);
        assert_eq!(propagate(&[1.0; 3], &[1.0; 4], &[0.0; 2]), [0.0; 0]);
        assert_eq!(propagate(&[1.0; 4], &[1.0; 3], &[0.0; 2]), [0.0; 0]);
        assert_eq!(propagate(&[], &[], &[]), [0.0; 0]);
        assert_eq!(diagonal(&[]), [0.0; 0]);
        assert_eq!(sample_covariance(&[[1.0, 2.0]]), None);
        assert_eq!(sample_covariance(&[[1.0, 2.0], [f32::NAN, 0.0]]), None);
    }
}
