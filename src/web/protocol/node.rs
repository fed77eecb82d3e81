//! Changes of nodes that are there, what clicks on them do, and their end.

use std::collections::BTreeMap;

use serde::Serialize;

use super::about;
use super::array::Written;

/// Other props of a node.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename = "SceneNodeUpdateMessage")]
pub struct NodeUpdate<'a> {
    /// Whose.
    pub name: &'a str,
    /// What, by name.
    pub updates: BTreeMap<&'a str, Written<'a>>,
    /// Whose the node is.
    pub owner: &'a str,
}

/// The end of a node and of what is below it.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename = "RemoveSceneNodeMessage")]
pub struct RemoveNode<'a> {
    /// Whose.
    pub name: &'a str,
    /// Whose the node is.
    pub owner: &'a str,
}

/// Which clicks on a node are told.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetSceneNodeClickBindingsMessage")]
pub struct Clicks {
    /// Whose.
    pub name: String,
    /// All of them; empty for none.
    pub bindings: Vec<Binding>,
    /// Whose the node is.
    pub owner: String,
}

about!(Clicks, "SetSceneNodeClickBindingsMessage" of node name);

/// One kind of click.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Binding {
    /// `left`, `middle` or `right`.
    pub button: &'static str,
    /// The keys that are held; none for none.
    pub modifier: Option<&'static str>,
}

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::super::write;
    use super::*;

    #[test]
    fn they_are_what_the_reference_sends() {
        let color = write(&[250, 120, 60]);
        let updates = BTreeMap::from([("color", Written(&color))]);
        let update = NodeUpdate {
            name: "/box",
            updates,
            owner: "",
        };
        holds(&update, "s2c_078_scene_update_props.bin", 0);
        let end = RemoveNode {
            name: "/arrows",
            owner: "",
        };
        holds(&end, "s2c_089_scene_remove.bin", 0);
        let clicks = Clicks {
            name: "/box".to_owned(),
            bindings: vec![Binding {
                button: "left",
                modifier: None,
            }],
            owner: String::new(),
        };
        holds(&clicks, "s2c_084_scene_click_bindings.bin", 0);
    }
}
