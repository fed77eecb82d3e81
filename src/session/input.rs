//! From keys to actions: the table, and the few keys that change what the next ones mean.

use super::command::Command;
use super::keymap::{FaceCommand, Meaning, Mode, lookup};
use super::keys::Key;
use super::prompt;
use super::snapshot::Snapshot;

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
    line: String,
    focused: usize,
}

impl Input {
    /// Takes a key; none if it only changed what the next one means, or means nothing.
    pub fn press(&mut self, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        if key.name() == "<c-c>" {
            return Some(Action::Face(FaceCommand::Quit));
        }
        match self.mode {
            None => self.plain(key, snapshot),
            Some(Mode::Prompt) => self.prompt(key, snapshot),
            Some(Mode::Solo) => {
                self.mode = None;
                match digit(key) {
                    Some(position) => Some(Action::Session(Command::Solo(position))),
                    None if key.name() == "<esc>" => None,
                    None => self.plain(key, snapshot),
                }
            }
            Some(mode) => self.adjust(mode, key, snapshot),
        }
    }

    /// The mode the next key is read in.
    pub fn mode(&self) -> Option<Mode> {
        self.mode
    }

    /// The line to show while a key is awaited.
    pub fn hint(&self, snapshot: &Snapshot) -> Option<String> {
        let hint = match self.mode? {
            Mode::Prompt => format!(":{}", self.line),
            Mode::Solo => "only which sensor? a digit".to_owned(),
            Mode::Context => format!("context {}: - = change it, Esc ends", snapshot.context),
            Mode::Horizon => format!("horizon {}: - = change it, Esc ends", snapshot.horizon),
            Mode::Temper => match snapshot.experts.get(self.focused) {
                Some(view) => {
                    let name = view.expert.name();
                    format!(
                        "α of {name} {}: - = change it, a digit picks another, Esc ends",
                        view.alpha
                    )
                }
                None => "α of which expert? a digit".to_owned(),
            },
        };
        Some(hint)
    }

    /// The expert that `a` tempers: the last one whose digit was pressed.
    pub fn focused_expert(&self) -> usize {
        self.focused
    }

    /// Makes `a` temper this one, where a face has other ways to point at an expert.
    pub fn focus_expert(&mut self, position: usize) {
        self.focused = position;
    }

    fn plain(&mut self, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        match lookup(key.name())?.meaning.clone() {
            Meaning::Session(command) => Some(Action::Session(command)),
            Meaning::Face(command) => Some(Action::Face(command)),
            Meaning::ExpertDigit => {
                self.focused = digit(key)?;
                // The prior stands after the sensors, but its key is not the next digit.
                let sensors = snapshot.experts.len().saturating_sub(1);
                if self.focused < sensors {
                    return Some(Action::Session(Command::ToggleExpert(self.focused)));
                }
                let text = format!("there are {sensors} sensor experts; 9 is the prior");
                Some(Action::Explain { error: true, text })
            }
            Meaning::Prior => {
                self.focused = snapshot.experts.len().saturating_sub(1);
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
                self.line.clear();
                None
            }
        }
    }

    fn prompt(&mut self, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        match key.name() {
            "<esc>" => self.mode = None,
            "<backspace>" if self.line.pop().is_none() => self.mode = None,
            "<enter>" => {
                self.mode = None;
                let line = std::mem::take(&mut self.line);
                return (!line.trim().is_empty()).then(|| prompt::action(&line, snapshot));
            }
            _ => self.line.extend(key.as_char()),
        }
        None
    }

    /// `-` and `=` change a number; any other key ends the mode and does what it always does.
    fn adjust(&mut self, mode: Mode, key: &Key, snapshot: &Snapshot) -> Option<Action> {
        let by = match key.name() {
            "-" => -1,
            "=" | "+" => 1,
            "<esc>" | "<enter>" => {
                self.mode = None;
                return None;
            }
            _ => 0,
        };
        match (mode, by) {
            (Mode::Temper, 0)
                if key
                    .as_char()
                    .is_some_and(|c| c.is_ascii_digit() && c != '0') =>
            {
                let prior = snapshot.experts.len().saturating_sub(1);
                self.focused = if key.name() == "9" {
                    prior
                } else {
                    digit(key)?.min(prior)
                };
                None
            }
            (_, 0) => {
                self.mode = None;
                self.plain(key, snapshot)
            }
            (Mode::Context, by) => Some(Action::Session(Command::Context(by))),
            (Mode::Horizon, by) => Some(Action::Session(Command::Horizon(by))),
            (_, by) => {
                let (expert, tenths) = (self.focused, by);
                Some(Action::Session(Command::Temper { expert, tenths }))
            }
        }
    }
}

