//! The terminal: draws a [`Snapshot`](crate::session::snapshot::Snapshot), never computes one.
//!
//! ```text
//! status            view  dataset  model           computing…  episode 3/24  push-3 test  scope episode
//! frames, image     truth         belief        prediction    error ±0.50
//!                   ▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀   ▀▀▀▀▀▀▀▀▀▀▀
//! strip             every 2nd step of the same, on a large screen
//! experts           1 V vision  ● on   2.1 0.31 ██████ 52 %   position cm           position, braille
//!                   9 D prior   ● on   1.9 0.60 ░░░    21 %    12   ╌╌╌╌×╌╌
//! dims, stack       share per latent dimension                     ────●┈┈┈◆        latents
//! timeline          step ━━━━━━┃╌╌╌╌◆╌╌╌╌╌╌╌──                  0
//!                   force  ▂▃▄▅▆▇█▇▆▅▄▃▂  3.2 N                  -3           12
//!                   share ▓▓▓▓▒▒▒▒░░░░
//! palette           commands to choose from while a line is typed, over what is above the last line
//! status::message   message, prompt, warning or a few keys
//! ```
//! This is the overview; [`view`] lists the other views and the panes of each. One file a pane; [`layout`] says where
//! each stands, [`face`] holds what only this face knows, [`app`] turns keys and clicks into commands, [`terminal`] runs
//! it all, [`print()`] writes a frame as text, [`picture()`] as pixels, [`plain()`] what it says.

pub mod app;
pub mod compare;
pub mod face;
pub mod layout;
pub mod pixels;
pub mod terminal;
pub mod theme;
pub mod view;

mod axis;
mod border;
mod braille;
mod consistency;
mod episodes;
mod experts;
mod frames;
mod fuse;
mod help;
mod image;
mod latents;
mod lattice;
mod paint;
mod palette;
mod picture;
mod plain;
mod plane;
mod plot;
mod position;
mod predict;
mod print;
mod scale;
mod stack;
mod status;
mod strip;
mod timeline;
mod words;

#[cfg(test)]
mod fixture;
#[cfg(test)]
mod tests;

use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

pub use face::Face;
pub use picture::{Picture, picture};
pub use plain::plain;
pub use print::print;

use crate::session::snapshot::{Badge, Snapshot};
use layout::{Layout, SMALLEST, Shape};
use view::Pane;

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
    let layout = layout(screen, snapshot, face);
    status::draw(buf, layout.status, snapshot, face);
    for (pane, rect) in layout.shown() {
        drawing(pane)(buf, rect, snapshot, face);
    }
    status::message(buf, layout.message, snapshot, face);
    if let Some(list) = &face.episodes {
        episodes::draw(buf, screen, snapshot, face, list);
    }
    if let Some(view) = &face.palette {
        palette::draw(buf, palette::pane(screen, layout.message), view);
    }
    if let Some(page) = face.help {
        help::draw(buf, screen, page, face.address.as_deref());
    }
    if let Some(pixels) = &face.pixels {
        pixels.finish(buf);
    }
}

/// What draws a pane.
fn drawing(pane: Pane) -> fn(&mut Buffer, Rect, &Snapshot, &Face) {
    match pane {
        Pane::Frames => frames::draw,
        Pane::Strip => strip::draw,
        Pane::Experts => experts::draw,
        Pane::Dims => fuse::dims::draw,
        Pane::Latents => latents::draw,
        Pane::Position => position::draw,
        Pane::Timeline => timeline::draw,
        Pane::Pairs => fuse::pairs::draw,
        Pane::Divergence => fuse::divergence::draw,
        Pane::Response => fuse::response::draw,
        Pane::Series => fuse::series::draw,
        Pane::Spread => predict::spread::draw,
        Pane::Quality => predict::horizon::draw,
        Pane::Samples => predict::samples::draw,
        Pane::Pulls => position::pulls::draw,
        Pane::Verdict => consistency::verdict::sentences,
        Pane::Numbers => consistency::verdict::numbers,
        Pane::Coverage => consistency::coverage::draw,
        Pane::Horizons => consistency::horizons::draw,
        Pane::Dependence => consistency::dependence::draw,
        Pane::Sets => lattice::draw,
    }
}

/// Where the panes are on a screen of this size, as the user has moved their borders.
fn layout(screen: Rect, snapshot: &Snapshot, face: &Face) -> Layout {
    let own = own_layout(screen, snapshot, face);
    if face.zoomed {
        own
    } else {
        own.moved(&face.splits, face.view)
    }
}

/// Where the view itself puts them.
fn own_layout(screen: Rect, snapshot: &Snapshot, face: &Face) -> Layout {
    let steps = snapshot.steps();
    let shape = Shape {
        view: face.view,
        steps,
        experts: snapshot.experts.len(),
        product: snapshot.badge != Badge::NoProduct,
        damaged: !snapshot.corruptions.is_empty(),
        zoom: face.zoomed.then_some(face.focus),
    };
    Layout::of(screen, shape)
}
