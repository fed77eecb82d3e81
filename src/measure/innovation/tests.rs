//! The identities of D8 to D10 on made-up experts, and their χ² laws on seeded draws of a right model.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::super::gaussian::{Product, made_up, product};
use super::*;

const DRAWS: usize = 4000;

/// Standard deviations to draws, by seed.
struct Noise(ChaCha8Rng);

impl Noise {
    fn around(&mut self, mean: &[f32], log_var: &[f32]) -> Vec<f32> {
        mean.iter()
            .zip(log_var)
            .map(|(mean, log_var)| {
                let unit: f32 = StandardNormal.sample(&mut self.0);
                mean + unit * (0.5 * log_var).exp()
            })
            .collect()
    }
}

fn trained<'a>(mean: &'a [f32], log_var: &'a [f32]) -> Factor<'a> {
    Factor {
        gaussian: Gaussian { mean, log_var },
        alpha: 1.0,
    }
}

/// Mean of a statistic, and the part of its draws within the bounds.
fn summary(draws: &[f32], bounds: Bounds) -> (f64, f64) {
    let count = draws.len() as f64;
    let mean = draws.iter().copied().map(f64::from).sum::<f64>() / count;
    let within = draws.iter().filter(|&&x| bounds.hold(x)).count() as f64 / count;
    (mean, within)
}

#[test]
fn a_right_model_passes_against_the_propagated_covariance_only() {
    // z' = A z + w from a posterior N(m, P), seen by a sensor of noise R. The head states Q alone.
    let transition = [0.9, 0.4, 0.0, -0.4, 0.9, 0.0, 0.2, 0.0, 0.8];
    let (p, q, r) = ([0.0, -0.5, 0.2], [-1.0, -1.2, -0.8], [-0.7, -0.4, -1.0]);
    let carried = predicted_covariance(&transition, &p, &q);
    let mut noise = Noise(ChaCha8Rng::seed_from_u64(11));
    let (mut head, mut propagated) = (Vec::new(), Vec::new());
    let mut law = None;
    for _ in 0..DRAWS {
        // The predicted mean is 0: m = 0.
        let z = noise.around(&[0.0; 3], &p);
        let moved: Vec<f32> = transition
            .chunks_exact(3)
            .map(|row| row.iter().zip(&z).map(|(a, z)| a * z).sum())
            .collect();
        let truth = noise.around(&moved, &q);
        let seen = noise.around(&truth, &r);
        let prior = Gaussian {
            mean: &[0.0; 3],
            log_var: &q,
        };
        let nis = nis(trained(&seen, &r), prior, Some(&carried), &[true; 3]).unwrap();
        head.push(nis.head);
        propagated.push(nis.propagated.unwrap());
        law = nis.bounds;
    }
    let bounds = law.unwrap();
    // tr((Q + R)⁻¹ (A P Aᵀ + Q + R)): what the head must read in the mean.
    let expected: f64 = (0..3)
        .map(|d| {
            let extra = f64::from(r[d]).exp();
            (carried[4 * d] + extra) / (f64::from(q[d]).exp() + extra)
        })
        .sum();
    assert!(expected > 5.0);
    let (mean, within) = summary(&head, bounds);
    assert!(
        (mean - expected).abs() < 0.05 * expected,
        "{mean} {expected}"
    );
    assert!(within < 0.88, "{within}");
    let (mean, within) = summary(&propagated, bounds);
    // The mean of n draws of χ²₃ has a standard deviation of sqrt(6 / n).
    assert!(
        (mean - 3.0).abs() < 3.0 * (6.0 / DRAWS as f64).sqrt(),
        "{mean}"
    );
    assert!((within - 0.95).abs() < 0.011, "{within}");
}

