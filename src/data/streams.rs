//! Which channels of a file can be read, and as what.

use std::collections::BTreeMap;

use super::collect::Stream;
use super::index::{Channel, Index};
use super::message_type::MessageType;
use super::report::LeftOut;
use super::schema;
use super::topics::{NOTES, Role, Topics};

/// The channels of a file, sorted out.
pub(super) struct Streams {
    pub(super) readable: BTreeMap<u16, Stream>,
    pub(super) left_out: Vec<LeftOut>,
    pub(super) notes: Vec<String>,
}

/// Sorts out the channels of `index`.
pub(super) fn find(index: &Index, topics: &Topics) -> Streams {
    let mut found = Streams {
        readable: BTreeMap::new(),
        left_out: Vec::new(),
        notes: Vec::new(),
    };
    let mut noted = 0;
    for (&id, channel) in &index.channels {
        if topics.role(&channel.topic).is_none() && channel.topic.starts_with(NOTES) {
            noted += 1;
            continue;
        }
        let read = match topics.role(&channel.topic) {
            Some(role) => stream(index, channel, role, &mut found.notes),
            None => Err(
                "has no role; give it one with --topic ROLE=TOPIC or in dataset.toml".to_owned(),
            ),
        };
        match read {
            Ok(stream) => {
                found.readable.insert(id, stream);
            }
            Err(why) => found.left_out.push(LeftOut {
                what: channel.topic.clone(),
                why,
            }),
        }
    }
    if noted > 0 {
        found.notes.push(format!(
            "{noted} channels under {NOTES} are what models made of it, from an export; they are not read"
        ));
    }
    found
}

/// How to read `channel` as `role`.
///
/// # Errors
/// A phrase that says why it cannot be.
fn stream(
    index: &Index,
    channel: &Channel,
    role: Role,
    notes: &mut Vec<String>,
) -> Result<Stream, String> {
    let schema = index
        .schemas
        .get(&channel.schema_id)
        .ok_or("has no schema, so its type is unknown; record it with its definition")?;
    if channel.encoding != "cdr" {
        return Err(format!(
            "has type {}, encoded as {:?}; only cdr can be read",
            schema.name, channel.encoding
        ));
    }
    let accepted = role.types();
    let ty = MessageType::from_name(&schema.name).filter(|ty| accepted.contains(ty));
    let Some(ty) = ty else {
        let names: Vec<_> = accepted.iter().map(|ty| ty.name()).collect();
        return Err(format!(
            "has type {}; as {} it can be {}",
            schema.name,
            role.name(),
            names.join(" or ")
        ));
    };
    if schema.text.is_empty() {
        notes.push(format!(
            "{}: the file has no definition of {}, so the built-in one is used",
            channel.topic,
            ty.name()
        ));
        return Ok(Stream { role, ty });
    }
    if schema.encoding != "ros2msg" {
        return Err(format!(
            "has type {}, defined in {:?}; only ros2msg can be read",
            schema.name, schema.encoding
        ));
    }
    let text = std::str::from_utf8(&schema.text)
        .map_err(|_| format!("has type {}, but its definition is no text", schema.name))?;
    schema::check(ty, text).map_err(|why| format!("has type {}, but {why}", schema.name))?;
    Ok(Stream { role, ty })
}
