//! What drives the rod: a Gaussian policy, drawn anew at each image, and a velocity controller that follows it.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::Scene;

/// From the rod's surface to the plate at the start, along x.
const START_GAP_M: f64 = 0.03;
/// Standard deviation of the rod's start along y.
const START_Y_SD_M: f64 = 0.02;
/// Mean of a command: forward, into the plate.
const COMMAND_MEAN: [f64; 2] = [0.065, 0.0];
/// Standard deviation of a command, in m/s.
const COMMAND_SD: [f64; 2] = [0.045, 0.060];
/// Time constant of the arm's velocity controller.
const LAG_SECS: f64 = 0.03;

/// Where the rod's axis starts: before the plate, beside its middle.
pub(super) fn start_m(scene: &Scene, rng: &mut impl Rng) -> [f64; 2] {
    let reach = scene.plate_side_m / 2.0 + START_GAP_M + scene.tip_radius_m;
    [
        scene.plate_start_m[0] - reach,
        scene.plate_start_m[1] + START_Y_SD_M * normal(rng),
    ]
}

/// A command of the policy: x, y in m/s.
pub(super) fn command(rng: &mut impl Rng) -> [f64; 2] {
    std::array::from_fn(|axis| COMMAND_MEAN[axis] + COMMAND_SD[axis] * normal(rng))
}

/// One draw of the standard normal.
pub(super) fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// The arm's velocity controller. It follows the command with a lag, and leaves the workspace in no direction: at
/// the edge the motion stops although the command goes on.
pub(super) struct Arm {
    velocity: [f64; 2],
    workspace_m: [[f64; 2]; 2],
    /// Share of the velocity error that is made up in one physics step.
    gain: f64,
}

impl Arm {
    /// An arm at rest, controlled every `step_secs`.
    pub fn new(scene: &Scene, step_secs: f64) -> Self {
        Self {
            velocity: [0.0; 2],
            workspace_m: scene.workspace_m,
            gain: 1.0 - (-step_secs / LAG_SECS).exp(),
        }
    }

    /// The velocity for the next physics step, from the command and where the rod is.
    pub fn follow(&mut self, command: [f64; 2], tip_m: [f64; 2]) -> [f64; 2] {
        let [low, high] = self.workspace_m;
        for axis in 0..2 {
            let leads_out = (command[axis] < 0.0 && tip_m[axis] <= low[axis])
                || (command[axis] > 0.0 && tip_m[axis] >= high[axis]);
            let target = if leads_out { 0.0 } else { command[axis] };
            self.velocity[axis] += self.gain * (target - self.velocity[axis]);
        }
        self.velocity
    }
}
