//! How well a model predicts: open loop against the truth, beside predictors that anybody could write.

use std::borrow::Borrow;

use candle_core::Result;
use serde::{Deserialize, Serialize};

use crate::episode::Episode;
use crate::measure::bootstrap::{self, Interval};
use crate::measure::frame::psnr_db_from_mse;
use crate::model::Model;
use crate::model::inspect::Inspector;
use crate::model::observation::observe;
use crate::model::trace::Alphas;

/// c images are seen with every expert on; the next h are predicted from the known controls alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Protocol {
    /// c, counted in images: with stacked frames there are fewer beliefs.
    pub context: usize,
    /// h.
    pub horizon: usize,
}

impl Protocol {
    /// The paper's 4 and 11, cut to an episode of `steps` images.
    pub fn for_episode(steps: usize) -> Self {
        Self {
            context: 4,
            horizon: 11.min(steps.saturating_sub(4)),
        }
    }
}

/// Predicted pixels in [0, 1] of images c + 1 … c + h, `(h, height * width)`.
pub fn open_loop<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    episode: &Episode,
    protocol: Protocol,
) -> Result<Vec<f32>> {
    let config = &inspector.model().config;
    let seen = observe(config, episode).map_err(candle_core::Error::wrap)?;
    let experts = inspector.encode(&seen)?;
    let beliefs = inspector.filter(&experts, &Alphas::trained(seen.beliefs, config.switches()))?;
    let Some(from) = protocol.context.checked_sub(config.frame_stack + 1) else {
        candle_core::bail!(
            "a context of {} images is too short: the first belief is at image {}",
            protocol.context,
            config.frame_stack + 1
        );
    };
    let Some(controls) = experts.controls.get(from..from + protocol.horizon) else {
        candle_core::bail!(
            "a rollout of {} steps from belief {from} needs controls that were not recorded",
            protocol.horizon
        );
    };
    let rolled = inspector.rollout(&beliefs, from, controls)?;
    inspector.decode_pixels(&rolled.gaussians.mean)
}

/// Mean squared error of each predicted image.
pub fn open_loop_mse<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    episode: &Episode,
    protocol: Protocol,
) -> Result<Vec<f64>> {
    let predicted = open_loop(inspector, episode, protocol)?;
    let pixels = predicted.len() / protocol.horizon.max(1);
    Ok(predicted
        .chunks_exact(pixels.max(1))
        .zip(&episode.frames[protocol.context..])
        .map(|(predicted, truth)| mse(predicted, &truth.pixels))
        .collect())
}

/// Mean squared error of pixels in [0, 1] against grey levels.
fn mse(predicted: &[f32], truth: &[u8]) -> f64 {
    let sum: f64 = predicted
        .iter()
        .zip(truth)
        .map(|(&p, &t)| (f64::from(p) - f64::from(t) / 255.0).powi(2))
        .sum();
    sum / truth.len() as f64
}

/// PSNR in dB at one horizon, averaged over episodes, and how far the model is ahead, paired over episodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Images after the context, from 1.
    pub horizon: usize,
    /// The model's.
    pub model_db: f64,
    /// Of the last seen frame, held.
    pub held_db: f64,
    /// Of the mean training frame.
    pub mean_frame_db: f64,
    /// Model less held, with its 95 % bootstrap interval.
    pub over_held: Interval,
    /// Model less mean frame, with its 95 % bootstrap interval.
    pub over_mean_frame: Interval,
}

/// A model's open-loop scores on some episodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The model's name.
    pub model: String,
    /// How it was scored.
    pub protocol: Protocol,
    /// On how many episodes.
    pub episodes: usize,
    /// One a horizon.
    pub rows: Vec<Row>,
}

/// Scores a model beside the trivial predictors; `mean_frame` is of its training set. None for no episodes.
pub fn report<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    episodes: &[Episode],
    mean_frame: &[f32],
    protocol: Protocol,
    mut done: impl FnMut(),
) -> Result<Option<Report>> {
    let mut scores = vec![Vec::new(); protocol.horizon];
    for episode in episodes {
        let ours = open_loop_mse(inspector, episode, protocol)?;
        let held: Vec<f32> = episode.frames[protocol.context - 1]
            .pixels
            .iter()
            .map(|&p| f32::from(p) / 255.0)
            .collect();
        for ((scores, ours), truth) in scores
            .iter_mut()
            .zip(ours)
            .zip(&episode.frames[protocol.context..])
        {
            let psnr = |mse: f64| f64::from(psnr_db_from_mse(mse));
            scores.push([
                psnr(ours),
                psnr(mse(&held, &truth.pixels)),
                psnr(mse(mean_frame, &truth.pixels)),
            ]);
        }
        done();
    }
    let row = |(i, scores): (usize, &Vec<[f64; 3]>)| {
        let mean = |k: usize| scores.iter().map(|s| s[k]).sum::<f64>() / scores.len() as f64;
        let ahead = |k: usize| {
            let differences: Vec<f64> = scores.iter().map(|s| s[0] - s[k]).collect();
            bootstrap::mean_95(&differences, 0)
        };
        Some(Row {
            horizon: i + 1,
            model_db: mean(0),
            held_db: mean(1),
            mean_frame_db: mean(2),
            over_held: ahead(1)?,
            over_mean_frame: ahead(2)?,
        })
    };
    let rows: Option<Vec<Row>> = scores.iter().enumerate().map(row).collect();
    Ok(rows.map(|rows| Report {
        model: inspector.model().config.name.clone(),
        protocol,
        episodes: episodes.len(),
        rows,
    }))
}
