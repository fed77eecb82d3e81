//! Whole screens after scripts of keys, as text with a hash of each row's styles.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::sync::Arc;
use std::time::Duration;

use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Size};
use ratatui::style::Color;

use super::app::{App, Flow, Pointer};
use super::compare::Compare;
use super::face::Face;
use super::fixture;
use super::print::to_text;
use super::theme::Depth;
use super::view::{Pane, View};
use crate::session::Session;
use crate::session::fake::{FakePredictor, FakeSource};
use crate::session::keymap::bindings;
use crate::session::keys::{Key, parse_script};
use crate::session::snapshot::{Badge, Message, Snapshot};

mod bench;
mod rollout;
mod scripts;

const SMALL: (u16, u16) = (80, 24);
const LARGE: (u16, u16) = (120, 40);

fn screen(snapshot: &Snapshot, face: &Face, (columns, rows): (u16, u16)) -> Buffer {
    let Ok(mut terminal) = Terminal::new(TestBackend::new(columns, rows));
    let Ok(_) = terminal.draw(|frame| super::draw(frame, snapshot, face));
    terminal.backend().buffer().clone()
}

/// The text, then eight hashes a line of what the rows look like besides it.
fn described(buf: &Buffer) -> String {
    let mut out = to_text(buf, false);
    for row in 0..buf.area.height {
        let mut styles = String::new();
        for column in 0..buf.area.width {
            let cell = &buf[(column, row)];
            write!(styles, "{}/{}/{:?};", cell.fg, cell.bg, cell.modifier).unwrap();
        }
        let end = if row % 8 == 7 { '\n' } else { ' ' };
        write!(out, "{:08x}{end}", crc32fast::hash(styles.as_bytes())).unwrap();
    }
    out
}

fn app(size: (u16, u16)) -> App {
    let source = Arc::new(FakeSource::new(3));
    let session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
    App::new(session, Face::default(), Size::new(size.0, size.1))
}

fn settle(app: &mut App) {
    assert!(app.session.wait_idle(Duration::from_secs(30)));
}

/// The app after a script of keys, everything computed.
fn pressed(script: &str, size: (u16, u16)) -> App {
    let mut app = app(size);
    for key in parse_script(script).unwrap() {
        settle(&mut app);
        assert_eq!(app.press(&key), Flow::Go);
    }
    settle(&mut app);
    app
}

fn keys(script: &str, size: (u16, u16)) -> String {
    let app = pressed(script, size);
    described(&screen(&app.session.snapshot(), &app.face, size))
}

macro_rules! keys_snapshot {
    ($name:ident, $script:literal) => {
        #[test]
        fn $name() {
            for size in [SMALL, LARGE] {
                let name = format!("{}_{}x{}", stringify!($name), size.0, size.1);
                insta::assert_snapshot!(name, keys($script, size));
            }
        }
    };
}

keys_snapshot!(at_first, "");
keys_snapshot!(predicting, "llll llll");
keys_snapshot!(an_expert_off, "llllllll 1");
keys_snapshot!(tempering, "lllllll a2---");
keys_snapshot!(a_line_being_typed, "l:ep");
keys_snapshot!(a_command_being_chosen, "l:corrupt<down>");
keys_snapshot!(an_input_being_damaged, "llll x");
keys_snapshot!(frames_alone, "lllllll <enter>");
keys_snapshot!(experts_alone, "lllllll <tab><enter>");
keys_snapshot!(position_alone, "lllllll <s-tab><s-tab><enter>");
keys_snapshot!(the_keys, "?");

#[test]
fn overview() {
    let snapshot = fixture::snapshot(8, 16);
    for size in [SMALL, LARGE, (200, 60)] {
        let name = format!("overview_{}x{}", size.0, size.1);
        let shown = screen(&snapshot, &Face::default(), size);
        insta::assert_snapshot!(name, described(&shown));
    }
}

#[test]
fn a_long_episode_has_a_column_for_each_step() {
    let shown = screen(&fixture::snapshot(20, 48), &Face::default(), SMALL);
    insta::assert_snapshot!(described(&shown));
}

#[test]
fn untrained_switches_and_errors_are_said() {
    let mut snapshot = fixture::snapshot(8, 16);
    snapshot.badge = Badge::Untrained("α 0.5 was never trained".to_owned());
    let shown = to_text(&screen(&snapshot, &Face::default(), SMALL), false);
    assert!(shown.contains("! untrained switches: α 0.5 was never trained"));
    snapshot.message = Some(Message {
        error: true,
        text: "there is no step 99".to_owned(),
    });
    let shown = to_text(&screen(&snapshot, &Face::default(), SMALL), false);
    assert!(shown.contains("! there is no step 99"));
}

