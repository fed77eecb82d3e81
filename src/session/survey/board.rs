//! Consistency over a split: one error an episode and horizon, then the laws they should follow (D11 to D15).

use std::sync::Arc;

use super::score::Sheet;
use crate::episode::Split;
use crate::measure::calibration::{
    Error2, HorizonNees, calibration, horizon_nees, nees, nll as nll_of,
};
use crate::measure::correlation::{dependence, dependence_beyond};
use crate::measure::gaussian::{Factor, Gaussian};
use crate::measure::spread::{diagonal, plane};
use crate::measure::tempering::{FittedAlpha, fit_alpha};
use crate::modality::Expert;
use crate::session::predict::Predictor;
use crate::session::settings::Settings;
use crate::session::snapshot::Estimate;
use crate::session::snapshot::board::BoardView;

/// Episodes that α is fitted on, at most.
pub const FITTED_ON: usize = 128;

/// Errors collected so far. Averages are over episodes, never along time: errors of one episode hang together.
pub struct Board {
    settings: Settings,
    split: Option<Split>,
    total: usize,
    looked_at: usize,
    /// Images seen before the prediction: the wish, or as many as the longest episode has room for.
    context: usize,
    /// Of the filtered belief, then of each horizon, with the head's spread.
    by_head: Vec<Vec<Error2>>,
    /// The same with A P Aᵀ + Q carried along.
    by_propagation: Vec<Vec<Error2>>,
    /// The same of the belief that goes on seeing.
    by_filter: Vec<Vec<Error2>>,
    /// Of the filtered belief without R_p.
    bare: Vec<Error2>,
    /// Of each sensor expert that is on, alone, an error an episode, in metres.
    single: Vec<(Expert, Vec<[f32; 2]>)>,
    /// Sums over episodes of what precision the prior brings to the position, and a sensor expert on average.
    precisions: [f64; 2],
    residual: [f32; 3],
    /// Why the first of the episodes that could not be read was not.
    fault: Option<String>,
}

impl Board {
    /// For so many episodes.
    pub fn new(settings: &Settings, split: Option<Split>, total: usize) -> Self {
        Self {
            settings: settings.clone(),
            split,
            total,
            looked_at: 0,
            context: 0,
            by_head: Vec::new(),
            by_propagation: Vec::new(),
            by_filter: Vec::new(),
            bare: Vec::new(),
            single: Vec::new(),
            precisions: [0.0; 2],
            residual: [0.0; 3],
            fault: None,
        }
    }

    /// An episode that cannot be read, and why.
    pub fn leave_out(&mut self, why: String) {
        self.looked_at += 1;
        self.fault.get_or_insert(why);
    }

    /// Adds an episode; one without poses or controls only counts as looked at.
    pub fn take(&mut self, sheet: &Sheet, predictor: &dyn Predictor) {
        self.looked_at += 1;
        // What cannot be filtered is told where the episode is shown.
        let _ = self.add(sheet, predictor);
    }

