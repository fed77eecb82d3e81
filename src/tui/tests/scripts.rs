//! Everything that the bench can do, by keys alone: a script, then a look at the session and the screen.

#![expect(clippy::float_cmp, reason = "α is compared as it was set")]

use std::sync::Arc;

use ratatui::layout::Size;

use super::{LARGE, SMALL, screen, settle};
use crate::measure::corruption::Damage;
use crate::measure::failure::Order;
use crate::modality::Modality;
use crate::session::Session;
use crate::session::command::{Looping, Scope};
use crate::session::fake::{FakePredictor, FakeSource};
use crate::session::keys::parse_script;
use crate::session::predict::Predictor;
use crate::session::snapshot::table::Column;
use crate::session::snapshot::{Badge, EventKind, Snapshot};
use crate::tui::app::{App, Flow};
use crate::tui::compare::Compare;
use crate::tui::face::Face;
use crate::tui::print::to_text;
use crate::tui::view::{Pane, View};

/// An app on four episodes of a moving square.
fn with(models: Vec<Arc<dyn Predictor>>, size: (u16, u16)) -> App {
    let session = Session::new(Arc::new(FakeSource::new(4)), models);
    App::new(session, Face::default(), Size::new(size.0, size.1))
}

fn three() -> Vec<Arc<dyn Predictor>> {
    vec![Arc::new(FakePredictor::three())]
}

fn several() -> Vec<Arc<dyn Predictor>> {
    vec![
        Arc::new(FakePredictor::three()),
        Arc::new(FakePredictor::joint()),
        Arc::new(FakePredictor::vision()),
    ]
}

fn play(app: &mut App, script: &str) -> Snapshot {
    for key in parse_script(script).unwrap() {
        settle(app);
        assert_eq!(app.press(&key), Flow::Go);
    }
    settle(app);
    app.session.snapshot()
}

/// What a script comes to with one model.
fn after(script: &str) -> Snapshot {
    play(&mut with(three(), SMALL), script)
}

/// The screen after a script.
fn shown(models: Vec<Arc<dyn Predictor>>, script: &str, size: (u16, u16)) -> String {
    let mut app = with(models, size);
    let snapshot = play(&mut app, script);
    to_text(&screen(&snapshot, &app.face, size), false)
}

fn said(snapshot: &Snapshot) -> &str {
    snapshot.message.as_ref().map_or("", |m| m.text.as_str())
}

fn alphas(snapshot: &Snapshot) -> Vec<f32> {
    snapshot.experts.iter().map(|view| view.alpha).collect()
}

#[test]
fn a_switch_reaches_as_far_as_its_scope() {
    let mut app = with(three(), SMALL);
    let frame = play(&mut app, "lllll ss 1");
    assert_eq!((frame.scope, alphas(&frame)[0]), (Scope::Frame, 0.0));
    assert_eq!(alphas(&play(&mut app, "l"))[0], 1.0);
    let onward = play(&mut app, "ss 2 lll");
    assert_eq!((onward.scope, alphas(&onward)[1]), (Scope::Onward, 0.0));
    assert_eq!(alphas(&play(&mut app, "<home> l"))[1], 1.0);
    assert_eq!(alphas(&play(&mut app, "lllll 0")), [1.0; 4]);
}

#[test]
fn off_and_on_again_is_as_it_was_to_the_bit() {
    let mut app = with(three(), SMALL);
    let before = play(&mut app, "lllllll");
    let after = play(&mut app, "1 2 2 1 9 9 S3 u a2--- u u u");
    assert_eq!(
        (&before.belief, &before.position),
        (&after.belief, &after.position)
    );
    assert_eq!(before.frames.belief, after.frames.belief);
}

#[test]
fn the_last_active_expert_stays_on() {
    let snapshot = after("lll 1 2 3 9");
    assert_eq!(alphas(&snapshot), [0.0, 0.0, 0.0, 1.0]);
    assert!(
        said(&snapshot).contains("last active expert"),
        "{}",
        said(&snapshot)
    );
}

