//! The heading of the main panel.

use serde::Serialize;

use super::about;

/// The heading of the main panel.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetGuiPanelLabelMessage")]
pub struct PanelLabel {
    /// The heading; none says that the client is connected.
    pub label: Option<String>,
}

about!(PanelLabel, "SetGuiPanelLabelMessage" of client);

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let label = Some("poescope golden".to_owned());
        holds(&PanelLabel { label }, "s2c_001_gui_panel_label.bin", 0);
    }
}