#[test]
fn conflict_and_disagreement_of_honest_experts_follow_their_laws() {
    // Four experts, the last one the prior, all of the same unknown z; the second dimension is not active.
    let spreads = [
        [-1.0, 0.3, 0.5],
        [0.4, 0.0, -0.6],
        [1.0, 1.0, 0.0],
        [0.1, -0.2, 0.9],
    ];
    let active = [true, false, true];
    let mut noise = Noise(ChaCha8Rng::seed_from_u64(12));
    let (mut energies, mut distances) = (Vec::new(), Vec::new());
    let mut laws = None;
    for _ in 0..DRAWS {
        let z = noise.around(&[1.0, -2.0, 0.5], &[1.0; 3]);
        let means = spreads.map(|log_var| noise.around(&z, &log_var));
        let mut factors: Vec<Factor> = means
            .iter()
            .zip(&spreads)
            .map(|(mean, log_var)| trained(mean, log_var))
            .collect();
        // One is off and counts for nothing.
        factors[1].alpha = 0.0;
        let conflict = conflict(&factors, &active).unwrap();
        let pairs = disagreements(&factors, &active);
        let named: Vec<_> = pairs.iter().map(|pair| (pair.a, pair.b)).collect();
        assert_eq!(named, [(0, 2), (0, 3), (2, 3)]);
        assert_eq!((conflict.dof, pairs[0].dof), (4, 2));
        energies.push(conflict.energy);
        distances.push(pairs[0].distance);
        laws = conflict.bounds.zip(pairs[0].bounds);
    }
    let (of_conflict, of_pair) = laws.unwrap();
    for (draws, bounds, dof) in [(energies, of_conflict, 4.0), (distances, of_pair, 2.0)] {
        let (mean, within) = summary(&draws, bounds);
        let deviation = (2.0 * dof / DRAWS as f64).sqrt();
        assert!((mean - dof).abs() < 3.0 * deviation, "{dof}: {mean}");
        assert!((within - 0.95).abs() < 0.011, "{dof}: {within}");
    }
}

#[test]
fn tempering_takes_the_bounds_away() {
    let (mean, log_var) = ([1.0, 2.0], [0.0, 0.0]);
    let mut factors = [trained(&mean, &log_var), trained(&[0.0; 2], &log_var)];
    let prior = factors[1].gaussian;
    let whole = nis(factors[0], prior, None, &[true; 2]).unwrap();
    assert_eq!((whole.head, whole.dof, whole.propagated), (2.5, 2, None));
    assert!(whole.bounds.is_some());
    factors[0].alpha = 0.5;
    let tempered = nis(factors[0], prior, None, &[true; 2]).unwrap();
    // R is twice Σ.
    assert!((tempered.head - 5.0 / 3.0).abs() < 1e-6);
    assert_eq!(tempered.bounds, None);
    assert_eq!(conflict(&factors, &[true; 2]).unwrap().bounds, None);
    assert_eq!(disagreements(&factors, &[true; 2])[0].bounds, None);
}

#[test]
fn what_does_not_fit_says_nothing() {
    let (mean, log_var) = ([1.0, 2.0], [0.0, 0.0]);
    let one = trained(&mean, &log_var);
    let prior = one.gaussian;
    let off = Factor { alpha: 0.0, ..one };
    assert_eq!(nis(off, prior, None, &[true; 2]), None);
    assert_eq!(nis(one, prior, None, &[false; 2]), None);
    assert_eq!(nis(one, prior, None, &[true; 3]), None);
    assert_eq!(
        nis(one, trained(&[1.0], &[0.0]).gaussian, None, &[true; 2]),
        None
    );
    assert_eq!(
        nis(trained(&[f32::NAN, 0.0], &log_var), prior, None, &[true; 2]),
        None
    );
    let odd: [&[f64]; 4] = [&[], &[1.0; 3], &[f64::NAN; 4], &[-9.0, 0.0, 0.0, 1.0]];
    for covariance in odd {
        let nis = nis(one, prior, Some(covariance), &[true; 2]).unwrap();
        assert_eq!(nis.propagated, None);
    }
    assert_eq!(conflict(&[one], &[true; 2]), None);
    assert_eq!(conflict(&[one, off], &[true; 2]), None);
    assert_eq!(conflict(&[], &[]), None);
    assert_eq!(conflict(&[one, one], &[true]), None);
    assert_eq!(disagreements(&[one, off], &[true; 2]), []);
    assert_eq!(disagreements(&[one, one], &[]), []);
    assert_eq!(
        disagreements(&[one, trained(&[1.0], &[0.0])], &[true; 2]),
        []
    );
    assert_eq!(predicted_covariance(&[1.0], &[0.0; 2], &[0.0; 2]), [0.0; 0]);
}

