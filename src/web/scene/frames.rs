//! The images at the cursor.

use super::panel::Panel;
use super::pictures::Pictures;
use super::png::ERROR_RANGE;
use crate::session::snapshot::{ErrorOf, Snapshot};

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot, pictures: &mut Pictures) {
    let frames = &snapshot.frames;
    panel.folder("frames", "Frames", true);
    panel.image("frame-truth", "truth", pictures.grey(frames.truth.as_ref()));
    panel.image(
        "frame-input",
        "input (damaged)",
        pictures.grey(frames.input.as_ref()),
    );
    panel.image(
        "frame-belief",
        "belief",
        pictures.grey(frames.belief.as_ref()),
    );
    panel.image(
        "frame-prediction",
        "prediction",
        pictures.grey(frames.prediction.as_ref()),
    );
    let of = match frames.error_of {
        ErrorOf::Belief => "belief",
        ErrorOf::Prediction => "prediction",
    };
    let label = format!("error of {of}: blue −{ERROR_RANGE}, orange +{ERROR_RANGE}");
    panel.image(
        "frame-error",
        &label,
        pictures.signed(frames.error.as_ref()),
    );
}
