//! Lines on a plane.

use serde::Serialize;

use super::envelope::NodeProps;
use super::props::Rgb;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridProps {
    /// Along the first axis.
    pub width: f32,
    /// Along the second axis.
    pub height: f32,
    /// Both axes: `xy`.
    pub plane: &'static str,
    /// Of the fine lines.
    pub cell_color: Rgb,
    /// Of the fine lines.
    pub cell_thickness: f32,
    /// Between two fine lines.
    pub cell_size: f32,
    /// Of the bold lines.
    pub section_color: Rgb,
    /// Of the bold lines.
    pub section_thickness: f32,
    /// Between two bold lines.
    pub section_size: f32,
    /// Whether it has no end.
    pub infinite_grid: bool,
    /// Where it has faded.
    pub fade_distance: f32,
    /// How quickly it fades.
    pub fade_strength: f32,
    /// `camera` or `origin`.
    pub fade_from: &'static str,
    /// Of shadows on it.
    pub shadow_opacity: f32,
    /// Of the plane.
    pub plane_color: Rgb,
    /// Of the plane.
    pub plane_opacity: f32,
    /// Times as large.
    pub scale: f32,
}

impl NodeProps for GridProps {
    const TYPE: &'static str = "GridMessage";
}

impl Default for GridProps {
    fn default() -> Self {
        Self {
            width: 10.0,
            height: 10.0,
            plane: "xy",
            cell_color: [200; 3],
            cell_thickness: 1.0,
            cell_size: 0.5,
            section_color: [140; 3],
            section_thickness: 1.0,
            section_size: 1.0,
            infinite_grid: false,
            fade_distance: 100.0,
            fade_strength: 1.0,
            fade_from: "camera",
            shadow_opacity: 0.125,
            plane_color: [255; 3],
            plane_opacity: 0.0,
            scale: 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Node;
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let props = GridProps {
            width: 8.0,
            height: 8.0,
            cell_size: 0.5,
            section_size: 2.0,
            ..GridProps::default()
        };
        holds(&Node::new("/grid", props), "s2c_052_scene_grid.bin", 0);
    }
}
