//! What is written reads back, and what cannot be read is named.
#![expect(clippy::float_cmp, reason = "numbers are compared as they were set")]

use proptest::prelude::*;

use super::*;
use crate::measure::corruption::Damage;
use crate::modality::Expert;
use crate::model::switches::Reach;

#[test]
fn reads_what_the_documentation_shows() {
    let text = "v=1;episode=a%20b;step=6;alpha=vision:0@1-15,haptic:0.5@4;later=x%3by";
    let (state, complaints) = State::parse(text);
    assert_eq!(complaints, Vec::<String>::new());
    assert_eq!(state.episode.as_deref(), Some("a b"));
    let switches = &state.switches;
    assert!(switches.alpha(Expert::Vision, 14) == 0.0 && switches.alpha(Expert::Vision, 15) == 1.0);
    assert!(switches.alpha(Expert::Haptic, 3) == 0.5 && switches.alpha(Expert::Haptic, 4) == 1.0);
    assert_eq!(state.unknown, [("later".to_owned(), "x;y".to_owned())]);
    assert_eq!(state.to_string(), text);
}

#[test]
fn the_bench_is_in_it() {
    let text = "v=1;compare=vhp;corrupt=vision:occlude:1@4-:0.25x0.75,haptic:noise:0.5@3-7;\
                controls=from:6,rotate:30,scale:0.5,mirror;samples=64;sample=on;seed=7;marks=3,7;select=4-9;rank=nees";
    let (state, complaints) = State::parse(text);
    assert_eq!(complaints, Vec::<String>::new());
    let haptic = state.corruptions[&Modality::Haptic];
    assert_eq!(
        (haptic.damage, haptic.from, haptic.until, haptic.seed),
        (Damage::Noise, 2, Some(7), 7)
    );
    assert_eq!(state.corruptions[&Modality::Vision].patch, [0.25, 0.75]);
    let controls = state.controls.unwrap_or(ControlEdit::from(0));
    assert_eq!(
        (controls.from, controls.mirror, controls.rotate_deg),
        (5, true, 30.0)
    );
    assert_eq!(
        state.sampling,
        Sampling {
            shown: true,
            count: 64,
            seed: 7
        }
    );
    assert_eq!(state.marks, BTreeSet::from([2, 6]));
    assert_eq!(
        (state.selection, state.order),
        (Some((3, Some(8))), Order::Nees)
    );
    assert_eq!(state.to_string(), text);
    assert_eq!(state.selected(), Some(3..=8));
    let open = State::parse("v=1;select=4-").0;
    assert_eq!((open.selection, open.selected()), (Some((3, None)), None));
    assert_eq!(
        State::parse("v=1;controls=from:6,rotate:360").0.controls,
        None
    );
}

#[test]
fn each_complaint_of_the_bench_names_its_key() {
    for text in [
        "corrupt=haptic:occlude:0.5",
        "corrupt=vision:noise:1.5",
        "corrupt=vision:noise:NaN",
        "corrupt=vision:noise:0.5:0.5x0.5",
        "corrupt=vision:blur:0.5",
        "controls=from:0",
        "controls=scale:9",
        "controls=rotate:inf",
        "samples=1",
        "sample=perhaps",
        "seed=-1",
        "marks=3,0",
        "select=9-4",
        "rank=jerk",
    ] {
        let (state, complaints) = State::parse(&format!("v=1;{text}"));
        let key = text.split('=').next().unwrap_or_default();
        assert!(
            complaints.len() == 1 && complaints[0].starts_with(&format!("{key}: ")),
            "{text}: {complaints:?}"
        );
        assert_eq!(state, State::default(), "{text}");
    }
}

#[test]
fn a_bad_value_is_named_and_the_others_count() {
    let (state, complaints) =
        State::parse("v=2;step=0;context=7;scope=all;alpha=vison:0;speed=x;junk");
    assert_eq!(state.context, Some(7));
    let keys: Vec<&str> = complaints
        .iter()
        .map(|c| c.split(':').next().unwrap_or_default())
        .collect();
    assert_eq!(keys[..5], ["v", "step", "scope", "alpha", "speed"]);
    assert_eq!(complaints.len(), 6);
    assert_eq!((state.step, state.scope), (None, None));
}

