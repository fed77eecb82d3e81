//! Each expert's share of precision in each latent dimension at the cursor: one stack a dimension.
//!
//! ```text
//! share  █ ▒ █ █ ░ █ ▓ █ █ ▓ █ █ ░ █ █ █
//! per z  █ ▓ █ █ ░ █ ▓ █ █ ▓ █ ▒ ░ █ █ █
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::modality::Expert;
use crate::session::snapshot::Snapshot;
use crate::tui::axis::LABELS;
use crate::tui::face::Face;
use crate::tui::paint::{right, text};
use crate::tui::stack::stack;
use crate::tui::theme::dim;

/// Draws the stacks, with the dimensions' numbers below them where there is room.
pub fn draw(buf: &mut Buffer, pane: Rect, snapshot: &Snapshot, face: &Face) {
    let dims = snapshot
        .experts
        .iter()
        .map(|view| view.share.len())
        .max()
        .unwrap_or(0);
    if dims == 0 || pane.width <= LABELS || pane.height == 0 {
        return;
    }
    text(buf, pane, 0, 0, "share", dim());
    text(buf, pane, 0, 1, "per z", dim());
    let pitch = ((pane.width - LABELS) / dims as u16).clamp(1, 4);
    let fat = if pitch > 1 { pitch - 1 } else { 1 };
    let numbered = pane.height >= 5;
    let stacks = Rect {
        height: pane.height - u16::from(numbered),
        ..pane
    };
    for d in 0..dims {
        let shares: Vec<(Expert, f32)> = snapshot
            .experts
            .iter()
            .map(|view| (view.expert, view.share.get(d).copied().unwrap_or(0.0)))
            .collect();
        let at = LABELS + d as u16 * pitch;
        for column in 0..fat.min(pane.width.saturating_sub(at)) {
            stack(buf, stacks, at + column, &shares, face.depth);
        }
        if numbered && (pitch > 2 || d % 5 == 0) {
            right(
                buf,
                pane,
                at + fat.max(1),
                pane.height - 1,
                &d.to_string(),
                dim(),
            );
        }
    }
}