#[test]
fn without_colour_no_cell_has_one() {
    let face = Face {
        depth: Depth::Plain,
        ..Face::default()
    };
    let shown = screen(&fixture::snapshot(8, 16), &face, SMALL);
    let is_plain = |color: Color| color == Color::Reset;
    assert!(
        shown
            .content
            .iter()
            .all(|cell| is_plain(cell.fg) && is_plain(cell.bg))
    );
    insta::assert_snapshot!(to_text(&shown, false));
}

#[test]
fn sixteen_colours_say_nothing_that_fills_do_not() {
    let shown = [Depth::Plain, Depth::Sixteen].map(|depth| {
        let face = Face {
            depth,
            ..Face::default()
        };
        screen(&fixture::snapshot(8, 16), &face, SMALL)
    });
    assert_eq!(to_text(&shown[0], false), to_text(&shown[1], false));
    let is_named = |color: Color| !matches!(color, Color::Rgb(..) | Color::Indexed(_));
    let cells = &shown[1].content;
    assert!(
        cells
            .iter()
            .all(|cell| is_named(cell.fg) && cell.bg == Color::Reset)
    );
    assert!(cells.iter().any(|cell| cell.fg == Color::Blue));
}

#[test]
fn a_terminal_too_small_says_so() {
    let shown = screen(&fixture::snapshot(8, 16), &Face::default(), (39, 24));
    assert!(to_text(&shown, false).starts_with("poescope needs 40x12\n"));
}

#[test]
fn the_mouse_seeks_and_switches() {
    let mut app = pressed("", SMALL);
    let face = Face::default();
    let layout = super::layout(
        ratatui::layout::Rect::new(0, 0, SMALL.0, SMALL.1),
        &app.session.snapshot(),
        &face,
    );
    let (timeline, experts) = (layout.get(Pane::Timeline), layout.get(Pane::Experts));
    app.point(
        Pointer::Press,
        Position::new(timeline.x + 7 + 10, timeline.y + 2),
    );
    assert_eq!(app.session.snapshot().cursor, 5);
    app.point(Pointer::Drag, Position::new(79, 0));
    assert_eq!(app.session.snapshot().cursor, 15);
    app.point(Pointer::Release, Position::new(79, 0));
    app.point(Pointer::Drag, Position::new(0, 0));
    app.point(Pointer::Wheel(-1), Position::new(0, 0));
    assert_eq!(app.session.snapshot().cursor, 14);
    app.point(Pointer::Press, Position::new(experts.x + 4, experts.y + 2));
    settle(&mut app);
    let alphas: Vec<f32> = app
        .session
        .snapshot()
        .experts
        .iter()
        .map(|view| view.alpha)
        .collect();
    assert_eq!(alphas, [1.0, 0.0, 1.0, 1.0]);
    assert_eq!((app.face.focus, app.face.expert), (Pane::Experts, 1));
}

#[test]
fn a_dragged_border_moves_and_a_title_is_no_step() {
    let mut app = pressed("lll", SMALL);
    let rect = ratatui::layout::Rect::new(0, 0, SMALL.0, SMALL.1);
    let layout = |app: &App| super::layout(rect, &app.session.snapshot(), &app.face);
    let (timeline, experts) = (
        layout(&app).get(Pane::Timeline),
        layout(&app).get(Pane::Experts),
    );
    app.point(Pointer::Press, Position::new(experts.x + 3, experts.y));
    app.point(Pointer::Drag, Position::new(experts.x + 9, experts.y - 3));
    app.point(
        Pointer::Release,
        Position::new(experts.x + 9, experts.y - 3),
    );
    app.point(Pointer::Drag, Position::new(0, 0));
    assert_eq!(layout(&app).get(Pane::Experts).y, experts.y - 3);
    assert_eq!(layout(&app).get(Pane::Timeline), timeline);
    app.point(Pointer::Press, Position::new(timeline.x + 20, timeline.y));
    assert_eq!(app.session.snapshot().cursor, 3);
    app.point(Pointer::Release, Position::new(0, 0));
    app.press(&Key::of_char('v'));
    app.press(&Key::of_spelling("<enter>").unwrap());
    screen(&app.session.snapshot(), &app.face, SMALL);
    let switched = app.session.snapshot().state.contains("alpha");
    assert!(!switched, "a title is no switch");
}

#[test]
fn the_state_string_goes_to_the_clipboard() {
    let mut app = pressed("lll y", SMALL);
    let state = app.to_copy.take().unwrap();
    assert_eq!(state, app.session.snapshot().state);
    let shown = to_text(&screen(&app.session.snapshot(), &app.face, SMALL), false);
    // However long it is, it can be read: a terminal may not have taken it.
    let lines: String = shown.lines().map(str::trim).collect();
    assert!(
        lines.ends_with(&format!("sent to the clipboard: {state}")),
        "{shown}"
    );
}

