use proptest::prelude::*;

use super::*;
use crate::episode::{EpisodeMeta, Frame, Layout, PlanarPose};

const STEPS: usize = 12;
const WINDOW: usize = 4;
const SIDE: usize = 8;
const MODALITIES: [Modality; 3] = [Modality::Vision, Modality::Haptic, Modality::Proprio];

fn windows(phase: f32) -> Vec<f32> {
    (0..STEPS * WINDOW * 6)
        .map(|i| (1 + i % 6) as f32 * (0.37 * (i / 6) as f32 + phase).sin() - 0.5)
        .collect()
}

fn episode() -> Episode {
    Episode {
        meta: EpisodeMeta::default(),
        layout: Layout {
            frame_size: SIDE,
            window: WINDOW,
        },
        steps_nanos: (0..STEPS as i64).collect(),
        frames: (0..STEPS)
            .map(|t| Frame {
                width: SIDE,
                height: SIDE,
                pixels: (0..SIDE * SIDE).map(|i| (7 * i + 13 * t) as u8).collect(),
            })
            .collect(),
        haptic: Some(windows(0.0)),
        proprio: Some(windows(1.0)),
        controls: Some(vec![[0.1, 0.2]; STEPS - 1]),
        object: Some(vec![PlanarPose::default(); STEPS]),
        tip: Some(vec![[0.3, 0.4]; STEPS]),
        flags: Vec::new(),
    }
}

fn corruption(damage: Damage, severity: f32) -> Corruption {
    Corruption {
        damage,
        severity,
        seed: 5,
        ..Corruption::default()
    }
}

/// The window of step `t` of a modality other than vision.
fn window(episode: &Episode, modality: Modality, t: usize) -> &[f32] {
    let data = match modality {
        Modality::Haptic => episode.haptic.as_deref(),
        _ => episode.proprio.as_deref(),
    };
    &data.expect("windows")[t * WINDOW * 6..(t + 1) * WINDOW * 6]
}

/// What a modality shows at step `t`, as bits.
fn bits(episode: &Episode, modality: Modality, t: usize) -> Vec<u32> {
    match modality {
        Modality::Vision => episode.frames[t].pixels.iter().map(|&p| p.into()).collect(),
        _ => window(episode, modality, t)
            .iter()
            .map(|x| x.to_bits())
            .collect(),
    }
}

#[test]
fn names_are_unique() {
    for damage in Damage::ALL {
        assert_eq!(Damage::from_name(damage.name()), Some(damage));
    }
    assert_eq!(Damage::from_name("none"), None);
}

#[test]
fn windows_cannot_be_occluded() {
    let damage = corruption(Damage::Occlude, 1.0);
    assert!(applies(Damage::Occlude, Modality::Vision));
    for modality in [Modality::Haptic, Modality::Proprio] {
        assert!(!applies(Damage::Occlude, modality));
        assert_eq!(corrupt(&episode(), modality, &damage), episode());
    }
}

#[test]
fn zero_goes_to_black_and_to_nothing() {
    let half = corrupt(&episode(), Modality::Haptic, &corruption(Damage::Zero, 0.5));
    let whole = corrupt(&episode(), Modality::Haptic, &corruption(Damage::Zero, 1.0));
    for (x, half) in
        window(&episode(), Modality::Haptic, 3)
            .iter()
            .zip(window(&half, Modality::Haptic, 3))
    {
        assert!((0.5 * x - half).abs() < 1e-6);
    }
    assert!(
        whole
            .haptic
            .expect("windows")
            .iter()
            .all(|x| x.to_bits() == 0)
    );
    let black = corrupt(&episode(), Modality::Vision, &corruption(Damage::Zero, 1.0));
    assert!(
        black
            .frames
            .iter()
            .all(|f| f.pixels.iter().all(|&p| p == 0))
    );
}

#[test]
fn held_altogether_the_range_shows_its_first_step() {
    let held = Corruption {
        from: 3,
        until: Some(9),
        ..corruption(Damage::Hold, 1.0)
    };
    for modality in MODALITIES {
        let damaged = corrupt(&episode(), modality, &held);
        for t in 3..9 {
            assert_eq!(bits(&damaged, modality, t), bits(&episode(), modality, 3));
        }
        assert_eq!(bits(&damaged, modality, 9), bits(&episode(), modality, 9));
    }
}

#[test]
fn the_share_of_held_steps_is_the_severity_and_grows_with_it() {
    let count = |severity| {
        let shown = timing::shown(&corruption(Damage::Hold, severity), Modality::Vision, 4001);
        let held: Vec<bool> = (0..4001).map(|t| shown[t] != t).collect();
        held
    };
    let (few, many) = (count(0.25), count(0.75));
    let share = |held: &[bool]| held.iter().filter(|&&h| h).count() as f64 / 4000.0;
    assert!((share(&few) - 0.25).abs() < 0.03);
    assert!((share(&many) - 0.75).abs() < 0.03);
    assert!(few.iter().zip(&many).all(|(&few, &many)| !few || many));
}

#[test]
fn noise_has_the_size_it_says() {
    let clean = episode();
    let damaged = corrupt(&clean, Modality::Haptic, &corruption(Damage::Noise, 0.5));
    let sd = |values: &[f32]| {
        let n = values.len() as f32;
        let mean = values.iter().sum::<f32>() / n;
        (values.iter().map(|x| (x - mean).powi(2)).sum::<f32>() / n).sqrt()
    };
    let (clean, damaged) = (
        clean.haptic.expect("windows"),
        damaged.haptic.expect("windows"),
    );
    let scaled: Vec<f32> = (0..clean.len())
        .map(|i| {
            let channel: Vec<f32> = clean.iter().skip(i % 6).step_by(6).copied().collect();
            (damaged[i] - clean[i]) / sd(&channel)
        })
        .collect();
    // 288 draws: the deviation of their deviation is 4 %.
    assert!((sd(&scaled) - 0.5).abs() < 0.07, "{}", sd(&scaled));
}

