//! The one table of keys: what terminal, browser, help and README all follow.

mod table;

use std::fmt::Write;

use super::command::Command;
use table::BINDINGS;
pub use table::VIEWS;

/// What a key means.
#[derive(Clone, Debug, PartialEq)]
pub enum Meaning {
    /// A command to the session.
    Session(Command),
    /// Something only the face can do.
    Face(FaceCommand),
    /// Switch the expert of this digit.
    ExpertDigit,
    /// Switch the prior, wherever it stands in the model's list.
    Prior,
    /// So many models on.
    Model(i64),
    /// The keys after it mean something else.
    Mode(Mode),
    /// The keys after it are a line of text that begins with this.
    Line(&'static str),
}

/// What only a face can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceCommand {
    /// Show or hide the keys.
    Help,
    /// End.
    Quit,
    /// Next pane.
    FocusNext,
    /// Previous pane.
    FocusPrevious,
    /// The focused pane alone, or all of them.
    Zoom,
    /// Close what is open.
    Back,
    /// Next view.
    NextView,
    /// The view of this name, one of [`VIEWS`].
    View(&'static str),
    /// What two models differ by, or no longer.
    Difference,
    /// Model A and model B by turns, or no longer.
    Blink,
    /// Model A on the left of a line, model B on its right, or no longer.
    Wipe,
    /// The list of episodes, or no longer.
    Episodes,
    /// Copy the state string.
    CopyState,
    /// Write what is shown as a file.
    Export,
}

/// What the keys after this one are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// The digit of the only sensor to leave on.
    Solo,
    /// Change α of an expert.
    Temper,
    /// Change c.
    Context,
    /// Change h.
    Horizon,
    /// Damage what an expert sees.
    Corrupt,
    /// Predict with other controls.
    Controls,
    /// Change the number of samples.
    Samples,
    /// A line of text, with commands to choose from.
    Prompt,
}

/// One line of the table.
#[derive(Clone, Debug)]
pub struct Binding {
    /// The keys, as [`super::keys::Key::name`] spells them.
    pub keys: &'static [&'static str],
    /// What each of them does.
    pub meaning: Meaning,
    /// Where help lists it.
    pub group: &'static str,
    /// What help says.
    pub help: &'static str,
}

/// The table, in the order of help.
pub fn bindings() -> &'static [Binding] {
    BINDINGS
}

/// The line of a key, if it has one.
pub fn lookup(key: &str) -> Option<&'static Binding> {
    BINDINGS.iter().find(|binding| binding.keys.contains(&key))
}

/// The groups of help with their lines, in order.
pub fn groups() -> Vec<(&'static str, Vec<&'static Binding>)> {
    let mut groups: Vec<(&'static str, Vec<&'static Binding>)> = Vec::new();
    for binding in BINDINGS {
        match groups.last_mut() {
            Some((group, lines)) if *group == binding.group => lines.push(binding),
            _ => groups.push((binding.group, vec![binding])),
        }
    }
    groups
}

impl Binding {
    /// Its keys as people write them: `Space`, `← , h`, `1 … 8`.
    pub fn label(&self) -> String {
        let labels: Vec<String> = self.keys.iter().map(|key| key_label(key)).collect();
        match labels.as_slice() {
            [first, .., last] if self.meaning == Meaning::ExpertDigit => {
                format!("{first} … {last}")
            }
            _ => labels.join(" "),
        }
    }
}

/// A key as people write it: `Space`, `Shift+←`, `Ctrl+R`.
pub fn key_label(key: &str) -> String {
    let Some(name) = key
        .strip_prefix('<')
        .and_then(|rest| rest.strip_suffix('>'))
    else {
        return key.to_owned();
    };
    if let Some(name) = name.strip_prefix("s-") {
        return format!("Shift+{}", key_label(&format!("<{name}>")));
    }
    if let Some(name) = name.strip_prefix("c-") {
        return format!("Ctrl+{}", name.to_uppercase());
    }
    match name {
        "left" => "←".to_owned(),
        "right" => "→".to_owned(),
        "up" => "↑".to_owned(),
        "down" => "↓".to_owned(),
        name => {
            let mut chars = name.chars();
            let first = chars.next().map(|c| c.to_ascii_uppercase());
            first.into_iter().chain(chars).collect()
        }
    }
}

/// The table as Markdown, for the README.
pub fn markdown() -> String {
    let mut table = String::from("| | keys | |\n| --- | --- | --- |\n");
    for (group, lines) in groups() {
        for (i, binding) in lines.iter().enumerate() {
            let group = if i == 0 { group } else { "" };
            let keys: Vec<String> = binding.label().split(' ').map(code).collect();
            // Writing to a string cannot fail.
            let _ = writeln!(table, "| {group} | {} | {} |", keys.join(" "), binding.help);
        }
    }
    table
}

fn code(key: &str) -> String {
    if key == "…" {
        key.to_owned()
    } else {
        format!("`{key}`")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::keys::Key;

    #[test]
    fn every_key_has_one_meaning_and_a_canonical_name() {
        let mut seen = Vec::new();
        for key in bindings().iter().flat_map(|binding| binding.keys) {
            assert_eq!(
                Key::of_spelling(key).map(|k| k.name().to_owned()),
                Ok((*key).to_owned())
            );
            assert!(!seen.contains(key), "{key} is bound twice");
            seen.push(*key);
        }
    }

    #[test]
    fn each_group_is_listed_once() {
        let names: Vec<&str> = groups().into_iter().map(|(group, _)| group).collect();
        let mut once = names.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!((once.len(), names.len()), (6, 6), "{names:?}");
    }

    #[test]
    fn labels_are_what_people_write() {
        let label = |key: &str| lookup(key).map(Binding::label).unwrap_or_default();
        assert_eq!(label("<space>"), "Space");
        assert_eq!(label("<"), "Shift+← <");
        assert_eq!(label("3"), "1 … 8");
        assert_eq!(label("<c-r>"), "Ctrl+R");
        assert!(markdown().contains("| Fusion | `1` … `8` | switch a sensor expert off or on |"));
    }
}
