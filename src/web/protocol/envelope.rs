//! What every node of the scene and every control of the panel has around its props.

use serde::Serialize;

use super::{Key, Message};

/// How one sort of node looks.
pub trait NodeProps: Serialize {
    /// The message that makes one, as the wire calls it.
    const TYPE: &'static str;
}

/// A node of the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Node<P> {
    r#type: &'static str,
    /// Its path.
    pub name: String,
    /// Whose it is; empty for everybody's.
    pub owner: String,
    /// Whether it only holds a place.
    pub r#virtual: bool,
    /// How it looks.
    pub props: P,
}

impl<P: NodeProps> Node<P> {
    /// Everybody's, at a path.
    pub fn new(name: &str, props: P) -> Self {
        Self {
            r#type: P::TYPE,
            name: name.to_owned(),
            owner: String::new(),
            r#virtual: false,
            props,
        }
    }
}

impl<P: NodeProps> Message for Node<P> {
    fn key(&self) -> Key {
        Key::node(&self.name)
    }
}

/// How one sort of control looks.
pub trait ControlProps: Serialize {
    /// The message that makes one, as the wire calls it.
    const TYPE: &'static str;
    /// What it holds; `()` for nothing.
    type Value: Serialize;
}

/// A control of the panel, or what is only shown there.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(bound = "P: ControlProps")]
pub struct Control<P: ControlProps> {
    r#type: &'static str,
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// What it holds; none for what holds nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<P::Value>,
    /// How it looks.
    pub props: P,
}

impl<P: ControlProps> Control<P> {
    /// One in a container.
    pub fn new(uuid: &str, container_uuid: &str, value: Option<P::Value>, props: P) -> Self {
        Self {
            r#type: P::TYPE,
            uuid: uuid.to_owned(),
            container_uuid: container_uuid.to_owned(),
            value,
            props,
        }
    }
}

impl<P: ControlProps> Message for Control<P> {
    fn key(&self) -> Key {
        Key::gui(&self.uuid)
    }
}
