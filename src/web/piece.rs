//! What a client shows is made of pieces: elements, nodes, and facts about the client. A piece is a written message,
//! taken apart so that a later one can be compared with it field by field.

use std::collections::BTreeMap;
use std::ops::Range;

use super::protocol::array::Written;
use super::protocol::node::{NodeUpdate, RemoveNode};
use super::protocol::pack::entries;
use super::protocol::update::{Remove, Update};
use super::protocol::{Key, Kind, Message, write};

/// One piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// What it is about.
    pub key: Key,
    /// The whole message.
    pub written: Vec<u8>,
    /// The parts that can be changed one by one: where they stand in `written`.
    parts: Vec<(String, Range<usize>)>,
}

impl Piece {
    /// Of a message.
    pub fn of(message: &impl Message) -> Self {
        let written = write(message);
        let key = message.key();
        let parts = if key.part.is_empty() {
            parts(&written).unwrap_or_default()
        } else {
            Vec::new()
        };
        Self {
            key,
            written,
            parts,
        }
    }

    /// A part as written.
    pub fn part(&self, name: &str) -> Option<&[u8]> {
        let found = self.parts.iter().find(|(part, _)| part == name);
        found.map(|(_, range)| &self.written[range.clone()])
    }

    /// What makes this piece of an earlier one of the same key; nothing where they are equal.
    pub fn changes_since(&self, earlier: &Self) -> Vec<Change> {
        if self.written == earlier.written {
            return Vec::new();
        }
        if self.parts.is_empty() || self.rest() != earlier.rest() {
            return vec![self.making()];
        }
        let changed = self.parts.iter().filter_map(|(name, range)| {
            let now = &self.written[range.clone()];
            let was = earlier.part(name);
            (was != Some(now)).then(|| Change {
                key: self.key.part(name),
                does: Does::Set(now.to_vec()),
            })
        });
        changed.collect()
    }

    /// The piece as a change of nothing.
    pub fn making(&self) -> Change {
        Change {
            key: self.key.clone(),
            does: Does::Make(self.written.clone()),
        }
    }

    /// Its end; none for what only stops being said.
    pub fn end(&self) -> Option<Change> {
        let id = self.key.id.as_str();
        let written = match self.key.kind {
            _ if !self.key.part.is_empty() => return None,
            Kind::Gui => write(&Remove { uuid: id }),
            Kind::Node => write(&RemoveNode {
                name: id,
                owner: "",
            }),
            Kind::Note | Kind::Client => return None,
        };
        Some(Change {
            key: self.key.clone(),
            does: Does::Make(written),
        })
    }

    /// All but the parts: what it is and where it stands.
    fn rest(&self) -> Vec<&[u8]> {
        let mut rest = Vec::new();
        let mut at = 0;
        for (_, range) in &self.parts {
            rest.push(&self.written[at..range.start]);
            at = range.end;
        }
        rest.push(&self.written[at..]);
        rest
    }
}

/// The value and the props of a written message, in the order in which they stand there.
fn parts(written: &[u8]) -> Option<Vec<(String, Range<usize>)>> {
    let place = |value: &[u8]| {
        let start = value.as_ptr() as usize - written.as_ptr() as usize;
        start..start + value.len()
    };
    let mut parts = Vec::new();
    for (name, value) in entries(written)? {
        match name {
            "value" => parts.push((name.to_owned(), place(value))),
            "props" => {
                let props = entries(value)?.into_iter();
                parts.extend(props.map(|(name, value)| (name.to_owned(), place(value))));
            }
            _ => {}
        }
    }
    Some(parts)
}

/// One thing that a client is to be told.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What it is about.
    pub key: Key,
    /// What happens to it.
    pub does: Does,
}

/// What happens to a piece.
#[derive(Clone, Debug, PartialEq)]
pub enum Does {
    /// It is made, replaced or taken away by this message.
    Make(Vec<u8>),
    /// One part of it has this value now.
    Set(Vec<u8>),
}

/// The messages that tell some changes, in their order; parts of one thing share a message.
pub fn messages<'a>(changes: impl IntoIterator<Item = &'a Change>) -> Vec<Vec<u8>> {
    let mut messages: Vec<Telling> = Vec::new();
    let mut places: BTreeMap<(Kind, &str), usize> = BTreeMap::new();
    for change in changes {
        let thing = (change.key.kind, change.key.id.as_str());
        match &change.does {
            Does::Make(written) => {
                places.remove(&thing);
                messages.push(Telling::Whole(written));
            }
            Does::Set(value) => {
                let place = *places.entry(thing).or_insert_with(|| {
                    messages.push(Telling::Parts(thing, BTreeMap::new()));
                    messages.len() - 1
                });
                if let Some(Telling::Parts(_, parts)) = messages.get_mut(place) {
                    parts.insert(&change.key.part, Written(value));
                }
            }
        }
    }
    messages.into_iter().map(Telling::write).collect()
}

enum Telling<'a> {
    Whole(&'a [u8]),
    Parts((Kind, &'a str), BTreeMap<&'a str, Written<'a>>),
}

impl Telling<'_> {
    fn write(self) -> Vec<u8> {
        match self {
            Self::Whole(written) => written.to_vec(),
            Self::Parts((Kind::Node, name), updates) => write(&NodeUpdate {
                name,
                updates,
                owner: "",
            }),
            Self::Parts((_, uuid), updates) => write(&Update { uuid, updates }),
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use serde_json::{Value, json};

    use super::super::protocol::checkbox::CheckboxProps;
    use super::super::protocol::envelope::Control;
    use super::super::protocol::props::Base;
    use super::super::protocol::{batch, frame};
    use super::*;

    fn switch(value: bool, label: &str, container: &str) -> Piece {
        let props = CheckboxProps {
            base: Base::new(1.0, label),
        };
        Piece::of(&Control::new("s", container, Some(value), props))
    }

    fn told(changes: &[Change]) -> Vec<Value> {
        let messages = messages(changes);
        let frame = batch::encode(messages.iter().map(Vec::as_slice), 0.0).unwrap();
        frame::read(&frame).unwrap().messages
    }

    #[test]
    fn only_what_is_other_is_told_and_in_one_message() {
        let before = switch(true, "a", "root");
        assert_eq!(before.changes_since(&before.clone()), []);
        let changes = switch(false, "b", "root").changes_since(&before);
        let expected = json!({"type": "GuiUpdateMessage", "uuid": "s", "updates": {"value": false, "label": "b"}});
        assert_eq!(told(&changes), [expected]);
    }

    #[test]
    fn what_cannot_be_changed_is_made_again() {
        let before = switch(true, "a", "root");
        let changes = switch(true, "a", "folder").changes_since(&before);
        let told = told(&changes);
        assert_eq!(
            (told.len(), &told[0]["type"]),
            (1, &json!("GuiCheckboxMessage"))
        );
    }

    #[test]
    fn an_end_is_told_by_kind() {
        let end = switch(true, "a", "root").end().unwrap();
        assert_eq!(
            told(&[end]),
            [json!({"type": "GuiRemoveMessage", "uuid": "s"})]
        );
    }
}
