//! The diagnostics of a fusion, read at every step of an episode at once.

use std::sync::Arc;

use super::inferred::Inferred;
use super::memo::BeliefKey;
use super::opened::Opened;
use crate::measure::active::LatentStats;
use crate::measure::attribution::attribution;
use crate::measure::calibration::nees;
use crate::measure::divergence::{KlParts, kl_parts};
use crate::measure::gaussian::Factor;
use crate::measure::innovation::{conflict, disagreements, nis, predicted_covariance};
use crate::measure::leave_one_out::without;
use crate::measure::pull::pulls;
use crate::session::known::Known;
use crate::session::predict::{PredictError, Predictor};
use crate::session::snapshot::reading::{ExpertReading, FusionView, SeriesView};

/// Readings depend on the beliefs, and on which dimensions are known to be active.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingsKey {
    /// Of which beliefs.
    pub belief: BeliefKey,
    /// How many episodes the activity was measured on; none for this episode alone.
    pub known: Option<usize>,
}

/// Readings of an episode.
#[derive(Debug)]
pub struct Readings {
    /// One a step; none before the first belief.
    pub fusion: Vec<Option<Arc<FusionView>>>,
    /// Over time.
    pub series: Arc<SeriesView>,
}

/// What is the same at every step.
struct Reader<'a> {
    inferred: &'a Inferred,
    predictor: &'a dyn Predictor,
    stats: LatentStats,
    active: Arc<Vec<bool>>,
    active_from: String,
    importance_m: Arc<Vec<f64>>,
    /// `A_t` of each belief, `(beliefs, Z, Z)`.
    transitions: Vec<f32>,
    latent: usize,
}

/// Reads every step. Of a model that multiplies nothing there is only how far its belief moves and how honest it is.
pub fn read(
    inferred: &Inferred,
    opened: &Opened,
    known: Option<&Known>,
    predictor: &dyn Predictor,
) -> Result<Readings, PredictError> {
    let latent = predictor.info().latent;
    let stats = known.map_or_else(|| own_stats(inferred), |known| known.stats.clone());
    let mut active = stats.active();
    if !active.contains(&true) {
        // An episode in which nothing moves says nothing about activity.
        active.fill(true);
    }
    let reader = Reader {
        active: Arc::new(active),
        active_from: known.map_or_else(
            || "this episode".to_owned(),
            |known| format!("{} episodes", known.episodes),
        ),
        importance_m: Arc::new(known.map(|k| k.importance_m.clone()).unwrap_or_default()),
        transitions: predictor.transitions(&inferred.beliefs)?,
        inferred,
        predictor,
        stats,
        latent,
    };
    let steps = opened.steps();
    let experts = predictor.info().experts.len();
    let blank = || vec![f32::NAN; steps];
    let mut series = SeriesView {
        share_position: vec![blank(); experts + 1],
        nis_head: vec![blank(); experts],
        nis_propagated: vec![blank(); experts],
        nis_bounds: None,
        conflict: blank(),
        conflict_bounds: vec![None; steps],
        surprise: blank(),
        nees: blank(),
        nees_bare: blank(),
    };
    let mut fusion = vec![None; steps];
    for step in 0..steps {
        let Some(belief) = inferred.belief_at(step) else {
            continue;
        };
        let surprise = reader.surprise(belief);
        series.surprise[step] = surprise.mean + surprise.spread;
        if let Some(truth) = opened.poses.get(step) {
            let [with, bare] = reader.nees(belief, [truth.x, truth.y]);
            (series.nees[step], series.nees_bare[step]) = (with, bare);
        }
        if !predictor.info().has_product() {
            continue;
        }
        let view = reader.view(belief);
        for (i, reading) in view.experts.iter().enumerate() {
            let Some(nis) = &reading.nis else { continue };
            series.nis_head[i][step] = nis.head;
            series.nis_propagated[i][step] = nis.propagated.unwrap_or(f32::NAN);
            series.nis_bounds = series.nis_bounds.or(nis.bounds);
        }
        if let Some(conflict) = &view.conflict {
            series.conflict[step] = conflict.energy;
            series.conflict_bounds[step] = conflict.bounds;
        }
        for (row, share) in series
            .share_position
            .iter_mut()
            .zip(reader.position_shares(belief).into_iter().flatten())
        {
            row[step] = share;
        }
        fusion[step] = Some(Arc::new(view));
    }
    Ok(Readings {
        fusion,
        series: Arc::new(series),
    })
}

