//! Edited controls in words.

use crate::session::settings::ControlEdit;

/// `controls from step 6: turned 30°, × 0.5, mirrored; the prediction follows these, the truth the recorded ones`.
pub fn words(edit: &ControlEdit) -> String {
    let from = edit.from + 1;
    if edit.is_identity() {
        return format!("controls from step {from}: as recorded");
    }
    let parts = if edit.scale == 0.0 {
        "stopped".to_owned()
    } else {
        let turned = (edit.rotate_deg != 0.0).then(|| format!("turned {}°", edit.rotate_deg));
        let scaled = ((edit.scale - 1.0).abs() > f32::EPSILON).then(|| format!("× {}", edit.scale));
        let mirrored = edit.mirror.then(|| "mirrored".to_owned());
        let parts: Vec<String> = [turned, scaled, mirrored].into_iter().flatten().collect();
        parts.join(", ")
    };
    format!(
        "controls from step {from}: {parts}; the prediction follows these, the truth the recorded ones"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edit_is_said_in_the_order_of_what_it_does() {
        let edit = ControlEdit {
            from: 5,
            rotate_deg: 30.0,
            scale: 0.5,
            mirror: true,
        };
        assert!(words(&edit).starts_with("controls from step 6: turned 30°, × 0.5, mirrored; "));
        let stopped = ControlEdit { scale: 0.0, ..edit };
        assert!(words(&stopped).starts_with("controls from step 6: stopped; "));
        assert_eq!(
            words(&ControlEdit::from(0)),
            "controls from step 1: as recorded"
        );
    }
}
