//! Which sensor pulls the position estimate where (D7).
//!
//! `μ* − μ₀ = Σᵢ sᵢ ⊙ (μᵢ − μ₀)` splits the correction of the prior exactly, sensor by sensor: Kalman gain times
//! innovation. Arrows may oppose each other; that is the finding.

use super::gaussian::{self, Factor};
use super::position;

/// The arrow `vᵢ = W (sᵢ ⊙ (μᵢ − μ₀))` of each sensor, in metres, with `sᵢ = αᵢTᵢ / T*`.
///
/// They add up to `W (μ* − μ₀)`, also where the prior is off and only marks where they start; a sensor that is off
/// has an arrow of zero. `weights` is the probe's W, `(2, Z)` row major. None where nothing is on, the prior has no
/// finite mean of Z, or the sizes do not fit.
pub fn pulls(sensors: &[Factor], prior: Factor, weights: &[f32]) -> Option<Vec<[f32; 2]>> {
    let mut factors = sensors.to_vec();
    factors.push(prior);
    let full = gaussian::moments(&factors)?;
    let origin = prior.gaussian.mean;
    if origin.len() != full.mean.len() || origin.iter().any(|x| !x.is_finite()) {
        return None;
    }
    sensors
        .iter()
        .map(|sensor| {
            if !sensor.is_on() {
                return Some([0.0; 2]);
            }
            let pull: Vec<f64> = full
                .precision
                .iter()
                .enumerate()
                .map(|(d, total)| {
                    let innovation = f64::from(sensor.gaussian.mean[d]) - f64::from(origin[d]);
                    sensor.precision(d) / total * innovation
                })
                .collect();
            position::moved(weights, &pull).map(|[x, y]| [x as f32, y as f32])
        })
        .collect()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use proptest::prelude::*;

    use super::super::fusion::precision_shares;
    use super::super::gaussian::{Gaussian, made_up, product};
    use super::*;

    fn unit(mean: &[f32], alpha: f32) -> Factor<'_> {
        let gaussian = Gaussian {
            mean,
            log_var: &[0.0],
        };
        Factor { gaussian, alpha }
    }

    #[test]
    fn sensors_on_either_side_oppose() {
        let sensors = [unit(&[3.0], 1.0), unit(&[-6.0], 1.0), unit(&[9.0], 0.0)];
        let arrows = pulls(&sensors, unit(&[0.0], 1.0), &[1.0, 0.5]).unwrap();
        for (arrow, expected) in arrows.iter().zip([[1.0, 0.5], [-2.0, -1.0], [0.0, 0.0]]) {
            assert!((arrow[0] - expected[0]).abs() < 1e-6 && (arrow[1] - expected[1]).abs() < 1e-6);
        }
    }

    #[test]
    fn without_sensors_nothing_pulls() {
        let prior = unit(&[1.0], 1.0);
        assert_eq!(pulls(&[], prior, &[1.0, 0.5]), Some(vec![]));
        assert_eq!(
            pulls(&[unit(&[4.0], 0.0)], prior, &[1.0, 0.5]),
            Some(vec![[0.0; 2]])
        );
        assert_eq!(pulls(&[], unit(&[1.0], 0.0), &[1.0, 0.5]), None);
        assert_eq!(pulls(&[unit(&[4.0], 1.0)], prior, &[1.0]), None);
        let lost = unit(&[f32::NAN], 0.0);
        assert_eq!(pulls(&[unit(&[4.0], 1.0)], lost, &[1.0, 0.5]), None);
        assert_eq!(
            pulls(&[unit(&[4.0], 1.0)], unit(&[], 0.0), &[1.0, 0.5]),
            None
        );
    }

    proptest! {
        #[test]
        fn they_add_up_to_the_correction(
            experts in made_up::experts(4, 5),
            weights in prop::collection::vec(-0.3_f32..0.3, 10),
        ) {
            // The last is the prior: off, as trained or tempered.
            let factors = made_up::factors(&experts);
            let (prior, sensors) = factors.split_last().unwrap();
            let full = product(&factors).unwrap();
            let arrows = pulls(sensors, *prior, &weights).unwrap();
            let shares = precision_shares(&factors);
            for ((arrow, share), sensor) in arrows.iter().zip(&shares).zip(sensors) {
                let x: f32 = (0..5)
                    .map(|d| weights[d] * share[d] * (sensor.gaussian.mean[d] - prior.gaussian.mean[d]))
                    .sum();
                prop_assert!((arrow[0] - x).abs() < 1e-5, "{} {x}", arrow[0]);
            }
            for axis in 0..2 {
                let correction: f32 = (0..5)
                    .map(|d| weights[5 * axis + d] * (full.mean[d] - prior.gaussian.mean[d]))
                    .sum();
                let sum: f32 = arrows.iter().map(|arrow| arrow[axis]).sum();
                prop_assert!((sum - correction).abs() < 1e-5, "{sum} {correction}");
            }
        }
    }
}
