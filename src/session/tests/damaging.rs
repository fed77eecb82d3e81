//! Damaged inputs, edited controls, samples.

use super::*;
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::Modality;
use crate::session::settings::ControlEdit;
use crate::session::wants::Wants;

fn damage(damage: Damage, severity: f32) -> Corruption {
    Corruption {
        damage,
        severity,
        from: 0,
        until: None,
        patch: [0.5, 0.5],
        seed: 0,
    }
}

fn corrupt(modality: Modality, corruption: Corruption) -> Command {
    Corrupt {
        modality,
        corruption: Some(corruption),
    }
}

#[test]
fn only_the_damaged_expert_is_encoded_again() {
    let model = FakePredictor::three();
    let calls = model.calls();
    let mut session = session_of(vec![Arc::new(model)]);
    let before = run(&mut session, [SeekTo(7)]);
    let after = run(
        &mut session,
        [corrupt(Modality::Haptic, damage(Damage::Bias, 1.0))],
    );
    assert_eq!((calls.encoded(), calls.encoded_one()), (1, 1));
    let means = |snapshot: &Snapshot, i: usize| snapshot.experts[i].latent.clone().unwrap().mean;
    assert_ne!(means(&before, 1), means(&after, 1));
    assert_eq!(means(&before, 0), means(&after, 0));
    assert_eq!(means(&before, 2), means(&after, 2));
    assert_eq!(after.corruptions.len(), 1);
    assert_eq!(after.experts[1].alpha, 1.0, "damaged is not switched off");
    assert_eq!(before.frames.truth, after.frames.truth);
    assert!(after.frames.input.is_none(), "vision is as recorded");
    let mended = run(
        &mut session,
        [Corrupt {
            modality: Modality::Haptic,
            corruption: None,
        }],
    );
    assert_eq!(mended.belief, before.belief);
    assert_eq!((calls.encoded(), calls.encoded_one()), (1, 1));
}

#[test]
fn the_frame_that_the_model_sees_is_shown_where_it_is_damaged() {
    let mut session = session();
    let patch = Corruption {
        from: 4,
        until: Some(6),
        ..damage(Damage::Occlude, 0.5)
    };
    let at = |session: &mut Session, step: usize| run(session, [SeekTo(step)]).frames;
    run(&mut session, [corrupt(Modality::Vision, patch)]);
    assert!(at(&mut session, 4).input.is_none());
    let frames = at(&mut session, 5);
    assert_ne!(frames.input.unwrap(), frames.truth.unwrap());
    assert!(at(&mut session, 7).input.is_none());
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    let mut session = session_of(vec![Arc::new(FakePredictor::vision())]);
    let before = session.snapshot().state;
    for command in [
        corrupt(Modality::Haptic, damage(Damage::Zero, 0.5)),
        corrupt(Modality::Vision, damage(Damage::Noise, 1.5)),
        corrupt(Modality::Vision, damage(Damage::Noise, f32::NAN)),
        SetSamples(0),
        SetSamples(1_000_000),
        CompareWith(0),
        CompareWith(7),
        EditControls(Some(ControlEdit {
            scale: f32::NAN,
            ..ControlEdit::from(0)
        })),
    ] {
        let snapshot = run(&mut session, [command.clone()]);
        assert!(is_refusal(&snapshot), "{command:?}");
        assert_eq!(snapshot.state, before);
    }
    let mut session = self::session();
    let occluded = corrupt(Modality::Haptic, damage(Damage::Occlude, 0.5));
    assert!(is_refusal(&run(&mut session, [occluded])));
}

#[test]
fn edited_controls_change_the_prediction_and_nothing_that_was_seen() {
    let mut session = session();
    let before = run(&mut session, [SeekTo(10)]);
    let edit = ControlEdit {
        rotate_deg: 90.0,
        ..ControlEdit::from(5)
    };
    let after = run(&mut session, [EditControls(Some(edit))]);
    let (was, is) = (before.position.unwrap(), after.position.unwrap());
    assert_eq!(was.belief, is.belief);
    assert_eq!(before.belief, after.belief);
    // The control of step 6 is the first that is another one: step 7 is the first that ends elsewhere.
    assert_eq!(was.prediction[..6], is.prediction[..6]);
    assert_ne!(was.prediction[6..15], is.prediction[6..15]);
    assert_eq!(is.recorded_controls, was.prediction);
    assert_ne!(before.frames.prediction, after.frames.prediction);
    assert_eq!(after.control_edit, Some(edit));
    let undone = run(&mut session, [Undo]);
    assert_eq!(undone.position.unwrap().prediction, was.prediction);
}

#[test]
fn samples_have_the_same_noise_whenever_they_are_asked_for() {
    let mut session = session();
    session.want(Wants {
        spread: true,
        ..Wants::default()
    });
    let mean = run(&mut session, [SeekTo(9)]);
    let spread = mean.spread.clone().unwrap();
    assert_eq!((spread.first_step, spread.head.len()), (4, 11));
    assert_eq!(spread.fan.len(), 24);
    assert!(spread.frames.is_some());
    // The fake's transition keeps what it knew: its spread accumulates, and A P Aᵀ + Q says the same.
    let sample = run(&mut session, [ToggleSamples]);
    assert_ne!(sample.frames.prediction, mean.frames.prediction);
    let again = run(&mut session, [ToggleSamples, ToggleSamples]);
    assert_eq!(again.frames.prediction, sample.frames.prediction);
    let other = run(&mut session, [SetSeed(1)]);
    assert_ne!(other.frames.prediction, sample.frames.prediction);
    let more = run(&mut session, [SetSeed(0), SetSamples(64)]);
    assert_eq!(more.spread.unwrap().fan, spread.fan);
}

#[test]
fn a_response_goes_from_no_damage_to_all_of_it() {
    let mut session = session();
    session.want(Wants {
        response: true,
        ..Wants::default()
    });
    assert!(run(&mut session, [SeekTo(7)]).responses.is_empty());
    let bias = corrupt(Modality::Proprio, damage(Damage::Bias, 0.4));
    let responses = run(&mut session, [bias]).responses;
    let [response] = responses.as_slice() else {
        panic!("one damage, one response")
    };
    assert_eq!((response.severity.len(), response.severity[10]), (11, 1.0));
    assert!(response.rmse_m[10] > response.rmse_m[0] && response.nees[10] > response.nees[0]);
    // The fake states the same spread whatever it sees.
    assert!(response.slope.abs() < 1e-5 && response.sentence.contains("does not notice"));
    let off = run(&mut session, [ToggleExpert(2)]).responses;
    assert!(off[0].sentence.contains("is off"));
}
