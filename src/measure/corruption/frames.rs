//! Damage to camera frames, 0 black to 255 white.

use rand::Rng;
use rand_distr::StandardNormal;

use super::timing::shown;
use super::{Corruption, Damage};
use crate::episode::Frame;
use crate::modality::Modality;

/// The grey range, and the mid-grey of a patch.
const WHITE: f64 = 255.0;
const GREY: u8 = 128;

/// Damages `frames` as `corruption` says.
pub(super) fn damage(frames: &mut [Frame], corruption: &Corruption) {
    let range = corruption.range(frames.len());
    let severity = f64::from(corruption.strength());
    match corruption.damage {
        Damage::Zero => each(frames, range, |grey| (1.0 - severity) * grey),
        Damage::Bias => each(frames, range, |grey| grey + 0.5 * severity * WHITE),
        Damage::Noise => {
            for t in range {
                let mut rng = corruption.draws(Modality::Vision, t);
                each(frames, t..t + 1, |grey| {
                    let draw: f64 = rng.sample(StandardNormal);
                    grey + 0.5 * severity * WHITE * draw
                });
            }
        }
        Damage::Hold | Damage::Delay => {
            let recorded = frames.to_vec();
            let sources = shown(corruption, Modality::Vision, frames.len());
            for (frame, source) in frames.iter_mut().zip(sources) {
                frame.clone_from(&recorded[source]);
            }
        }
        Damage::Occlude => {
            for frame in &mut frames[range] {
                occlude(frame, corruption);
            }
        }
    }
}

/// Maps every grey value of the steps in `range`, rounded and clamped.
fn each(frames: &mut [Frame], range: std::ops::Range<usize>, mut change: impl FnMut(f64) -> f64) {
    for grey in frames[range].iter_mut().flat_map(|frame| &mut frame.pixels) {
        *grey = change(f64::from(*grey)).round().clamp(0.0, WHITE) as u8;
    }
}

/// Paints the patch over a frame.
fn occlude(frame: &mut Frame, corruption: &Corruption) {
    if frame.width == 0 {
        return;
    }
    let side = corruption.strength() * frame.width.min(frame.height) as f32;
    let (columns, rows) = (
        covered(corruption.patch[0], side, frame.width),
        covered(corruption.patch[1], side, frame.height),
    );
    let width = frame.width;
    for row in frame
        .pixels
        .chunks_exact_mut(width)
        .take(rows.end)
        .skip(rows.start)
    {
        row[columns.clone()].fill(GREY);
    }
}

/// The pixels that a patch of `side` pixels covers along an axis of `size`, its centre at the part `centre` of it.
fn covered(centre: f32, side: f32, size: usize) -> std::ops::Range<usize> {
    let centre = if centre.is_nan() { 0.5 } else { centre };
    let side = side.round();
    let start = (centre.clamp(0.0, 1.0) * size as f32 - 0.5 * side).round();
    let end = (start + side).clamp(0.0, size as f32) as usize;
    (start.max(0.0) as usize).min(end)..end
}
