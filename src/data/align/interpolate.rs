//! The value of a track at any time: linear between samples, or held.

use std::f64::consts::{PI, TAU};

use super::since;
use crate::episode::Track;

/// A recorded sample this close, in nanoseconds, is taken as it is.
const UNCHANGED_NANOS: f64 = 1000.0;

/// A track in time order, with at least one sample.
pub(super) struct Clock<'a, const N: usize> {
    /// Nanoseconds after the first image, and the sample.
    samples: Vec<(f64, &'a [f64; N])>,
}

/// Mixes two samples, `weight` of the second.
type Mix<const N: usize> = fn(&[f64; N], &[f64; N], f64) -> [f64; N];

impl<'a, const N: usize> Clock<'a, N> {
    /// The samples of `track` on a clock that starts at `origin`; none if it is empty.
    pub(super) fn of(track: &'a Track<N>, origin: i64) -> Option<Self> {
        let times = track.stamps_nanos.iter().map(|&stamp| since(origin, stamp));
        let mut samples: Vec<_> = times.zip(&track.values).collect();
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        (!samples.is_empty()).then_some(Self { samples })
    }

    /// The value at `time`.
    pub(super) fn at(&self, time: f64, mix: Mix<N>) -> [f64; N] {
        let after = self.samples.partition_point(|&(stamp, _)| stamp < time);
        let later = self.samples.get(after);
        let earlier = after.checked_sub(1).and_then(|i| self.samples.get(i));
        match (earlier, later) {
            (Some(&(t0, a)), Some(&(t1, b))) => {
                let (from, to) = (time - t0, t1 - time);
                if from.min(to) <= UNCHANGED_NANOS {
                    return if from <= to { *a } else { *b };
                }
                mix(a, b, from / (from + to))
            }
            (Some(&(_, held)), None) | (None, Some(&(_, held))) => *held,
            (None, None) => [f64::NAN; N],
        }
    }
}

/// Linear in every component.
pub(super) fn linear<const N: usize>(a: &[f64; N], b: &[f64; N], weight: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + weight * (b[i] - a[i]))
}

/// Linear in x and y; the yaw along the shorter arc, in (−π, π].
pub(super) fn planar_pose(a: &[f64; 3], b: &[f64; 3], weight: f64) -> [f64; 3] {
    let [x, y, _] = linear(a, b, weight);
    let arc = wrap(b[2] - a[2]);
    [x, y, wrap(a[2] + weight * arc)]
}

/// The same angle in (−π, π].
fn wrap(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}

/// The mean over `[from, to)` of a command held from its stamp on; the first one before its stamp too. A stamp within
/// 1 µs of an end is taken to lie on it, so one command over the whole interval comes out as it is.
pub(super) fn held_mean<const N: usize>(track: &Clock<'_, N>, from: f64, to: f64) -> [f64; N] {
    let samples = &track.samples;
    let mut next = samples
        .partition_point(|&(stamp, _)| stamp <= from + UNCHANGED_NANOS)
        .max(1);
    let Some(&(_, mut held)) = samples.get(next - 1) else {
        return [f64::NAN; N];
    };
    let mut since = from;
    let mut sum = [0.0; N];
    while let Some(&(stamp, value)) = samples.get(next).filter(|s| s.0 < to - UNCHANGED_NANOS) {
        add(&mut sum, held, stamp - since);
        (since, held) = (stamp, value);
        next += 1;
    }
    if since <= from {
        return *held;
    }
    add(&mut sum, held, to - since);
    sum.map(|total| total / (to - from))
}

fn add<const N: usize>(sum: &mut [f64; N], value: &[f64; N], weight: f64) {
    for (total, v) in sum.iter_mut().zip(value) {
        *total += v * weight;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_takes_the_shorter_arc() {
        let halfway = |a: f64, b: f64| planar_pose(&[0.0, 0.0, a], &[2.0, 4.0, b], 0.5);
        let [x, y, yaw] = halfway(3.0, -3.0);
        assert!((x - 1.0).abs() < 1e-15 && (y - 2.0).abs() < 1e-15);
        assert!((yaw.abs() - PI).abs() < 1e-12, "{yaw}");
        assert!((halfway(-0.5, 0.3)[2] + 0.1).abs() < 1e-12);
        assert!((wrap(-PI) - PI).abs() < 1e-15);
    }
}
