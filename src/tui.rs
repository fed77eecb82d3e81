//! The terminal: draws a [`Snapshot`](crate::session::snapshot::Snapshot), never computes one.
//!
//! ```text
//! status            dataset  model                 computing…  episode 3/24  push-3 test  scope episode
//! frames, image     truth         belief        prediction    error ±0.50
//!                   ▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀
//! strip             every 2nd step of the same, on a large screen
//! experts           1 V vision  ● on   2.1 0.31 ██████ 52 %   position cm           position, braille
//!                   9 D prior   ● on   1.9 0.60 ░░░    21 %    12   ╌╌╌╌×╌╌
//! shares, stack     share per latent dimension                     ────●┈┈┈◆        latents
//! timeline          step ━━━━━━┃╌╌╌╌◆╌╌╌╌╌╌╌──                  0
//!                   force  ▂▃▄▅▆▇█▇▆▅▄▃▂  3.2 N                  -3           12
//!                   share ▓▓▓▓▒▒▒▒░░░░
//! status::message   message, prompt, warning or a few keys
//! ```
//! One file a pane; [`layout`] says where each stands, [`face`] holds what only this face knows, [`app`] turns keys
//! and clicks into commands, [`terminal`] runs it all, [`print()`] writes a frame as text,
//! [`plain()`] what it says.

pub mod app;
pub mod face;
pub mod layout;
pub mod pixels;
pub mod terminal;
pub mod theme;

mod axis;
mod braille;
mod experts;
mod frames;
mod help;
mod image;
mod latents;
mod paint;
mod plain;
mod position;
mod print;
mod shares;
mod stack;
mod status;
mod strip;
mod timeline;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod tests;

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Style;

pub use face::Face;
pub use plain::plain;
pub use print::print;

use crate::session::snapshot::Snapshot;
use layout::{Panes, SMALLEST};

/// Draws one frame.
pub fn draw(frame: &mut Frame, snapshot: &Snapshot, face: &Face) {
    let screen = frame.area();
    let buf = frame.buffer_mut();
    if screen.width < SMALLEST.0 || screen.height < SMALLEST.1 {
        let (columns, rows) = SMALLEST;
        let line = format!("poescope needs {columns}x{rows}");
        paint::text(buf, screen, 0, 0, &line, Style::new());
        return;
    }
    let panes = panes(screen, snapshot, face);
    status::draw(buf, panes.status, snapshot, face);
    let shown = |pane: Rect| !pane.is_empty();
    if shown(panes.frames) {
        frames::draw(buf, panes.frames, snapshot, face);
    }
    if shown(panes.strip) {
        strip::draw(buf, panes.strip, snapshot, face);
    }
    if shown(panes.experts) {
        experts::draw(buf, panes.experts, snapshot, face);
    }
    if shown(panes.shares) {
        shares::draw(buf, panes.shares, snapshot, face);
    }
    if shown(panes.latents) {
        latents::draw(buf, panes.latents, snapshot, face);
    }
    if shown(panes.position) {
        position::draw(buf, panes.position, snapshot, face);
    }
    if shown(panes.timeline) {
        timeline::draw(buf, panes.timeline, snapshot, face);
    }
    status::message(buf, panes.message, snapshot, face);
    if let Some(page) = face.help {
        help::draw(buf, screen, page);
    }
    if let Some(pixels) = &face.pixels {
        pixels.finish(buf);
    }
}

/// Where the panes are on a screen of this size.
fn panes(screen: Rect, snapshot: &Snapshot, face: &Face) -> Panes {
    let steps = snapshot
        .episode
        .as_ref()
        .map_or(0, |episode| episode.secs.len());
    let zoom = face.zoomed.then_some(face.focus);
    Panes::of(screen, steps, snapshot.experts.len(), zoom)
}
