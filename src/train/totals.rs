//! What one pass over a training set sums up: all that scaling, error weights and the mean frame are made of.

use crate::data::{DataError, Episodes};
use crate::episode::Episode;
use crate::modality::Modality;
use crate::model::observation::channels_of;

/// Sums over every step of some episodes.
#[derive(Clone, Debug, Default)]
pub struct Totals {
    /// Median time between two images of the first episode, in seconds.
    pub step_secs: Option<f64>,
    haptic: Samples,
    proprio: Samples,
    frames: u64,
    /// Of the grey levels of each pixel, and of their squares.
    grey: Vec<[u64; 2]>,
}

/// Sums over the samples of a modality's six channels.
#[derive(Clone, Debug, Default)]
struct Samples {
    count: u64,
    sum: [f64; 6],
    squares: [f64; 6],
}

impl Totals {
    /// Of `episodes`, one after the other.
    pub fn of(episodes: Episodes) -> Result<Self, DataError> {
        let mut totals = Self::default();
        for episode in episodes.iter() {
            totals.add(&*episode?);
        }
        Ok(totals)
    }

    /// Adds an episode.
    pub fn add(&mut self, episode: &Episode) {
        if self.frames == 0 {
            self.step_secs = episode.step_secs();
        }
        for (samples, modality) in [
            (&mut self.haptic, Modality::Haptic),
            (&mut self.proprio, Modality::Proprio),
        ] {
            if let Some((windows, _)) = channels_of(episode, modality) {
                samples.add(windows);
            }
        }
        for frame in &episode.frames {
            self.frames += 1;
            self.grey.resize(frame.pixels.len(), [0; 2]);
            for ([sum, squares], &grey) in self.grey.iter_mut().zip(&frame.pixels) {
                *sum += u64::from(grey);
                *squares += u64::from(grey) * u64::from(grey);
            }
        }
    }

    /// Mean and standard deviation of each of a modality's six channels; 0 for vision and where none was recorded.
    pub fn moments(&self, modality: Modality) -> [(f64, f64); 6] {
        let samples = match modality {
            Modality::Vision => &Samples::default(),
            Modality::Haptic => &self.haptic,
            Modality::Proprio => &self.proprio,
        };
        let n = samples.count.max(1) as f64;
        std::array::from_fn(|i| {
            let mean = samples.sum[i] / n;
            let variance = samples.squares[i] / n - mean * mean;
            (mean, variance.max(0.0).sqrt())
        })
    }

    /// Σ over pixels of the variance over all frames, grey in [0, 1].
    pub fn frame_variance(&self) -> f64 {
        let n = self.frames.max(1) as f64;
        let variance = |&[sum, squares]: &[u64; 2]| squares as f64 / n - (sum as f64 / n).powi(2);
        self.grey.iter().map(variance).sum::<f64>() / (255.0 * 255.0)
    }

    /// The mean frame, as grey levels.
    pub fn mean_frame(&self) -> Vec<u8> {
        let n = self.frames.max(1) as f64;
        let mean = |&[sum, _]: &[u64; 2]| (sum as f64 / n).round() as u8;
        self.grey.iter().map(mean).collect()
    }
}

impl Samples {
    fn add(&mut self, windows: &[f32]) {
        for sample in windows.chunks_exact(6) {
            self.count += 1;
            for ((sum, squares), &x) in self.sum.iter_mut().zip(&mut self.squares).zip(sample) {
                *sum += f64::from(x);
                *squares += f64::from(x) * f64::from(x);
            }
        }
    }
}
