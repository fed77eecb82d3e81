use proptest::prelude::*;

use super::*;
use crate::measure::synthetic::{World, unexplained};

fn held_95(errors: &[Error2]) -> f64 {
    let found = calibration(errors).expect("errors");
    found.at_claim().expect("the claim").held
}

/// Mean NEES, its bounds, episodes.
fn shown(nees: &HorizonNees) -> String {
    let HorizonNees {
        mean,
        low,
        high,
        episodes,
        ..
    } = nees;
    format!("{mean:.2} [{low:.2}, {high:.2}] of {episodes}")
}

#[test]
fn an_honest_filter_holds_what_it_claims() {
    let outcome = World::honest().last(4000, 6, 1);
    let found = calibration(&outcome.fused).expect("errors");
    let horizon = horizon_nees(0, &outcome.fused).expect("errors");
    assert!((held_95(&outcome.fused) - 0.95).abs() < 0.02);
    for point in &found.coverage {
        assert!((point.held - point.claimed).abs() < 0.02, "{point:?}");
    }
    assert!(found.area < 0.01 && found.pit.iter().all(|p| (p - 0.1).abs() < 0.02));
    assert_eq!(found.verdict, Verdict::Calibrated, "{}", found.sentence);
    assert_eq!(horizon.verdict, Verdict::Calibrated, "{horizon:?}");
    assert_eq!(
        found.sentence,
        "claims 95 %, holds 95 % [94, 95] of 4000: calibrated"
    );
}

#[test]
fn the_bounds_of_the_mean_nees_hold_in_95_of_100_sets_of_episodes() {
    let outcome = World::honest().last(20_000, 3, 2);
    let sets = outcome.fused.chunks_exact(20);
    let (count, mut inside) = (sets.len(), 0);
    for set in sets {
        let found = horizon_nees(0, set).expect("errors");
        inside += usize::from(found.verdict == Verdict::Calibrated);
    }
    let share = inside as f64 / count as f64;
    assert!((share - 0.95).abs() < 0.02, "{share}");
}

#[test]
fn a_head_that_states_only_its_noise_is_overconfident() {
    let honest = World::honest();
    let world = World {
        head: Some(honest.noise),
        ..honest
    };
    let outcome = world.last(1000, 12, 3);
    let found = calibration(&outcome.fused).expect("errors");
    let horizon = horizon_nees(0, &outcome.fused).expect("errors");
    assert_eq!(found.verdict, Verdict::Overconfident);
    assert_eq!(horizon.verdict, Verdict::Overconfident);
    assert!(found.pit[9] > 0.2 && found.area > 0.1);
    assert_eq!(
        found.sentence,
        "claims 95 %, holds 59 % [56, 62] of 1000: overconfident"
    );
    assert_eq!(shown(&horizon), "7.12 [1.88, 2.13] of 1000");
}

#[test]
fn a_variance_that_is_too_large_is_underconfident() {
    let outcome = World::honest().last(1000, 3, 4);
    let wide: Vec<Error2> = outcome
        .fused
        .iter()
        .map(|e| e.beside(e.covariance))
        .collect();
    let found = calibration(&wide).expect("errors");
    assert_eq!(found.verdict, Verdict::Underconfident);
    assert_eq!(
        horizon_nees(0, &wide).expect("errors").verdict,
        Verdict::Underconfident
    );
    assert_eq!(
        found.sentence,
        "claims 95 %, holds 99 % [99, 100] of 1000: underconfident"
    );
}

#[test]
fn a_rollout_is_honest_only_if_it_carries_its_spread() {
    let world = World::honest();
    for horizon in [1, 5, 20] {
        let [carried, head] = world.rollout(4000, horizon, 5);
        let carried = horizon_nees(horizon, &carried).expect("errors");
        let head = horizon_nees(horizon, &head).expect("errors");
        assert_eq!(carried.verdict, Verdict::Calibrated);
        // One step ahead the head is right; it does not accumulate after that.
        let expected = if horizon == 1 {
            Verdict::Calibrated
        } else {
            Verdict::Overconfident
        };
        assert_eq!(head.verdict, expected);
    }
}

