//! The fuse and lattice views, and two images in one place, on a made-up moment.

use std::sync::Arc;
use std::time::Duration;

use ratatui::layout::Position;
use ratatui::style::Color;

use super::{LARGE, SMALL, app, described, pressed, screen};
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::Modality;
use crate::session::keys::Key;
use crate::session::snapshot::reading::ExpertReading;
use crate::session::snapshot::{Badge, Snapshot};
use crate::tui::app::{App, Flow, Pointer};
use crate::tui::compare::Compare;
use crate::tui::face::Face;
use crate::tui::fixture;
use crate::tui::print::to_text;
use crate::tui::theme::Depth;
use crate::tui::view::{Pane, View};

/// A moment in a view, with one thing changed.
fn moment(
    view: View,
    zoom: Option<Pane>,
    change: impl Fn(&mut Snapshot, &mut Face),
) -> (Snapshot, Face) {
    let mut snapshot = fixture::snapshot(8, 16);
    let mut face = Face::default();
    face.open(view);
    if let Some(pane) = zoom {
        (face.focus, face.zoomed) = (pane, true);
    }
    change(&mut snapshot, &mut face);
    (snapshot, face)
}

/// Every picture of the bench, by name.
pub fn pictures() -> Vec<(&'static str, (Snapshot, Face))> {
    let same = |_: &mut Snapshot, _: &mut Face| {};
    let damaged = |damage, severity| Corruption {
        damage,
        severity,
        from: 0,
        until: None,
        patch: [0.5; 2],
        seed: 0,
    };
    let fuse = View::Fuse;
    vec![
        ("fuse", moment(fuse, None, same)),
        (
            "fuse_removed_and_damaged",
            moment(fuse, None, |snapshot, _| {
                snapshot.experts[1].alpha = 0.0;
                snapshot.experts[1].share_mean = 0.0;
                snapshot.experts[1].share_position = Some(0.0);
                let fusion = Arc::make_mut(snapshot.fusion.as_mut().unwrap());
                fusion.experts[1] = ExpertReading::default();
                fusion
                    .disagreements
                    .retain(|pair| pair.a != 1 && pair.b != 1);
                snapshot.corruptions = vec![(Modality::Proprio, damaged(Damage::Noise, 0.5))];
                snapshot.responses = fixture::bench::responses();
            }),
        ),
        (
            "fuse_without_a_product",
            moment(fuse, None, |snapshot, _| {
                let mut model = (*snapshot.models[0]).clone();
                "v".clone_into(&mut model.name);
                model.experts.truncate(1);
                snapshot.models = vec![Arc::new(model)];
                snapshot.experts.truncate(1);
                snapshot.badge = Badge::NoProduct;
                (snapshot.fusion, snapshot.series) = (None, None);
            }),
        ),
        ("fuse_experts", moment(fuse, Some(Pane::Experts), same)),
        ("fuse_pairs", moment(fuse, Some(Pane::Pairs), same)),
        ("fuse_dims", moment(fuse, Some(Pane::Dims), same)),
        (
            "fuse_divergence",
            moment(fuse, Some(Pane::Divergence), same),
        ),
        ("fuse_series", moment(fuse, Some(Pane::Series), same)),
        ("fuse_latents", moment(fuse, Some(Pane::Latents), same)),
        (
            "lattice",
            moment(View::Lattice, None, |_, face| face.lattice_cell = 6),
        ),
        (
            "frames_of_two_models",
            moment(View::Overview, None, |snapshot, _| {
                fixture::compare(snapshot);
            }),
        ),
        (
            "frames_wiped",
            moment(View::Overview, Some(Pane::Frames), |_, face| {
                face.compare = Compare::Wipe(0.5);
            }),
        ),
        (
            "frames_of_a_damaged_input",
            moment(View::Overview, None, |snapshot, _| {
                snapshot.corruptions = vec![(Modality::Vision, damaged(Damage::Occlude, 0.5))];
                snapshot.frames.input = snapshot.frames.truth.clone();
                snapshot.sampling.shown = true;
            }),
        ),
    ]
}

#[test]
fn the_bench() {
    for (name, (snapshot, face)) in pictures() {
        for size in [SMALL, LARGE] {
            let name = format!("{name}_{}x{}", size.0, size.1);
            insta::assert_snapshot!(name, described(&screen(&snapshot, &face, size)));
        }
    }
}

#[test]
fn without_colour_nothing_has_one_and_removed_and_damaged_differ() {
    for (name, (snapshot, mut face)) in pictures() {
        face.depth = Depth::Plain;
        let shown = screen(&snapshot, &face, SMALL);
        let plain = |color: Color| color == Color::Reset;
        assert!(
            shown
                .content
                .iter()
                .all(|cell| plain(cell.fg) && plain(cell.bg)),
            "{name}"
        );
        if name == "fuse_removed_and_damaged" {
            let text = to_text(&shown, false);
            assert!(text.contains("haptic  ○ off") && text.contains("~noise 0.5"));
            insta::assert_snapshot!("fuse_without_colour", text);
        }
    }
}

#[test]
fn up_and_down_choose_a_set_and_enter_switches_to_it() {
    let (snapshot, face) = moment(View::Lattice, None, |_, _| {});
    let mut app = app(SMALL);
    app.face = face;
    let press = |app: &mut App, key: &str| {
        let key = Key::of_spelling(key).unwrap();
        assert_eq!(app.press_on(&key, &snapshot), Flow::Go);
    };
    press(&mut app, "<up>");
    assert_eq!(app.face.lattice_cell, 14);
    press(&mut app, "<down>");
    press(&mut app, "<down>");
    assert_eq!(app.face.lattice_cell, 1);
    press(&mut app, "<enter>");
    assert!(!app.face.zoomed);
}

#[test]
fn blinking_wakes_and_changes_over_twice_a_second() {
    let mut app = pressed("", SMALL);
    // Takes in what was computed.
    app.tick(Duration::ZERO);
    assert_eq!(app.next_wake(), None);
    app.face.compare = Compare::Blink(false);
    assert!(!app.tick(Duration::from_millis(400)));
    assert_eq!(app.next_wake(), Some(Duration::from_millis(100)));
    assert!(app.tick(Duration::from_millis(100)));
    assert_eq!(app.face.compare, Compare::Blink(true));
}

#[test]
fn dragging_moves_the_border_of_a_wipe() {
    let mut app = pressed("lllllll <enter>", SMALL);
    app.face.compare = Compare::Wipe(0.5);
    // Truth on the left, the compared picture on the right: its last columns.
    app.point(Pointer::Press, Position::new(75, 10));
    app.point(Pointer::Drag, Position::new(70, 10));
    let Compare::Wipe(border) = app.face.compare else {
        panic!("{:?}", app.face.compare)
    };
    assert!((0.6..1.0).contains(&border), "{border}");
}
