//! Where to look next, and the way back.

use super::panel::Panel;

/// Adds the folder.
pub fn add(panel: &mut Panel) {
    panel.folder("find", "Find", false);
    panel.button("failure-next", "Next failure", "The worst first");
    panel.button("failure-previous", "Previous failure", "");
    panel.button("event-next", "Next event", "A contact or a mark");
    panel.button("event-previous", "Previous event", "");
    panel.button("undo", "Undo", "");
    panel.button("redo", "Redo", "");
}
