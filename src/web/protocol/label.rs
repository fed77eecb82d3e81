//! Text in the scene.

use serde::Serialize;

use super::envelope::NodeProps;

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

impl NodeProps for LabelProps {
    const TYPE: &'static str = "LabelMessage";
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Node;
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
            &Node::new("/box/label", props),
            "s2c_068_scene_label.bin",
            0,
        );
    }
}
