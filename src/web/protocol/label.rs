//! Text in the scene.

use serde::Serialize;

use super::about;

/// Text in the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "LabelMessage")]
pub struct Label {
    /// Its path.
    pub name: String,
    /// Whose it is; empty for everybody's.
    pub owner: String,
    /// Whether it only holds a place.
    pub r#virtual: bool,
    /// How it looks.
    pub props: LabelProps,
}

about!(Label, node name);

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LabelProps {
    /// What it says.
    pub text: String,
    /// `screen` or `scene`.
    pub font_size_mode: &'static str,
    /// Times as large on the screen.
    pub font_screen_scale: f32,
    /// Height in the scene.
    pub font_scene_height: f32,
    /// Whether what stands before it hides it.
    pub depth_test: bool,
    /// Which of its places stands at the node: `top-left`.
    pub anchor: &'static str,
}

impl Label {
    /// Everybody's, at a path.
    pub fn new(name: &str, props: LabelProps) -> Self {
        Self {
            name: name.to_owned(),
            owner: String::new(),
            r#virtual: false,
            props,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let props = LabelProps {
            text: "box label".to_owned(),
            font_size_mode: "screen",
            font_screen_scale: 1.0,
            font_scene_height: 0.075,
            depth_test: false,
            anchor: "bottom-center",
        };
        holds(
            &Label::new("/box/label", props),
            "s2c_068_scene_label.bin",
            0,
        );
    }
}
