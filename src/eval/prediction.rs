//! What a model makes of an episode whose end it does not see.

use std::borrow::Borrow;

use candle_core::{Result, bail};

use super::protocol::Protocol;
use crate::episode::Episode;
use crate::model::Model;
use crate::model::inspect::Inspector;
use crate::model::observation::observe;
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace, Rolled};

/// What the sensors say of an episode.
pub fn encode<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    episode: &Episode,
) -> Result<ExpertTrace> {
    let seen = observe(&inspector.model().config, episode).map_err(candle_core::Error::wrap)?;
    inspector.encode(&seen)
}

/// What the sensors say of an episode, and what is believed of it with every expert on.
pub fn believe<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    episode: &Episode,
) -> Result<(ExpertTrace, BeliefTrace)> {
    let experts = encode(inspector, episode)?;
    let switches = inspector.model().config.switches();
    let alphas = Alphas::trained(experts.controls.len() + 1, switches);
    let beliefs = inspector.filter(&experts, &alphas)?;
    Ok((experts, beliefs))
}

/// The last belief that saw something, under a protocol.
pub fn start<M: Borrow<Model>>(inspector: &Inspector<M>, protocol: Protocol) -> Result<usize> {
    let stack = inspector.model().config.frame_stack;
    let Some(from) = protocol.context.checked_sub(stack + 1) else {
        bail!(
            "a context of {} images is too short: the first belief is at image {}",
            protocol.context,
            stack + 1
        );
    };
    Ok(from)
}

/// The h steps after the context: the prior alone, with the recorded controls.
pub fn roll<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    experts: &ExpertTrace,
    beliefs: &BeliefTrace,
    protocol: Protocol,
) -> Result<Rolled> {
    let from = start(inspector, protocol)?;
    let Some(controls) = experts.controls.get(from..from + protocol.horizon) else {
        bail!(
            "a rollout of {} steps from belief {from} needs controls that were not recorded",
            protocol.horizon
        );
    };
    inspector.rollout(beliefs, from, controls)
}

/// Predicted pixels in [0, 1] of images c + 1 … c + h, `(h, height * width)`, with every expert on.
pub fn open_loop<M: Borrow<Model>>(
    inspector: &Inspector<M>,
    episode: &Episode,
    protocol: Protocol,
) -> Result<Vec<f32>> {
    let (experts, beliefs) = believe(inspector, episode)?;
    let rolled = roll(inspector, &experts, &beliefs, protocol)?;
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
        .map(|(predicted, truth)| squared_error(predicted, &grey(truth)) / pixels as f64)
        .collect())
}

/// A frame's pixels in [0, 1].
pub fn grey(frame: &crate::episode::Frame) -> Vec<f32> {
    frame.pixels.iter().map(|&p| f32::from(p) / 255.0).collect()
}

/// Sum over pixels of squared differences.
pub fn squared_error(a: &[f32], b: &[f32]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2))
        .sum()
}
