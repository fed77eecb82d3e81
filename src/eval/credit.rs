//! What each sensor contributes to a prediction (D24): exact Shapley values over the sets of sensors that the model was
//! trained on, the prior always in.

use candle_core::Result;
use serde::{Deserialize, Serialize};

use super::prediction::{roll, squared_error, start};
use super::protocol::Protocol;
use super::score::Scorer;
use crate::episode::Episode;
use crate::measure::calibration::{Error2, nll};
use crate::measure::shapley::shapley;
use crate::measure::spread::plane;
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, Rolled};

/// Shapley values of an episode, one a sensor expert in the model's order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Credit {
    /// Of minus the squared error, a sum over pixels, mean over the horizon.
    pub squared_error: Vec<f64>,
    /// What all sensors gain over none, in the same: the sum of the above.
    pub squared_error_gain: f64,
    /// Of minus the position's negative log-likelihood in nats, mean over the horizon; none without a probe, or where
    /// no position was recorded.
    pub nll: Option<Vec<f64>>,
    /// What all sensors gain over none, in nats.
    pub nll_gain: Option<f64>,
}

/// Plays every set of sensors on the context and predicts.
pub(super) fn of(
    scorer: &Scorer,
    protocol: Protocol,
    experts: &ExpertTrace,
    episode: &Episode,
    truth: &[(Vec<f32>, usize)],
) -> Result<Credit> {
    let inspector = &scorer.inspector;
    let sensors = experts.experts.len();
    let beliefs = experts.controls.len() + 1;
    let settings: Vec<Alphas> = (0..1_usize << sensors)
        .map(|set| {
            let mut row: Vec<f32> = (0..sensors).map(|i| (set >> i & 1) as f32).collect();
            row.push(1.0);
            Alphas {
                experts: sensors + 1,
                values: row.repeat(beliefs),
            }
        })
        .collect();
    let filtered = inspector.filter_all(experts, &settings)?;
    let mut means = Vec::new();
    let mut likelihoods = Vec::new();
    for beliefs in &filtered {
        let rolled = roll(inspector, experts, beliefs, protocol)?;
        likelihoods.push(position_nll(scorer, protocol, beliefs, &rolled, episode));
        means.extend(rolled.gaussians.mean);
    }
    let pixels = inspector.decode_pixels(&means)?;
    let size = truth.first().map_or(1, |(truth, _)| truth.len());
    let errors: Vec<f64> = pixels
        .chunks_exact(size * truth.len().max(1))
        .map(|frames| {
            let pairs = frames.chunks_exact(size).zip(truth);
            -pairs
                .map(|(frame, (truth, _))| squared_error(frame, truth))
                .sum::<f64>()
                / truth.len() as f64
        })
        .collect();
    let nlls: Option<Vec<f64>> = likelihoods.into_iter().map(|nll| nll.map(|n| -n)).collect();
    let gain = |values: &[f64]| {
        values
            .last()
            .zip(values.first())
            .map_or(0.0, |(a, b)| a - b)
    };
    Ok(Credit {
        squared_error: shapley(&errors).unwrap_or_default(),
        squared_error_gain: gain(&errors),
        nll: nlls.as_deref().and_then(shapley),
        nll_gain: nlls.as_deref().map(gain),
    })
}

/// Mean over the horizon of the negative log-likelihood of the true position, in nats, under the probe and the
/// uncertainty that accumulates, `A P Aᵀ + Q` (D20).
fn position_nll(
    scorer: &Scorer,
    protocol: Protocol,
    beliefs: &BeliefTrace,
    rolled: &Rolled,
    episode: &Episode,
) -> Option<f64> {
    let probe = scorer.probe.as_ref()?;
    let poses = episode.object.as_ref()?;
    let from = start(&scorer.inspector, protocol).ok()?;
    let log_var = beliefs.posterior.row(from).1;
    let mut sum = 0.0;
    for (step, covariance) in rolled.covariances(log_var).enumerate() {
        let [x, y] = probe.position(rolled.gaussians.row(step).0);
        let truth = poses.get(protocol.context + step)?;
        let error = Error2 {
            error_m: [truth.x - x, truth.y - y],
            covariance: plane(&probe.weights, &covariance)?,
        };
        sum += nll(&error.beside(probe.residual))?;
    }
    Some(sum / rolled.gaussians.len() as f64)
}