#[test]
fn the_badge_says_what_was_never_trained_and_what_was() {
    let mut app = with(vec![Arc::new(FakePredictor::joint())], SMALL);
    let Badge::Untrained(why) = play(&mut app, "lll 1").badge else {
        panic!("J alone was never trained")
    };
    assert_eq!(why, "J never trained; trained: V+J");
}

#[test]
fn a_key_over_the_help_closes_it_and_does_nothing_else() {
    let mut app = with(three(), SMALL);
    let snapshot = play(&mut app, "lll ? 1");
    assert_eq!((alphas(&snapshot), app.face.help), ([1.0; 4].into(), None));
    assert_eq!(alphas(&play(&mut app, "1")), [0.0, 1.0, 1.0, 1.0]);
}

#[test]
fn a_set_of_the_lattice_is_entered() {
    let mut app = with(three(), LARGE);
    let snapshot = play(
        &mut app,
        "lllllll :view<space>lattice<enter> <down><down> <enter>",
    );
    let lattice = snapshot.lattice.unwrap();
    assert_eq!(lattice.cells.len(), 15);
    let expected: Vec<f32> = lattice.cells[2]
        .active
        .iter()
        .map(|&on| f32::from(u8::from(on)))
        .collect();
    let now: Vec<f32> = snapshot.experts.iter().map(|view| view.alpha).collect();
    assert_eq!((now, lattice.cells[2].current), (expected, true));
    let by_letters = play(&mut app, ":set<space>HD<enter>");
    assert_eq!(alphas(&by_letters), [0.0, 1.0, 0.0, 1.0]);
}

#[test]
fn an_input_is_damaged_and_its_expert_is_not_removed() {
    let mut app = with(three(), SMALL);
    let snapshot = play(&mut app, "lllllll x2 xxx == <esc>");
    let (modality, corruption) = snapshot.corruptions[0];
    assert_eq!(
        (modality, corruption.damage),
        (Modality::Haptic, Damage::Noise)
    );
    assert!((corruption.severity - 0.7).abs() < 1e-6);
    assert_eq!(alphas(&snapshot), [1.0; 4]);
    let screen = to_text(&screen(&play(&mut app, "v"), &app.face, SMALL), false);
    assert!(
        screen.contains("~noise 0.7") || screen.contains("~n"),
        "{screen}"
    );
    let patch = play(&mut app, "x1 xxxx <left><down> <esc>").corruptions[0].1;
    assert_eq!(
        (patch.damage, patch.patch),
        (Damage::Occlude, [0.375, 0.625])
    );
    assert!(play(&mut app, "uuuu uuuu uuuu uuuu").corruptions.is_empty());
}

#[test]
fn the_response_to_damage_is_read() {
    let screen = shown(
        three(),
        "lllllll v x2 xxx <esc> <tab><tab><tab><tab><enter>",
        LARGE,
    );
    assert!(
        screen.contains("response") && screen.contains("does not notice"),
        "{screen}"
    );
}

#[test]
fn a_model_without_a_product_says_so_in_every_view() {
    for keys in ["", "v", "vv", "vvv", "vvvv", "vvvvv"] {
        for size in [SMALL, LARGE] {
            let mut models = several();
            models.drain(..2);
            let screen = shown(models, &format!("llllll{keys}"), size);
            assert!(screen.contains("no product"), "{keys}: {screen}");
        }
    }
}

#[test]
fn the_fusion_is_read_expert_by_expert() {
    let screen = shown(three(), "lllllll v", LARGE);
    for word in [
        "NIS",
        "info nats",
        "without σ",
        "pairs d²",
        "KL nats",
        "Q ",
        "per z",
        "x cm",
        "force",
    ] {
        assert!(screen.contains(word), "{word}: {screen}");
    }
    let numbers = shown(three(), "lllllll v <tab><tab><tab><tab><tab><enter>", LARGE);
    assert!(numbers.contains("latents"), "{numbers}");
}

