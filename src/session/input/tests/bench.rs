//! Corruption, controls, samples, and the other keys of the bench.

use super::*;
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::Modality;
use crate::session::command::Scope;
use crate::session::settings::ControlEdit;

/// A snapshot in which what was asked for has come true.
fn obeyed(snapshot: &mut Snapshot, command: Command) {
    match command {
        Command::Corrupt {
            modality,
            corruption,
        } => {
            snapshot.corruptions.retain(|(m, _)| *m != modality);
            snapshot
                .corruptions
                .extend(corruption.map(|c| (modality, c)));
        }
        Command::EditControls(edit) => snapshot.control_edit = edit,
        Command::SetSamples(count) => snapshot.sampling.count = count,
        Command::ToggleSamples => snapshot.sampling.shown ^= true,
        Command::Step(by) => snapshot.cursor = snapshot.cursor.saturating_add_signed(by as isize),
        other => panic!("{other:?}"),
    }
}

/// Presses keys that do what they ask for; the last hint.
fn played(script: &str, snapshot: &mut Snapshot) -> (Input, Option<String>) {
    let mut input = Input::default();
    for key in parse_script(script).unwrap() {
        match input.press(&key, snapshot) {
            Some(Action::Session(command)) => obeyed(snapshot, command),
            None => {}
            other => panic!("{key}: {other:?}"),
        }
    }
    let hint = input.hint(snapshot);
    (input, hint)
}

fn vision(snapshot: &Snapshot) -> Option<Corruption> {
    let found = snapshot
        .corruptions
        .iter()
        .find(|(m, _)| *m == Modality::Vision);
    found.map(|&(_, corruption)| corruption)
}

#[test]
fn the_keys_of_the_bench_are_in_the_table() {
    let at = snapshot("");
    let expected = [
        Command::Event(-1),
        Command::Event(1),
        Command::Failure(1),
        Command::Failure(-1),
        Command::CycleFailureOrder,
        Command::ToggleSamples,
        Command::Select,
        Command::ToggleMark,
        Command::CycleLoop,
    ];
    assert_eq!(commands("{ } n N o m V * L", &at), expected);
    let face = asked(&mut Input::default(), "d b w E e", &at);
    let expected = [
        FaceCommand::Difference,
        FaceCommand::Blink,
        FaceCommand::Wipe,
        FaceCommand::Episodes,
        FaceCommand::Export,
    ];
    assert_eq!(face, expected.map(Action::Face));
    for key in ["t", "k"] {
        assert_eq!(asked(&mut Input::default(), key, &at), []);
    }
    for key in [":", "<c-k>", "<c-p>"] {
        let mut input = Input::default();
        asked(&mut input, key, &at);
        assert!(input.palette(&at).is_some(), "{key}");
    }
}

#[test]
fn x_goes_through_every_damage_and_back_to_none() {
    let mut at = snapshot("");
    let mut seen = Vec::new();
    for presses in 1..=8 {
        at.corruptions.clear();
        played(&"x".repeat(1 + presses), &mut at);
        seen.push(vision(&at).map(|corruption| corruption.damage));
    }
    let kinds = [
        Damage::Zero,
        Damage::Hold,
        Damage::Noise,
        Damage::Occlude,
        Damage::Bias,
        Damage::Delay,
    ];
    let expected: Vec<_> = kinds
        .map(Some)
        .into_iter()
        .chain([None, Some(Damage::Zero)])
        .collect();
    assert_eq!(seen, expected);
    at.corruptions.clear();
    played("x2xxxx", &mut at);
    let (modality, corruption) = at.corruptions[0];
    assert_eq!(
        (modality, corruption.damage),
        (Modality::Haptic, Damage::Bias),
        "nothing occludes a force"
    );
}

#[test]
fn severity_counts_in_tenths_and_arrows_move_the_patch() {
    let mut at = snapshot("");
    at.sampling.seed = 4;
    let (_, hint) = played("xxxxx===<left><up><up>", &mut at);
    let corruption = vision(&at).unwrap();
    assert_eq!(
        (corruption.severity, corruption.patch, corruption.seed),
        (0.8, [0.375, 0.25], 4)
    );
    assert_eq!(
        hint.unwrap(),
        "vision input: occlude 0.8 from step 1 | x kind, - = severity, arrows patch, a digit another, @ from here, Esc ends"
    );
    played("x-----------", &mut at);
    assert_eq!(vision(&at).unwrap().severity, 0.0);
    played(
        "x====================<down><down><down><down><down><down><down>",
        &mut at,
    );
    let corruption = vision(&at).unwrap();
    assert_eq!((corruption.severity, corruption.patch), (1.0, [0.375, 1.0]));
    let (_, hint) = played("x x x x x", &mut snapshot(""));
    assert!(hint.unwrap().contains("arrows"));
    let (input, hint) = played("xx<right>", &mut at);
    assert_eq!(
        (input.mode(), hint),
        (None, None),
        "without a patch an arrow is a step"
    );
}

