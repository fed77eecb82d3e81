//! Tempering as a reading (D15): the α at which an expert would be honest.
//!
//! `α̂ = argmin NLL` on held-out episodes. Below 1 the expert is oversure as trained, above 1 it is timid. The model
//! stays as it is. n equal experts tempered together, with an honest prior or none, give `1 / (1 + (n − 1) ρ)`, so k
//! copies of one expert give 1/k.

use serde::Serialize;

/// The range that is searched.
const LEAST: f64 = 0.05;
const MOST: f64 = 5.0;
/// Intervals of the first, even look in ln α: a curve with two valleys must not trap the section.
const LOOKS: usize = 8;
/// Where the section stops, in ln α.
const CLOSE: f64 = 2e-3;
/// Within this of 1, in ln α, the sentence says that the training was right.
const ALIKE: f64 = 0.05;

/// The α that fits best.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedAlpha {
    /// α̂, within 0.2 %; exactly 1 where no other does better.
    pub alpha: f64,
    /// NLL at α̂, in the caller's unit (nats an episode).
    pub nll: f64,
    /// NLL at α = 1.
    pub nll_as_trained: f64,
    /// In words: "α 0.36 fits best (NLL -3.201 against -2.914 as trained): oversure".
    pub sentence: String,
}

/// The α in 0.05..=5 of the least `nll`: an even look in ln α, then a golden section around the best.
///
/// About 22 calls. What gives no finite number is avoided; none where α = 1 does not.
pub fn fit_alpha(mut nll: impl FnMut(f64) -> Option<f64>) -> Option<FittedAlpha> {
    let mut at = |log: f64| {
        let found = nll(log.exp().clamp(LEAST, MOST));
        found.filter(|x| x.is_finite()).unwrap_or(f64::INFINITY)
    };
    let nll_as_trained = at(0.0);
    if !nll_as_trained.is_finite() {
        return None;
    }
    let (low, high) = (LEAST.ln(), MOST.ln());
    let look = |i: usize| low + (high - low) * i as f64 / LOOKS as f64;
    let values: Vec<f64> = (0..=LOOKS).map(|i| at(look(i))).collect();
    let best = (0..=LOOKS).min_by(|&a, &b| values[a].total_cmp(&values[b]))?;
    let around = (look(best.saturating_sub(1)), look((best + 1).min(LOOKS)));
    // The section never calls the ends, so the look's own value competes with what it finds.
    let found = [
        golden(&mut at, around),
        (look(best), values[best]),
        (0.0, nll_as_trained),
    ];
    let (log, nll) = found.into_iter().rev().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let alpha = log.exp().clamp(LEAST, MOST);
    Some(FittedAlpha {
        alpha,
        nll,
        nll_as_trained,
        sentence: sentence(log, alpha, nll, nll_as_trained),
    })
}

/// The least of `f` between `low` and `high`, where it has one valley: where, and how much.
fn golden(f: &mut impl FnMut(f64) -> f64, (mut low, mut high): (f64, f64)) -> (f64, f64) {
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    let inner = |low: f64, high: f64| (high - part * (high - low), low + part * (high - low));
    let (mut a, mut b) = inner(low, high);
    let (mut at_a, mut at_b) = (f(a), f(b));
    while high - low > CLOSE {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high).0;
            at_a = f(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high).1;
            at_b = f(b);
        }
    }
    if at_a < at_b { (a, at_a) } else { (b, at_b) }
}

fn sentence(log: f64, alpha: f64, nll: f64, as_trained: f64) -> String {
    let at_end = log < LEAST.ln() + CLOSE || log > MOST.ln() - CLOSE;
    let word = match () {
        () if log.abs() < ALIKE => "as trained is right",
        () if log < 0.0 => "oversure",
        () => "timid",
    };
    let end = if at_end {
        ", at the end of what was searched"
    } else {
        ""
    };
    format!("α {alpha:.2} fits best (NLL {nll:.3} against {as_trained:.3} as trained): {word}{end}")
}

#[cfg(test)]
mod tests;