/// Position of the expert of a digit from 1 to 8.
fn digit(key: &Key) -> Option<usize> {
    let digit = key.as_char()?.to_digit(10)?;
    (1..=8).contains(&digit).then(|| digit as usize - 1)
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may stop here; α is compared as it was set"
)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::*;
    use crate::session::Session;
    use crate::session::fake::{FakePredictor, FakeSource};
    use crate::session::keys::parse_script;

    /// Presses the keys of a script; returns the session's snapshot and what it was not for the session to do.
    fn press(script: &str) -> (Snapshot, Vec<Action>, Input) {
        let mut session = Session::new(
            Arc::new(FakeSource::new(3)),
            vec![Arc::new(FakePredictor::three())],
        );
        let (mut input, mut others) = (Input::default(), Vec::new());
        for key in parse_script(script).unwrap() {
            assert!(session.wait_idle(Duration::from_secs(20)));
            match input.press(&key, &session.snapshot()) {
                Some(Action::Session(command)) => session.apply(command),
                other => others.extend(other),
            }
        }
        assert!(session.wait_idle(Duration::from_secs(20)));
        (session.snapshot(), others, input)
    }

    fn alphas(script: &str) -> Vec<f32> {
        press(script)
            .0
            .experts
            .iter()
            .map(|view| view.alpha)
            .collect()
    }

    #[test]
    fn plain_keys_follow_the_table() {
        let (snapshot, others, _) = press("lll<right>h 2 ] ?");
        assert_eq!((snapshot.cursor, snapshot.episode_index), (3, 1));
        assert_eq!(snapshot.experts[1].alpha, 0.0);
        assert_eq!(others, [Action::Face(FaceCommand::Help)]);
    }

    #[test]
    fn digits_switch_and_nine_is_the_prior() {
        assert_eq!(alphas("l9"), [1.0, 1.0, 1.0, 0.0]);
        assert_eq!(alphas("S3"), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(alphas("12 0"), [1.0; 4]);
        let (snapshot, others, _) = press("4");
        assert_eq!(snapshot.message, None);
        let text = "there are 3 sensor experts; 9 is the prior".to_owned();
        assert_eq!(others, [Action::Explain { error: true, text }]);
    }

    #[test]
    fn tempering_counts_in_tenths_and_comes_back_to_one() {
        assert_eq!(alphas("a2---"), [1.0, 0.7, 1.0, 1.0]);
        assert_eq!(alphas("a2---==="), [1.0; 4]);
        let (_, _, input) = press("a2-<esc>");
        assert_eq!((input.mode(), input.focused_expert()), (None, 1));
    }

    #[test]
    fn another_key_ends_a_mode_and_does_what_it_always_does() {
        let (snapshot, _, input) = press("c=== l C--- l");
        assert_eq!(
            (snapshot.context, snapshot.horizon, snapshot.cursor),
            (7, 6, 2)
        );
        assert_eq!(input.mode(), None);
    }

    #[test]
    fn a_line_can_be_typed() {
        assert_eq!(press(":12<enter>").0.cursor, 11);
        assert_eq!(press(":12<esc>l").0.cursor, 1);
        assert_eq!(
            press(":alpha<space>haptic<space>0.25<enter>").0.experts[1].alpha,
            0.25
        );
        assert_eq!(press(":episode<space>3<enter>").0.episode_index, 2);
        assert_eq!(press(":q<enter>").1, [Action::Face(FaceCommand::Quit)]);
        let (snapshot, others, input) = press(":nonsense<enter>:4");
        assert!(matches!(&others[..], [Action::Explain { error: true, .. }]));
        assert_eq!(input.hint(&snapshot).as_deref(), Some(":4"));
        assert_eq!(press(":x<backspace><backspace>l").0.cursor, 1);
    }
}
