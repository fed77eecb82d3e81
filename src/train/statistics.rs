//! What a model takes from its training set before the first update: the scaling of its channels and the weights of
//! its error terms (`standard` in the dataset format).

use super::totals::Totals;
use crate::modality::{Expert, Modality};
use crate::model::config::Config;
use crate::model::observation::known;

/// A channel's scale is at least this: 0.1 N and 0.01 N·m, 1 mm and 1 mm/s, so that a channel that never moves is not
/// blown up.
const FLOORS: [[f32; 6]; 2] = [[0.1, 0.1, 0.1, 0.01, 0.01, 0.01], [0.001; 6]];

/// Fills in scaling and error weights where the config has none.
pub fn complete(config: &mut Config, totals: &Totals) {
    if config.step_secs.is_none() {
        config.step_secs = totals.step_secs;
    }
    for (modality, floors) in [
        (Modality::Haptic, &FLOORS[0]),
        (Modality::Proprio, &FLOORS[1]),
    ] {
        let channels = if modality == Modality::Haptic {
            &mut config.haptic
        } else {
            &mut config.proprio
        };
        if channels.mean.is_empty() {
            let moments = totals.moments(modality);
            let at: Vec<usize> = channels
                .columns(known(modality))
                .map(|(at, _, _)| at)
                .collect();
            channels.mean = at.iter().map(|&at| moments[at].0 as f32).collect();
            channels.scale = at
                .iter()
                .map(|&at| (moments[at].1 as f32).max(floors[at]))
                .collect();
        }
    }
    if config.training.error_weights.is_empty() {
        let at_mean = error_at_the_mean(config, totals);
        let windows: f64 = at_mean[1..].iter().sum();
        // All windows together count as much as the frame, at the predictor that always says the mean.
        let shared = if windows > 0.0 {
            (at_mean[0] / windows) as f32
        } else {
            1.0
        };
        let weight = |&expert: &Expert| {
            if expert == Expert::Vision {
                1.0
            } else {
                shared
            }
        };
        config.training.error_weights = config.experts.iter().map(weight).collect();
    }
}

/// Squared error a belief of each expert's term at the predictor that always says the mean: what the weights balance.
pub fn error_at_the_mean(config: &Config, totals: &Totals) -> Vec<f64> {
    let each = |&expert: &Expert| match expert {
        Expert::Vision => totals.frame_variance() * (config.frame_stack + 1) as f64,
        _ => window_variance(config, expert, totals),
    };
    config.experts.iter().map(each).collect()
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
