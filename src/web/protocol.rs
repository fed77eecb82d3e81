//! viser's websocket protocol of version 1.1.1: one struct a message, written and framed.
//!
//! The structs have the names and fields of the wire; each is checked field for field against a frame of the
//! reference server. [`write`] makes msgpack of one, [`batch`] makes a frame of many, [`inbound`] reads what clients say.

pub mod array;
pub mod arrow;
pub mod batch;
pub mod batched;
pub mod button;
pub mod camera;
pub mod checkbox;
pub mod dropdown;
pub mod envelope;
pub mod folder;
pub mod frame;
pub mod grid;
pub mod html;
pub mod image;
pub mod inbound;
pub mod label;
pub mod lines;
pub mod markdown;
pub mod node;
pub mod notification;
pub mod pack;
pub mod panel;
pub mod pose;
pub mod progress;
pub mod props;
pub mod replay;
pub mod shapes;
pub mod slider;
pub mod text;
pub mod theme;
pub mod update;
pub mod uplot;

#[cfg(test)]
mod golden;

use serde::Serialize;

/// The subprotocol of the client this server speaks to.
pub const SUBPROTOCOL: &str = "viser-v1.1.1";
/// The same words under another name: 1.1.0 differs in a message that is never sent here.
pub const ALSO: &str = "viser-v1.1.0";
/// What every version's subprotocol begins with.
pub const PREFIX: &str = "viser-v";
/// The container of the main panel.
pub const ROOT: &str = "root";

/// What a message is about: a newer message of the same key makes an unsent older one needless.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    /// Of what sort.
    pub kind: Kind,
    /// The uuid or the name.
    pub id: String,
    /// Which part of it; empty for its making and its end.
    pub part: String,
}

/// Sorts of things that messages are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// An element of the panel, by uuid.
    Gui,
    /// A node of the scene, by name.
    Node,
    /// A notification, by uuid.
    Note,
    /// The client as a whole, by the message's type.
    Client,
}

impl Key {
    /// Of an element.
    pub fn gui(uuid: &str) -> Self {
        Self::new(Kind::Gui, uuid, "")
    }

    /// Of a node.
    pub fn node(name: &str) -> Self {
        Self::new(Kind::Node, name, "")
    }

    /// Of a notification.
    pub fn note(uuid: &str) -> Self {
        Self::new(Kind::Note, uuid, "")
    }

    /// Of the client as a whole.
    pub fn client(what: &str) -> Self {
        Self::new(Kind::Client, what, "")
    }

    fn new(kind: Kind, id: &str, part: &str) -> Self {
        let (id, part) = (id.to_owned(), part.to_owned());
        Self { kind, id, part }
    }

    /// Of a part of the same thing.
    #[must_use]
    pub fn part(&self, part: &str) -> Self {
        Self::new(self.kind, &self.id, part)
    }

    /// Whether both are about one thing.
    pub fn same_thing(&self, other: &Self) -> bool {
        self.kind == other.kind && self.id == other.id
    }
}

/// A message to a client that stays true until another one of its key.
pub trait Message: Serialize {
    /// What it is about.
    fn key(&self) -> Key;
}

/// Writes a message as msgpack.
pub fn write(message: &impl Serialize) -> Vec<u8> {
    // Writing to memory cannot fail, and no message here refuses to be written.
    rmp_serde::to_vec_named(message).unwrap_or_default()
}

/// Says what a message is about.
macro_rules! about {
    ($message:ty, $part:literal of node $field:ident) => {
        impl $crate::web::protocol::Message for $message {
            fn key(&self) -> $crate::web::protocol::Key {
                $crate::web::protocol::Key::node(&self.$field).part($part)
            }
        }
    };
    ($message:ty, $part:literal of client) => {
        impl $crate::web::protocol::Message for $message {
            fn key(&self) -> $crate::web::protocol::Key {
                $crate::web::protocol::Key::client($part)
            }
        }
    };
}
use about;
