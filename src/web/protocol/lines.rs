//! Straight lines, each from one point to another.

use serde::Serialize;

use super::array::Array;
use super::envelope::NodeProps;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinesProps {
    /// `<f4` (N, 2, 3): both ends of each.
    pub points: Array,
    /// In `thickness_units`.
    pub thickness: f32,
    /// `|u1` (N, 2, 3), or (3) for all.
    pub colors: Array,
    /// Times as large.
    pub scale: f32,
    /// `screen` for pixels, `world` for units of the scene.
    pub thickness_units: &'static str,
}

impl NodeProps for LinesProps {
    const TYPE: &'static str = "LineSegmentsMessage";
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Node;
    use super::super::golden::{captured, holds};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_060_scene_line_segments_uniform.bin";
        let props = &captured(name)[0]["props"];
        let numbers = |field: &str| -> Vec<f64> {
            let values = props[field]["values"].as_array().into_iter().flatten();
            values.filter_map(serde_json::Value::as_f64).collect()
        };
        let props = LinesProps {
            points: Array::f32(numbers("points").into_iter().map(|it| it as f32)),
            thickness: 0.01,
            colors: Array::u8(numbers("colors").into_iter().map(|it| it as u8)),
            scale: 1.0,
            thickness_units: "world",
        };
        holds(&Node::new("/segments1", props), name, 0);
    }
}
