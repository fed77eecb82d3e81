//! The words, one by one.

use super::bench::{controls, corrupt, corruptions, set};
use super::{Choice, Verb, split, usage};
use crate::measure::failure::Order;
use crate::measure::protocol::Protocol;
use crate::session::command::Command;
use crate::session::input::Action;
use crate::session::keymap::{FaceCommand, VIEWS};
use crate::session::restore::{keys, model_key, model_named};
use crate::session::settings::SAMPLES;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::table::Column;

/// All of them, in the order of the palette.
pub(in crate::session) static VERBS: &[Verb] = &[
    Verb {
        word: "step",
        arguments: "N",
        help: "go to a step; the number alone does too",
        keys: "",
        choices: none,
        read: |rest, _| session(rest.parse().ok().map(Command::SeekTo)),
    },
    Verb {
        word: "view",
        arguments: "NAME",
        help: "go to a view",
        keys: "v",
        choices: |_| VIEWS.map(whole).to_vec(),
        read: |rest, _| {
            let view = VIEWS.into_iter().find(|view| *view == rest)?;
            Some(Action::Face(FaceCommand::View(view)))
        },
    },
    Verb {
        word: "corrupt",
        arguments: "MODALITY KIND SEVERITY",
        help: "damage an input; none mends it",
        keys: "x",
        choices: corruptions,
        read: |rest, snapshot| session(corrupt(rest, snapshot)),
    },
    Verb {
        word: "alpha",
        arguments: "EXPERT α",
        help: "temper an expert: 0 off, 1 as trained",
        keys: "a",
        choices: |snapshot| {
            let names = snapshot.experts.iter().map(|view| view.expert.name());
            names.map(|name| (name.to_owned(), "α")).collect()
        },
        read: |rest, snapshot| session(alpha(rest, snapshot)),
    },
    Verb {
        word: "set",
        arguments: "LETTERS",
        help: "exactly these experts, in the whole episode",
        keys: "",
        choices: none,
        read: |rest, snapshot| session(set(rest, snapshot)),
    },
    Verb {
        word: "controls",
        arguments: "turn DEGREES, scale FACTOR, mirror, stop or recorded",
        help: "predict with other controls",
        keys: "r",
        choices: |_| {
            let begun = [("turn", "DEGREES"), ("scale", "FACTOR")]
                .map(|(word, wanted)| (word.to_owned(), wanted));
            let others = ["mirror", "stop", "recorded"].map(whole);
            begun.into_iter().chain(others).collect()
        },
        read: |rest, snapshot| session(controls(rest, snapshot)),
    },
    Verb {
        word: "context",
        arguments: "N",
        help: "images seen before the rollout",
        keys: "c",
        choices: none,
        read: |rest, _| session(rest.parse().ok().map(Command::SetContext)),
    },
    Verb {
        word: "horizon",
        arguments: "N",
        help: "images predicted",
        keys: "C",
        choices: none,
        read: |rest, _| session(rest.parse().ok().map(Command::SetHorizon)),
    },
    Verb {
        word: "preset",
        arguments: "NAME",
        help: "images seen and predicted as in the paper: 4 and 11, or 5 and 37",
        keys: "c C",
        choices: |_| Protocol::NAMED.map(|(name, _)| whole(name)).to_vec(),
        read: |rest, _| {
            let mut named = Protocol::NAMED.iter();
            let found = named.find(|(name, _)| *name == rest);
            session(found.map(|&(_, protocol)| Command::Predict(protocol)))
        },
    },
    Verb {
        word: "samples",
        arguments: "N",
        help: "number of samples of the rollout",
        keys: "M",
        choices: none,
        read: |rest, _| {
            let count = rest.parse().ok().filter(|count| SAMPLES.contains(count));
            session(count.map(Command::SetSamples))
        },
    },
    Verb {
        word: "seed",
        arguments: "N",
        help: "seed of all noise",
        keys: "",
        choices: none,
        read: |rest, _| session(rest.parse().ok().map(Command::SetSeed)),
    },
    Verb {
        word: "model",
        arguments: "NAME or N",
        help: "show a model",
        keys: "( )",
        choices: |snapshot| models(snapshot, usize::MAX),
        read: |rest, snapshot| session(model(rest, snapshot).map(Command::SelectModel)),
    },
    Verb {
        word: "compare",
        arguments: "NAME or N",
        help: "show a model beside this one",
        keys: "",
        choices: |snapshot| models(snapshot, snapshot.model),
        read: |rest, snapshot| session(model(rest, snapshot).map(Command::CompareWith)),
    },
    Verb {
        word: "episode",
        arguments: "N or NAME",
        help: "go to an episode",
        keys: "[ ]",
        choices: none,
        read: |rest, snapshot| session(episode(rest, snapshot)),
    },
    Verb {
        word: "filter",
        arguments: "TEXT",
        help: "list only episodes with this; nothing for all",
        keys: "/",
        choices: none,
        read: |rest, _| session(Some(Command::Filter(rest.to_owned()))),
    },
    Verb {
        word: "sort",
        arguments: "COLUMN",
        help: "sort the episodes; again turns round",
        keys: "",
        choices: |_| Column::ALL.map(|column| whole(column.name())).to_vec(),
        read: |rest, _| {
            let column = Column::ALL.into_iter().find(|c| c.name() == rest);
            session(column.map(Command::SortBy))
        },
    },
    Verb {
        word: "rank",
        arguments: "ORDER",
        help: "what makes a failure",
        keys: "o",
        choices: |_| Order::ALL.map(|order| whole(order.name())).to_vec(),
        read: |rest, _| {
            let order = Order::from_name(rest);
            session(order.map(Command::RankBy))
        },
    },
    Verb {
        word: "state",
        arguments: "TEXT",
        help: "restore a state string",
        keys: "",
        choices: none,
        read: |rest, _| {
            let text = (!rest.is_empty()).then(|| rest.to_owned());
            session(text.map(Command::Restore))
        },
    },
    Verb {
        word: "recording",
        arguments: "",
        help: "what is odd about it, one after the other",
        keys: "",
        choices: |_| vec![(String::new(), "")],
        read: |rest, _| session(rest.is_empty().then_some(Command::Oddity)),
    },
    Verb {
        word: "help",
        arguments: "",
        help: "the words that can be typed",
        keys: "",
        choices: |_| vec![(String::new(), "")],
        read: |rest, _| {
            let text = usage();
            rest.is_empty()
                .then_some(Action::Explain { error: false, text })
        },
    },
    // What has a key has its line in the palette from there; these are for who types the word.
    bare("keys", |_, _| Some(Action::Face(FaceCommand::Help))),
    bare("quit", |_, _| Some(Action::Face(FaceCommand::Quit))),
    bare("undo", |_, _| session(Some(Command::Undo))),
    bare("redo", |_, _| session(Some(Command::Redo))),
];

