//! The terminal itself: taken over and given back, read on a thread of its own, drawn on only when something changed.
//!
//! ```text
//! input thread ──┐
//! signal thread ─┼─► bounded channel ─► loop: drain all, let the session take in what is done, draw once
//! session, images┘
//! ```
//! With nothing to play or compute the loop sleeps on the channel.

mod guard;

use std::io::{self, BufWriter, Stdout, Write, stdout};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Instant;

use crossterm::clipboard::CopyToClipboard;
use crossterm::event::{
    Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, MouseButton, MouseEvent, MouseEventKind,
};
use crossterm::queue;
use crossterm::terminal::{BeginSynchronizedUpdate, EndSynchronizedUpdate};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::layout::{Position, Size};
use ratatui_image::picker::ProtocolType;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use super::app::{App, Flow, Pointer};
use super::draw;
use super::pixels::{Pixels, ask_terminal, forced};
use super::theme::Depth;
use crate::session::keys::Key;
use guard::Guard;

/// Events that may wait; held keys beyond it are dropped by the terminal's own buffer.
const QUEUE: usize = 256;
/// Bytes of a full screen of coloured half-blocks, so that a frame is one write.
const FRAME_BYTES: usize = 1 << 18;

/// How images are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Images {
    /// As the terminal answers, else half-blocks.
    #[default]
    Ask,
    /// Half-blocks.
    HalfBlocks,
    /// This protocol, whatever the terminal says.
    Force(ProtocolType),
}

/// Why the face ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The user quit.
    Quit,
    /// The process was sent this signal.
    Signal(i32),
}

/// What wakes the loop.
enum Wake {
    Terminal(Event),
    Signal(i32),
    /// Something was computed or encoded.
    Done,
    /// The terminal is gone.
    Closed(io::Error),
}

/// Runs the face until the user quits or a signal comes. The terminal is given back in every case.
pub fn run(app: &mut App, images: Images) -> io::Result<Ended> {
    // Before the terminal is taken over: a signal must never find it taken and nobody listening.
    let mut signals = Signals::new([SIGTERM, SIGHUP, SIGINT])?;
    let guard = Guard::enter()?;
    // The answer comes on the terminal's input, so it is asked for before anything else reads there.
    let picker = match images {
        _ if app.face.depth == Depth::Plain => None,
        Images::Ask => ask_terminal(),
        Images::HalfBlocks => None,
        Images::Force(protocol) => Some(forced(protocol)),
    };
    let (sender, events) = sync_channel(QUEUE);
    if let Some(picker) = picker {
        app.face.pixels = Some(Pixels::start(picker, waker(sender.clone()))?);
    }
    app.session.set_waker(Box::new(waker(sender.clone())));
    let handle = signals.handle();
    let to_loop = sender.clone();
    thread::Builder::new()
        .name("poescope-signals".to_owned())
        .spawn(move || {
            for signal in signals.forever() {
                if to_loop.send(Wake::Signal(signal)).is_err() {
                    return;
                }
            }
        })?;
    thread::Builder::new()
        .name("poescope-input".to_owned())
        .spawn(move || read_input(&sender))?;

    let ended = drive(app, &events);
    handle.close();
    app.face.pixels = None;
    drop(guard);
    ended
}

/// A full queue needs no further wake: the loop is about to run anyway.
fn waker(sender: SyncSender<Wake>) -> impl Fn() + Send + 'static {
    move || {
        let _ = sender.try_send(Wake::Done);
    }
}

fn read_input(sender: &SyncSender<Wake>) {
    loop {
        let (wake, last) = match crossterm::event::read() {
            Ok(event) => (Wake::Terminal(event), false),
            Err(error) => (Wake::Closed(error), true),
        };
        if sender.send(wake).is_err() || last {
            return;
        }
    }
}

fn drive(app: &mut App, events: &Receiver<Wake>) -> io::Result<Ended> {
    let out = BufWriter::with_capacity(FRAME_BYTES, stdout());
    let mut terminal = Terminal::new(CrosstermBackend::new(out))?;
    app.resize(terminal.size()?);
    let mut changed = true;
    let mut before = Instant::now();
    loop {
        let now = Instant::now();
        changed |= app.tick(now - before);
        before = now;
        if let Some(pixels) = &mut app.face.pixels {
            changed |= pixels.receive();
        }
        if std::mem::take(&mut changed) {
            show(&mut terminal, app)?;
        }
        let first = match app.next_wake() {
            Some(soon) => match events.recv_timeout(soon) {
                Ok(wake) => Some(wake),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Ok(Ended::Quit),
            },
            None => match events.recv() {
                Ok(wake) => Some(wake),
                Err(_) => return Ok(Ended::Quit),
            },
        };
        // Everything that has come is taken in before the next drawing, so a held key leaves nothing behind.
        for wake in first.into_iter().chain(events.try_iter()) {
            match wake {
                Wake::Terminal(event) => {
                    changed = true;
                    if take(app, &event) == Flow::Quit {
                        return Ok(Ended::Quit);
                    }
                }
                Wake::Signal(signal) => return Ok(Ended::Signal(signal)),
                Wake::Closed(error) => return Err(error),
                Wake::Done => {}
            }
        }
    }
}

