//! What can be typed after `:`. One table: what reads a line, what lists it and what `:help` says all follow it.

mod bench;
mod verbs;

use super::command::Command;
use super::input::Action;
use super::snapshot::Snapshot;
pub(super) use verbs::VERBS;

/// A word that can be typed, with what belongs after it.
pub(super) struct Verb {
    /// The word.
    pub word: &'static str,
    /// What belongs after it, as help writes it; empty for nothing.
    pub arguments: &'static str,
    /// What it does.
    pub help: &'static str,
    /// The key that does much the same.
    pub keys: &'static str,
    /// What may stand after the word, where that can be listed.
    pub choices: fn(&Snapshot) -> Vec<Choice>,
    /// What a line means by what stands after the word.
    pub read: fn(&str, &Snapshot) -> Option<Action>,
}

/// Something that may stand after a word: what to type, and what is still to be typed after it, empty for nothing.
pub(super) type Choice = (String, &'static str);

/// The action of a line that makes sense.
pub(super) fn understood(line: &str, snapshot: &Snapshot) -> Option<Action> {
    if let Ok(step) = line.trim().parse() {
        return Some(Action::Session(Command::SeekTo(step)));
    }
    let (word, rest) = split(line);
    (verb(word)?.read)(rest, snapshot)
}

/// Why a line makes no sense: what its word wants, or the words there are.
pub(super) fn why_not(line: &str) -> String {
    let line = line.trim();
    match verb(split(line).0) {
        Some(verb) => format!(":{line} is not :{} {}", verb.word, verb.arguments),
        None => format!(":{line} means nothing; {}", usage()),
    }
}

/// Every word, for `:help`.
fn usage() -> String {
    let words: Vec<&str> = VERBS.iter().map(|verb| verb.word).collect();
    format!("a number goes to that step; or one of {}", words.join(", "))
}

fn verb(word: &str) -> Option<&'static Verb> {
    let word = match word {
        "q" => "quit",
        word => word,
    };
    VERBS.iter().find(|verb| verb.word == word)
}

/// The first word of a line, and the rest.
fn split(line: &str) -> (&str, &str) {
    let line = line.trim();
    line.split_once(char::is_whitespace)
        .map_or((line, ""), |(word, rest)| (word, rest.trim()))
}