fn close(a: f32, b: f64) -> bool {
    (f64::from(a) - b).abs() < 1e-4 * (1.0 + b.abs())
}

proptest! {
    #[test]
    fn the_energy_is_what_every_pair_adds(experts in made_up::experts(4, 3)) {
        // Q = Σ_d Σ_{i<j} αᵢTᵢ αⱼTⱼ / T* (μᵢ − μⱼ)², and −2 ln C less the determinants.
        let factors = made_up::factors(&experts);
        let Some(ours) = conflict(&factors, &[true; 3]) else {
            prop_assert!(factors.iter().filter(|f| f.is_on()).count() < 2);
            return Ok(());
        };
        let on: Vec<&Factor> = factors.iter().filter(|f| f.is_on()).collect();
        let (mut pairs, mut determinants) = (0.0, 0.0);
        for d in 0..3 {
            let total: f64 = on.iter().map(|f| f.precision(d)).sum();
            determinants -= (TAU / total).ln();
            for (j, b) in on.iter().enumerate() {
                determinants += (TAU * b.variance(d)).ln();
                for a in &on[..j] {
                    let apart = f64::from(a.gaussian.mean[d]) - f64::from(b.gaussian.mean[d]);
                    pairs += a.precision(d) * b.precision(d) / total * apart * apart;
                }
            }
        }
        prop_assert!(close(ours.energy, pairs), "{} {pairs}", ours.energy);
        let from_normaliser = -2.0 * f64::from(ours.log_normaliser) - determinants;
        prop_assert!((from_normaliser - pairs).abs() < 1e-3 * (1.0 + pairs));
    }

    #[test]
    fn two_experts_conflict_as_much_as_they_disagree(experts in made_up::experts(2, 3)) {
        let factors = made_up::factors(&experts);
        let Some(conflict) = conflict(&factors, &[true, false, true]) else { return Ok(()) };
        let pairs = disagreements(&factors, &[true, false, true]);
        prop_assert!(close(conflict.energy, f64::from(pairs[0].distance)));
        prop_assert_eq!(conflict.dof, pairs[0].dof);
        // And C is the density of one mean under the sum of both: −½ [d² + ln det 2π(Σᵢ + Σⱼ)].
        let log_det: f64 = [0, 2]
            .iter()
            .map(|&d| (TAU * (factors[0].variance(d) + factors[1].variance(d))).ln())
            .sum();
        prop_assert!(close(conflict.log_normaliser, -0.5 * (f64::from(pairs[0].distance) + log_det)));
    }

    #[test]
    fn normalisers_multiply_as_experts_are_added(a in made_up::gaussian(2), b in made_up::gaussian(2), c in made_up::gaussian(2)) {
        let factor = |x: &Product| -> (Product, f32) { (x.clone(), 1.0) };
        let of = |experts: &[(Product, f32)]| {
            conflict(&made_up::factors(experts), &[true; 2]).unwrap().log_normaliser
        };
        let three = [factor(&a), factor(&b), factor(&c)];
        let two = product(&made_up::factors(&three[..2])).unwrap();
        let stepwise = of(&three[..2]) + of(&[factor(&two), factor(&c)]);
        prop_assert!(close(of(&three), f64::from(stepwise)));
    }

    #[test]
    fn a_diagonal_prediction_reads_as_the_head(sensor in made_up::gaussian(3), prior in made_up::gaussian(3)) {
        let sensor = trained(&sensor.mean, &sensor.log_var);
        let full = spread::diagonal(&prior.log_var);
        let nis = nis(sensor, prior.gaussian(), Some(&full), &[true, true, false]).unwrap();
        prop_assert!(close(nis.head, f64::from(nis.propagated.unwrap())));
        // And the head's reading is the pair's disagreement.
        let pair = disagreements(&[sensor, trained(&prior.mean, &prior.log_var)], &[true, true, false]);
        prop_assert!(close(nis.head, f64::from(pair[0].distance)));
    }
}
