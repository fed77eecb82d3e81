//! Boxes, balls and cylinders.

use serde::Serialize;

use super::envelope::NodeProps;
use super::props::{Look, Rgb};

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CuboidProps {
    /// Lengths of its edges along x, y, z.
    pub dimensions: [f32; 3],
    /// Its colour.
    pub color: Rgb,
    /// What every solid has.
    #[serde(flatten)]
    pub look: Look,
    /// Times as large.
    pub scale: f32,
}

impl NodeProps for CuboidProps {
    const TYPE: &'static str = "BoxMessage";
}

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BallProps {
    /// Its radius.
    pub radius: f32,
    /// How round it is.
    pub subdivisions: u32,
    /// Its colour.
    pub color: Rgb,
    /// What every solid has.
    #[serde(flatten)]
    pub look: Look,
    /// Times as large.
    pub scale: f32,
}

impl NodeProps for BallProps {
    const TYPE: &'static str = "IcosphereMessage";
}

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CylinderProps {
    /// Its radius.
    pub radius: f32,
    /// Its height.
    pub height: f32,
    /// Its colour.
    pub color: Rgb,
    /// How round it is.
    pub radial_segments: u32,
    /// What every solid has.
    #[serde(flatten)]
    pub look: Look,
    /// Times as large.
    pub scale: f32,
}

impl NodeProps for CylinderProps {
    const TYPE: &'static str = "CylinderMessage";
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Node;
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn they_are_what_the_reference_sends() {
        let look = Look {
            flat_shading: true,
            ..Look::default()
        };
        let props = CuboidProps {
            dimensions: [0.6, 0.8, 1.0],
            color: [220, 60, 60],
            look,
            scale: 1.0,
        };
        holds(&Node::new("/box", props), "s2c_055_scene_box.bin", 0);
        let look = Look {
            opacity: Some(0.6),
            ..Look::default()
        };
        let props = BallProps {
            radius: 0.4,
            subdivisions: 2,
            color: [60, 160, 60],
            look,
            scale: 1.0,
        };
        holds(&Node::new("/ico", props), "s2c_056_scene_icosphere.bin", 0);
        let props = CylinderProps {
            radius: 0.3,
            height: 0.9,
            color: [70, 90, 220],
            radial_segments: 24,
            look: Look::default(),
            scale: 1.0,
        };
        holds(&Node::new("/cyl", props), "s2c_057_scene_cylinder.bin", 0);
    }
}
