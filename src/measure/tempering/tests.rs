use super::*;
use crate::measure::calibration::calibration;
use crate::measure::synthetic::World;

fn fit(world: World, steps: usize) -> FittedAlpha {
    fit_alpha(|alpha| {
        let tempered = World {
            alpha: alpha as f32,
            ..world
        };
        calibration(&tempered.last(4000, steps, 21).fused).map(|found| found.nll)
    })
    .expect("a fit")
}

#[test]
fn equal_experts_are_tempered_by_what_they_are_worth() {
    for (n, rho) in [(3, 0.6), (3, 0.9), (2, 1.0)] {
        let world = World {
            experts: n,
            rho,
            head: None,
            ..World::honest()
        };
        let expected = 1.0 / (1.0 + (n - 1) as f64 * rho);
        let found = fit(world, 1);
        assert!((found.alpha / expected - 1.0).abs() < 0.05);
        assert!(found.nll < found.nll_as_trained);
        // The same beside an honest prior.
        let found = fit(
            World {
                head: World::honest().head,
                ..world
            },
            1,
        );
        assert!((found.alpha / expected - 1.0).abs() < 0.1);
    }
}

#[test]
fn what_is_right_as_trained_stays() {
    let found = fit(World::honest(), 3);
    assert!((found.alpha - 1.0).abs() < 0.1);
    assert!(found.sentence.ends_with("as trained is right"));
    // The expected NLL, without the chance of a sample, is least at 1 itself.
    let found = fit_alpha(|alpha| Some(0.5 * (alpha - alpha.ln()))).expect("a fit");
    assert_eq!(found.alpha.to_bits(), 1.0_f64.to_bits());
    assert_eq!(found.nll.to_bits(), found.nll_as_trained.to_bits());
}

#[test]
fn the_least_is_found_on_odd_curves() {
    let at = |least: f64| {
        fit_alpha(|alpha| Some((alpha.ln() - least.ln()).powi(2)))
            .expect("a fit")
            .alpha
    };
    for least in [0.06, 0.2, 0.7, 1.3, 4.9] {
        assert!((at(least) / least - 1.0).abs() < 2e-3, "{least}");
    }
    // Beyond the range the end is named.
    let found = fit_alpha(Some).expect("a fit");
    assert!((found.alpha - LEAST).abs() < 1e-9);
    assert!(found.sentence.ends_with("at the end of what was searched"));
    let most = fit_alpha(|alpha| Some(-alpha)).expect("a fit").alpha;
    assert!((most - MOST).abs() < 1e-9);
    // Two valleys, the deeper one at 0.1; holes in the curve.
    let valleys = |alpha: f64| {
        (alpha.ln() - 0.1_f64.ln())
            .abs()
            .min(0.3 + (alpha - 2.0).abs())
    };
    let found = fit_alpha(|alpha| Some(valleys(alpha))).expect("a fit");
    assert!((found.alpha / 0.1 - 1.0).abs() < 5e-3);
    let found = fit_alpha(|alpha| (alpha < 1.5).then(|| (alpha - 1.2).powi(2))).expect("a fit");
    assert!((found.alpha - 1.2).abs() < 5e-3);
    assert_eq!(fit_alpha(|_| None), None);
    assert_eq!(fit_alpha(|_| Some(f64::NAN)), None);
    let mut calls = 0;
    fit_alpha(|alpha| {
        calls += 1;
        Some(alpha)
    });
    assert!(calls <= 26, "{calls}");
}