#[test]
fn pulls_and_ghosts_stand_on_the_table() {
    let screen = shown(three(), "lllllll vvv", LARGE);
    for word in ["pulls", "Σ sum", "(V)", "NEES"] {
        assert!(screen.contains(word), "{word}: {screen}");
    }
}

#[test]
fn a_rollout_is_sure_in_three_ways_and_shows_its_samples() {
    let mut app = with(three(), LARGE);
    let mean = play(&mut app, "lllllll vv");
    let text = to_text(&screen(&mean, &app.face, LARGE), false);
    for word in ["A P Aᵀ+Q", "samples", "head", "seed 0"] {
        assert!(text.contains(word), "{word}: {text}");
    }
    let sample = play(&mut app, "m");
    assert_ne!(sample.frames.prediction, mean.frames.prediction);
    assert_eq!(play(&mut app, "M== <esc>").sampling.count, 128);
    assert_eq!(play(&mut app, ":seed<space>7<enter>").sampling.seed, 7);
}

#[test]
fn consistency_is_told_in_plain_words() {
    let screen = shown(three(), "lllllll vvvv", LARGE);
    for word in [
        "claims 95 %",
        "4/4 episodes",
        "NEES",
        "coverage",
        "fit α",
        "over episodes",
    ] {
        assert!(screen.contains(word), "{word}: {screen}");
    }
}

#[test]
fn two_models_have_one_cursor_and_are_compared() {
    let mut app = with(several(), LARGE);
    let own = play(&mut app, "llllllll 1");
    assert_eq!(own.other.as_ref().map(|other| other.model), Some(1));
    play(&mut app, "d");
    assert_eq!(app.face.compare, Compare::Difference);
    play(&mut app, "w");
    assert!(matches!(app.face.compare, Compare::Wipe(_)));
    play(&mut app, "b");
    assert!(matches!(app.face.compare, Compare::Blink(_)));
    let text = to_text(&screen(&app.session.snapshot(), &app.face, LARGE), false);
    assert!(text.contains("vhp"), "{text}");
    let next = play(&mut app, "b <enter> )");
    assert_eq!((next.model, next.cursor, alphas(&next)[0]), (1, 8, 0.0));
    assert!(app.face.zoomed, "the zoom survives another model");
    let third = play(&mut app, "] :compare<space>3<enter>");
    assert_eq!(third.other.map(|other| other.model), Some(2));
    assert!(app.face.zoomed && third.cursor == 8, "and another episode");
}

#[test]
fn controls_are_edited_and_rolled_out_beside_the_truth() {
    let mut app = with(three(), LARGE);
    let before = play(&mut app, "lllll");
    let after = play(&mut app, "r == <up> m <esc> llll");
    let edit = after.control_edit.unwrap();
    assert_eq!(
        (edit.from, edit.rotate_deg, edit.scale, edit.mirror),
        (5, 30.0, 1.25, true)
    );
    let (was, is) = (before.position.unwrap(), after.position.unwrap());
    assert_ne!(was.prediction, is.prediction);
    assert_eq!(is.recorded_controls, was.prediction);
    assert!(play(&mut app, "r r").control_edit.is_none());
}

#[test]
fn failures_are_gone_to_in_a_choice_of_orders() {
    let mut app = with(three(), SMALL);
    let first = play(&mut app, "n");
    assert!(
        said(&first).starts_with("failure 1/4 by error"),
        "{}",
        said(&first)
    );
    assert_eq!(first.episode_index, first.table.queue[0].episode);
    let second = play(&mut app, "n");
    assert_eq!(second.table.place, Some(1));
    assert_eq!(play(&mut app, "N").table.place, Some(0));
    assert_eq!(play(&mut app, "o").table.order, Order::Distance);
    assert_eq!(
        play(&mut app, ":rank<space>nees<enter>").table.order,
        Order::Nees
    );
}

