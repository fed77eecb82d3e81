//! From keys to actions: the table, and the few keys that change what the next ones mean.
//!
//! Inside a mode its own keys are read by its file; Esc and Enter end it, and so does any other key, which then does
//! what it always does.

mod adjust;
mod controls;
mod corrupt;
mod typing;

use super::command::Command;
use super::keymap::{FaceCommand, Meaning, Mode, lookup};
use super::keys::Key;
use super::palette::PaletteView;
use super::snapshot::Snapshot;
use typing::Typing;

/// What a face has to do for a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Hand it to the session.
    Session(Command),
    /// Do it.
    Face(FaceCommand),
    /// Show a line.
    Explain {
        /// Whether the key made no sense.
        error: bool,
        /// The line.
        text: String,
    },
}

/// What the next key is for.
#[derive(Clone, Debug, Default)]
pub struct Input {
    mode: Option<Mode>,
    typing: Typing,
    /// The expert that `a` and `x` are about.
    focused: usize,
    /// Which of its modalities `x` damages, by its place among them.
    modality: usize,
    /// The step from which `r` edits the controls.
    from: usize,
}

/// What a mode makes of a key.
enum Taken {
    /// This.
    Action(Action),
    /// Nothing that anyone else has to do.
    Quietly,
    /// It is not one of its keys.
    Not,
}

impl Input {
    /// Takes a key; none if it only changed what the next one means, or means nothing.
    pub fn press(&mut self, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        if key.name() == "<c-c>" {
            return Some(Action::Face(FaceCommand::Quit));
        }
        let taken = match self.mode {
            None => Taken::Not,
            Some(Mode::Prompt) => return self.type_key(key, snapshot),
            // 9 is the prior here too, and the session says why it has no solo.
            Some(Mode::Solo) if key.as_char() == Some('9') => {
                self.mode = None;
                let prior = snapshot.experts.len().saturating_sub(1);
                Taken::Action(Action::Session(Command::Solo(prior)))
            }
            Some(Mode::Solo) => sensor(key, snapshot).map_or(Taken::Not, |position| {
                self.mode = None;
                Taken::Action(match position {
                    Ok(position) => Action::Session(Command::Solo(position)),
                    Err(why) => why,
                })
            }),
            Some(Mode::Temper) => self.temper(key, snapshot),
            Some(Mode::Context) => adjust::by(key).map(Command::Context).into(),
            Some(Mode::Horizon) => adjust::by(key).map(Command::Horizon).into(),
            Some(Mode::Samples) => adjust::samples(key, snapshot),
            Some(Mode::Corrupt) => self.corrupt(key, snapshot),
            Some(Mode::Controls) => self.controls(key, snapshot),
        };
        match taken {
            Taken::Action(action) => Some(action),
            Taken::Quietly => None,
            Taken::Not => {
                let ended = self.mode.take().is_some();
                let ends = matches!(key.name(), "<esc>" | "<enter>");
                if ended && ends {
                    return None;
                }
                self.plain(key, snapshot)
            }
        }
    }

    /// The mode the next key is read in.
    pub fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// The line to show while a key is awaited: what is changed, then the keys, the most useful first.
    pub fn hint(&self, snapshot: &Snapshot) -> Option<String> {
        let hint = match self.mode? {
            Mode::Prompt => format!(":{}", self.typing.line),
            Mode::Solo => "only which sensor? a digit".to_owned(),
            Mode::Context => format!("context {} | - = change it, Esc ends", snapshot.context),
            Mode::Horizon => format!("horizon {} | - = change it, Esc ends", snapshot.horizon),
            Mode::Samples => {
                let count = snapshot.sampling.count;
                format!("{count} samples | - half, = twice as many, Esc ends")
            }
            Mode::Temper => self.temper_hint(snapshot),
            Mode::Corrupt => self.corrupt_hint(snapshot),
            Mode::Controls => self.controls_hint(snapshot),
        };
        Some(hint)
    }

    /// What can be chosen while a line is typed.
    pub fn palette(&self, snapshot: &Snapshot) -> Option<PaletteView> {
        (self.mode == Some(Mode::Prompt)).then(|| self.typing.palette(snapshot))
    }

    /// The expert that `a` tempers and `x` damages: the last one whose digit was pressed.
    pub fn focused_expert(&self) -> usize {
        self.focused
    }

    /// Makes `a` and `x` about this one, where a face has other ways to point at an expert.
    pub fn focus_expert(&mut self, position: usize) {
        if self.focused != position {
            self.modality = 0;
        }
        self.focused = position;
    }

    fn plain(&mut self, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        match lookup(key.name())?.meaning.clone() {
            Meaning::Session(command) => Some(Action::Session(command)),
            Meaning::Face(command) => Some(Action::Face(command)),
            Meaning::ExpertDigit => Some(match sensor(key, snapshot)? {
                Ok(position) => {
                    self.focus_expert(position);
                    Action::Session(Command::ToggleExpert(position))
                }
                Err(complaint) => complaint,
            }),
            Meaning::Prior => {
                self.focus_expert(snapshot.experts.len().saturating_sub(1));
                Some(Action::Session(Command::ToggleExpert(self.focused)))
            }
            Meaning::Model(by) => {
                let last = snapshot.models.len().saturating_sub(1);
                let model = snapshot.model.saturating_add_signed(by as isize).min(last);
                Some(if model == snapshot.model {
                    let text = format!(
                        "this is the {} model",
                        if by < 0 { "first" } else { "last" }
                    );
                    Action::Explain { error: false, text }
                } else {
                    Action::Session(Command::SelectModel(model))
                })
            }
            Meaning::Mode(mode) => {
                self.mode = Some(mode);
                self.from = snapshot
                    .control_edit
                    .map_or(snapshot.cursor, |edit| edit.from);
                None
            }
            Meaning::Line(start) => {
                self.mode = Some(Mode::Prompt);
                self.typing = Typing::from(start);
                None
            }
        }
    }
}

impl From<Option<Command>> for Taken {
    fn from(command: Option<Command>) -> Self {
        command.map_or(Self::Not, |command| Self::Action(Action::Session(command)))
    }
}

/// Position of the expert of a digit from 1 to 8.
fn digit(key: &Key) -> Option<usize> {
    let digit = key.as_char()?.to_digit(10)?;
    (1..=8).contains(&digit).then(|| digit as usize - 1)
}

/// The sensor of a digit; why there is none, for the prior stands after the sensors but its key is not the next digit.
fn sensor(key: &Key, snapshot: &Snapshot) -> Option<Result<usize, Action>> {
    let position = digit(key)?;
    let sensors = snapshot.experts.len().saturating_sub(1);
    if position < sensors {
        return Some(Ok(position));
    }
    let text = format!("there are {sensors} sensor experts; 9 is the prior");
    Some(Err(Action::Explain { error: true, text }))
}

#[cfg(test)]
mod tests;