/// Of one episode's beliefs.
fn own_stats(inferred: &Inferred) -> LatentStats {
    let mut stats = LatentStats::default();
    for belief in 0..inferred.len() {
        stats.push(inferred.posterior(belief).mean);
    }
    stats
}

impl Reader<'_> {
    fn view(&self, belief: usize) -> FusionView {
        let factors = self.inferred.factors(belief);
        let posterior = self.inferred.posterior(belief);
        let prior = self.inferred.prior(belief);
        let weights = self.predictor.position_weights();
        let position = |mean: &[f32], log_var: &[f32]| self.predictor.position(mean, log_var);
        let sensors = &factors[..factors.len() - 1];
        let pulls_m = weights.and_then(|weights| {
            let prior = Factor {
                gaussian: prior,
                alpha: factors[sensors.len()].alpha,
            };
            pulls(sensors, prior, weights)
        });
        let propagated = self.predicted(belief);
        let reading = |i: usize| {
            let (factor, is_sensor) = (factors[i], i < sensors.len());
            let left = without(&factors, i, weights);
            ExpertReading {
                nis: is_sensor
                    .then(|| nis(factor, prior, propagated.as_deref(), &self.active))
                    .flatten(),
                fused: factor.is_on().then(|| kl_parts(posterior, factor.gaussian)),
                claim: is_sensor.then(|| kl_parts(factor.gaussian, prior)),
                information_nats: left.as_ref().map(|left| left.information_nats),
                mahalanobis: left.as_ref().map(|left| left.mahalanobis),
                without: left.and_then(|left| position(&left.mean, &left.log_var)),
                pull_m: pulls_m.as_ref().and_then(|pulls| pulls.get(i).copied()),
            }
        };
        let at = |mean: &[f32]| position(mean, prior.log_var).map(|at| [at.x, at.y]);
        let (prior_m, belief_m) = (at(prior.mean), at(posterior.mean));
        FusionView {
            experts: (0..factors.len()).map(reading).collect(),
            surprise: Some(self.surprise(belief)),
            disagreements: disagreements(&factors, &self.active),
            conflict: conflict(&factors, &self.active),
            correction_m: prior_m
                .zip(belief_m)
                .map(|(prior, belief)| [belief[0] - prior[0], belief[1] - prior[1]]),
            prior_m,
            attribution: weights
                .and_then(|w| attribution(w, posterior.mean, posterior.log_var, &self.stats))
                .map(Arc::new),
            active: Arc::clone(&self.active),
            active_from: self.active_from.clone(),
            importance_m: Arc::clone(&self.importance_m),
        }
    }

    /// `KL(belief ‖ prior)` (D2).
    fn surprise(&self, belief: usize) -> KlParts {
        kl_parts(self.inferred.posterior(belief), self.inferred.prior(belief))
    }

    /// A P Aᵀ + Q of the transition that led to a belief; none for the first, which nothing led to.
    fn predicted(&self, belief: usize) -> Option<Vec<f64>> {
        let before = belief.checked_sub(1)?;
        let size = self.latent * self.latent;
        let transition = self.transitions.get(belief * size..(belief + 1) * size)?;
        let (posterior, noise) = (self.inferred.posterior(before), self.inferred.prior(belief));
        Some(predicted_covariance(
            transition,
            posterior.log_var,
            noise.log_var,
        ))
    }

    fn position_shares(&self, belief: usize) -> Option<Vec<f32>> {
        let weights = self.predictor.position_weights()?;
        let shares = self.inferred.shares(belief);
        self.inferred.position_shares(belief, &shares, weights)
    }

    /// NEES of the position with R_p and without (D11); NaN where there is none.
    fn nees(&self, belief: usize, truth: [f32; 2]) -> [f32; 2] {
        let posterior = self.inferred.posterior(belief);
        let Some(at) = self.predictor.position(posterior.mean, posterior.log_var) else {
            return [f32::NAN; 2];
        };
        let residual = self.predictor.position_residual().unwrap_or_default();
        let off = at.error(truth);
        [off, off.beside(residual.map(|r| -r))]
            .map(|error| nees(&error).map_or(f32::NAN, |value| value as f32))
    }
}
