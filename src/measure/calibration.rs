//! Whether a belief's position is as sure as it claims to be, over many episodes (D11 to D13).
//!
//! Everything here reads pairs of an error and the covariance that was claimed for it, at most one pair an episode:
//! errors along one episode depend on each other, and the intervals below would be too narrow. Whether the probe's
//! residual R_p is in the covariance is the caller's choice, and worth looking at both ways: R_p was fitted so that
//! filtered beliefs of `val` come out right on average, so with it an oversure fusion looks calibrated there.

mod coverage;
mod nees;
mod scores;
mod verdict;

use serde::Serialize;

pub use coverage::CoveragePoint;
pub use nees::{Error2, HorizonNees, horizon_nees, nees};
pub use verdict::Verdict;

use coverage::{area, coverage, histogram};
use scores::{crps, sharpness};

/// Fewer episodes than this get no verdict.
pub const FEW: usize = 20;
/// The claim that verdicts are about.
pub const CLAIM: f64 = 0.95;

/// What the ellipses of a set of episodes claim, and what they hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// Errors that were counted.
    pub n: usize,
    /// Errors that were left out: not finite, or their covariance not positive definite.
    pub skipped: usize,
    /// The coverage curve, claims rising (D12); [`CLAIM`] is among them.
    pub coverage: Vec<CoveragePoint>,
    /// `∫ |ĉ(π) − π| dπ`, 0 to 1/2 (D12).
    pub area: f64,
    /// Shares of the probability integral transform `χ²₂(ε)` in ten bins (D12): flat at 0.1 where calibrated, high
    /// at the right where oversure.
    pub pit: Vec<f64>,
    /// Mean `tr P` in cm² (D13): what calibration is bought with.
    pub sharpness_cm2: f64,
    /// Mean `½ (ε + ln det 2πP)` in nats, positions in metres (D13).
    pub nll: f64,
    /// Mean continuous ranked probability score along x and y, in cm (D13).
    pub crps_cm: [f64; 2],
    /// Overconfident where the 95 % claimed lie above the binomial interval of what is held, underconfident where
    /// below; where within, what the mean NEES says: with fewer than 73 episodes all of them inside is what 95 % may
    /// give, and only it can tell claiming too little.
    pub verdict: Verdict,
    /// The verdict in words: "claims 95 %, holds 71 % [64, 77] of 160: overconfident".
    pub sentence: String,
}

impl Calibration {
    /// The point of the curve at [`CLAIM`].
    pub fn at_claim(&self) -> Option<CoveragePoint> {
        let at = |point: &&CoveragePoint| (point.claimed - CLAIM).abs() < 1e-9;
        self.coverage.iter().find(at).copied()
    }
}

/// `½ (ε + ln det 2πP)` in nats, positions in metres (D13); none where [`nees`] has none.
pub fn nll(error: &Error2) -> Option<f64> {
    nees(error).map(|nees| scores::nll(error, nees))
}

/// Calibration, sharpness and scores of `errors` (D12, D13), at most one an episode. None where none can be counted.
pub fn calibration(errors: &[Error2]) -> Option<Calibration> {
    let counted: Vec<(Error2, f64)> = errors
        .iter()
        .filter_map(|&error| nees(&error).map(|nees| (error, nees)))
        .collect();
    if counted.is_empty() {
        return None;
    }
    // For two degrees of freedom χ² is the exponential law: the share of it below ε.
    let mut pit: Vec<f64> = counted.iter().map(|(_, e)| -(-0.5 * e).exp_m1()).collect();
    pit.sort_by(f64::total_cmp);
    let n = counted.len();
    let skipped = errors.len() - n;
    let claim = CoveragePoint::at(CLAIM, &pit);
    let by_claim = Verdict::of_claim(claim, n);
    let by_nees = horizon_nees(0, errors)
        .filter(|nees| by_claim == Verdict::Calibrated && nees.verdict != Verdict::Calibrated);
    let verdict = by_nees.map_or(by_claim, |nees| nees.verdict);
    let mean = |of: &dyn Fn(&(Error2, f64)) -> f64| counted.iter().map(of).sum::<f64>() / n as f64;
    Some(Calibration {
        n,
        skipped,
        coverage: coverage(&pit),
        area: area(&pit),
        pit: histogram(&pit),
        sharpness_cm2: 1e4 * mean(&|(error, _)| sharpness(error)),
        nll: mean(&|(error, nees)| scores::nll(error, *nees)),
        crps_cm: [0, 1].map(|axis| 1e2 * mean(&|(error, _)| crps(error, axis))),
        verdict,
        sentence: verdict::sentence(claim, n, skipped, verdict, by_nees.map(|nees| nees.mean)),
    })
}

#[cfg(test)]
mod tests;
