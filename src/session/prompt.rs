//! What can be typed after `:`.

use super::command::Command;
use super::input::Action;
use super::keymap::FaceCommand;
use super::snapshot::Snapshot;

/// Said by `:help`, and where a line makes no sense.
const USAGE: &str = ":42 goes to step 42; :episode 3, :model 2, :context 4, :horizon 11, :alpha vision 0.5, :state TEXT, :q";

/// The action of a line; a line of explanation where it has none.
pub fn action(line: &str, snapshot: &Snapshot) -> Action {
    let line = line.trim();
    let (word, rest) = line
        .split_once(' ')
        .map_or((line, ""), |(word, rest)| (word, rest.trim()));
    if let Ok(step) = line.parse() {
        return Action::Session(Command::SeekTo(step));
    }
    let number = || rest.parse::<usize>().ok();
    let command = match word {
        "q" | "quit" => return Action::Face(FaceCommand::Quit),
        "keys" => return Action::Face(FaceCommand::Help),
        "episode" => number()
            .and_then(|n| n.checked_sub(1))
            .map(Command::SelectEpisode),
        "model" => number()
            .and_then(|n| n.checked_sub(1))
            .map(Command::SelectModel),
        "context" => number().map(Command::SetContext),
        "horizon" => number().map(Command::SetHorizon),
        "alpha" => alpha(rest, snapshot),
        "state" => (!rest.is_empty()).then(|| Command::Restore(rest.to_owned())),
        "undo" => Some(Command::Undo),
        "redo" => Some(Command::Redo),
        _ => None,
    };
    match command {
        Some(command) => Action::Session(command),
        None if word == "help" => Action::Explain {
            error: false,
            text: USAGE.to_owned(),
        },
        None => Action::Explain {
            error: true,
            text: format!(":{line} means nothing; {USAGE}"),
        },
    }
}

fn alpha(text: &str, snapshot: &Snapshot) -> Option<Command> {
    let (name, alpha) = text.split_once(' ')?;
    let expert = snapshot
        .experts
        .iter()
        .position(|view| view.expert.name() == name)?;
    let alpha = alpha.trim().parse().ok()?;
    Some(Command::SetAlpha { expert, alpha })
}