fn show(
    terminal: &mut Terminal<CrosstermBackend<BufWriter<Stdout>>>,
    app: &mut App,
) -> io::Result<()> {
    let snapshot = app.session.snapshot();
    queue!(terminal.backend_mut(), BeginSynchronizedUpdate)?;
    terminal.draw(|frame| draw(frame, &snapshot, &app.face))?;
    queue!(terminal.backend_mut(), EndSynchronizedUpdate)?;
    if let Some(state) = app.to_copy.take() {
        queue!(
            terminal.backend_mut(),
            CopyToClipboard::to_clipboard_from(state)
        )?;
    }
    terminal.backend_mut().flush()
}

fn take(app: &mut App, event: &Event) -> Flow {
    match event {
        Event::Key(key) if key.kind != KeyEventKind::Release => {
            if let Some(key) = key_of(*key) {
                return app.press(&key);
            }
        }
        Event::Mouse(mouse) => {
            if let Some(pointer) = pointer_of(*mouse) {
                app.point(pointer, Position::new(mouse.column, mouse.row));
            }
        }
        Event::Resize(columns, rows) => app.resize(Size::new(*columns, *rows)),
        _ => {}
    }
    Flow::Go
}

/// The keymap's name of a key; none for one it has no name for.
fn key_of(event: KeyEvent) -> Option<Key> {
    let shift = event.modifiers.contains(KeyModifiers::SHIFT);
    let control = event.modifiers.contains(KeyModifiers::CONTROL);
    let name = match event.code {
        KeyCode::Char(c) if control => format!("c-{}", c.to_ascii_lowercase()),
        KeyCode::Char(c) => return Some(Key::of_char(c)),
        KeyCode::BackTab => "s-tab".to_owned(),
        KeyCode::F(n) => format!("f{n}"),
        code => {
            let name = match code {
                KeyCode::Left => "left",
                KeyCode::Right => "right",
                KeyCode::Up => "up",
                KeyCode::Down => "down",
                KeyCode::Home => "home",
                KeyCode::End => "end",
                KeyCode::PageUp => "pageup",
                KeyCode::PageDown => "pagedown",
                KeyCode::Tab => "tab",
                KeyCode::Enter => "enter",
                KeyCode::Esc => "esc",
                KeyCode::Backspace => "backspace",
                KeyCode::Delete => "delete",
                _ => return None,
            };
            let prefix = if shift { "s-" } else { "" };
            format!("{prefix}{name}")
        }
    };
    Key::named(&name).ok()
}

fn pointer_of(event: MouseEvent) -> Option<Pointer> {
    match event.kind {
        MouseEventKind::Down(MouseButton::Left) => Some(Pointer::Press),
        MouseEventKind::Drag(MouseButton::Left) => Some(Pointer::Drag),
        MouseEventKind::Up(MouseButton::Left) => Some(Pointer::Release),
        MouseEventKind::ScrollUp => Some(Pointer::Wheel(-1)),
        MouseEventKind::ScrollDown => Some(Pointer::Wheel(1)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_the_names_of_the_keymap() {
        let name = |code, modifiers| {
            let key = key_of(KeyEvent::new(code, modifiers));
            key.map(|key| key.name().to_owned())
        };
        let plain = KeyModifiers::NONE;
        assert_eq!(name(KeyCode::Char('l'), plain).as_deref(), Some("l"));
        assert_eq!(name(KeyCode::Char(' '), plain).as_deref(), Some("<space>"));
        assert_eq!(
            name(KeyCode::Char('G'), KeyModifiers::SHIFT).as_deref(),
            Some("G")
        );
        assert_eq!(
            name(KeyCode::Left, KeyModifiers::SHIFT).as_deref(),
            Some("<s-left>")
        );
        assert_eq!(
            name(KeyCode::BackTab, KeyModifiers::SHIFT).as_deref(),
            Some("<s-tab>")
        );
        assert_eq!(
            name(KeyCode::Char('r'), KeyModifiers::CONTROL).as_deref(),
            Some("<c-r>")
        );
        assert_eq!(name(KeyCode::CapsLock, plain), None);
    }
}
