//! Damage in time: whose data each step shows.

use rand::Rng;

use super::{Corruption, Damage};
use crate::modality::Modality;

/// How late a stream is at severity 1, in steps.
const LATEST: f32 = 8.0;

/// For each of `steps` steps, the step whose data it shows; its own where `corruption` does not act in time.
pub(super) fn shown(corruption: &Corruption, modality: Modality, steps: usize) -> Vec<usize> {
    let mut shown: Vec<usize> = (0..steps).collect();
    let range = corruption.range(steps);
    let first = range.start;
    match corruption.damage {
        Damage::Hold => {
            for t in range.skip(1) {
                let draw: f64 = corruption.draws(modality, t).random();
                if draw < f64::from(corruption.strength()) {
                    shown[t] = shown[t - 1];
                }
            }
        }
        Damage::Delay => {
            let late = (LATEST * corruption.strength()).round() as usize;
            for t in range {
                shown[t] = t.saturating_sub(late).max(first);
            }
        }
        _ => {}
    }
    shown
}
