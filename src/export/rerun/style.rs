//! Colours: one modality has one colour everywhere.

use ::rerun::components::{Color, MagnificationFilter};

/// Red, green and blue, sRGB.
pub(super) type Rgb = (u8, u8, u8);

/// Pixels are shown as they are.
pub(super) const NEAREST: MagnificationFilter = MagnificationFilter::Nearest;
/// What was recorded.
pub(super) const TRUTH: Rgb = (0xB8, 0xB8, 0xB8);
/// The belief's; light, since the viewer is dark.
pub(super) const BELIEF: Rgb = (0xF5, 0xF5, 0xF5);
/// The prediction's.
pub(super) const PREDICTION: Rgb = (0x56, 0xB4, 0xE9);
/// The plate.
pub(super) const PLATE: Rgb = (0x96, 0xA0, 0xAC);
/// The tip that pushes it.
pub(super) const TIP: Rgb = (0xE0, 0xE0, 0x90);

pub(super) fn color((r, g, b): Rgb) -> Color {
    Color::from_rgb(r, g, b)
}
