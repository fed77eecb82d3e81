//! Alignment to steps and windows, against a slow and obvious reference.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use poescope::data::{DataError, align};
use poescope::episode::{Frame, Layout, Recording, Track};
use poescope::sim::{Params, simulate};
use proptest::collection::vec;
use proptest::prelude::*;

const BASE: i64 = 1_700_000_000_000_000_000;
const LAYOUT: Layout = Layout {
    frame_size: 2,
    window: 8,
};

fn frame() -> Frame {
    Frame {
        width: 2,
        height: 2,
        pixels: vec![0, 1, 2, 3],
    }
}

/// Stamps from `start` on with such intervals.
fn stamps(start: i64, intervals: &[i64]) -> Vec<i64> {
    let next = |at: &mut i64, step: &i64| {
        *at += step;
        Some(*at)
    };
    intervals.iter().scan(start, next).collect()
}

fn track<const N: usize>(stamps: &[i64], value: impl Fn(usize) -> [f64; N]) -> Track<N> {
    let mut track = Track::default();
    for (i, &stamp) in stamps.iter().enumerate() {
        track.push(stamp, value(i));
    }
    track
}

prop_compose! {
    /// Images at a few hertz, samples at jittered tens of hertz, beginning before, at or after the first image.
    fn recording()(
        images in vec(80_000_000_i64..300_000_000, 2..6),
        samples in vec(2_000_000_i64..20_000_000, 3..120),
        commands in vec(20_000_000_i64..200_000_000, 1..12),
        lead in -100_000_000_i64..400_000_000,
        values in vec(-1.0_f64..1.0, 16),
    ) -> Recording {
        let value = |i: usize, n: usize| values[(i * 7 + n * 3) % 16] + i as f64 * 1e-3;
        let frame_stamps_nanos = stamps(BASE, &images);
        let at = stamps(frame_stamps_nanos[0] - lead, &samples);
        Recording {
            frames: frame_stamps_nanos.iter().map(|_| frame()).collect(),
            wrench: track(&at, |i| std::array::from_fn(|n| value(i, n))),
            ee_position: track(&at, |i| std::array::from_fn(|n| value(i, n + 1))),
            ee_velocity: track(&at, |i| std::array::from_fn(|n| value(i, n + 2))),
            object: track(&at, |i| [value(i, 0), value(i, 1), value(i, 2) * 3.0]),
            control: track(&stamps(frame_stamps_nanos[0] - lead, &commands), |i| [value(i, 0), value(i, 5)]),
            frame_stamps_nanos,
            ..Recording::default()
        }
    }
}

/// The value of component `n` at `time`: by looking at every sample.
fn reference<const N: usize>(track: &Track<N>, time: f64, n: usize) -> f64 {
    let relative = |i: usize| (track.stamps_nanos[i] - BASE) as f64;
    let all = 0..track.values.len();
    let nearest = all.clone().min_by(|&a, &b| {
        (relative(a) - time)
            .abs()
            .total_cmp(&(relative(b) - time).abs())
    });
    let nearest = nearest.unwrap();
    let before = all.clone().rev().find(|&i| relative(i) <= time);
    let after = all.clone().find(|&i| relative(i) >= time);
    match (before, after) {
        _ if (relative(nearest) - time).abs() <= 1000.0 => track.values[nearest][n],
        (Some(a), Some(b)) => {
            let weight = (time - relative(a)) / (relative(b) - relative(a));
            track.values[a][n] * (1.0 - weight) + track.values[b][n] * weight
        }
        (Some(held), None) | (None, Some(held)) => track.values[held][n],
        (None, None) => unreachable!(),
    }
}