fn any_switches() -> impl Strategy<Value = Switches> {
    let run = (
        0_usize..5,
        0_usize..20,
        prop::option::of(1_usize..9),
        0_u8..9,
    );
    prop::collection::vec(run, 0..8).prop_map(|runs| {
        let mut switches = Switches::default();
        for (expert, from, length, tenth) in runs {
            let until = length.map(|length| from + length);
            switches.set(
                Expert::ALL[expert],
                Reach { from, until },
                f32::from(tenth) / 8.0,
            );
        }
        switches
    })
}

fn any_corruptions() -> impl Strategy<Value = BTreeMap<Modality, Corruption>> {
    let one = (
        0_usize..3,
        0_usize..6,
        0.0_f32..=1.0,
        0_usize..20,
        prop::option::of(1_usize..9),
        [0.0_f32..=1.0, 0.0_f32..=1.0],
    );
    prop::collection::vec(one, 0..4).prop_map(|entries| {
        let corruption = |(modality, damage, severity, from, length, patch): (
            usize,
            usize,
            f32,
            usize,
            Option<usize>,
            [f32; 2],
        )| {
            let modality = crate::modality::Modality::ALL[modality];
            let (damage, patch) = match Damage::ALL[damage] {
                Damage::Occlude if modality == Modality::Vision => (Damage::Occlude, patch),
                Damage::Occlude => (Damage::Bias, [0.5; 2]),
                damage => (damage, [0.5; 2]),
            };
            let until = length.map(|length| from + length);
            (
                modality,
                Corruption {
                    damage,
                    severity,
                    from,
                    until,
                    patch,
                    seed: 0,
                },
            )
        };
        entries.into_iter().map(corruption).collect()
    })
}

fn any_controls() -> impl Strategy<Value = Option<ControlEdit>> {
    let edit = (0_usize..30, -500.0_f32..500.0, 0.0_f32..=4.0, any::<bool>());
    prop::option::of(edit).prop_map(|edit| {
        let (from, turn, scale, mirror) = edit?;
        let edit = ControlEdit {
            mirror,
            ..ControlEdit::from(from)
        };
        edit.turned(turn).scaled(scale).unless_identity()
    })
}

fn any_bench() -> impl Strategy<Value = State> {
    let steps = prop::collection::btree_set(0_usize..40, 0..4);
    let selection = prop::option::of((0_usize..20, prop::option::of(0_usize..9)));
    let sampling = (any::<bool>(), SAMPLES, any::<u64>());
    let rest = (prop::option::of("[a-z#-]{1,6}"), 0_usize..6, 0_usize..3);
    (
        any_corruptions(),
        any_controls(),
        steps,
        selection,
        sampling,
        rest,
    )
        .prop_map(
            |(mut corruptions, controls, marks, selection, (shown, count, seed), rest)| {
                for corruption in corruptions.values_mut() {
                    corruption.seed = seed;
                }
                State {
                    corruptions,
                    controls,
                    marks,
                    selection: selection
                        .map(|(first, more)| (first, more.map(|more| first + more))),
                    sampling: Sampling { shown, count, seed },
                    compare: rest.0,
                    order: Order::ALL[rest.1],
                    looping: Some(LOOPINGS[rest.2].1),
                    ..State::default()
                }
            },
        )
}

proptest! {
    #[test]
    fn what_is_written_reads_back(
        episode in prop::option::of("\\PC{0,12}"),
        model in prop::option::of("[a-z =;%#-]{1,9}"),
        numbers in (prop::option::of(1_usize..99), prop::option::of(1_usize..99), prop::option::of(1_usize..99)),
        scope in 0_usize..3,
        speed in prop::option::of(-3_i32..4),
        switches in any_switches(),
        unknown in prop::collection::vec(("[a-z]{9,10}", ".{0,6}"), 0..3),
        bench in any_bench(),
    ) {
        let state = State {
            episode,
            model,
            step: numbers.0,
            context: numbers.1,
            horizon: numbers.2,
            scope: Some(SCOPES[scope].1),
            speed: speed.map(|e| 2.0_f32.powi(e)),
            switches,
            unknown,
            ..bench
        };
        prop_assert_eq!(State::parse(&state.to_string()), (state, Vec::new()));
    }

    #[test]
    fn any_text_can_be_read(text in ".{0,40}", alpha in "[a-z:0-9@.,x-]{0,20}") {
        State::parse(&text);
        for key in ["corrupt", "controls", "marks", "select", "samples", "seed"] {
            State::parse(&format!("v=1;{key}={alpha}"));
        }
        State::parse(&format!("v=1;alpha={alpha};step={alpha}"));
    }
}
