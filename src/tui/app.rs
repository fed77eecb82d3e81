//! Keys, clicks and drags in; commands to the session and changes of the face out. Knows no terminal.

mod list;

use std::time::Duration;

use ratatui::layout::{Position, Rect, Size};

use super::axis::Axis;
use super::border::{self, Border};
use super::compare::{BLINK, Compare};
use super::experts::expert_at;
use super::face::Face;
use super::frames::part_of_compared;
use super::help;
use super::lattice::set_at;
use super::view::{Pane, View};
use crate::session::Session;
use crate::session::command::Command;
use crate::session::input::{Action, Input};
use crate::session::keymap::FaceCommand;
use crate::session::keys::Key;
use crate::session::snapshot::{Message, Snapshot};

/// Whether to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// Yes.
    Go,
    /// The user has ended it.
    Quit,
}

/// Writes what is shown as a file; says what becomes of it.
pub type TakeAlong = Box<dyn FnMut(&Snapshot) -> Message>;

/// What a mouse does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointer {
    /// A button goes down.
    Press,
    /// It moves while held.
    Drag,
    /// It comes up.
    Release,
    /// The wheel turns by so many steps of time.
    Wheel(i64),
}

/// What the pressed button holds.
#[derive(Clone, Copy)]
enum Drag {
    /// The cursor.
    Timeline,
    /// The border between two images.
    Wipe,
    /// A border between two panes: where the button went down, and the border's offset then.
    Border(Border, Position, i16),
}

/// Keys that mean the same where the help is open; any other one closes it.
const OVER_HELP: [&str; 5] = ["?", "<f1>", "<esc>", "q", "<c-c>"];

/// A session with a face.
pub struct App {
    /// What is looked at.
    pub session: Session,
    /// How.
    pub face: Face,
    /// A state string that is to go to the clipboard.
    pub to_copy: Option<String>,
    /// What writes files; none where nobody would find them.
    pub take_along: Option<TakeAlong>,
    input: Input,
    size: Size,
    dragged: Option<Drag>,
    /// How long the present image of a blinking pair has been shown.
    blinked: Duration,
}

impl App {
    /// Joins the two on a screen of this size.
    pub fn new(session: Session, face: Face, size: Size) -> Self {
        Self {
            session,
            face,
            to_copy: None,
            take_along: None,
            input: Input::default(),
            size,
            dragged: None,
            blinked: Duration::ZERO,
        }
    }

    /// The screen has another size now.
    pub fn resize(&mut self, size: Size) {
        self.size = size;
        self.face.help = self.face.help.filter(|&page| page < help::pages(size));
    }

    /// Lets time pass for playback, for what was computed and for what blinks; whether anything looks other than before.
    pub fn tick(&mut self, dt: Duration) -> bool {
        let changed = self.session.update(dt);
        let Compare::Blink(other) = self.face.compare else {
            return changed;
        };
        self.blinked += dt;
        if self.blinked < BLINK {
            return changed;
        }
        // However late, it changes over once: nothing is caught up with.
        self.blinked = Duration::ZERO;
        self.face.compare = Compare::Blink(!other);
        true
    }

    /// How long nothing happens by itself; none: until a key, or until something is computed.
    pub fn next_wake(&self) -> Option<Duration> {
        let blink = matches!(self.face.compare, Compare::Blink(_))
            .then(|| BLINK.saturating_sub(self.blinked));
        [self.session.next_wake(), blink]
            .into_iter()
            .flatten()
            .min()
    }

    /// Takes one key.
    pub fn press(&mut self, key: &Key) -> Flow {
        let snapshot = self.session.snapshot();
        self.press_on(key, &snapshot)
    }

    /// Takes one key as it is meant on this snapshot.
    pub(super) fn press_on(&mut self, key: &Key, snapshot: &Snapshot) -> Flow {
        let flow = self.take(key, snapshot);
        // Only what a key has opened is computed.
        self.session.want(self.face.wants());
        flow
    }

    fn take(&mut self, key: &Key, snapshot: &Snapshot) -> Flow {
        if self.face.help.is_some() && !OVER_HELP.contains(&key.name()) {
            // What it would change could not be seen.
            self.face.help = None;
            return Flow::Go;
        }
        if self.list_takes(key, snapshot) || self.choose_set(key, snapshot) {
            return Flow::Go;
        }
        let flow = match self.input.press(key, snapshot) {
            Some(Action::Session(command)) => {
                self.session.apply(command);
                Flow::Go
            }
            Some(Action::Face(command)) => self.face_command(command, snapshot),
            Some(Action::Explain { error, text }) => {
                self.session.say(Message { error, text });
                Flow::Go
            }
            None => Flow::Go,
        };
        self.show_input();
        flow
    }

    /// Shows what the next key would be read as.
    fn show_input(&mut self) {
        let snapshot = self.session.snapshot();
        self.face.expert = self.input.focused_expert();
        self.face.prompt = self.input.hint(&snapshot);
        self.face.palette = self.input.palette(&snapshot);
    }

    /// In the lattice up and down choose a set and Enter switches to it; whether the key was one of these.
    fn choose_set(&mut self, key: &Key, snapshot: &Snapshot) -> bool {
        let face = &mut self.face;
        let meant = face.view == View::Lattice && face.focus == Pane::Sets && face.help.is_none();
        let Some(lattice) = snapshot.lattice.as_ref() else {
            return false;
        };
        let count = lattice.cells.len();
        if !meant || self.input.mode().is_some() || count == 0 {
            return false;
        }
        let chosen = face.lattice_cell.min(count - 1);
        match key.name() {
            "<up>" => face.lattice_cell = (chosen + count - 1) % count,
            "<down>" => face.lattice_cell = (chosen + 1) % count,
            "<enter>" => {
                let active = lattice.cells[chosen].active.clone();
                self.session.apply(Command::UseSet(active));
            }
            _ => return false,
        }
        true
    }

