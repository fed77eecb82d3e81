//! The views of the rollout, the table and the split, and the list of episodes, on a made-up moment.

use super::*;
use crate::measure::corruption::{Corruption, Damage};
use crate::modality::Modality;
use crate::session::settings::ControlEdit;
use crate::tui::episodes::list::List;

fn face(view: View) -> Face {
    let mut face = Face::default();
    face.open(view);
    face
}

fn shown(name: &str, snapshot: &Snapshot, face: &Face) {
    for size in [SMALL, LARGE] {
        let name = format!("{name}_{}x{}", size.0, size.1);
        insta::assert_snapshot!(name, described(&screen(snapshot, face, size)));
    }
}

/// Two models, edited controls, samples, damaged input and a selection.
fn everything(cursor: usize, steps: usize) -> Snapshot {
    let mut snapshot = fixture::snapshot(cursor, steps);
    fixture::compare(&mut snapshot);
    snapshot.sampling.shown = true;
    snapshot.control_edit = Some(ControlEdit {
        from: 5,
        rotate_deg: 30.0,
        scale: 0.5,
        mirror: true,
    });
    let position = snapshot.position.as_mut().unwrap();
    position.recorded_controls = Arc::clone(&position.prediction);
    snapshot.selection = Some((5, 9));
    let damage = Corruption {
        damage: Damage::Hold,
        severity: 1.0,
        from: 6,
        until: Some(12),
        patch: [0.5; 2],
        seed: 0,
    };
    snapshot.corruptions = vec![(Modality::Haptic, damage)];
    snapshot
}

#[test]
fn predict() {
    shown("predict", &fixture::snapshot(8, 16), &face(View::Predict));
}

#[test]
fn predict_two_models_under_edited_controls() {
    shown("predict_two", &everything(8, 16), &face(View::Predict));
}

#[test]
fn position() {
    shown("position", &fixture::snapshot(8, 16), &face(View::Position));
}

#[test]
fn position_with_everything_on_it() {
    let snapshot = everything(8, 16);
    shown("position_all", &snapshot, &face(View::Position));
    let text = to_text(&screen(&snapshot, &face(View::Position), LARGE), false);
    for said in [
        "recorded controls",
        "of 32 samples",
        "pulls ×",
        "turned 30°",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
}

#[test]
fn consistency() {
    let snapshot = fixture::snapshot(8, 16);
    shown("consistency", &snapshot, &face(View::Consistency));
}

#[test]
fn a_board_that_cannot_be_says_why() {
    let mut snapshot = fixture::snapshot(8, 16);
    let mut board = (**snapshot.board.as_ref().unwrap()).clone();
    board.why_not = Some("these recordings have no object poses".to_owned());
    snapshot.board = Some(Arc::new(board));
    let text = to_text(&screen(&snapshot, &face(View::Consistency), SMALL), false);
    assert!(text.contains("these recordings have no object poses") && !text.contains("NEES"));
    snapshot.board = None;
    let text = to_text(&screen(&snapshot, &face(View::Consistency), SMALL), false);
    assert!(text.contains("not measured yet"));
}

#[test]
fn without_a_product_or_a_probe_the_table_says_so() {
    let mut snapshot = fixture::snapshot(8, 16);
    snapshot.fusion = None;
    let text = to_text(&screen(&snapshot, &face(View::Position), SMALL), false);
    assert!(text.contains("no product of experts"), "{text}");
    snapshot.position = None;
    let text = to_text(&screen(&snapshot, &face(View::Position), SMALL), false);
    assert!(text.contains("no probe or no belief yet"), "{text}");
}

#[test]
fn episodes() {
    let snapshot = fixture::snapshot(8, 16);
    let face = Face {
        episodes: Some(List::open(&snapshot)),
        ..Face::default()
    };
    shown("episodes", &snapshot, &face);
}

#[test]
fn the_list_opens_the_selected_episode() {
    let mut app = pressed("", SMALL);
    app.toggle_episodes();
    let keys = |app: &mut App, script: &str| {
        for key in parse_script(script).unwrap() {
            assert_eq!(app.press(&key), Flow::Go);
            settle(app);
        }
    };
    keys(&mut app, "?");
    assert!(app.face.help.is_some() && app.face.episodes.is_some());
    keys(&mut app, "<esc><esc>");
    assert_eq!((app.face.help, app.face.episodes.clone()), (None, None));
    let before = app.session.snapshot();
    app.face.episodes = Some(List {
        selected: before.table.shown.get(1).copied().unwrap_or(0),
        is_typing: false,
    });
    keys(&mut app, "<enter>");
    assert_eq!(
        app.session.snapshot().episode_index,
        before.table.shown.get(1).copied().unwrap_or(0)
    );
    assert_eq!(app.face.episodes.is_none(), !before.table.shown.is_empty());
}

#[test]
fn nothing_panics_at_any_size_with_everything_on_it() {
    let mut bare = everything(3, 16);
    bare.spread = Some(Arc::default());
    bare.board = Some(Arc::default());
    bare.table = Arc::default();
    bare.strip = Arc::default();
    let snapshots = [
        everything(8, 16),
        everything(40, 48),
        everything(0, 300),
        bare,
    ];
    let widths = (40..=200_u16).step_by(11);
    let sizes: Vec<(u16, u16)> = widths
        .flat_map(|width| (12..=60_u16).step_by(3).map(move |height| (width, height)))
        .collect();
    for (i, snapshot) in snapshots.iter().enumerate() {
        for (n, &size) in sizes.iter().enumerate() {
            let mut face = face(View::ALL[(n + i) % View::ALL.len()]);
            face.zoomed = n % 5 == 0;
            let panes = face.view.panes();
            face.focus = panes[n % panes.len()];
            face.depth = if n % 3 == 0 {
                Depth::Plain
            } else {
                Depth::True
            };
            face.episodes = (n % 7 == 0).then(List::default);
            screen(snapshot, &face, size);
        }
    }
}

#[test]
fn without_colour_the_views_have_none() {
    let snapshot = everything(8, 16);
    for view in View::ALL {
        let face = Face {
            depth: Depth::Plain,
            ..face(view)
        };
        let shown = screen(&snapshot, &face, LARGE);
        let coloured =
            |cell: &ratatui::buffer::Cell| cell.fg != Color::Reset || cell.bg != Color::Reset;
        assert!(!shown.content.iter().any(coloured), "{}", view.name());
    }
}
