//! Keys from one viewer: what the next one means is that viewer's own.

use serde_json::{Value, json};

use super::scene::face_name;
use crate::session::command::Command;
use crate::session::input::{Action, Input};
use crate::session::keys::Key;
use crate::session::snapshot::Snapshot;

/// One viewer's keys.
#[derive(Debug, Default)]
pub struct Talk {
    input: Input,
    /// The last press.
    number: u64,
    /// What the viewer's own face is to do for it.
    face: Option<String>,
    explain: Option<(bool, String)>,
}

impl Talk {
    /// Takes a key, as it is spelled.
    pub fn press(&mut self, spelling: &str, number: u64, snapshot: &Snapshot) -> Option<Command> {
        let action = match Key::of_spelling(spelling) {
            Ok(key) => self.input.press(&key, snapshot),
            Err(error) => Some(Action::Explain {
                error: true,
                text: error.to_string(),
            }),
        };
        self.answer(action, number)
    }

    /// Takes a whole line, as if it was typed after `:`.
    pub fn line(&mut self, line: &str, number: u64, snapshot: &Snapshot) -> Option<Command> {
        let mut input = Input::default();
        let typed = line.chars().filter(|c| !c.is_control()).map(Key::of_char);
        let enter = Key::named("enter").ok();
        let mut action = None;
        for key in std::iter::once(Key::of_char(':')).chain(typed).chain(enter) {
            action = input.press(&key, snapshot);
        }
        self.answer(action, number)
    }

    /// A mode's line follows the snapshot, so what is said may change without a key.
    pub fn is_in_mode(&self) -> bool {
        self.input.mode().is_some()
    }

    fn answer(&mut self, action: Option<Action>, number: u64) -> Option<Command> {
        self.number = number;
        (self.face, self.explain) = (None, None);
        match action? {
            Action::Session(command) => return Some(command),
            Action::Face(command) => self.face = Some(face_name(command)),
            Action::Explain { error, text } => self.explain = Some((error, text)),
        }
        None
    }

    /// Says that a viewer who may only look asked for more.
    pub fn refuse(&mut self) {
        self.explain = Some((true, "this viewer may only look".to_owned()));
    }

    /// What the viewer is told.
    pub fn told(&self, snapshot: &Snapshot) -> Value {
        json!({
            "n": self.number,
            "hint": self.input.hint(snapshot),
            "mode": self.is_in_mode(),
            "palette": self.input.palette(snapshot),
            "expert": self.input.focused_expert(),
            "face": self.face,
            "explain": self.explain.as_ref().map(|(error, text)| json!({ "error": error, "text": text })),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use super::*;
    use crate::session::Session;
    use crate::session::fake::{FakePredictor, FakeSource};

    fn snapshot() -> Snapshot {
        let source = Arc::new(FakeSource::new(3));
        let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
        assert!(session.wait_idle(Duration::from_secs(20)));
        session.snapshot()
    }

    #[test]
    fn keys_are_the_terminals() {
        let (snapshot, mut talk) = (snapshot(), Talk::default());
        assert_eq!(talk.press("l", 1, &snapshot), Some(Command::Step(1)));
        assert_eq!(talk.press("a", 2, &snapshot), None);
        let told = talk.told(&snapshot);
        assert_eq!((&told["n"], &told["mode"]), (&json!(2), &json!(true)));
        assert!(told["hint"].is_string());
        assert_eq!(talk.press("?", 3, &snapshot), None);
        assert_eq!(talk.told(&snapshot)["face"], "help");
        assert_eq!(talk.press("<nokey>", 4, &snapshot), None);
        let told = talk.told(&snapshot);
        assert_eq!(
            (&told["face"], &told["explain"]["error"]),
            (&Value::Null, &json!(true))
        );
    }

    #[test]
    fn a_line_does_what_it_says_in_the_terminal() {
        let (snapshot, mut talk) = (snapshot(), Talk::default());
        assert_eq!(talk.line("7", 1, &snapshot), Some(Command::SeekTo(7)));
        assert_eq!(talk.line("no such thing", 2, &snapshot), None);
        assert_eq!(talk.told(&snapshot)["explain"]["error"], json!(true));
        assert!(!talk.is_in_mode());
    }
}
