//! Damage to high-rate windows, `(T, W, 6)` in SI units.

use rand::Rng;
use rand_distr::StandardNormal;

use super::timing::shown;
use super::{Corruption, Damage};
use crate::modality::Modality;

/// Channels of a window, as in [`crate::episode::HAPTIC_CHANNELS`].
const CHANNELS: usize = 6;
/// A bias of severity 1, in standard deviations of the channel.
const BIAS_SIGMAS: f64 = 3.0;

/// Damages `data` as `corruption` says; data beyond the last whole window stay.
pub(super) fn damage(data: &mut [f32], window: usize, modality: Modality, corruption: &Corruption) {
    let stride = window * CHANNELS;
    if stride == 0 {
        return;
    }
    let steps = data.len() / stride;
    let range = corruption.range(steps);
    let severity = corruption.strength();
    let span = range.start * stride..range.end * stride;
    match corruption.damage {
        Damage::Zero => {
            for x in &mut data[span] {
                // Written out at 1, where a product would keep the sign of a zero and any NaN.
                *x = if severity < 1.0 {
                    (1.0 - severity) * *x
                } else {
                    0.0
                };
            }
        }
        Damage::Hold | Damage::Delay => {
            let recorded = data.to_vec();
            let sources = shown(corruption, modality, steps);
            for (step, source) in data.chunks_exact_mut(stride).zip(sources) {
                step.copy_from_slice(&recorded[source * stride..(source + 1) * stride]);
            }
        }
        Damage::Noise => {
            let sigmas = deviations(data).map(|sd| f64::from(severity) * sd);
            for t in range {
                let mut rng = corruption.draws(modality, t);
                for sample in data[t * stride..(t + 1) * stride].chunks_exact_mut(CHANNELS) {
                    for (x, sigma) in sample.iter_mut().zip(sigmas) {
                        let draw: f64 = rng.sample(StandardNormal);
                        *x = (f64::from(*x) + sigma * draw) as f32;
                    }
                }
            }
        }
        Damage::Bias => {
            let offsets = deviations(data).map(|sd| f64::from(severity) * BIAS_SIGMAS * sd);
            for sample in data[span].chunks_exact_mut(CHANNELS) {
                for (x, offset) in sample.iter_mut().zip(offsets) {
                    *x = (f64::from(*x) + offset) as f32;
                }
            }
        }
        Damage::Occlude => {}
    }
}

/// Standard deviation of each channel over all its finite samples; zero for a channel without any.
fn deviations(data: &[f32]) -> [f64; CHANNELS] {
    std::array::from_fn(|channel| {
        let samples = || {
            let all = data.iter().skip(channel).step_by(CHANNELS);
            all.filter(|x| x.is_finite()).map(|&x| f64::from(x))
        };
        let count = samples().count().max(1) as f64;
        let mean = samples().sum::<f64>() / count;
        (samples().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
    })
}
