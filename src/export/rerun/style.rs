//! Colours and names of series: one modality has one colour everywhere.

use ::rerun::components::{Color, MagnificationFilter};
use ::rerun::{RecordingStream, RecordingStreamResult, SeriesLines};

use crate::modality::Expert;

/// Pixels are shown as they are.
pub(super) const NEAREST: MagnificationFilter = MagnificationFilter::Nearest;
/// What was recorded.
pub(super) const TRUTH: (u8, u8, u8) = (0xB8, 0xB8, 0xB8);
/// The belief's; light, since the viewer is dark.
pub(super) const BELIEF: (u8, u8, u8) = (0xF5, 0xF5, 0xF5);
/// The prediction's.
pub(super) const PREDICTION: (u8, u8, u8) = (0x56, 0xB4, 0xE9);

pub(super) fn color((r, g, b): (u8, u8, u8)) -> Color {
    Color::from_rgb(r, g, b)
}

pub(super) fn of_expert(expert: Expert) -> Color {
    color(expert.rgb())
}

/// Names the series of an entity; one colour makes all of them alike, none leaves it to the viewer.
pub(super) fn series(
    stream: &RecordingStream,
    path: &str,
    names: impl IntoIterator<Item = String>,
    color: Option<Color>,
) -> RecordingStreamResult<()> {
    let lines = SeriesLines::new().with_names(names);
    match color {
        Some(color) => stream.log_static(path, &lines.with_colors([color])),
        None => stream.log_static(path, &lines),
    }
}