    fn add(&mut self, sheet: &Sheet, predictor: &dyn Predictor) -> Option<()> {
        let info = predictor.info();
        let beliefs = sheet.steps.checked_sub(info.frame_stack)?;
        let alphas = info.alphas(&self.settings.switches, beliefs);
        let inferred = sheet.infer(alphas, predictor).ok()?;
        let rollout = self.settings.rollout(sheet.steps, info.frame_stack);
        let from = inferred.start(rollout);
        let posterior = inferred.posterior(from);
        let truth_m = sheet.truth_m(rollout.start)?;
        let at = position(predictor, posterior)?;
        let residual = predictor.position_residual()?;
        self.residual = residual;
        self.context = self.context.max(rollout.start + 1);
        let off = at.error(truth_m);
        self.bare.push(off.beside(residual.map(|r| -r)));
        push(&mut self.by_head, 0, off);
        push(&mut self.by_propagation, 0, off);
        push(&mut self.by_filter, 0, off);
        let weights = predictor.position_weights()?;
        let factors = inferred.factors(from);
        let brings = |factor: &Factor| {
            let spread = plane(weights, &diagonal(factor.gaussian.log_var))?;
            factor
                .is_on()
                .then(|| 2.0 * f64::from(factor.alpha) / f64::from(spread[0] + spread[2]))
        };
        let (prior, sensors) = factors.split_last()?;
        let each: Vec<f64> = sensors.iter().filter_map(brings).collect();
        self.precisions[0] += brings(prior).unwrap_or(0.0);
        self.precisions[1] += each.iter().sum::<f64>() / each.len().max(1) as f64;
        for (i, factor) in sensors.iter().enumerate() {
            let Some(&expert) = info.experts.get(i).filter(|_| factor.is_on()) else {
                continue;
            };
            let alone = position(predictor, factor.gaussian)?;
            let error_m = alone.error(truth_m).error_m;
            match self.single.iter_mut().find(|(e, _)| *e == expert) {
                Some((_, errors)) => errors.push(error_m),
                None => self.single.push((expert, vec![error_m])),
            }
        }
        let controls = inferred.controls(rollout, None).ok()?;
        let rolled = predictor.rollout(&inferred.beliefs, from, &controls).ok()?;
        for (step, covariance) in rolled.covariances(posterior.log_var).enumerate() {
            let (mean, log_var) = rolled.gaussians.row(step);
            let at = position(predictor, Gaussian { mean, log_var })?;
            let image = rollout.start + 1 + step;
            let truth_m = sheet.truth_m(image)?;
            let off = at.error(truth_m);
            let seeing_on = inferred.posterior(inferred.belief_at(image)?);
            let seen = position(predictor, seeing_on)?;
            let plane = plane(weights, &covariance)?;
            let propagated = Error2 {
                covariance: std::array::from_fn(|i| plane[i] + residual[i]),
                ..off
            };
            push(&mut self.by_head, step + 1, off);
            push(&mut self.by_propagation, step + 1, propagated);
            push(&mut self.by_filter, step + 1, seen.error(truth_m));
        }
        Some(())
    }

    /// How far it is, without numbers.
    pub fn progress(&self) -> BoardView {
        BoardView {
            split: self.split.map_or("all", Split::name).to_owned(),
            episodes: self.looked_at,
            total: self.total,
            ..BoardView::default()
        }
    }