#[test]
fn a_bias_is_the_same_everywhere() {
    let damaged = corrupt(
        &episode(),
        Modality::Proprio,
        &corruption(Damage::Bias, 0.5),
    );
    let offset = |t: usize, i: usize| {
        window(&damaged, Modality::Proprio, t)[i] - window(&episode(), Modality::Proprio, t)[i]
    };
    for channel in 0..6 {
        assert!(offset(0, channel) > 0.5);
        assert!((offset(0, channel) - offset(11, channel + 6)).abs() < 1e-5);
    }
    let bright = corrupt(&episode(), Modality::Vision, &corruption(Damage::Bias, 1.0));
    let (before, after) = (&episode().frames[0].pixels, &bright.frames[0].pixels);
    assert_eq!((before[1], after[1]), (7, 135));
    assert_eq!((before[30], after[30]), (210, 255));
}

#[test]
fn a_late_stream_holds_its_first_data_and_never_runs_backwards() {
    let late = Corruption {
        from: 2,
        ..corruption(Damage::Delay, 0.375)
    };
    for modality in MODALITIES {
        let damaged = corrupt(&episode(), modality, &late);
        for (t, source) in [(0, 0), (1, 1), (2, 2), (4, 2), (5, 2), (6, 3), (11, 8)] {
            let expected = bits(&episode(), modality, source);
            assert_eq!(bits(&damaged, modality, t), expected, "step {t}");
        }
    }
}

#[test]
fn the_patch_lies_where_it_was_put_and_is_cut_at_the_border() {
    let patch = |patch, severity| {
        let corruption = Corruption {
            patch,
            ..corruption(Damage::Occlude, severity)
        };
        let mut clean = episode();
        clean.frames.iter_mut().for_each(|f| f.pixels.fill(1));
        let damaged = corrupt(&clean, Modality::Vision, &corruption);
        let pixels = &damaged.frames[0].pixels;
        let covered: Vec<usize> = (0..SIDE * SIDE).filter(|&i| pixels[i] == 128).collect();
        covered
    };
    assert_eq!(patch([0.5, 0.5], 0.25), [27, 28, 35, 36]);
    assert_eq!(patch([1.0, 0.0], 0.25), [7]);
    assert_eq!(patch([0.5, 0.5], 1.0).len(), 64);
    assert_eq!(patch([f32::NAN, 9.0], 0.25), [59, 60]);
}

#[test]
fn two_modalities_are_not_hurt_by_the_same_noise() {
    let both = Episode {
        proprio: episode().haptic,
        ..episode()
    };
    let noise = corruption(Damage::Noise, 1.0);
    let haptic = corrupt(&both, Modality::Haptic, &noise).haptic;
    assert_ne!(haptic, corrupt(&both, Modality::Proprio, &noise).proprio);
}

#[test]
fn odd_episodes_come_through() {
    let empty = Episode {
        steps_nanos: Vec::new(),
        frames: Vec::new(),
        haptic: None,
        proprio: Some(vec![f32::NAN; 7]),
        layout: Layout {
            frame_size: 0,
            window: 0,
        },
        ..episode()
    };
    let ragged = Episode {
        proprio: Some(vec![f32::INFINITY; 31]),
        frames: vec![Frame {
            width: 3,
            height: 9,
            pixels: vec![1; 7],
        }],
        ..episode()
    };
    for modality in MODALITIES {
        for damage in Damage::ALL {
            let damage = corruption(damage, 0.7);
            assert_eq!(corrupt(&empty, modality, &damage).frames, Vec::new());
            assert_eq!(corrupt(&ragged, modality, &damage).frames.len(), 1);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn only_the_chosen_steps_of_the_chosen_modality_change(
        (damage, modality) in (0_usize..6, 0_usize..3),
        (from, length) in (0_usize..20, 0_usize..20),
        severity in 0.0_f32..1.5,
        seed in 0_u64..4,
    ) {
        let modality = MODALITIES[modality];
        let corruption = Corruption {
            damage: Damage::ALL[damage],
            severity,
            from,
            until: (length < 15).then_some(from + length),
            seed,
            ..Corruption::default()
        };
        let clean = episode();
        let damaged = corrupt(&clean, modality, &corruption);
        prop_assert_eq!(&damaged, &corrupt(&clean, modality, &corruption));
        let until = corruption.until.unwrap_or(STEPS);
        for t in (0..STEPS).filter(|&t| t < from || t >= until) {
            prop_assert_eq!(bits(&damaged, modality, t), bits(&clean, modality, t));
        }
        let untouched = match modality {
            Modality::Vision => Episode { frames: clean.frames.clone(), ..damaged },
            Modality::Haptic => Episode { haptic: clean.haptic.clone(), ..damaged },
            Modality::Proprio => Episode { proprio: clean.proprio.clone(), ..damaged },
        };
        prop_assert_eq!(untouched, clean);
    }

    #[test]
    fn severity_zero_is_the_identity(damage in 0_usize..6, modality in 0_usize..3) {
        let corruption = corruption(Damage::ALL[damage], 0.0);
        prop_assert_eq!(corrupt(&episode(), MODALITIES[modality], &corruption), episode());
        let nan = Corruption { severity: f32::NAN, ..corruption };
        prop_assert_eq!(corrupt(&episode(), MODALITIES[modality], &nan), episode());
    }
}
