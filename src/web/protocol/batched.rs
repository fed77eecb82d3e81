//! One solid in many places; a click says which.

use serde::Serialize;

use super::array::Array;
use super::envelope::NodeProps;
use super::props::Look;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BatchedProps {
    /// `<f4` (N, 4): how each is turned.
    pub batched_wxyzs: Array,
    /// `<f4` (N, 3): where each is.
    pub batched_positions: Array,
    /// `<f4` (N): how large each is; none for all as it is.
    pub batched_scales: Option<Array>,
    /// `auto` or `off`: whether it gets simpler in the distance.
    pub lod: &'static str,
    /// `<f4` (V, 3).
    pub vertices: Array,
    /// `<u4` (F, 3), counter-clockwise from outside.
    pub faces: Array,
    /// `|u1` (N, 3), or (3) for all.
    pub batched_colors: Array,
    /// What every solid has.
    #[serde(flatten)]
    pub look: Look,
    /// `<f4` (N); none for opaque.
    pub batched_opacities: Option<Array>,
    /// Times as large.
    pub scale: f32,
}

impl NodeProps for BatchedProps {
    const TYPE: &'static str = "BatchedMeshesMessage";
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Node;
    use super::super::golden::{captured, holds};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_067_scene_batched_meshes.bin";
        let props = &captured(name)[0]["props"];
        let numbers = |field: &str| -> Vec<f64> {
            let values = props[field]["values"].as_array().into_iter().flatten();
            values.filter_map(serde_json::Value::as_f64).collect()
        };
        let floats = |field| Array::f32(numbers(field).into_iter().map(|it| it as f32));
        let props = BatchedProps {
            batched_wxyzs: floats("batched_wxyzs"),
            batched_positions: floats("batched_positions"),
            batched_scales: Some(floats("batched_scales")),
            lod: "auto",
            vertices: floats("vertices"),
            faces: Array::u32(numbers("faces").into_iter().map(|it| it as u32)),
            batched_colors: Array::u8(numbers("batched_colors").into_iter().map(|it| it as u8)),
            look: Look::default(),
            batched_opacities: None,
            scale: 1.0,
        };
        holds(&Node::new("/batched", props), name, 0);
    }
}