#[test]
fn the_probe_residual_counts_once() {
    let world = World {
        residual_m: 0.01,
        ..World::honest()
    };
    let outcome = world.last(8000, 3, 6);
    let (val, test) = outcome.fused.split_at(4000);
    let with =
        |residual: [f32; 3]| -> Vec<Error2> { test.iter().map(|e| e.beside(residual)).collect() };
    // Without R_p the probe's own error looks like overconfidence; with it the bounds hold.
    assert_eq!(
        horizon_nees(0, test).expect("errors").verdict,
        Verdict::Overconfident
    );
    let residual = unexplained(val);
    assert!(
        (residual[0] - 1e-4).abs() < 2e-5 && (residual[2] - 1e-4).abs() < 2e-5,
        "{residual:?}"
    );
    let found = horizon_nees(0, &with(residual)).expect("errors");
    assert_eq!(found.verdict, Verdict::Calibrated, "{found:?}");
    assert!((held_95(&with(residual)) - 0.95).abs() < 0.02);
}

#[test]
fn a_plain_residual_covariance_counts_the_belief_twice() {
    // A perfect probe: the residual is the belief's own spread, NEES halves and 95 % become 99.7.
    let outcome = World::honest().last(8000, 3, 7);
    let twice: Vec<Error2> = outcome
        .fused
        .iter()
        .map(|e| e.beside(e.covariance))
        .collect();
    let found = horizon_nees(0, &twice).expect("errors");
    assert!((found.mean - 1.0).abs() < 0.05, "{}", found.mean);
    assert!((held_95(&twice) - 0.9975).abs() < 0.003);
}

#[test]
fn a_residual_fitted_on_an_oversure_filter_hides_it() {
    let honest = World::honest();
    let world = World {
        head: Some(honest.noise),
        ..honest
    };
    let outcome = world.last(8000, 12, 8);
    let (val, test) = outcome.fused.split_at(4000);
    let residual = unexplained(val);
    let hidden: Vec<Error2> = test.iter().map(|e| e.beside(residual)).collect();
    let bare = horizon_nees(0, test).expect("errors");
    let found = horizon_nees(0, &hidden).expect("errors");
    assert_eq!(bare.verdict, Verdict::Overconfident);
    assert_eq!(found.verdict, Verdict::Calibrated);
}

#[test]
fn the_nll_is_least_at_the_true_scale_and_sharpness_pays_for_inflation() {
    let outcome = World::honest().last(20_000, 2, 9);
    let scaled = |scale: f32| {
        let errors: Vec<Error2> = outcome
            .fused
            .iter()
            .map(|e| Error2 {
                covariance: e.covariance.map(|c| scale * c),
                ..*e
            })
            .collect();
        calibration(&errors).expect("errors")
    };
    let truth = scaled(1.0);
    for scale in [0.5, 0.8, 0.9, 1.1, 1.25, 2.0] {
        let other = scaled(scale);
        assert!(other.nll > truth.nll, "{scale}");
        assert!((other.sharpness_cm2 / truth.sharpness_cm2 - f64::from(scale)).abs() < 1e-5);
        assert!(other.crps_cm[0] > truth.crps_cm[0], "{scale}");
    }
    // CRPS of N(0, σ²) against its own draws is σ/√π.
    let xx = f64::from(outcome.fused[0].covariance[0]);
    let expected = 1e2 * (xx / std::f64::consts::PI).sqrt();
    assert!((truth.crps_cm[0] / expected - 1.0).abs() < 0.02);
}

#[test]
fn few_episodes_get_no_verdict() {
    let outcome = World::honest().last(FEW - 1, 3, 10);
    let found = calibration(&outcome.fused).expect("errors");
    let horizon = horizon_nees(4, &outcome.fused).expect("errors");
    assert_eq!(found.verdict, Verdict::TooFew);
    assert_eq!(horizon.verdict, Verdict::TooFew);
    assert_eq!(
        found.sentence,
        "claims 95 %, holds 95 % [75, 99] of 19: too few to say, 20 or more are needed"
    );
    assert_eq!(shown(&horizon), "1.79 [1.20, 2.99] of 19");
}