    fn face_command(&mut self, command: FaceCommand, snapshot: &Snapshot) -> Flow {
        let face = &mut self.face;
        match command {
            FaceCommand::Quit => return Flow::Quit,
            FaceCommand::Help => {
                let next = face.help.map_or(0, |page| page + 1);
                face.help = (next < help::pages(self.size)).then_some(next);
            }
            FaceCommand::FocusNext => face.focus = face.focus.turned(face.view, 1),
            FaceCommand::FocusPrevious => face.focus = face.focus.turned(face.view, -1),
            FaceCommand::Zoom => face.zoomed = !face.zoomed,
            FaceCommand::Back => {
                if face.help.take().is_none() {
                    face.zoomed = false;
                }
            }
            FaceCommand::NextView => face.open(face.view.next()),
            FaceCommand::View(name) => {
                if let Some(view) = View::ALL.into_iter().find(|view| view.name() == name) {
                    face.open(view);
                }
            }
            FaceCommand::Episodes => self.toggle_episodes(),
            FaceCommand::Difference => face.compare = face.compare.difference(),
            FaceCommand::Blink => {
                self.blinked = Duration::ZERO;
                face.compare = face.compare.blink();
            }
            FaceCommand::Wipe => face.compare = face.compare.wipe(),
            FaceCommand::CopyState => {
                self.to_copy = Some(snapshot.state.clone());
                self.session.say(Message {
                    error: false,
                    text: format!("sent to the clipboard: {}", snapshot.state),
                });
            }
            FaceCommand::Export => {
                let message = match &mut self.take_along {
                    Some(write) => write(snapshot),
                    None => Message {
                        error: true,
                        text: "there is no file to write to from here; `poescope export --state` does it".to_owned(),
                    },
                };
                self.session.say(message);
            }
        }
        Flow::Go
    }

    /// Takes what the mouse did at a cell of the screen.
    pub fn point(&mut self, pointer: Pointer, at: Position) {
        let face = &self.face;
        if face.help.is_some() || face.episodes.is_some() || face.palette.is_some() {
            // What lies below could not be seen.
            return;
        }
        let snapshot = self.session.snapshot();
        let screen = Rect::new(0, 0, self.size.width, self.size.height);
        let layout = super::layout(screen, &snapshot, &self.face);
        let timeline = layout.get(Pane::Timeline);
        match pointer {
            Pointer::Wheel(by) => self.session.apply(Command::Step(by)),
            Pointer::Release => self.dragged = None,
            Pointer::Drag => match self.dragged {
                Some(Drag::Timeline) => self.seek(timeline, at, &snapshot),
                Some(Drag::Wipe) => self.wipe(layout.get(Pane::Frames), at, &snapshot),
                Some(Drag::Border(border, from, by)) => {
                    let own = super::own_layout(screen, &snapshot, &self.face);
                    let by = by.saturating_add(border.side.way(from, at));
                    let (face, panes) = (&mut self.face, own.panes());
                    border::set(&mut face.splits, panes, face.view, border, by);
                }
                None => {}
            },
            Pointer::Press => {
                let border = border::at(layout.panes(), at).filter(|_| !self.face.zoomed);
                self.dragged = border.map(|border| {
                    let by = border::offset(&self.face.splits, self.face.view, border);
                    Drag::Border(border, at, by)
                });
                let Some((pane, rect)) = layout.at(at) else {
                    return;
                };
                if self.face.view.panes().contains(&pane) {
                    self.face.focus = pane;
                }
                match pane {
                    // Its title: a border, not a step.
                    _ if self.dragged.is_some() => {}
                    Pane::Timeline => {
                        self.dragged = Some(Drag::Timeline);
                        self.seek(rect, at, &snapshot);
                    }
                    Pane::Frames => {
                        self.dragged = Some(Drag::Wipe);
                        self.wipe(rect, at, &snapshot);
                    }
                    Pane::Sets => {
                        if let Some(set) = set_at(rect, at, &snapshot, &self.face) {
                            self.face.lattice_cell = set;
                        }
                    }
                    Pane::Experts => {
                        if let Some(expert) = expert_at(at.y - rect.y, snapshot.experts.len()) {
                            self.input.focus_expert(expert);
                            self.session.apply(Command::ToggleExpert(expert));
                            self.show_input();
                        }
                    }
                    _ => {}
                }
            }
        }
    }

    /// Moves the border of a wipe to the mouse.
    fn wipe(&mut self, frames: Rect, at: Position, snapshot: &Snapshot) {
        if matches!(self.face.compare, Compare::Wipe(_))
            && let Some(border) = part_of_compared(frames, at, snapshot, &self.face)
        {
            self.face.compare = Compare::Wipe(border);
        }
    }

    fn seek(&mut self, timeline: Rect, at: Position, snapshot: &Snapshot) {
        let steps = snapshot.steps();
        let axis = Axis::of(timeline.width, steps);
        if let Some(step) = axis.step_at(at.x.saturating_sub(timeline.x)) {
            self.session.apply(Command::SeekClamped(step));
        }
    }
}
