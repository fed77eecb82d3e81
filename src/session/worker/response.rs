//! The same episode under damage of rising severity: does an expert notice when its input is spoilt (D17)?

use std::sync::Arc;

use super::Stop;
use super::inferred::{Inferred, infer};
use super::memo::BeliefKey;
use super::opened::Opened;
use crate::episode::Episode;
use crate::measure::calibration::nees;
use crate::measure::corruption::{Corruption, corrupt};
use crate::measure::fusion::mean_share;
use crate::modality::{Expert, Modality};
use crate::session::predict::Predictor;
use crate::session::snapshot::response::ResponseView;

/// Severities from 0 to 1.
const LEVELS: usize = 11;
/// Shares that change less than this over the whole range stay as they are.
const FLAT: f32 = 0.02;

/// What a response depends on: the beliefs, which hold damage and switches.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseKey {
    /// Of which beliefs.
    pub belief: BeliefKey,
    /// To which modality's damage.
    pub modality: Modality,
}

/// Damages, encodes what is damaged, filters, and reads, level by level; `check` is asked between two levels.
pub fn respond(
    (modality, corruption): (Modality, Corruption),
    episode: &Episode,
    inferred: &Inferred,
    opened: &Opened,
    predictor: &dyn Predictor,
    mut check: impl FnMut() -> Result<(), Stop>,
) -> Result<Option<ResponseView>, Stop> {
    let looks = |expert: &Expert| expert.modalities().contains(&modality);
    let experts = &predictor.info().experts;
    let Some(position) = experts.iter().position(looks) else {
        return Ok(None);
    };
    let expert = experts[position];
    let mut view = ResponseView {
        modality,
        damage: corruption.damage,
        expert,
        severity: Vec::new(),
        rmse_m: Vec::new(),
        nees: Vec::new(),
        share: Vec::new(),
        slope: 0.0,
        sentence: String::new(),
    };
    for level in 0..LEVELS {
        check()?;
        let severity = level as f32 / (LEVELS - 1) as f32;
        let spoilt = corrupt(
            episode,
            modality,
            &Corruption {
                severity,
                ..corruption
            },
        );
        let mut trace = Arc::clone(&inferred.trace);
        let trace_experts = &mut Arc::make_mut(&mut trace).experts;
        for (i, said) in trace_experts.iter_mut().enumerate() {
            if experts.get(i).is_some_and(looks) {
                *said = predictor.encode_expert(&spoilt, i)?;
            }
        }
        let damaged = infer(trace, inferred.alphas.clone(), opened.steps(), predictor)?;
        let reading = Reading::of(&damaged, position, &corruption, opened, predictor);
        view.severity.push(severity);
        view.rmse_m.push(reading.rmse_m);
        view.nees.push(reading.nees);
        view.share.push(reading.share);
    }
    view.slope = slope(&view.severity, &view.share);
    view.sentence = sentence(&view);
    Ok(Some(view))
}

/// Means over the damaged steps.
struct Reading {
    rmse_m: f32,
    nees: f32,
    share: f32,
}

impl Reading {
    fn of(
        inferred: &Inferred,
        position: usize,
        corruption: &Corruption,
        opened: &Opened,
        predictor: &dyn Predictor,
    ) -> Self {
        let (mut squares, mut epsilons, mut shares) = (Vec::new(), Vec::new(), Vec::new());
        let until = corruption.until.unwrap_or(usize::MAX).min(opened.steps());
        for step in corruption.from..until {
            let Some(belief) = inferred.belief_at(step) else {
                continue;
            };
            let all = inferred.shares(belief);
            shares.extend(all.get(position).map(|share| mean_share(share)));
            let posterior = inferred.posterior(belief);
            let at = predictor.position(posterior.mean, posterior.log_var);
            let Some((at, truth)) = at.zip(opened.poses.get(step)) else {
                continue;
            };
            let error = at.error([truth.x, truth.y]);
            squares.push(error.error_m[0].powi(2) + error.error_m[1].powi(2));
            epsilons.extend(nees(&error).map(|epsilon| epsilon as f32));
        }
        Self {
            rmse_m: mean(&squares).sqrt(),
            nees: mean(&epsilons),
            share: mean(&shares),
        }
    }
}

/// NaN of nothing.
fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}

/// Least squares.
fn slope(x: &[f32], y: &[f32]) -> f32 {
    let (mean_x, mean_y) = (mean(x), mean(y));
    let along: f32 = std::iter::zip(x, y)
        .map(|(x, y)| (x - mean_x) * (y - mean_y))
        .sum();
    along / x.iter().map(|x| (x - mean_x).powi(2)).sum::<f32>()
}

fn sentence(view: &ResponseView) -> String {
    let name = view.expert.name();
    let (first, last) = match view.share.as_slice() {
        [first, .., last] if first.is_finite() && last.is_finite() => (*first, *last),
        _ => return format!("{name} is not multiplied in here"),
    };
    if first == 0.0 {
        return format!("{name} is off: damage to its input changes nothing");
    }
    let kind = view.damage.name();
    let percent = |share: f32| format!("{:.0} %", 100.0 * share);
    let shares = format!("{} to {}", percent(first), percent(last));
    if view.slope < -FLAT {
        format!("{name} doubts itself: under {kind} its share falls from {shares}")
    } else if view.slope > FLAT {
        format!("{name} grows surer: under {kind} its share rises from {shares}")
    } else {
        format!("{name} does not notice: under {kind} its share stays, {shares}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_line_is_its_own() {
        let x = [0.0, 0.5, 1.0, 1.5];
        assert!((slope(&x, &x.map(|x| 3.0 - 2.0 * x)) + 2.0).abs() < 1e-6);
        assert!(slope(&x, &[1.0; 4]).abs() < 1e-6);
    }
}
