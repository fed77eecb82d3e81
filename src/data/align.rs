//! Lays a recording out on the clock of its images: windows, controls, poses and frames per step.

mod interpolate;
mod irregular;
mod resample;

pub(super) use resample::square;

use interpolate::{Clock, held_mean, linear, planar_pose};

use super::error::DataError;
use super::topics::{Role, Topics};
use crate::episode::{Episode, Flag, Frame, Layout, PlanarPose, Recording, Track};

/// Lays `recording` out in `layout`.
///
/// Step t is the t-th image in time, at `τ_t`; of two with one stamp the first counts. Sample k = 1…W of its window lies
/// at `τ_{t-1} + k (τ_t − τ_{t-1}) / W`, linear between recorded samples, a recorded one within 1 µs taken as it is, the
/// first and last held beyond the ends. Before the first image lies a window as long as the one after it. Controls
/// are means over `[τ_t, τ_{t+1})` of the held command. A role that was not recorded is none; proprio needs both
/// position and velocity. Gaps and stamps that run backwards are flagged, on the format's default topics.
///
/// # Errors
/// [`DataError::TooFewImages`] if there are fewer than two.
pub fn align(recording: &Recording, layout: Layout) -> Result<Episode, DataError> {
    align_on(recording, layout, &Topics::default())
}

/// As [`align`], naming `topics` in flags.
pub(super) fn align_on(
    recording: &Recording,
    layout: Layout,
    topics: &Topics,
) -> Result<Episode, DataError> {
    let (steps_nanos, frames) = steps(recording);
    let &[first, second, ..] = steps_nanos.as_slice() else {
        return Err(DataError::TooFewImages {
            place: format!("episode {:?}", recording.meta.id),
            images: steps_nanos.len(),
        });
    };
    let times = window_times(&steps_nanos, second.saturating_sub(first), layout.window);
    let wrench = Clock::of(&recording.wrench, first);
    let position = Clock::of(&recording.ee_position, first);
    let velocity = Clock::of(&recording.ee_velocity, first);
    let object = Clock::of(&recording.object, first);
    let control = Clock::of(&recording.control, first);
    let step_times: Vec<f64> = steps_nanos.iter().map(|&t| since(first, t)).collect();

    let haptic = wrench.as_ref().map(|wrench| {
        let at = |&time: &f64| wrench.at(time, linear).map(|v| v as f32);
        times.iter().flat_map(at).collect()
    });
    let proprio = position.as_ref().zip(velocity.as_ref()).map(|(p, v)| {
        let at = |&time: &f64| {
            let ([px, py, pz], [vx, vy, vz]) = (p.at(time, linear), v.at(time, linear));
            [px, py, pz, vx, vy, vz].map(|v| v as f32)
        };
        times.iter().flat_map(at).collect()
    });
    let controls = control.map(|control| {
        let mean = |pair: &[f64]| held_mean(&control, pair[0], pair[1]).map(|v| v as f32);
        step_times.windows(2).map(mean).collect()
    });
    let object = object.map(|object| {
        let at = |&time: &f64| {
            let [x, y, yaw] = object.at(time, planar_pose).map(|v| v as f32);
            PlanarPose { x, y, yaw }
        };
        step_times.iter().map(at).collect()
    });
    let tip = position.map(|position| {
        let at = |&time: &f64| {
            let [x, y, _] = position.at(time, linear).map(|v| v as f32);
            [x, y]
        };
        step_times.iter().map(at).collect()
    });
    Ok(Episode {
        meta: recording.meta.clone(),
        layout,
        frames: frames
            .into_iter()
            .map(|frame| square(frame, layout.frame_size))
            .collect(),
        haptic,
        proprio,
        controls,
        object,
        tip,
        flags: flags(recording, topics, &steps_nanos),
        steps_nanos,
    })
}

/// Stamps and frames in time order, one of each stamp.
fn steps(recording: &Recording) -> (Vec<i64>, Vec<&Frame>) {
    let stamps = recording.frame_stamps_nanos.iter().copied();
    let mut steps: Vec<_> = stamps.zip(&recording.frames).collect();
    steps.sort_by_key(|&(stamp, _)| stamp);
    steps.dedup_by_key(|&mut (stamp, _)| stamp);
    steps.into_iter().unzip()
}

/// Times of all window samples, `(T, W)`, in nanoseconds after the first image; `before` is the length of the first
/// window.
fn window_times(steps_nanos: &[i64], before: i64, window: usize) -> Vec<f64> {
    let Some(&first) = steps_nanos.first() else {
        return Vec::new();
    };
    let mut times = Vec::with_capacity(steps_nanos.len() * window);
    let mut previous = -(before as f64);
    for &step in steps_nanos {
        let step = since(first, step);
        let span = step - previous;
        times.extend((1..=window).map(|k| previous + k as f64 * span / window as f64));
        previous = step;
    }
    times
}

/// Nanoseconds from `origin` to `stamp`; exact for a hundred days.
fn since(origin: i64, stamp: i64) -> f64 {
    stamp.saturating_sub(origin) as f64
}

/// What was odd: what the recording says already, then each stream's gaps, backward stamps and values that are none.
fn flags(recording: &Recording, topics: &Topics, steps_nanos: &[i64]) -> Vec<Flag> {
    fn stamps<const N: usize>(track: &Track<N>) -> &[i64] {
        &track.stamps_nanos
    }
    let streams: [(Role, &[i64]); 6] = [
        (Role::Vision, &recording.frame_stamps_nanos),
        (Role::Haptic, stamps(&recording.wrench)),
        (Role::EePose, stamps(&recording.ee_position)),
        (Role::EeTwist, stamps(&recording.ee_velocity)),
        (Role::Control, stamps(&recording.control)),
        (Role::Object, stamps(&recording.object)),
    ];
    let mut flags = recording.flags.clone();
    for (role, stamps) in streams {
        let covered = match (role, stamps, steps_nanos) {
            // One command may hold all along.
            (Role::Control, [_], _) => continue,
            // The one at the last image moves nothing any more.
            (Role::Control, _, [rest @ .., _]) => rest,
            (_, _, all) => all,
        };
        let (Some(&from), Some(&until)) = (covered.first(), covered.last()) else {
            continue;
        };
        irregular::find(topics.topic(role), stamps, (from, until), &mut flags);
    }
    let broken = [
        (Role::Haptic, irregular::not_finite(&recording.wrench)),
        (Role::EePose, irregular::not_finite(&recording.ee_position)),
        (Role::EeTwist, irregular::not_finite(&recording.ee_velocity)),
        (Role::Control, irregular::not_finite(&recording.control)),
        (Role::Object, irregular::not_finite(&recording.object)),
    ];
    for (role, stamp) in broken {
        flags.extend(stamp.map(|stamp_nanos| Flag {
            topic: topics.topic(role).to_owned(),
            stamp_nanos,
            what: "a value that is not a finite number".to_owned(),
            gap: false,
        }));
    }
    flags
}
