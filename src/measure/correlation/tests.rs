use proptest::prelude::*;

use super::*;
use crate::measure::calibration::horizon_nees;
use crate::measure::synthetic::{Outcome, World};

/// Mean NEES over the 2 of a calibrated belief.
fn measured(outcome: &Outcome) -> f64 {
    horizon_nees(0, &outcome.fused).expect("errors").mean / 2.0
}

#[test]
fn correlated_experts_inflate_the_nees_without_a_prior() {
    for (n, rho) in [(2, 0.5), (3, 0.6), (3, 0.9), (3, 0.0)] {
        let world = World {
            experts: n,
            rho,
            head: None,
            ..World::honest()
        };
        let outcome = world.last(10_000, 1, 11);
        let found = dependence(&outcome.alone).expect("errors");
        let expected = 1.0 + (n - 1) as f64 * rho;
        assert!((found.mean_rho - rho).abs() < 0.02);
        assert!((measured(&outcome) / expected - 1.0).abs() < 0.03);
        assert!((found.inflation / expected - 1.0).abs() < 0.02);
        assert!((found.effective * found.inflation - n as f64).abs() < 1e-9);
        assert_eq!(found.pairs.len(), n * (n - 1) / 2);
    }
}

#[test]
fn with_the_prior_off_nothing_is_carried_along() {
    let world = World {
        experts: 3,
        rho: 0.6,
        head: None,
        ..World::honest()
    };
    assert!((measured(&world.last(10_000, 8, 12)) / 2.2 - 1.0).abs() < 0.03);
}

#[test]
fn copies_beside_an_honest_prior_inflate_as_the_formula_says() {
    for k in [1, 2, 3, 5] {
        let world = World {
            experts: k,
            rho: 1.0,
            ..World::even()
        };
        let (prior, expert) = (1.0 / world.predictive()[0], 1.0 / world.sensor[0]);
        let outcome = world.last(10_000, 1, 13);
        let formula = inflation(prior, expert, k, 1.0);
        assert!((measured(&outcome) / formula - 1.0).abs() < 0.03);
        if k > 1 {
            let found = dependence(&outcome.alone)
                .expect("errors")
                .beside_prior(prior, expert);
            let with_prior = found.with_prior.expect("precisions");
            assert!((with_prior - formula).abs() < 1e-3);
            assert!((found.inflation - k as f64).abs() < 1e-3);
        }
    }
}

#[test]
fn a_filter_carries_the_copies_into_its_prior_and_ends_above_the_formula() {
    let world = World {
        experts: 3,
        rho: 1.0,
        ..World::even()
    };
    let (s, a, q, r) = (
        world.predictive()[0],
        world.transition[0],
        world.noise[0],
        world.sensor[0],
    );
    // Error variance of the posterior with the gain of k copies, step by step.
    let claimed = 1.0 / (1.0 / s + 3.0 / r);
    let gain = 3.0 / r * claimed;
    let mut predicted = s;
    let mut variance = 0.0;
    for _ in 0..30 {
        variance = (1.0 - gain).powi(2) * predicted + gain.powi(2) * r;
        predicted = a * a * variance + q;
    }
    let outcome = world.last(10_000, 30, 14);
    let formula = inflation(1.0 / s, 1.0 / r, 3, 1.0);
    assert!((measured(&outcome) / (variance / claimed) - 1.0).abs() < 0.03);
    assert!(measured(&outcome) > 1.05 * formula);
}

#[test]
fn a_shared_probe_residual_looks_like_correlation_until_it_is_taken_off() {
    let world = World {
        experts: 3,
        head: None,
        residual_m: 0.03,
        ..World::honest()
    };
    let outcome = world.last(10_000, 1, 15);
    let residual = [9e-4, 0.0, 9e-4];
    let plain = dependence(&outcome.alone).expect("errors");
    let beyond = dependence_beyond(&outcome.alone, residual).expect("errors");
    let fused: Vec<_> = outcome.fused.iter().map(|e| e.beside(residual)).collect();
    let truth = horizon_nees(0, &fused).expect("errors").mean / 2.0;
    assert!(plain.mean_rho > 0.3);
    assert!(beyond.mean_rho.abs() < 0.03);
    assert!((truth - 1.0).abs() < 0.03);
    assert_eq!(dependence_beyond(&outcome.alone, [1.0; 3]), None);
}

#[test]
fn a_residual_that_takes_off_too_much_leaves_no_correlation() {
    let errors = |signs: [f32; 4]| signs.map(|s| [s, s]).to_vec();
    let [a, b, c] = [
        [1.0, -1.0, 1.0, -1.0],
        [1.0, 1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0, 1.0],
    ]
    .map(errors);
    // Independent; two thirds of a variance less they would correlate by −2.
    assert!(dependence(&[a.clone(), b.clone()]).is_some());
    let residual = 2.0 / 3.0;
    assert_eq!(
        dependence_beyond(&[a.clone(), b.clone()], [residual; 3]),
        None
    );
    // Each pair could have −0.67, but no three of them at once.
    let residual = 0.4;
    assert!(dependence_beyond(&[a.clone(), b.clone()], [residual; 3]).is_some());
    assert_eq!(dependence_beyond(&[a, b, c], [residual; 3]), None);
}

#[test]
fn what_cannot_be_compared_has_no_correlation() {
    let errors = vec![[0.1, 0.3], [0.2, -0.1], [0.4, 0.2]];
    let turned: Vec<[f32; 2]> = errors.iter().map(|[x, y]| [-x, -y]).collect();
    assert_eq!(dependence(&[]), None);
    assert_eq!(dependence(std::slice::from_ref(&errors)), None);
    assert_eq!(dependence(&[errors.clone(), errors[..2].to_vec()]), None);
    assert_eq!(
        dependence(&[errors[..2].to_vec(), errors[..2].to_vec()]),
        None
    );
    assert_eq!(dependence(&[errors.clone(), vec![[1.0, 1.0]; 3]]), None);
    // Errors that cancel altogether: no inflation, and still a finite number of experts.
    let against = dependence(&[errors.clone(), turned]).expect("errors");
    assert!((against.mean_rho + 1.0).abs() < 1e-6 && against.effective.is_finite());
    // An episode that one expert lost counts for none.
    let mut lost = errors.clone();
    lost.push([f32::NAN, 0.0]);
    let mut more = errors.clone();
    more.push([9.0, -9.0]);
    let found = dependence(&[lost, more]).expect("errors");
    assert_eq!(found.episodes, 3);
    assert!((found.mean_rho - 1.0).abs() < 1e-6);
    assert_eq!(
        found.sentence,
        "2 experts whose errors correlate by 1.00 (of 3 episodes only) count as 1.0: without the prior their product \
         claims a variance 2.0 times too small"
    );
    assert_eq!(found.beside_prior(f64::NAN, 1.0).with_prior, None);
    assert!(inflation(0.0, 0.0, 2, 1.0).is_nan() && inflation(-1.0, 2.0, 2, 1.0).is_nan());
}

proptest! {
    #[test]
    fn whatever_the_errors_a_correlation_is_one(
        errors in prop::collection::vec(
            prop::collection::vec(prop::array::uniform2(prop_oneof![-2.0_f32..2.0, any::<f32>()]), 4),
            0..4,
        ),
    ) {
        if let Some(found) = dependence(&errors) {
            prop_assert!(found.pairs.iter().all(|pair| (-1.0..=1.0).contains(&pair.rho)));
            prop_assert!(found.effective.is_finite() && found.inflation > 0.0);
        }
    }
}