/// Mean of the held command over `[from, to)`: each command's share of it.
fn reference_control(track: &Track<2>, from: f64, to: f64, n: usize) -> f64 {
    let count = track.values.len();
    let share = |i: usize| {
        let begin = if i == 0 {
            f64::MIN
        } else {
            (track.stamps_nanos[i] - BASE) as f64
        };
        let end = track
            .stamps_nanos
            .get(i + 1)
            .map_or(f64::MAX, |&s| (s - BASE) as f64);
        (end.min(to) - begin.max(from)).max(0.0) / (to - from)
    };
    (0..count).map(|i| share(i) * track.values[i][n]).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn windows_and_controls_match_the_reference(recording in recording()) {
        let episode = align(&recording, LAYOUT).unwrap();
        let steps: Vec<f64> = recording.frame_stamps_nanos.iter().map(|s| (s - BASE) as f64).collect();
        prop_assert_eq!(episode.steps(), steps.len());
        let haptic = episode.haptic.unwrap();
        let proprio = episode.proprio.unwrap();
        prop_assert_eq!(haptic.len(), steps.len() * LAYOUT.window * 6);
        let close = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-5;
        for t in 0..steps.len() {
            let before = if t == 0 { 2.0 * steps[0] - steps[1] } else { steps[t - 1] };
            for k in 1..=LAYOUT.window {
                let time = before + k as f64 * (steps[t] - before) / LAYOUT.window as f64;
                let at = (t * LAYOUT.window + k - 1) * 6;
                for n in 0..6 {
                    prop_assert!(close(haptic[at + n], reference(&recording.wrench, time, n)));
                }
                for n in 0..3 {
                    prop_assert!(close(proprio[at + n], reference(&recording.ee_position, time, n)));
                    prop_assert!(close(proprio[at + 3 + n], reference(&recording.ee_velocity, time, n)));
                }
            }
            let tip = episode.tip.as_ref().unwrap()[t];
            prop_assert!(close(tip[1], reference(&recording.ee_position, steps[t], 1)));
            let pose = episode.object.as_ref().unwrap()[t];
            prop_assert!(close(pose.x, reference(&recording.object, steps[t], 0)));
        }
        let controls = episode.controls.unwrap();
        prop_assert_eq!(controls.len(), steps.len() - 1);
        for (t, u) in controls.iter().enumerate() {
            for (n, &u) in u.iter().enumerate() {
                let mean = reference_control(&recording.control, steps[t], steps[t + 1], n);
                // A command within 1 µs of an end is taken to lie on it.
                prop_assert!((f64::from(u) - mean).abs() < 1e-4, "{} {}", u, mean);
            }
        }
    }

    #[test]
    fn a_shift_of_all_stamps_changes_nothing(recording in recording(), shift in -1_000_000_000_000_i64..1_000_000_000_000) {
        let mut shifted = recording.clone();
        let tracks = [
            &mut shifted.frame_stamps_nanos,
            &mut shifted.wrench.stamps_nanos,
            &mut shifted.ee_position.stamps_nanos,
            &mut shifted.ee_velocity.stamps_nanos,
            &mut shifted.control.stamps_nanos,
            &mut shifted.object.stamps_nanos,
        ];
        for stamps in tracks {
            for stamp in stamps {
                *stamp += shift;
            }
        }
        let [a, mut b] = [align(&recording, LAYOUT).unwrap(), align(&shifted, LAYOUT).unwrap()];
        b.steps_nanos.iter_mut().for_each(|stamp| *stamp -= shift);
        b.flags.iter_mut().for_each(|flag| flag.stamp_nanos -= shift);
        prop_assert_eq!(a, b);
    }

    #[test]
    fn the_order_of_recording_does_not_matter_but_is_flagged(recording in recording()) {
        let mut shuffled = recording.clone();
        shuffled.wrench.stamps_nanos.reverse();
        shuffled.wrench.values.reverse();
        let [a, b] = [align(&recording, LAYOUT).unwrap(), align(&shuffled, LAYOUT).unwrap()];
        prop_assert_eq!(a.haptic, b.haptic);
        let backwards = b.flags.iter().filter(|f| f.topic == "/wrench" && f.what.contains("backwards")).count();
        prop_assert_eq!(backwards, recording.wrench.values.len() - 1);
    }

    #[test]
    fn a_missing_role_is_none(recording in recording(), missing in 0_usize..5) {
        let mut lacking = recording;
        match missing {
            0 => lacking.wrench = Track::default(),
            1 => lacking.ee_position = Track::default(),
            2 => lacking.ee_velocity = Track::default(),
            3 => lacking.control = Track::default(),
            _ => lacking.object = Track::default(),
        }
        let episode = align(&lacking, LAYOUT).unwrap();
        prop_assert_eq!(episode.haptic.is_none(), missing == 0);
        prop_assert_eq!(episode.proprio.is_none(), missing == 1 || missing == 2);
        prop_assert_eq!(episode.tip.is_none(), missing == 1);
        prop_assert_eq!(episode.controls.is_none(), missing == 3);
        prop_assert_eq!(episode.object.is_none(), missing == 4);
    }

    #[test]
    fn a_gap_is_flagged_where_it_is(at in 5_usize..40, jitter in vec(-1_000_000_i64..1_000_000, 50)) {
        let images = stamps(BASE, &[100_000_000; 5]);
        let even: Vec<i64> = (0..50).map(|i| BASE + i * 10_000_000 + jitter[i as usize]).collect();
        let mut recording = Recording {
            frames: images.iter().map(|_| frame()).collect(),
            frame_stamps_nanos: images,
            wrench: track(&even, |_| [0.0; 6]),
            ..Recording::default()
        };
        prop_assert_eq!(align(&recording, LAYOUT).unwrap().flags, []);
        // Four samples lost: 50 ms between two of a nominal 10.
        recording.wrench.stamps_nanos.drain(at..at + 4);
        recording.wrench.values.drain(at..at + 4);
        let flags = align(&recording, LAYOUT).unwrap().flags;
        prop_assert_eq!(flags.len(), 1);
        prop_assert_eq!(flags[0].topic.as_str(), "/wrench");
        prop_assert_eq!(flags[0].stamp_nanos, even[at - 1]);
        prop_assert!(flags[0].what.starts_with("gap of "), "{}", flags[0].what);
    }
}

