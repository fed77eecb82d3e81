//! The terminal itself: taken over and given back, read on a thread of its own, drawn on only when something changed.
//!
//! ```text
//! input thread ──┐
//! signal thread ─┼─► bounded channel ─► loop: drain all, let the session take in what is done, draw once
//! session, images┘
//! ```
//! With nothing to play or compute the loop sleeps on the channel. What the terminal can show is asked before the first
//! frame and never waited for: the answers come among the keys.

mod decode;
mod guard;
mod output;
mod screen;
#[cfg(test)]
mod tests;

use std::fs::File;
use std::io::{self, IsTerminal, Read, Write, stdin, stdout};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Instant;

use crossterm::terminal::{size, window_size};
use ratatui::layout::Size;
use ratatui_image::picker::ProtocolType;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGTSTP, SIGWINCH};
use signal_hook::iterator::Signals;

use super::app::{App, Flow};
use super::face::Face;
use super::pixels::ask::{Answer, Asking, CellSize, Graphics, Host};
use super::pixels::{Pixels, tmux};
use super::theme::Depth;
use decode::{Decoder, Input};
use guard::Guard;
use output::Output;
use screen::Screen;

/// Events that may wait; held keys beyond it wait in the terminal's own buffer.
const QUEUE: usize = 256;

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
    Input(Input),
    /// The screen has another size.
    Resized,
    /// To be stopped, and to go on later where it was: Ctrl-Z.
    Suspend,
    Signal(i32),
    /// Something was computed or encoded.
    Done,
    /// The terminal is gone.
    Closed(io::Error),
}

/// Runs the face until the user quits or a signal comes. The terminal is given back in every case.
pub fn run(app: &mut App, images: Images) -> io::Result<Ended> {
    // Before the terminal is taken over: a signal must never find it taken and nobody listening.
    let signals = Signals::new([SIGTERM, SIGHUP, SIGINT, SIGWINCH, SIGTSTP])?;
    let guard = Guard::enter()?;
    let sixteen = app.face.depth == Depth::Sixteen;
    let mut screen = Screen::whole(Output::new(stdout(), sixteen))?;
    app.resize(screen.size()?);
    let (sender, events) = sync_channel(QUEUE);
    app.session.set_waker(Box::new(waker(sender.clone())));

    let host = Host::of(|name| std::env::var(name).ok(), cell_size());
    let mut asking = None;
    if host.tmux {
        // What is copied goes through tmux too, whatever images are made of.
        tmux::let_through();
        screen.copy_through_tmux();
    }
    match images {
        Images::Force(protocol) => {
            if let Some(graphics) = host.forced(protocol) {
                start_images(&mut app.face, graphics, &sender)?;
            }
        }
        // Where there are not even colours there are no images, and some of the oldest would print the question.
        Images::Ask if app.face.depth.has_shades() => {
            screen.write(&host.question())?;
            asking = Some(Asking::new(host));
        }
        Images::Ask | Images::HalfBlocks => {}
    }

    let handle = signals.handle();
    let for_signals = sender.clone();
    thread::Builder::new()
        .name("poescope-signals".to_owned())
        .spawn(move || read_signals(signals, &for_signals))?;
    let for_input = sender.clone();
    thread::Builder::new()
        .name("poescope-input".to_owned())
        .spawn(move || read_input(&for_input))?;

    let ended = loop {
        let ended = drive(app, &mut screen, &events, |face, answer| {
            let graphics = asking.as_mut().and_then(|asking| asking.take(answer));
            graphics.map_or(Ok(false), |graphics| {
                start_images(face, graphics, &sender).map(|()| true)
            })
        });
        forget_images(app, &mut screen)?;
        match ended {
            Ok(Some(ended)) => break Ok(ended),
            Err(error) => break Err(error),
            Ok(None) => {
                guard::suspend()?;
                screen.clear()?;
                app.resize(screen.size()?);
            }
        }
    };
    handle.close();
    drop(guard);
    ended
}

/// What the terminal holds of images would stand over whatever it shows next.
fn forget_images<W: Write>(app: &mut App, screen: &mut Screen<W>) -> io::Result<()> {
    if let Some(pixels) = &mut app.face.pixels {
        pixels.forget();
        screen.write(&pixels.to_send())?;
        screen.flush()?;
    }
    Ok(())
}

/// Has images drawn this way from now on.
fn start_images(face: &mut Face, graphics: Graphics, sender: &SyncSender<Wake>) -> io::Result<()> {
    if let Some(pixels) = &mut face.pixels {
        pixels.change(graphics);
    } else {
        face.pixels = Some(Pixels::start(graphics, waker(sender.clone()))?);
    }
    Ok(())
}

