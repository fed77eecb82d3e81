//! Whatever is asked, the session stays in a valid state.

use proptest::prelude::*;

use super::*;
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::Modality;
use crate::session::input::{Action, Input};
use crate::session::keymap::bindings;
use crate::session::keys::Key;
use crate::session::settings::ControlEdit;

fn any_command() -> impl Strategy<Value = Command> {
    let small = -20_i64..20;
    prop_oneof![
        Just(TogglePlay),
        small.clone().prop_map(Step),
        any::<i64>().prop_map(Step),
        (0_usize..20).prop_map(SeekTo),
        (0_usize..20).prop_map(SeekClamped),
        Just(First),
        Just(Last),
        small.clone().prop_map(Episode),
        (0_usize..6).prop_map(SelectEpisode),
        (0_usize..4).prop_map(SelectModel),
        (0_usize..5).prop_map(ToggleExpert),
        ((0_usize..5), any::<bool>()).prop_map(|(expert, on)| SwitchExpert { expert, on }),
        (0_usize..5).prop_map(Solo),
        Just(AllOn),
        (
            (0_usize..5),
            prop_oneof![-0.5_f32..2.0, Just(0.0), any::<f32>()]
        )
            .prop_map(|(expert, alpha)| SetAlpha { expert, alpha }),
        ((0_usize..5), -12_i64..12).prop_map(|(expert, tenths)| Temper { expert, tenths }),
        Just(CycleScope),
        Just(PredictHere),
        any::<usize>().prop_map(SetContext),
        (0_usize..20).prop_map(SetContext),
        (0_usize..20).prop_map(SetHorizon),
        any::<usize>().prop_map(SetHorizon),
        small.clone().prop_map(Context),
        any::<i64>().prop_map(Horizon),
        small.prop_map(Speed),
        Just(CycleLoop),
        Just(Undo),
        Just(Redo),
        "v=1;(step|context|horizon)=[0-9]{1,2};alpha=(vision|prior):[01]@[1-9]-?".prop_map(Restore),
    ]
}

fn check(session: &Session) -> Result<(), TestCaseError> {
    let snapshot = session.snapshot();
    let Some(episode) = &snapshot.episode else {
        return Ok(());
    };
    let steps = episode.secs.len();
    prop_assert!(snapshot.cursor < steps && snapshot.episode_index < 5);
    prop_assert!(snapshot.start < steps && snapshot.start + snapshot.horizon < steps);
    let model = session.model().unwrap();
    let factors = model.factors();
    for step in model.frame_stack..steps {
        let active = factors
            .iter()
            .any(|&e| model.alpha(&session.settings.switches, e, step) > 0.0);
        prop_assert!(active, "no active expert at step {}", step);
    }
    if !snapshot.busy {
        let cells = snapshot.strip.iter().skip(1);
        prop_assert!(
            cells.clone().count() == steps - 1 && cells.clone().all(|cell| cell.belief.is_some())
        );
        prop_assert!(
            snapshot
                .belief
                .iter()
                .flat_map(|b| &b.mean)
                .all(|m| m.is_finite())
        );
    }
    Ok(())
}

fn models() -> Vec<Arc<dyn Predictor>> {
    vec![
        Arc::new(FakePredictor::three()),
        Arc::new(FakePredictor::joint()),
        Arc::new(FakePredictor::vision()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn random_commands_leave_a_valid_state(
        script in prop::collection::vec((any_command(), 0_u64..400, prop::bool::weighted(0.2)), 1..60)
    ) {
        let mut session = Session::new(Arc::new(FakeSource::with_steps(5, 9)), models());
        for (command, millis, wait) in script {
            session.apply(command);
            session.update(Duration::from_millis(millis));
            if wait {
                prop_assert!(session.wait_idle(LONG));
            }
            check(&session)?;
        }
        prop_assert!(session.wait_idle(LONG));
        check(&session)?;

        let state = session.snapshot().state;
        let mut again = Session::new(Arc::new(FakeSource::with_steps(5, 9)), models());
        let back = run(&mut again, [Restore(state.clone())]);
        prop_assert_eq!(back.state, state);
    }

    #[test]
    fn random_keys_never_panic_and_hints_end(picks in prop::collection::vec(any_key(), 1..120)) {
        let mut session = Session::new(Arc::new(FakeSource::new(3)), models());
        let mut input = Input::default();
        for key in picks {
            let snapshot = bent(session.snapshot(), key.name().len());
            if let Some(Action::Session(command)) = input.press(&key, &snapshot) {
                session.apply(command);
            }
            session.update(Duration::from_millis(30));
            let snapshot = session.snapshot();
            let hint = input.hint(&snapshot);
            prop_assert_eq!(hint.is_some(), input.mode().is_some());
            if let Some(view) = input.palette(&snapshot) {
                prop_assert!(view.chosen.is_none_or(|chosen| chosen < view.entries.len()));
                prop_assert_eq!(hint, Some(format!(":{}", view.line)));
            }
        }
        input.press(&Key::named("esc").unwrap(), &session.snapshot());
        prop_assert_eq!(input.hint(&session.snapshot()), None);
    }
}

/// Keys of the table, keys that mean something within a mode, and letters for lines.
fn any_key() -> impl Strategy<Value = Key> {
    let bound = (0_usize..999, 0_usize..8).prop_map(|(binding, key)| {
        let keys = bindings()[binding % bindings().len()].keys;
        keys[key % keys.len()].to_owned()
    });
    let inside = prop::sample::select(vec![
        "<up>",
        "<down>",
        "<left>",
        "<right>",
        "<tab>",
        "<enter>",
        "<esc>",
        "<backspace>",
        "x",
        "r",
        "a",
        "M",
        "@",
        ":",
        "1",
        "3",
        "8",
        "<delete>",
    ]);
    let typed = "[a-z0-9 α.-]".prop_map(|c| if c == " " { "<space>".to_owned() } else { c });
    prop_oneof![bound, inside.prop_map(str::to_owned), typed]
        .prop_map(|spelling| Key::of_spelling(&spelling).unwrap())
}

/// Damage and edits that a session may have: what the modes start from.
fn bent(mut snapshot: Snapshot, by: usize) -> Snapshot {
    if by > 2 {
        let corruption = Corruption {
            damage: Damage::ALL[by % 6],
            severity: 0.95,
            from: by,
            until: Some(by + 2),
            patch: [0.0, 1.0],
            seed: 1,
        };
        snapshot.corruptions = vec![(Modality::Vision, corruption)];
        snapshot.control_edit = Some(ControlEdit::from(by).turned(170.0));
    }
    snapshot
}