    /// What the errors say, but for α.
    pub fn view(&self, predictor: &dyn Predictor) -> BoardView {
        let why_not = if predictor.position_weights().is_none() {
            Some(format!(
                "{} has no position probe; train writes one",
                predictor.info().name
            ))
        } else if self.bare.is_empty() {
            let why = "no episode has a recorded object pose and controls";
            let read = |fault: &String| format!("no episode can be measured; the first: {fault}");
            Some(self.fault.as_ref().map_or_else(|| why.to_owned(), read))
        } else {
            None
        };
        // The last horizon that every episode has.
        let everywhere = |errors: &&Vec<Error2>| errors.len() == self.bare.len();
        let horizon = self.by_head.iter().take_while(everywhere).count().max(1) - 1;
        let filtered = self.by_head.first().and_then(|e| calibration(e));
        let at_horizon = |lists: &[Vec<Error2>]| {
            let errors = lists.get(horizon).filter(|_| horizon > 0)?;
            calibration(errors)
        };
        let predicted = at_horizon(&self.by_head);
        let nees_of = |lists: &[Vec<Error2>]| -> Vec<HorizonNees> {
            let each = lists.iter().enumerate();
            each.filter_map(|(h, errors)| horizon_nees(h, errors))
                .collect()
        };
        let errors: Vec<Vec<[f32; 2]>> = self.single.iter().map(|(_, e)| e.clone()).collect();
        // The probe's own residual is in every expert's error; where it leaves nothing over, it is not taken off.
        let beyond = dependence_beyond(&errors, self.residual);
        let dependence = beyond
            .or_else(|| dependence(&errors))
            .map(|dependence| dependence.beside_prior(self.precisions[0], self.precisions[1]));
        let say = |what: &str, sentence: &str| format!("{what} {sentence}");
        let mut sentences = Vec::new();
        if let Some(filtered) = &filtered {
            let what = format!("the belief at image {}", self.context);
            sentences.push(say(&what, &filtered.sentence));
        }
        if let Some(bare) = mean_nees(&self.bare).filter(|_| filtered.is_some()) {
            sentences.push(format!(
                "without the probe's residual its mean NEES is {bare:.1} where 2 is right; R_p was fitted to take that up"
            ));
        }
        if let Some(predicted) = &predicted {
            let what = format!("the prediction {horizon} steps on");
            sentences.push(say(&what, &predicted.sentence));
        }
        if let Some(seeing_on) = at_horizon(&self.by_filter) {
            let image = self.context + horizon;
            let what = format!("seeing on, the belief at image {image}");
            sentences.push(say(&what, &seeing_on.sentence));
        }
        if let Some(propagated) = at_horizon(&self.by_propagation) {
            let what = "the prediction with its spread carried along (A P Aᵀ + Q)";
            sentences.push(say(what, &propagated.sentence));
        }
        if let Some(dependence) = &dependence {
            sentences.push(dependence.sentence.clone());
        }
        BoardView {
            why_not,
            filtered,
            filtered_bare_nees: mean_nees(&self.bare),
            predicted,
            by_head: nees_of(&self.by_head),
            by_propagation: nees_of(&self.by_propagation),
            by_filter: nees_of(&self.by_filter),
            dependence,
            experts: self.single.iter().map(|(expert, _)| *expert).collect(),
            sentences,
            ..self.progress()
        }
    }
}

fn push(lists: &mut Vec<Vec<Error2>>, at: usize, error: Error2) {
    if lists.len() <= at {
        lists.resize_with(at + 1, Vec::new);
    }
    lists[at].push(error);
}

fn position(predictor: &dyn Predictor, gaussian: Gaussian) -> Option<Estimate> {
    predictor.position(gaussian.mean, gaussian.log_var)
}

fn mean_nees(errors: &[Error2]) -> Option<f64> {
    let values: Vec<f64> = errors.iter().filter_map(nees).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The α of one sensor expert, everywhere and all others as they are, that makes the positions of all beliefs
/// likeliest (D15). None for an expert that is off throughout, and without poses or a probe.
pub fn fit(
    settings: &Settings,
    sheets: &[Arc<Sheet>],
    expert: usize,
    predictor: &dyn Predictor,
    mut stopped: impl FnMut() -> bool,
) -> Option<(Expert, FittedAlpha)> {
    let info = predictor.info();
    let &kind = info.experts.get(expert)?;
    if !info.has_product() {
        return None;
    }
    let nll = |alpha: f64| {
        let mut sum = 0.0;
        let mut count = 0_u32;
        for sheet in sheets {
            if stopped() {
                return None;
            }
            let beliefs = sheet.steps.checked_sub(info.frame_stack)?;
            let mut alphas = info.alphas(&settings.switches, beliefs);
            let switches = alphas.experts;
            for own in alphas.values.iter_mut().skip(expert).step_by(switches) {
                if *own > 0.0 {
                    *own = alpha as f32;
                }
            }
            if alphas
                .values
                .iter()
                .skip(expert)
                .step_by(switches)
                .all(|&a| a == 0.0)
            {
                return None;
            }
            let inferred = sheet.infer(alphas, predictor).ok()?;
            for step in 0..sheet.steps {
                let off = inferred.belief_at(step).and_then(|belief| {
                    let at = position(predictor, inferred.posterior(belief))?;
                    Some(at.error(sheet.truth_m(step)?))
                });
                if let Some(nll) = off.as_ref().and_then(nll_of) {
                    sum += nll;
                    count += 1;
                }
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    };
    fit_alpha(nll).map(|fitted| (kind, fitted))
}
