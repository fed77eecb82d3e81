//! The loop, driven by events that are there at once, on a screen that only counts.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::*;
use crate::session::Session;
use crate::session::fake::{FakePredictor, FakeSource};
use crate::session::keys::Key;

const SIZE: Size = Size::new(80, 24);

/// Keeps what is written; `then` is called with the number of frames so far when one is complete.
#[derive(Clone)]
struct Sink<F> {
    bytes: Arc<Mutex<Vec<u8>>>,
    then: F,
}

impl<F: FnMut(usize)> Write for Sink<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let count = frames(&self.bytes.lock().unwrap());
        (self.then)(count);
        Ok(())
    }
}

/// Complete frames among the bytes.
fn frames(bytes: &[u8]) -> usize {
    let text = String::from_utf8_lossy(bytes);
    let (begun, ended) = (
        text.matches("\x1b[?2026h").count(),
        text.matches("\x1b[?2026l").count(),
    );
    assert_eq!(
        begun, ended,
        "text outside of a frame, or a frame left open"
    );
    ended
}

fn app() -> App {
    let source = Arc::new(FakeSource::new(3));
    let session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
    let mut app = App::new(session, Face::default(), SIZE);
    assert!(app.session.wait_idle(Duration::from_secs(30)));
    app
}

fn key(name: &str) -> Wake {
    Wake::Input(Input::Key(Key::named(name).unwrap()))
}

#[test]
fn five_hundred_held_keys_are_two_or_three_drawings() {
    let mut app = app();
    let (sender, events) = sync_channel(1024);
    for _ in 0..500 {
        sender.send(key("right")).unwrap();
    }
    let bytes = Arc::default();
    let sink = Sink {
        bytes: Arc::clone(&bytes),
        // The first frame is drawn before any key is read, then come what can wait at once and the rest of it.
        then: move |count| {
            if count == 3 {
                sender.send(Wake::Signal(SIGTERM)).unwrap();
            }
        },
    };
    let mut screen = Screen::fixed(sink, SIZE).unwrap();
    let ended = drive(&mut app, &mut screen, &events, |_, _| Ok(false));
    assert_eq!(ended.unwrap(), Some(Ended::Signal(SIGTERM)));
    assert_eq!(app.session.snapshot().cursor, 15);
    assert!(frames(&bytes.lock().unwrap()) <= 4);
}

#[test]
fn nothing_to_do_draws_nothing() {
    let mut app = app();
    // Handed over one by one, so that the loop goes round for each.
    let (sender, events) = sync_channel(0);
    let bytes = Arc::default();
    let sink = Sink {
        bytes: Arc::clone(&bytes),
        then: |_| {},
    };
    let wakes = thread::spawn(move || {
        // Wakes with nothing behind them, as a full queue may leave, and answers that change nothing.
        for _ in 0..100 {
            sender.send(Wake::Done).unwrap();
            let answer = Answer::Attributes { sixel: false };
            sender.send(Wake::Input(Input::Answer(answer))).unwrap();
        }
        sender.send(Wake::Signal(SIGTERM)).unwrap();
    });
    let mut screen = Screen::fixed(sink, SIZE).unwrap();
    drive(&mut app, &mut screen, &events, |_, _| Ok(false)).unwrap();
    wakes.join().unwrap();
    assert_eq!(frames(&bytes.lock().unwrap()), 1);
}

#[test]
fn images_come_before_the_text_that_places_them_and_only_once() {
    let mut app = app();
    let host = Host::default();
    let graphics = host.forced(ProtocolType::Kitty).unwrap();
    app.face.pixels = Some(Pixels::start(graphics, || {}).unwrap());
    let bytes: Arc<Mutex<Vec<u8>>> = Arc::default();
    let sink = Sink {
        bytes: Arc::clone(&bytes),
        then: |_| {},
    };
    let mut screen = Screen::fixed(sink, SIZE).unwrap();
    let mut after = |app: &mut App, name: &str| {
        app.press(&Key::named(name).unwrap());
        assert!(app.session.wait_idle(Duration::from_secs(30)));
        bytes.lock().unwrap().clear();
        // However slow the machine: a drawing that was not given the image in time draws again.
        for _ in 0..100 {
            screen.show(app).unwrap();
            thread::sleep(Duration::from_millis(1));
            if !app.face.pixels.as_mut().unwrap().receive() {
                break;
            }
        }
        String::from_utf8(bytes.lock().unwrap().clone()).unwrap()
    };
    after(&mut app, "right");
    let first = after(&mut app, "right");
    let sent = first.matches("a=T,").count();
    assert!((1..=4).contains(&sent), "{sent} images");
    let (image, place) = (first.find("a=T,"), first.find('\u{10EEEE}'));
    assert!(first.find("\x1b[?2026h") < image && image < place);
    after(&mut app, "left");
    let again = after(&mut app, "right");
    assert_eq!(again.matches("a=T,").count(), 0);
    assert!(again.contains('\u{10EEEE}'));
    assert_eq!(frames(again.as_bytes()), 1);
}

#[test]
fn keys_typed_before_the_terminal_has_answered_are_kept() {
    let (sender, events) = sync_channel(64);
    let typed: &[u8] = b"ll\x1b_Gi=31;OK\x1b\\l\x1b[?62c";
    let error = pass_on(typed, &sender);
    assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
    drop(sender);
    let keys = events
        .iter()
        .filter(|wake| matches!(wake, Wake::Input(Input::Key(_))));
    assert_eq!(keys.count(), 3);
}

#[test]
fn ctrl_z_leaves_the_loop_with_what_came_after_it_still_to_be_read() {
    let mut app = app();
    let (sender, events) = sync_channel(8);
    sender.send(key("right")).unwrap();
    sender.send(Wake::Suspend).unwrap();
    sender.send(key("right")).unwrap();
    sender.send(Wake::Signal(SIGTERM)).unwrap();
    let mut screen = Screen::fixed(Vec::new(), SIZE).unwrap();
    let mut go_on = || drive(&mut app, &mut screen, &events, |_, _| Ok(false)).unwrap();
    assert_eq!(go_on(), None);
    assert_eq!(go_on(), Some(Ended::Signal(SIGTERM)));
    assert_eq!(app.session.snapshot().cursor, 2);
}
