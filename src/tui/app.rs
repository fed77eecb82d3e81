//! Keys, clicks and drags in; commands to the session and changes of the face out. Knows no terminal.

use ratatui::layout::{Position, Rect, Size};

use super::axis::Axis;
use super::episodes::list::{Asked, List};
use super::experts::expert_at;
use super::face::Face;
use super::help;
use super::view::Pane;
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

/// A session with a face.
pub struct App {
    /// What is looked at.
    pub session: Session,
    /// How.
    pub face: Face,
    /// A state string that is to go to the clipboard.
    pub to_copy: Option<String>,
    input: Input,
    size: Size,
    seeking: bool,
}

impl App {
    /// Joins the two on a screen of this size.
    pub fn new(session: Session, face: Face, size: Size) -> Self {
        Self {
            session,
            face,
            to_copy: None,
            input: Input::default(),
            size,
            seeking: false,
        }
    }

    /// The screen has another size now.
    pub fn resize(&mut self, size: Size) {
        self.size = size;
        self.face.help = self.face.help.filter(|&page| page < help::pages(size));
    }

    /// Takes one key.
    pub fn press(&mut self, key: &Key) -> Flow {
        let snapshot = self.session.snapshot();
        if self.face.help.is_none() && self.list_takes(key, &snapshot) {
            return Flow::Go;
        }
        let flow = match self.input.press(key, &snapshot) {
            Some(Action::Session(command)) => {
                self.session.apply(command);
                Flow::Go
            }
            Some(Action::Face(command)) => self.face_command(command, &snapshot),
            Some(Action::Explain { error, text }) => {
                self.session.say(Message { error, text });
                Flow::Go
            }
            None => Flow::Go,
        };
        self.face.expert = self.input.focused_expert();
        self.face.prompt = self.input.hint(&self.session.snapshot());
        flow
    }

    /// Opens the list of episodes, or closes it.
    pub fn toggle_episodes(&mut self) {
        let open = List::open(&self.session.snapshot());
        self.face.episodes = self.face.episodes.is_none().then_some(open);
    }

    /// Whether the open list has taken the key.
    fn list_takes(&mut self, key: &Key, snapshot: &Snapshot) -> bool {
        let Some(list) = &mut self.face.episodes else {
            return false;
        };
        match list.press(key, snapshot) {
            Asked::Usual => return false,
            Asked::Nothing => {}
            Asked::Command(command) => self.session.apply(command),
            Asked::Close => self.face.episodes = None,
            Asked::Open(index) => {
                self.face.episodes = None;
                self.session.apply(Command::SelectEpisode(index));
            }
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
            FaceCommand::CopyState => {
                self.to_copy = Some(snapshot.state.clone());
                self.session.say(Message {
                    error: false,
                    text: format!("copied: {}", snapshot.state),
                });
            }
        }
        Flow::Go
    }

    /// Takes what the mouse did at a cell of the screen.
    pub fn point(&mut self, pointer: Pointer, at: Position) {
        if self.face.help.is_some() || self.face.episodes.is_some() {
            return;
        }
        let snapshot = self.session.snapshot();
        let screen = Rect::new(0, 0, self.size.width, self.size.height);
        let layout = super::layout(screen, &snapshot, &self.face);
        let timeline = layout.get(Pane::Timeline);
        match pointer {
            Pointer::Wheel(by) => self.session.apply(Command::Step(by)),
            Pointer::Release => self.seeking = false,
            Pointer::Drag if self.seeking => self.seek(timeline, at, &snapshot),
            Pointer::Drag => {}
            Pointer::Press => {
                let Some((pane, rect)) = layout.at(at) else {
                    return;
                };
                if self.face.view.panes().contains(&pane) {
                    self.face.focus = pane;
                }
                match pane {
                    Pane::Timeline => {
                        self.seeking = true;
                        self.seek(rect, at, &snapshot);
                    }
                    Pane::Experts => {
                        if let Some(expert) = expert_at(at.y - rect.y, snapshot.experts.len()) {
                            self.input.focus_expert(expert);
                            self.face.expert = expert;
                            self.session.apply(Command::ToggleExpert(expert));
                        }
                    }
                    _ => {}
                }
            }
        }
    }

    fn seek(&mut self, timeline: Rect, at: Position, snapshot: &Snapshot) {
        let steps = snapshot
            .episode
            .as_ref()
            .map_or(0, |episode| episode.secs.len());
        let axis = Axis::of(timeline.width, steps);
        if let Some(step) = axis.step_at(at.x.saturating_sub(timeline.x)) {
            self.session.apply(Command::SeekClamped(step));
        }
    }
}