#[test]
fn one_image_is_no_episode() {
    let mut recording = Recording {
        frames: vec![frame()],
        frame_stamps_nanos: vec![BASE],
        ..Recording::default()
    };
    let error = align(&recording, LAYOUT).unwrap_err();
    assert!(matches!(error, DataError::TooFewImages { images: 1, .. }));
    // Two of one stamp are one step.
    recording.frames.push(frame());
    recording.frame_stamps_nanos.push(BASE);
    assert!(align(&recording, LAYOUT).is_err());
}

#[test]
fn a_stream_that_stops_early_has_a_gap() {
    let images = stamps(BASE, &[100_000_000; 5]);
    let until = |samples: usize| stamps(BASE, &vec![10_000_000; samples]);
    let mut recording = Recording {
        frames: images.iter().map(|_| frame()).collect(),
        frame_stamps_nanos: images,
        wrench: track(&until(30), |_| [0.0; 6]),
        control: track(&until(30), |_| [0.0; 2]),
        ..Recording::default()
    };
    let flags = |recording: &Recording| align(recording, LAYOUT).unwrap().flags;
    let said = flags(&recording);
    let said: Vec<_> = said
        .iter()
        .map(|f| (f.topic.as_str(), f.stamp_nanos))
        .collect();
    let at = BASE + 300_000_000;
    assert_eq!(said, [("/wrench", at), ("/control", at)]);
    // No command counts after the last image but one; the wrench at the last one does.
    recording.wrench = track(&until(50), |_| [0.0; 6]);
    recording.control = track(&until(40), |_| [0.0; 2]);
    assert_eq!(flags(&recording), []);
}

#[test]
fn a_stream_that_starts_late_or_speaks_once_is_flagged() {
    let images = stamps(BASE, &[100_000_000; 5]);
    let late = stamps(BASE + 250_000_000, &[10_000_000; 25]);
    let recording = Recording {
        frames: images.iter().map(|_| frame()).collect(),
        frame_stamps_nanos: images,
        wrench: track(&late, |_| [0.0; 6]),
        ee_position: track(&[BASE], |_| [0.0; 3]),
        control: track(&late, |_| [0.0; 2]),
        ..Recording::default()
    };
    let episode = align(&recording, LAYOUT).unwrap();
    let said: Vec<_> = episode
        .flags
        .iter()
        .map(|flag| (flag.topic.as_str(), flag.stamp_nanos, flag.what.as_str()))
        .collect();
    let gap = (BASE + 100_000_000, "gap of 160.000 ms");
    assert_eq!(
        said,
        [
            ("/wrench", gap.0, gap.1),
            ("/ee/pose", BASE, "a single sample"),
            ("/control", gap.0, gap.1),
        ]
    );
    // A gap concerns the step that lacks something.
    assert_eq!(episode.flagged_steps().collect::<Vec<_>>(), [1, 0, 1]);
}

#[test]
fn a_value_that_is_no_number_is_flagged() {
    let images = stamps(BASE, &[100_000_000; 5]);
    let sensed = stamps(BASE, &[10_000_000; 50]);
    let mut wrench = track(&sensed, |_| [0.0; 6]);
    wrench.values[7][4] = f64::NAN;
    let recording = Recording {
        frames: images.iter().map(|_| frame()).collect(),
        frame_stamps_nanos: images,
        wrench,
        ..Recording::default()
    };
    let flags = align(&recording, LAYOUT).unwrap().flags;
    assert_eq!(flags.len(), 1, "{flags:?}");
    assert_eq!(
        (flags[0].topic.as_str(), flags[0].stamp_nanos),
        ("/wrench", sensed[7])
    );
}

/// Force and displacement have the same axes, and the force that is recorded is the one on the pusher.
#[test]
fn what_the_pusher_does_points_where_the_object_goes() {
    let mut pushes = 0;
    for index in 0..3 {
        let recording = simulate(&Params::default(), 5, index);
        let episode = align(&recording, Layout::default()).unwrap();
        let object = episode.object.as_ref().unwrap();
        for (t, pair) in (1..).zip(object.windows(2)) {
            let [fx, fy] = episode.push_newtons(t).unwrap();
            let (dx, dy) = (pair[1].x - pair[0].x, pair[1].y - pair[0].y);
            let size = fx.hypot(fy) * dx.hypot(dy);
            if fx.hypot(fy) > 1.0 && dx.hypot(dy) > 0.005 {
                pushes += 1;
                assert!(fx * dx + fy * dy > 0.5 * size, "episode {index}, step {t}");
            }
        }
    }
    assert!(pushes > 5, "{pushes} steps with a push");
}
