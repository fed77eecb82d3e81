//! What may be chosen about a recording: how many images, at what rates, and which channels.

use thiserror::Error;

/// The physics runs at the smallest multiple of the sensors' rate that is at least this.
const MIN_PHYSICS_HZ: f64 = 480.0;

/// The shape of the episodes to simulate; the scene itself is [`Scene`](super::Scene).
#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// T, the images of an episode.
    pub steps: usize,
    /// W, the high-rate samples from one image to the next; also those before the first image.
    pub window: usize,
    /// Rate of force, torque, position, velocity and object pose.
    pub rate_hz: f64,
    /// Senses what a planar setup senses: force x, y, torque z; position and velocity x, y. Other channels are 0.
    pub planar: bool,
    /// Side of the square images, in pixels.
    pub frame_size: usize,
}

impl Default for Params {
    /// The paper's synthetic set: 16 images of 64 × 64, every 32nd sample of 120 Hz.
    fn default() -> Self {
        Self {
            steps: 16,
            window: 32,
            rate_hz: 120.0,
            planar: false,
            frame_size: 64,
        }
    }
}

/// A parameter that nothing can be recorded with.
#[derive(Debug, Error, PartialEq)]
pub enum ParamsError {
    /// Fewer than two images is no episode.
    #[error("{0} images: an episode needs from 2 to 10000 (--steps)")]
    Steps(usize),
    /// No sample between two images, or far too many.
    #[error("{0} samples between two images: choose from 1 to 10000 (--window)")]
    Window(usize),
    /// A rate that no sensor of this kind has.
    #[error("{0} samples a second: choose from 1 to 2000 (--rate-hz)")]
    Rate(f64),
    /// Longer than anybody pushes, and than time stamps of many episodes can count.
    #[error("an episode of {0:.0} s: choose one of an hour or less")]
    Duration(f64),
    /// An image too small to show the scene, or too large to be one step's image.
    #[error("images of {0} pixels a side: choose from 16 to 1024")]
    FrameSize(usize),
}

impl Params {
    /// Fails on the first value that no episode can be recorded with.
    pub fn check(&self) -> Result<(), ParamsError> {
        if !(2..=10_000).contains(&self.steps) {
            return Err(ParamsError::Steps(self.steps));
        }
        if !(1..=10_000).contains(&self.window) {
            return Err(ParamsError::Window(self.window));
        }
        if !(1.0..=2000.0).contains(&self.rate_hz) {
            return Err(ParamsError::Rate(self.rate_hz));
        }
        let duration_secs = self.steps as f64 * self.step_secs();
        if duration_secs > 3600.0 {
            return Err(ParamsError::Duration(duration_secs));
        }
        if !(16..=1024).contains(&self.frame_size) {
            return Err(ParamsError::FrameSize(self.frame_size));
        }
        Ok(())
    }

    /// Physics steps from one sample to the next.
    pub(super) fn substeps(&self) -> usize {
        (MIN_PHYSICS_HZ / self.rate_hz).ceil().max(1.0) as usize
    }

    /// Length of a physics step.
    pub(super) fn physics_secs(&self) -> f64 {
        1.0 / (self.rate_hz * self.substeps() as f64)
    }

    /// Time from one image to the next.
    pub(super) fn step_secs(&self) -> f64 {
        self.window as f64 / self.rate_hz
    }

    /// When sample `i` is measured, in nanoseconds after the recording's start.
    pub(super) fn sample_nanos(&self, i: usize) -> i64 {
        (i as f64 * 1e9 / self.rate_hz).round() as i64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_recorded_is_refused() {
        let refuse = |change: fn(&mut Params)| {
            let mut params = Params::default();
            change(&mut params);
            params.check().is_err()
        };
        assert_eq!(Params::default().check(), Ok(()));
        assert!(refuse(|params| params.steps = 1));
        assert!(refuse(|params| params.window = 0));
        assert!(refuse(|params| params.rate_hz = f64::NAN));
        assert!(refuse(|params| params.rate_hz = 0.0));
        assert!(refuse(|params| params.frame_size = 0));
        assert!(refuse(
            |params| (params.steps, params.window) = (10_000, 10_000)
        ));
    }

    #[test]
    fn the_physics_is_a_multiple_of_the_sensors() {
        let substeps = |rate_hz| {
            let params = Params {
                rate_hz,
                ..Params::default()
            };
            params.substeps()
        };
        assert_eq!(
            [substeps(120.0), substeps(180.0), substeps(2000.0)],
            [4, 3, 1]
        );
    }
}
