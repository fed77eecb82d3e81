//! What a model takes from its training set before the first update: the scaling of its channels and the weights of
//! its error terms (`released` and `standard` in the dataset format).

use super::totals::Totals;
use crate::modality::{Expert, Modality};
use crate::model::config::{Config, Scaling};
use crate::model::observation::known;

/// A channel's scale is at least this: 0.1 N and 0.01 N·m, 1 mm and 1 mm/s, so that a channel that never moves is not
/// blown up.
const FLOORS: [[f32; 6]; 2] = [[0.1, 0.1, 0.1, 0.01, 0.01, 0.01], [0.001; 6]];

/// Fills in scaling and error weights where the config has none.
pub fn complete(config: &mut Config, totals: &Totals) {
    if config.step_secs.is_none() {
        config.step_secs = totals.step_secs;
    }
    let (scaling, force) = (config.training.scaling, config.training.force_scale);
    let each = [
        (&mut config.haptic, Modality::Haptic, &FLOORS[0], force),
        (&mut config.proprio, Modality::Proprio, &FLOORS[1], 1.0),
    ];
    for (channels, modality, floors, constant) in each {
        let at: Vec<usize> = channels
            .columns(known(modality))
            .map(|(at, _, _)| at)
            .collect();
        let moments = totals.moments(modality);
        let measured = |&at: &usize| match scaling {
            Scaling::Released => (0.0, constant),
            Scaling::Standard => (moments[at].0 as f32, (moments[at].1 as f32).max(floors[at])),
        };
        let (mean, scale): (Vec<f32>, Vec<f32>) = at.iter().map(measured).unzip();
        if channels.mean.is_empty() {
            channels.mean = mean;
        }
        if channels.scale.is_empty() {
            channels.scale = scale;
        }
    }
    if config.training.error_weights.is_empty() {
        config.training.error_weights = error_weights(config, totals);
    }
}

/// 1 for every stream as released; else all windows together count as much as the frame, at the predictor that always
/// says the mean.
fn error_weights(config: &Config, totals: &Totals) -> Vec<f32> {
    let at_mean = error_at_the_mean(config, totals);
    let windows: f64 = at_mean[1..].iter().sum();
    if config.training.scaling == Scaling::Released || windows <= 0.0 {
        return vec![1.0; at_mean.len()];
    }
    let shared = (at_mean[0] / windows) as f32;
    let weights = std::iter::once(1.0).chain(std::iter::repeat(shared));
    weights.take(at_mean.len()).collect()
}

/// Squared error a belief of each expert's term at the predictor that always says the mean: what the weights balance.
pub fn error_at_the_mean(config: &Config, totals: &Totals) -> Vec<f64> {
    let each = |&expert: &Expert| match expert {
        Expert::Vision => totals.frame_variance() * (config.frame_stack + 1) as f64,
        _ => window_variance(config, expert, totals),
    };
    config.streams().iter().map(each).collect()
}

/// Σ over samples and channels of a window's scaled variance.
fn window_variance(config: &Config, expert: Expert, totals: &Totals) -> f64 {
    let mut total = 0.0;
    for (channels, modality) in config.channels(expert) {
        let moments = totals.moments(modality);
        let each = channels
            .columns(known(modality))
            .map(|(at, _, scale)| (moments[at].1 / f64::from(scale)).powi(2));
        total += each.sum::<f64>() * config.window as f64;
    }
    total
}
