//! The main panel: its heading and where it stands.

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

/// The main panel's name.
pub const MAIN: &str = "viser-control-panel";

/// Where a panel stands. A client that the user has moved it in keeps it, unless the run is another one.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiSetPanelPositionMessage")]
pub struct PanelPosition {
    /// Which.
    pub uuid: String,
    /// At which edge.
    pub position: Edge,
    /// Grows with every placement of a run.
    pub counter: u32,
    /// Another one for each run of a server.
    pub run_id: String,
}

impl super::Message for PanelPosition {
    fn key(&self) -> super::Key {
        super::Key::gui(&self.uuid).part("GuiSetPanelPositionMessage")
    }
}

/// An edge of the window.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename = "edge")]
pub struct Edge {
    /// `left` or `right`.
    pub edge: &'static str,
}

#[cfg(test)]
mod tests {
    use super::super::golden::{captured, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let label = Some("poescope golden".to_owned());
        holds(&PanelLabel { label }, "s2c_001_gui_panel_label.bin", 0);
    }

    #[test]
    fn so_is_its_place() {
        let name = "s2c_045_gui_panel.bin";
        let all = captured(name);
        let place = all
            .iter()
            .position(|message| message["type"] == "GuiSetPanelPositionMessage")
            .unwrap_or_default();
        let run_id = all[place]["run_id"].as_str().unwrap_or_default();
        let message = PanelPosition {
            uuid: uuid(name),
            position: Edge { edge: "left" },
            counter: 2,
            run_id: run_id.to_owned(),
        };
        holds(&message, name, place);
    }
}
