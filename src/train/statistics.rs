//! What a model takes from its training set before the first update: the scaling of its channels and the weights of
//! its error terms (`released` and `standard` in the dataset format).

use crate::episode::Episode;
use crate::modality::{Expert, Modality};
use crate::model::config::{Config, Scaling};
use crate::model::observation::{channels_of, known};

/// A channel's scale is at least this: 0.1 N and 0.01 N·m, 1 mm and 1 mm/s, so that a channel that never moves is not
/// blown up.
const FLOORS: [[f32; 6]; 2] = [[0.1, 0.1, 0.1, 0.01, 0.01, 0.01], [0.001; 6]];

/// Fills in scaling and error weights where the config has none.
pub fn complete(config: &mut Config, episodes: &[Episode]) {
    if config.step_secs.is_none() {
        config.step_secs = episodes.first().and_then(Episode::step_secs);
    }
    let (scaling, force) = (config.training.scaling, config.training.force_scale);
    let each = [
        (&mut config.haptic, Modality::Haptic, &FLOORS[0], force),
        (&mut config.proprio, Modality::Proprio, &FLOORS[1], 1.0),
    ];
    for (channels, modality, floors, constant) in each {
        if !channels.mean.is_empty() {
            continue;
        }
        let at: Vec<usize> = channels
            .columns(known(modality))
            .map(|(at, _, _)| at)
            .collect();
        if scaling == Scaling::Released {
            channels.mean = vec![0.0; at.len()];
            channels.scale = vec![constant; at.len()];
            continue;
        }
        let moments = moments(episodes, modality);
        channels.mean = at.iter().map(|&at| moments[at].0 as f32).collect();
        channels.scale = at
            .iter()
            .map(|&at| (moments[at].1 as f32).max(floors[at]))
            .collect();
    }
    if config.training.error_weights.is_empty() {
        config.training.error_weights = error_weights(config, episodes);
    }
}

/// 1 for every stream as released; else all windows together count as much as the frame, at the predictor that always
/// says the mean.
fn error_weights(config: &Config, episodes: &[Episode]) -> Vec<f32> {
    let at_mean = error_at_the_mean(config, episodes);
    let windows: f64 = at_mean[1..].iter().sum();
    if config.training.scaling == Scaling::Released || windows <= 0.0 {
        return vec![1.0; at_mean.len()];
    }
    let shared = (at_mean[0] / windows) as f32;
    let weights = std::iter::once(1.0).chain(std::iter::repeat(shared));
    weights.take(at_mean.len()).collect()
}

/// Squared error a belief of each expert's term at the predictor that always says the mean: what the weights balance.
pub fn error_at_the_mean(config: &Config, episodes: &[Episode]) -> Vec<f64> {
    let each = |&expert: &Expert| match expert {
        Expert::Vision => frame_variance(episodes) * (config.frame_stack + 1) as f64,
        _ => window_variance(config, expert, episodes),
    };
    config.streams().iter().map(each).collect()
}

/// Mean and standard deviation of each of a modality's six channels.
fn moments(episodes: &[Episode], modality: Modality) -> [(f64, f64); 6] {
    let (mut count, mut sum, mut squares) = (0_usize, [0.0_f64; 6], [0.0_f64; 6]);
    let windows = episodes
        .iter()
        .filter_map(|episode| channels_of(episode, modality));
    for sample in windows.flat_map(|(window, _)| window.chunks_exact(6)) {
        count += 1;
        for ((sum, square), &x) in sum.iter_mut().zip(&mut squares).zip(sample) {
            *sum += f64::from(x);
            *square += f64::from(x) * f64::from(x);
        }
    }
    let n = count.max(1) as f64;
    std::array::from_fn(|i| {
        let mean = sum[i] / n;
        (mean, (squares[i] / n - mean * mean).max(0.0).sqrt())
    })
}

/// Σ over pixels of the variance over all frames, grey in [0, 1].
fn frame_variance(episodes: &[Episode]) -> f64 {
    let pixels = episodes
        .first()
        .and_then(|e| e.frames.first())
        .map_or(0, |f| f.pixels.len());
    let (mut count, mut sum, mut squares) = (0_usize, vec![0_u64; pixels], vec![0_u64; pixels]);
    for frame in episodes.iter().flat_map(|episode| &episode.frames) {
        count += 1;
        for ((sum, square), &x) in sum.iter_mut().zip(&mut squares).zip(&frame.pixels) {
            *sum += u64::from(x);
            *square += u64::from(x) * u64::from(x);
        }
    }
    let n = count.max(1) as f64;
    let variance = |(&sum, &square): (&u64, &u64)| square as f64 / n - (sum as f64 / n).powi(2);
    sum.iter().zip(&squares).map(variance).sum::<f64>() / (255.0 * 255.0)
}

/// Σ over samples and channels of a window's scaled variance.
fn window_variance(config: &Config, expert: Expert, episodes: &[Episode]) -> f64 {
    let mut total = 0.0;
    for (channels, modality) in config.channels(expert) {
        let moments = moments(episodes, modality);
        let each = channels
            .columns(known(modality))
            .map(|(at, _, scale)| (moments[at].1 / f64::from(scale)).powi(2));
        total += each.sum::<f64>() * config.window as f64;
    }
    total
}