#[test]
fn a_sample_is_not_called_the_prediction() {
    let rows = |script: &str| {
        let app = pressed(script, LARGE);
        let shown = to_text(&screen(&app.session.snapshot(), &app.face, LARGE), false);
        let named = |name: &str| {
            shown
                .lines()
                .filter(|line| line.trim_start().starts_with(name))
                .count()
        };
        (named("pred "), named("sample "))
    };
    assert_eq!(rows("lllllll"), (1, 0));
    assert_eq!(rows("lllllll m"), (0, 1));
    // Nor is its error anywhere.
    for size in [SMALL, LARGE] {
        let app = pressed("lllllll m", size);
        let shown = to_text(&screen(&app.session.snapshot(), &app.face, size), false);
        let mut words = shown.split_whitespace();
        assert!(
            !words.any(|word| matches!(word, "pred" | "prediction")),
            "{shown}"
        );
    }
}

#[test]
fn views_come_round() {
    let mut app = pressed("", SMALL);
    app.press(&Key::of_char('v'));
    for view in [
        View::Fuse,
        View::Predict,
        View::Position,
        View::Consistency,
        View::Lattice,
        View::Overview,
    ] {
        assert_eq!(app.face.view, view);
        assert_eq!(app.face.focus, view.panes()[0]);
        let shown = to_text(&screen(&app.session.snapshot(), &app.face, SMALL), false);
        assert!(shown.trim_start().starts_with(view.name()), "{shown}");
        app.press(&Key::of_spelling("<enter>").unwrap());
        assert!(app.face.zoomed);
        app.press(&Key::of_char('v'));
        assert!(!app.face.zoomed);
    }
}

#[test]
fn nothing_panics_at_any_size() {
    let mut snapshots = vec![
        fixture::snapshot(8, 16),
        fixture::snapshot(0, 48),
        fixture::snapshot(3, 300),
    ];
    let mut bare = fixture::snapshot(0, 16);
    bare.episode = None;
    bare.position = None;
    bare.experts.clear();
    snapshots.push(bare);
    snapshots.extend(
        bench::pictures()
            .into_iter()
            .map(|(_, (snapshot, _))| snapshot),
    );
    let mut face = Face::default();
    for (i, snapshot) in snapshots.iter().enumerate() {
        let widths = (1..=200_u16).step_by(9);
        for (width, height) in widths.flat_map(|w| (1..=60_u16).step_by(4).map(move |h| (w, h))) {
            face.open(View::ALL[usize::from(width / 9 + height / 4) % View::ALL.len()]);
            let panes = face.view.panes();
            face.focus = panes[usize::from(width + height) % panes.len()];
            face.zoomed = (width + i as u16).is_multiple_of(3);
            face.lattice_cell = usize::from(height);
            face.compare = match height % 5 {
                0 => Compare::Difference,
                1 => Compare::Blink(width % 2 == 0),
                2 => Compare::Wipe(f32::from(width) / 200.0),
                _ => Compare::Off,
            };
            face.help = (width % 5 == 0).then_some(usize::from(height % 3));
            face.depth = [Depth::Plain, Depth::Indexed, Depth::Sixteen][usize::from(height % 3)];
            screen(snapshot, &face, (width, height));
        }
    }
}

#[test]
fn random_keys_never_panic() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let names: Vec<&str> = bindings()
        .iter()
        .flat_map(|binding| binding.keys)
        .copied()
        .collect();
    let mut app = app(SMALL);
    for i in 0..400 {
        let size = (rng.random_range(1..=200), rng.random_range(1..=60));
        app.resize(Size::new(size.0, size.1));
        let key = Key::of_spelling(names[rng.random_range(0..names.len())]).unwrap();
        app.press(&key);
        let at = Position::new(rng.random_range(0..size.0), rng.random_range(0..size.1));
        app.point(Pointer::Press, at);
        if i % 20 == 0 {
            settle(&mut app);
        }
        screen(&app.session.snapshot(), &app.face, size);
    }
}

#[test]
fn what_was_odd_is_said_and_marked_on_the_timeline() {
    let mut snapshot = fixture::snapshot(6, 16);
    let mut episode = (**snapshot.episode.as_ref().unwrap()).clone();
    episode.flags = vec![
        "/wrench at 1.20 s: gap of 0.9 s".to_owned(),
        "/wrench at 2.00 s: other".to_owned(),
    ];
    episode.flagged_steps = vec![5, 7];
    snapshot.episode = Some(Arc::new(episode));
    snapshot.badge = Badge::Trained;
    snapshot.message = None;
    let text = to_text(&screen(&snapshot, &Face::default(), SMALL), false);
    assert!(
        text.contains("recording (1 of 2): /wrench at 1.20 s: gap of 0.9 s"),
        "{text}"
    );
    assert_eq!(
        text.lines()
            .filter(|line| line.matches('!').count() == 2)
            .count(),
        1,
        "{text}"
    );
}