/// Pixels of a cell, where the terminal has told the system.
fn cell_size() -> Option<CellSize> {
    let window = window_size().ok()?;
    let side = |pixels: u16, cells: u16| pixels.checked_div(cells).filter(|&side| side > 0);
    Some((
        side(window.width, window.columns)?,
        side(window.height, window.rows)?,
    ))
}

/// A full queue needs no further wake: the loop is about to run anyway.
fn waker(sender: SyncSender<Wake>) -> impl Fn() + Send + 'static {
    move || {
        let _ = sender.try_send(Wake::Done);
    }
}

fn read_signals(mut signals: Signals, sender: &SyncSender<Wake>) {
    for signal in signals.forever() {
        let wake = match signal {
            SIGWINCH => Wake::Resized,
            SIGTSTP => Wake::Suspend,
            signal => Wake::Signal(signal),
        };
        if sender.send(wake).is_err() {
            return;
        }
    }
}

/// Reads what is typed: from standard input, or where something else is piped there from the terminal itself.
fn read_input(sender: &SyncSender<Wake>) {
    let error = if stdin().is_terminal() {
        pass_on(stdin(), sender)
    } else {
        match File::open("/dev/tty") {
            Ok(terminal) => pass_on(terminal, sender),
            Err(error) => error,
        }
    };
    let _ = sender.send(Wake::Closed(error));
}

/// Until the input ends; why it did.
fn pass_on(mut terminal: impl Read, sender: &SyncSender<Wake>) -> io::Error {
    let mut decoder = Decoder::default();
    let mut bytes = [0; 1024];
    loop {
        let read = match terminal.read(&mut bytes) {
            Ok(0) => return io::ErrorKind::UnexpectedEof.into(),
            Ok(read) => read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return error,
        };
        for input in decoder.push(&bytes[..read], read == bytes.len()) {
            let is_suspend = matches!(&input, Input::Key(key) if key.name() == "<c-z>");
            let wake = if is_suspend {
                Wake::Suspend
            } else {
                Wake::Input(input)
            };
            if sender.send(wake).is_err() {
                return io::ErrorKind::BrokenPipe.into();
            }
        }
    }
}

/// The loop, until it ends; none where it is to go on once the process was stopped. `answered` says whether an answer of
/// the terminal changes what is drawn.
fn drive<W: Write>(
    app: &mut App,
    screen: &mut Screen<W>,
    events: &Receiver<Wake>,
    mut answered: impl FnMut(&mut Face, Answer) -> io::Result<bool>,
) -> io::Result<Option<Ended>> {
    let mut changed = true;
    let mut before = Instant::now();
    let mut tick = |app: &mut App| {
        let now = Instant::now();
        let since = now - std::mem::replace(&mut before, now);
        app.tick(since)
    };
    loop {
        changed |= tick(app);
        if let Some(pixels) = &mut app.face.pixels {
            changed |= pixels.receive();
        }
        if std::mem::take(&mut changed) {
            screen.show(app)?;
        }
        let first = match app.next_wake() {
            Some(soon) => match events.recv_timeout(soon) {
                Ok(wake) => Some(wake),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Ok(Some(Ended::Quit)),
            },
            None => match events.recv() {
                Ok(wake) => Some(wake),
                Err(_) => return Ok(Some(Ended::Quit)),
            },
        };
        // Before what the keys begin: the wait for them is no time that it has played.
        changed |= tick(app);
        // Everything that has come is taken in before the next drawing, so a held key leaves nothing behind; no more
        // than can wait, so that even an endless stream of it is drawn now and then.
        for wake in first.into_iter().chain(events.try_iter().take(QUEUE)) {
            match wake {
                Wake::Input(Input::Key(key)) => {
                    changed = true;
                    if app.press(&key) == Flow::Quit {
                        return Ok(Some(Ended::Quit));
                    }
                }
                Wake::Input(Input::Pointer(pointer, at)) => {
                    changed = true;
                    app.point(pointer, at);
                }
                Wake::Input(Input::Answer(answer)) => changed |= answered(&mut app.face, answer)?,
                Wake::Resized => {
                    changed = true;
                    let (columns, rows) = size()?;
                    app.resize(Size::new(columns, rows));
                    if let Some(pixels) = &mut app.face.pixels {
                        pixels.resized(cell_size());
                    }
                }
                Wake::Suspend => return Ok(None),
                Wake::Signal(signal) => return Ok(Some(Ended::Signal(signal))),
                Wake::Closed(error) => return Err(error),
                Wake::Done => {}
            }
        }
    }
}
