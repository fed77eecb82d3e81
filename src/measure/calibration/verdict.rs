//! What a number says about confidence, in a word and in a sentence that can be pasted.

use std::fmt;

use serde::Serialize;

use super::{CoveragePoint, FEW};

/// Whether a claim of confidence holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing speaks against the claim.
    Calibrated,
    /// Errors are larger than claimed.
    Overconfident,
    /// Errors are smaller than claimed.
    Underconfident,
    /// Too few episodes to say.
    TooFew,
}

impl Verdict {
    /// The word that faces show.
    pub fn name(self) -> &'static str {
        match self {
            Self::Calibrated => "calibrated",
            Self::Overconfident => "overconfident",
            Self::Underconfident => "underconfident",
            Self::TooFew => "too few",
        }
    }

    /// By the binomial interval of what is held.
    pub(super) fn of_claim(point: CoveragePoint, n: usize) -> Self {
        if n < FEW {
            Self::TooFew
        } else if point.claimed > point.high {
            Self::Overconfident
        } else if point.claimed < point.low {
            Self::Underconfident
        } else {
            Self::Calibrated
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// "claims 95 %, holds 71 % [64, 77] of 160: overconfident". `by_nees` is the mean NEES, where that alone says so.
pub(super) fn sentence(
    point: CoveragePoint,
    n: usize,
    skipped: usize,
    verdict: Verdict,
    by_nees: Option<f64>,
) -> String {
    let [claimed, held, low, high] =
        [point.claimed, point.held, point.low, point.high].map(|part| 100.0 * part);
    // Whole percents, unless rounding would put the claim into an interval that excludes it.
    let excluded = point.claimed < point.low || point.claimed > point.high;
    let digits = (0..3)
        .find(|&digits| {
            let shown = |x: f64| format!("{x:.digits$}");
            !excluded || ![low, high].map(shown).contains(&shown(claimed))
        })
        .unwrap_or(0);
    let left_out = match skipped {
        0 => String::new(),
        _ => format!(", {skipped} more without a usable covariance"),
    };
    let word = match (verdict, by_nees) {
        (Verdict::TooFew, _) => format!("too few to say, {FEW} or more are needed"),
        (_, Some(mean)) => format!("{verdict} (mean NEES {mean:.1}, not 2)"),
        _ => verdict.to_string(),
    };
    format!(
        "claims {claimed:.0} %, holds {held:.digits$} % [{low:.digits$}, {high:.digits$}] of {n}{left_out}: {word}"
    )
}
