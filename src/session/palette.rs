//! Everything there is to do, by name: the keymap's lines and what can be typed, filtered by what has been typed.

mod fuzzy;

use std::cmp::Reverse;

use serde::Serialize;

use super::keymap::{FaceCommand, Meaning, bindings};
use super::prompt::VERBS;
use super::snapshot::Snapshot;

/// What a face draws while a line is typed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PaletteView {
    /// What has been typed.
    pub line: String,
    /// What there is to choose, the best first.
    pub entries: Vec<PaletteEntry>,
    /// What Enter will do; none where it takes the line as it is typed.
    pub chosen: Option<usize>,
}

/// One thing to do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PaletteEntry {
    /// What it is called.
    pub name: String,
    /// The keys that do it without the palette; empty for none.
    pub keys: String,
    /// More about it.
    pub help: String,
}

/// An entry and how it is done.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub shown: PaletteEntry,
    pub does: Does,
}

/// How an entry is done.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Does {
    /// By pressing this key.
    Press(&'static str),
    /// By this line.
    Type(String),
    /// By this line with more after it.
    Begin(String),
}

/// The entries that fit a line, the best first; those that fit alike in the order of the tables.
pub(super) fn matching(line: &str, snapshot: &Snapshot) -> Vec<Entry> {
    let scored = all(snapshot).into_iter().filter_map(|entry| {
        let score = match &entry.does {
            // Its own words are being typed.
            Does::Begin(start) if line.starts_with(start.as_str()) => Some(i32::MAX),
            _ => fuzzy::score(line, &entry.shown.name),
        };
        Some((score?, entry))
    });
    let mut scored: Vec<(i32, Entry)> = scored.collect();
    scored.sort_by_key(|&(score, _)| Reverse(score));
    scored.into_iter().map(|(_, entry)| entry).collect()
}

fn all(snapshot: &Snapshot) -> Vec<Entry> {
    let mut entries = Vec::new();
    for binding in bindings() {
        let mut add = |key, keys: String, name: String| {
            let help = binding.group.to_owned();
            entries.push(Entry {
                shown: PaletteEntry { name, keys, help },
                does: Does::Press(key),
            });
        };
        match binding.meaning {
            // The palette itself, and what only makes sense beside it.
            Meaning::Line(_) | Meaning::Face(FaceCommand::Back) => {}
            Meaning::ExpertDigit => {
                let sensors = snapshot.experts.len().saturating_sub(1);
                for (key, view) in std::iter::zip(binding.keys, &snapshot.experts[..sensors]) {
                    let name = format!("switch {} off or on", view.expert.name());
                    add(*key, (*key).to_owned(), name);
                }
            }
            _ => add(binding.keys[0], binding.label(), binding.help.to_owned()),
        }
    }
    for verb in VERBS {
        let mut choices = (verb.choices)(snapshot);
        if choices.is_empty() && !verb.arguments.is_empty() {
            choices.push((String::new(), verb.arguments));
        }
        for (choice, wanted) in choices {
            let line = format!("{} {choice}", verb.word).trim_end().to_owned();
            let (name, does) = if wanted.is_empty() {
                (line.clone(), Does::Type(line))
            } else {
                (format!("{line} {wanted}"), Does::Begin(format!("{line} ")))
            };
            let (keys, help) = (verb.keys.to_owned(), verb.help.to_owned());
            entries.push(Entry {
                shown: PaletteEntry { name, keys, help },
                does,
            });
        }
    }
    entries
}
