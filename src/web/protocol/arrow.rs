//! Arrows, each from one point to another.

use serde::Serialize;

use super::array::Array;
use super::envelope::NodeProps;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArrowProps {
    /// `<f4` (N, 2, 3): start and end of each.
    pub points: Array,
    /// `|u1` (N, 3), or (3) for all.
    pub colors: Array,
    /// Of the shaft.
    pub shaft_radius: f32,
    /// Of the head.
    pub head_radius: f32,
    /// Of the head, along the arrow.
    pub head_length: f32,
    /// Times as large.
    pub scale: f32,
}

impl NodeProps for ArrowProps {
    const TYPE: &'static str = "ArrowMessage";
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Node;
    use super::super::golden::{captured, holds};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_065_scene_arrows.bin";
        let props = &captured(name)[0]["props"];
        let numbers = |field: &str| -> Vec<f64> {
            let values = props[field]["values"].as_array().into_iter().flatten();
            values.filter_map(serde_json::Value::as_f64).collect()
        };
        let props = ArrowProps {
            points: Array::f32(numbers("points").into_iter().map(|it| it as f32)),
            colors: Array::u8(numbers("colors").into_iter().map(|it| it as u8)),
            shaft_radius: 0.03,
            head_radius: 0.08,
            head_length: 0.15,
            scale: 1.0,
        };
        holds(&Node::new("/arrows", props), name, 0);
    }
}