#[test]
fn the_list_of_episodes_is_sorted_filtered_and_left_by_opening_one() {
    let mut app = with(three(), LARGE);
    play(&mut app, "n E");
    let text = to_text(&screen(&app.session.snapshot(), &app.face, LARGE), false);
    assert!(text.contains("square_03") && text.contains("4/4"), "{text}");
    let sorted = play(&mut app, "4 4");
    assert_eq!(
        (sorted.table.sort, sorted.table.descending),
        (Column::Rmse, true)
    );
    let filtered = play(&mut app, "/_02<enter>");
    assert_eq!(*filtered.table.shown, [2]);
    let opened = play(&mut app, "g <enter>");
    assert_eq!(
        (opened.episode_index, app.face.episodes.is_none()),
        (2, true)
    );
}

#[test]
fn marks_and_contacts_are_gone_to() {
    let mut app = with(three(), SMALL);
    let marked = play(&mut app, "lllll * lll * <home>");
    let marks = marked
        .events
        .iter()
        .filter(|event| event.kind == EventKind::Mark);
    assert_eq!(marks.map(|event| event.step).collect::<Vec<_>>(), [5, 8]);
    assert_eq!(play(&mut app, "<end> {").cursor, 8);
    assert_eq!(play(&mut app, "{").cursor, 5);
    assert_eq!(play(&mut app, "}").cursor, 8);
}

#[test]
fn a_selection_loops() {
    let mut app = with(three(), SMALL);
    let selected = play(&mut app, "lll V llll V L");
    assert_eq!(selected.selection, Some((3, 7)));
    assert_eq!(selected.looping, Looping::Selection);
}

#[test]
fn the_palette_finds_what_is_meant_and_a_number_is_a_step() {
    let mut app = with(three(), SMALL);
    assert_eq!(play(&mut app, ":12<enter>").cursor, 11);
    play(&mut app, "<c-k>consist");
    let chosen = app.face.palette.clone().unwrap();
    assert!(chosen.entries[0].name.contains("consistency"), "{chosen:?}");
    play(&mut app, "<enter>");
    assert_eq!(app.face.view, View::Consistency);
}

#[test]
fn what_was_done_is_undone_and_done_again() {
    let mut app = with(three(), SMALL);
    play(&mut app, "lllll 1 x2x<esc> r=<esc> m");
    let undone = play(&mut app, "uuuu");
    assert_eq!(alphas(&undone), [1.0; 4]);
    assert!(undone.corruptions.is_empty() && undone.control_edit.is_none());
    let again = play(&mut app, "<c-r><c-r><c-r><c-r>");
    assert_eq!(alphas(&again)[0], 0.0);
    assert!(again.sampling.shown && again.control_edit.is_some());
}

#[test]
fn a_state_string_brings_the_bench_back() {
    let mut app = with(several(), SMALL);
    let state = play(
        &mut app,
        "] llllll 1 s2 x3xx<esc> r==<esc> M=<esc> m * V ll V :compare<space>3<enter> o y",
    )
    .state;
    assert_eq!(app.to_copy.as_deref(), Some(state.as_str()));
    let mut fresh = with(several(), SMALL);
    let keys: String = state.chars().map(String::from).collect();
    fresh
        .session
        .apply(crate::session::command::Command::Restore(keys));
    settle(&mut fresh);
    let back = fresh.session.snapshot();
    assert_eq!(back.state, state, "{}", said(&back));
    let there = app.session.snapshot();
    assert_eq!(back.belief, there.belief);
    assert_eq!(back.frames.prediction, there.frames.prediction);
}

#[test]
fn a_pane_is_zoomed_and_left_again() {
    let mut app = with(three(), LARGE);
    play(&mut app, "lll vv <tab> <enter>");
    assert!(app.face.is_zoomed(Pane::Quality));
    play(&mut app, "<esc>");
    assert!(!app.face.zoomed);
}