const fn bare(word: &'static str, read: fn(&str, &Snapshot) -> Option<Action>) -> Verb {
    Verb {
        word,
        arguments: "",
        help: "",
        keys: "",
        choices: none,
        read,
    }
}

fn session(command: Option<Command>) -> Option<Action> {
    command.map(Action::Session)
}

fn none(_: &Snapshot) -> Vec<Choice> {
    Vec::new()
}

fn whole(name: &str) -> Choice {
    (name.to_owned(), "")
}

/// Every model but one; none where there is no choice.
fn models(snapshot: &Snapshot, but: usize) -> Vec<Choice> {
    let all = 0..snapshot.models.len();
    all.filter(|&model| model != but && snapshot.models.len() > 1)
        .map(|model| whole(&model_key(&snapshot.models, model)))
        .collect()
}

/// A model by its number from 1, else by its name.
fn model(text: &str, snapshot: &Snapshot) -> Option<usize> {
    match text.parse::<usize>() {
        Ok(number) => number.checked_sub(1),
        Err(_) => model_named(&snapshot.models, text),
    }
}

/// An episode by its name, which may be a number like `0007`; the second of one name is `name#2`; else by its number
/// from 1.
fn episode(text: &str, snapshot: &Snapshot) -> Option<Command> {
    let ids = snapshot.table.rows.iter().map(|row| row.id.as_str());
    let named = keys(ids).iter().position(|key| key == text);
    let numbered = || text.parse::<usize>().ok()?.checked_sub(1);
    named.or_else(numbered).map(Command::SelectEpisode)
}

fn alpha(text: &str, snapshot: &Snapshot) -> Option<Command> {
    let (name, alpha) = split(text);
    let expert = snapshot
        .experts
        .iter()
        .position(|view| view.expert.name() == name)?;
    let alpha = alpha.parse().ok()?;
    Some(Command::SetAlpha { expert, alpha })
}