#[test]
fn what_has_no_nees_is_left_out_aloud() {
    let good = Error2 {
        error_m: [0.3, 0.4],
        covariance: [0.25, 0.0, 0.25],
    };
    assert!((nees(&good).expect("positive definite") - 1.0).abs() < 1e-6);
    let flat = Error2 {
        covariance: [1.0, 1.0, 1.0],
        ..good
    };
    let lost = Error2 {
        error_m: [f32::NAN, 0.0],
        ..good
    };
    let endless = Error2 {
        covariance: [f32::INFINITY, 0.0, 1.0],
        ..good
    };
    for bad in [flat, lost, endless, Error2::default()] {
        assert_eq!(nees(&bad), None);
    }
    assert_eq!(calibration(&[flat, lost]), None);
    assert_eq!(calibration(&[]), None);
    assert_eq!(horizon_nees(0, &[lost]), None);
    let found = calibration(&[good, flat, lost]).expect("one");
    assert_eq!((found.n, found.skipped), (1, 2));
    assert!(
        found
            .sentence
            .contains("2 more without a usable covariance")
    );
}

#[test]
fn an_interval_that_rounds_to_the_claim_shows_its_decimals() {
    // 9000 of 9540 inside: [93.8, 94.8] is no 95.
    let error = |x: f32| Error2 {
        error_m: [x, 0.0],
        covariance: [1.0, 0.0, 1.0],
    };
    let errors: Vec<Error2> = (0..9540)
        .map(|i| error(if i < 9000 { 0.1 } else { 9.0 }))
        .collect();
    let found = calibration(&errors).expect("errors");
    assert_eq!(found.verdict, Verdict::Overconfident);
    assert_eq!(
        found.sentence,
        "claims 95 %, holds 94.3 % [93.9, 94.8] of 9540: overconfident"
    );
}

proptest! {
    #[test]
    fn whatever_comes_in_what_comes_out_is_finite(
        rows in prop::collection::vec(prop::array::uniform5(prop_oneof![-2.0_f32..2.0, any::<f32>()]), 0..6),
    ) {
        let errors: Vec<Error2> = rows
            .iter()
            .map(|&[x, y, xx, xy, yy]| Error2 {
                error_m: [x, y],
                covariance: [xx, xy, yy],
            })
            .collect();
        let horizon = horizon_nees(3, &errors);
        prop_assert_eq!(horizon.is_some(), calibration(&errors).is_some());
        if let Some(found) = calibration(&errors) {
            prop_assert_eq!(found.n + found.skipped, errors.len());
            let [x, y] = found.crps_cm;
            for number in [found.area, found.sharpness_cm2, found.nll, x, y] {
                prop_assert!(number.is_finite());
            }
            prop_assert!((0.0..=0.5 + 1e-9).contains(&found.area));
            prop_assert!((found.pit.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn where_the_claim_tells_nothing_the_mean_nees_speaks() {
    let outcome = World::honest().last(32, 3, 11);
    let wide: Vec<Error2> = outcome
        .fused
        .iter()
        .map(|e| e.beside(e.covariance.map(|c| 2.0 * c)))
        .collect();
    let found = calibration(&wide).expect("errors");
    let nees = horizon_nees(0, &wide).expect("errors");
    // All of 32 inside is what 95 % may give.
    assert_eq!((held_95(&wide), nees.verdict), (1.0, found.verdict));
    assert_eq!(found.verdict, Verdict::Underconfident);
    let told = format!("underconfident (mean NEES {:.1}, not 2)", nees.mean);
    assert_eq!(
        found.sentence,
        format!("claims 95 %, holds 100 % [89, 100] of 32: {told}")
    );
}
