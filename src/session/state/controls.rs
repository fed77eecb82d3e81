//! Edited controls: `from:6,rotate:30,scale:0.5,mirror`.

use std::fmt::Write;

use super::names::count;
use crate::session::settings::{ControlEdit, SCALES};

/// What differs from the recorded controls.
pub fn text(edit: &ControlEdit) -> String {
    let mut text = format!("from:{}", edit.from + 1);
    if edit.rotate_deg != 0.0 {
        // Writing to a string cannot fail.
        let _ = write!(text, ",rotate:{}", edit.rotate_deg);
    }
    if edit.scale.total_cmp(&1.0).is_ne() {
        let _ = write!(text, ",scale:{}", edit.scale);
    }
    if edit.mirror {
        text += ",mirror";
    }
    text
}

/// The inverse; none for no edit at all.
pub fn read(text: &str) -> Result<Option<ControlEdit>, String> {
    let mut edit = ControlEdit::from(0);
    for part in text.split(',').filter(|part| !part.is_empty()) {
        let (key, value) = part.split_once(':').unwrap_or((part, ""));
        let number = || value.parse().ok().filter(|n: &f32| n.is_finite());
        let known = match key {
            "from" => count(value).ok().map(|step| edit.from = step - 1),
            "rotate" => number().map(|degrees| edit = edit.turned(degrees)),
            "scale" => number()
                .filter(|scale| SCALES.contains(scale))
                .map(|scale| edit.scale = scale),
            "mirror" if value.is_empty() => {
                edit.mirror = true;
                Some(())
            }
            _ => None,
        };
        known.ok_or_else(|| {
            let (least, most) = (SCALES.start(), SCALES.end());
            format!("{part:?} is not from:STEP, rotate:DEGREES, scale:{least} to {most}, or mirror")
        })?;
    }
    Ok(edit.unless_identity())
}
