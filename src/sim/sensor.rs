//! The instruments: a wrist force-torque sensor with its low-pass filter, encoders, and the noise of both.

use std::f64::consts::TAU;

use rand::Rng;

use super::{Params, Scene, pusher::normal, world::Touch};

/// Corner of the force-torque sensor's low-pass filter.
const WRENCH_CORNER_HZ: f64 = 30.0;
/// Noise of a wrist force-torque sensor, standard deviations.
const FORCE_SD_NEWTONS: f64 = 0.06;
const TORQUE_SD_NEWTON_METRES: f64 = 0.002;
/// Noise of an arm's encoders seen at its tip, and of its velocity estimate.
const POSITION_SD_M: f64 = 0.000_05;
const VELOCITY_SD: f64 = 0.000_5;

/// A force-torque sensor above the rod, in world axes: what the plate does to the rod, tared at rest.
pub(super) struct WrenchSensor {
    filtered: [f64; 6],
    gain: f64,
    lever_m: f64,
    tip_radius_m: f64,
}

impl WrenchSensor {
    /// A sensor at rest, fed every `step_secs`.
    pub fn new(scene: &Scene, step_secs: f64) -> Self {
        Self {
            filtered: [0.0; 6],
            gain: 1.0 - (-TAU * WRENCH_CORNER_HZ * step_secs).exp(),
            lever_m: scene.sensor_lever_m,
            tip_radius_m: scene.tip_radius_m,
        }
    }

    /// Takes in what happened in one physics step.
    pub fn feel(&mut self, touch: &Touch) {
        let [fx, fy, fz] = touch.force_newtons;
        let [x, y] = touch.toward_contact.map(|unit| unit * self.tip_radius_m);
        let z = -self.lever_m;
        let torque = [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx];
        let wrench = [fx, fy, fz, torque[0], torque[1], torque[2]];
        for (filtered, raw) in self.filtered.iter_mut().zip(wrench) {
            *filtered += self.gain * (raw - *filtered);
        }
    }

    /// A reading: force in newtons, torque in newton metres.
    pub fn read(&self, params: &Params, rng: &mut impl Rng) -> [f64; 6] {
        let noise_sd = |channel| {
            if channel < 3 {
                FORCE_SD_NEWTONS
            } else {
                TORQUE_SD_NEWTON_METRES
            }
        };
        let sensed = |channel| !params.planar || matches!(channel, 0 | 1 | 5);
        std::array::from_fn(|channel| {
            let noise = noise_sd(channel) * normal(rng);
            if sensed(channel) {
                self.filtered[channel] + noise
            } else {
                0.0
            }
        })
    }
}

/// A reading of the rod's position in metres.
pub(super) fn read_position(params: &Params, position_m: [f64; 3], rng: &mut impl Rng) -> [f64; 3] {
    read(params, position_m, POSITION_SD_M, rng)
}

/// A reading of the rod's velocity in m/s.
pub(super) fn read_velocity(params: &Params, velocity: [f64; 3], rng: &mut impl Rng) -> [f64; 3] {
    read(params, velocity, VELOCITY_SD, rng)
}

fn read(params: &Params, truth: [f64; 3], sd: f64, rng: &mut impl Rng) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let noise = sd * normal(rng);
        if params.planar && axis == 2 {
            0.0
        } else {
            truth[axis] + noise
        }
    })
}
