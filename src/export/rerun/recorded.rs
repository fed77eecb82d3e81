//! What was sensed: frames on their steps, everything else at its own rate.

use std::collections::BTreeSet;

use ::rerun::RecordingStreamResult;
use ::rerun::datatypes::ColorModel;

use super::log::Log;
use crate::episode::{HAPTIC_CHANNELS, PROPRIO_CHANNELS, Recording, Track};
use crate::export::Run;

/// The camera.
pub(super) const FRAME: &str = "recorded/frame";
/// Force in N.
pub(super) const FORCE: &str = "recorded/force";
/// Torque in N·m.
pub(super) const TORQUE: &str = "recorded/torque";
/// Where the tip is, in m.
pub(super) const POSITION: &str = "recorded/tip_position";
/// How fast it moves, in m/s.
pub(super) const VELOCITY: &str = "recorded/tip_velocity";
/// What it is told to do.
pub(super) const CONTROL: &str = "recorded/control";

/// Names of the axes. In their modality's one colour they could not be told apart: they have the viewer's.
pub(super) fn describe(log: &Log<'_>) -> RecordingStreamResult<()> {
    for (path, names) in [
        (FORCE, &HAPTIC_CHANNELS[..3]),
        (TORQUE, &HAPTIC_CHANNELS[3..]),
        (POSITION, &PROPRIO_CHANNELS[..3]),
        (VELOCITY, &PROPRIO_CHANNELS[3..]),
        (CONTROL, &["ux", "uy"]),
    ] {
        log.names(path, names.iter().map(|&name| name.to_owned()), None)?;
    }
    Ok(())
}

/// What led up to the steps of the run.
pub(super) fn steps(log: &Log<'_>, run: &Run, sensed: &Recording) -> RecordingStreamResult<()> {
    let steps: BTreeSet<usize> = run.models.iter().flatten().map(|at| at.cursor).collect();
    let side = run.episode.layout.frame_size;
    let frame = |&step: &usize| {
        let frame = run.episode.frames.get(step);
        (step, frame.map(|frame| frame.pixels.clone()))
    };
    let frames = steps.iter().map(frame).collect();
    log.pictures(FRAME, [side, side], ColorModel::L, frames)?;
    log.samples(FORCE, &thirds(&sensed.wrench, 0), &steps)?;
    log.samples(TORQUE, &thirds(&sensed.wrench, 3), &steps)?;
    log.samples(POSITION, &sensed.ee_position, &steps)?;
    log.samples(VELOCITY, &sensed.ee_velocity, &steps)?;
    log.samples(CONTROL, &sensed.control, &steps)
}

/// Three channels of a wrench.
fn thirds(wrench: &Track<6>, from: usize) -> Track<3> {
    let of = |v: &[f64; 6]| [v[from], v[from + 1], v[from + 2]];
    Track {
        stamps_nanos: wrench.stamps_nanos.clone(),
        values: wrench.values.iter().map(of).collect(),
    }
}