#[test]
fn a_damage_reaches_as_far_as_the_scope_and_keeps_its_steps() {
    let mut at = snapshot("lll");
    at.scope = Scope::Onward;
    let (_, hint) = played("xx", &mut at);
    assert!(
        hint.unwrap()
            .starts_with("vision input: zero 0.5 from step 4 |")
    );
    at.cursor = 7;
    played("xx=", &mut at);
    let corruption = vision(&at).unwrap();
    assert_eq!((corruption.damage, corruption.from), (Damage::Hold, 3));
    at.scope = Scope::Frame;
    let (_, hint) = played("x@", &mut at);
    let moved = vision(&at).unwrap();
    assert_eq!((moved.from, moved.until, moved.severity), (7, Some(8), 0.6));
    assert!(hint.unwrap().contains("at step 8"));
}

#[test]
fn a_digit_picks_the_input_of_another_expert_and_tab_another_of_its_own() {
    let mut at = snapshot("");
    let (input, hint) = played("x3", &mut at);
    assert_eq!(input.focused_expert(), 2);
    assert_eq!(
        hint.unwrap(),
        "proprio input: as recorded | x damages it, a digit another, Esc ends"
    );
    assert!(at.corruptions.is_empty());
    let complaint = asked(&mut Input::default(), "x7", &at);
    assert!(matches!(
        complaint[..],
        [Action::Explain { error: true, .. }]
    ));

    let models: Vec<Arc<dyn crate::session::predict::Predictor>> =
        vec![Arc::new(FakePredictor::joint())];
    let mut session = Session::new(Arc::new(FakeSource::new(1)), models);
    assert!(session.wait_idle(Duration::from_secs(20)));
    let mut joint = session.snapshot();
    let place = joint
        .experts
        .iter()
        .position(|view| view.expert.modalities().len() > 1)
        .unwrap();
    let (_, hint) = played(&format!("x{}<tab>x", place + 1), &mut joint);
    assert_eq!(joint.corruptions[0].0, Modality::Proprio);
    assert!(hint.unwrap().contains("Tab or a digit another"));
    let (_, hint) = played(&format!("x{}<tab><tab>", place + 1), &mut joint);
    assert!(hint.unwrap().starts_with("haptic input: as recorded"));

    let mut input = Input::default();
    asked(&mut input, "9x", &joint);
    assert_eq!(
        input.hint(&joint).unwrap(),
        "whose input? a digit",
        "the prior sees nothing"
    );
}

#[test]
fn controls_turn_scale_mirror_stop_and_come_back() {
    let mut at = snapshot("lllll");
    let (_, hint) = played("r==<down><down>m", &mut at);
    let edit = at.control_edit.unwrap();
    let expected = ControlEdit {
        from: 5,
        rotate_deg: 30.0,
        scale: 0.5,
        mirror: true,
    };
    assert_eq!(edit, expected);
    assert!(
        hint.unwrap().starts_with(
            "controls from step 6: turned 30°, × 0.5, mirrored | - = turn, ↑ ↓ speed,"
        )
    );
    at.cursor = 9;
    played("r-", &mut at);
    assert_eq!(
        at.control_edit.unwrap(),
        ControlEdit {
            rotate_deg: 15.0,
            ..expected
        }
    );
    let (_, hint) = played("r.", &mut at);
    assert!(hint.unwrap().starts_with("controls from step 6: stopped |"));
    let (_, hint) = played("rr", &mut at);
    assert_eq!(at.control_edit, None);
    assert!(
        hint.unwrap()
            .starts_with("controls from step 6: as recorded |")
    );
    played("r=-", &mut at);
    assert_eq!(
        at.control_edit, None,
        "turned there and back is as recorded"
    );
}

#[test]
fn samples_double_and_halve_within_bounds() {
    let mut at = snapshot("");
    let (_, hint) = played("M==", &mut at);
    assert_eq!(
        hint.unwrap(),
        "128 samples | - half, = twice as many, Esc ends"
    );
    played("M==========", &mut at);
    assert_eq!(at.sampling.count, 256);
    played("M----------------", &mut at);
    assert_eq!(at.sampling.count, 2);
}

#[test]
fn every_mode_ends_with_esc_enter_or_another_key() {
    let at = snapshot("");
    for begin in ["S", "a", "c", "C", "x", "r", "M"] {
        for end in ["<esc>", "<enter>"] {
            let mut input = Input::default();
            assert_eq!(asked(&mut input, &format!("{begin}{end}"), &at), []);
            assert_eq!(input.hint(&at), None, "{begin}{end}");
        }
        let mut input = Input::default();
        let next = asked(&mut input, &format!("{begin}u"), &at);
        assert_eq!(
            (next, input.mode()),
            (vec![Action::Session(Command::Undo)], None)
        );
    }
}
