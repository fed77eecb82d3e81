//! The images at the cursor.

use super::panel::Panel;
use super::pictures::{Pace, Pictures};
use crate::measure::frame::ERROR_RANGE;
use crate::session::snapshot::{ErrorOf, Snapshot};

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot, pictures: &mut Pictures, pace: &mut Pace) {
    let frames = &snapshot.frames;
    panel.folder("frames", "Frames", true);
    let greys = [
        ("frame-truth", "truth", &frames.truth),
        ("frame-input", "input (damaged)", &frames.input),
        ("frame-belief", "belief", &frames.belief),
        ("frame-prediction", "prediction", &frames.prediction),
    ];
    for (name, label, frame) in greys {
        let file = pace.hold(name, pictures.grey(frame.as_ref()));
        panel.image(name, label, file);
    }
    let of = match frames.error_of {
        ErrorOf::Belief => "belief",
        ErrorOf::Prediction => "prediction",
    };
    let label = format!("error of {of}: blue −{ERROR_RANGE}, orange +{ERROR_RANGE}");
    let name = "frame-error";
    let file = pace.hold(name, pictures.signed(frames.error.as_ref()));
    panel.image(name, &label, file);
}
