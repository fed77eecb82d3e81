//! Where a node is, how it is turned, and whether it is seen.

use serde::Serialize;

use super::about;

/// Where a node is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetPositionMessage")]
pub struct Position {
    /// Whose.
    pub name: String,
    /// In its parent's frame.
    pub position: [f32; 3],
    /// Whose the node is.
    pub owner: String,
}

about!(Position, "SetPositionMessage" of node name);

/// How a node is turned.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetOrientationMessage")]
pub struct Orientation {
    /// Whose.
    pub name: String,
    /// A unit quaternion, from the node to its parent.
    pub wxyz: [f32; 4],
    /// Whose the node is.
    pub owner: String,
}

about!(Orientation, "SetOrientationMessage" of node name);

/// Whether a node is seen.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetSceneNodeVisibilityMessage")]
pub struct Visibility {
    /// Whose.
    pub name: String,
    /// Whether it and what is below it is seen.
    pub visible: bool,
    /// Whose the node is.
    pub owner: String,
}

about!(Visibility, "SetSceneNodeVisibilityMessage" of node name);

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn they_are_what_the_reference_sends() {
        let (name, owner) = ("/box".to_owned(), String::new());
        let position = [1.5, 0.3, 0.5];
        let message = Position {
            name: name.clone(),
            position,
            owner: owner.clone(),
        };
        holds(&message, "s2c_074_scene_set_position.bin", 0);
        let wxyz = [0.923_879_5, 0.0, 0.0, 0.382_683_4];
        let message = Orientation {
            name,
            wxyz,
            owner: owner.clone(),
        };
        holds(&message, "s2c_075_scene_set_orientation.bin", 0);
        let message = Visibility {
            name: "/a/b/c".to_owned(),
            visible: false,
            owner,
        };
        holds(&message, "s2c_076_scene_set_visibility.bin", 0);
    }
}
