//! What many messages have in common.

use serde::Serialize;

/// A colour as sRGB bytes.
pub type Rgb = [u8; 3];

/// Props of every control.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Base {
    /// Place in its container, ascending.
    pub order: f64,
    /// What stands beside it.
    pub label: String,
    /// What a pointer over it shows.
    pub hint: Option<String>,
    /// Whether it is there at all.
    pub visible: bool,
    /// Whether it takes no input.
    pub disabled: bool,
}

impl Base {
    /// Visible, taking input, without a hint.
    pub fn new(order: f64, label: &str) -> Self {
        Self {
            order,
            label: label.to_owned(),
            hint: None,
            visible: true,
            disabled: false,
        }
    }
}

/// Props of every solid.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "so are they on the wire")]
pub struct Look {
    /// Edges only.
    pub wireframe: bool,
    /// 0 to 1; none for opaque.
    pub opacity: Option<f32>,
    /// Whether each face has one shade.
    pub flat_shading: bool,
    /// `front`, `back` or `double`.
    pub side: &'static str,
    /// `standard`, `toon3` or `toon5`.
    pub material: &'static str,
    /// Whether it throws a shadow.
    pub cast_shadow: bool,
    /// Whether shadows fall on it.
    pub receive_shadow: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            wireframe: false,
            opacity: None,
            flat_shading: false,
            side: "front",
            material: "standard",
            cast_shadow: true,
            receive_shadow: true,
        }
    }
}
