//! Edited controls in words.

use super::super::paint::width;
use crate::session::settings::ControlEdit;

/// `controls from step 6: turned 30°, × 0.5, mirrored; the prediction follows these, the truth is as recorded`, the end
/// shorter where there are fewer columns.
pub fn words(edit: &ControlEdit, columns: u16) -> String {
    let what = edit.words();
    let said = [
        "; the prediction follows these, the truth is as recorded",
        "; truth as recorded",
    ];
    let fits = said
        .into_iter()
        .find(|end| width(&what) + width(end) <= columns);
    format!("{what}{}", fits.unwrap_or_default())
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
        let turned = "controls from step 6: turned 30°, × 0.5, mirrored";
        assert_eq!(words(&edit, 10), turned);
        assert_eq!(words(&edit, 78), format!("{turned}; truth as recorded"));
        assert!(words(&edit, 118).contains("the prediction follows these"));
        let stopped = ControlEdit { scale: 0.0, ..edit };
        assert_eq!(words(&stopped, 10), "controls from step 6: stopped");
        assert_eq!(
            words(&ControlEdit::from(0), 10),
            "controls from step 1: as recorded"
        );
    }
}
