//! NEES at each horizon.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::session::snapshot::Snapshot;
use crate::tui::face::Face;
use crate::tui::paint::title;
use crate::tui::view::Pane;

/// Draws the pane.
pub fn draw(buf: &mut Buffer, pane: Rect, _snapshot: &Snapshot, face: &Face) {
    title(buf, pane, "horizons", "", face.is_focused(Pane::Horizons));
}
