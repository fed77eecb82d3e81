//! What only this face knows: where the focus is, what lies over the screen, what the terminal can show.

use super::pixels::Pixels;
use super::theme::Depth;
use crate::session::palette::PaletteView;

/// A pane that can have the focus and fill the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Focus {
    /// Truth, belief, prediction, error.
    #[default]
    Frames,
    /// Switches and shares.
    Experts,
    /// Means and deviations of the latent.
    Latents,
    /// The table.
    Position,
    /// Steps, force and shares over time.
    Timeline,
}

impl Focus {
    /// All panes in the order of Tab.
    pub const ALL: [Self; 5] = [
        Self::Frames,
        Self::Experts,
        Self::Latents,
        Self::Position,
        Self::Timeline,
    ];

    /// The pane so many places on, round and round.
    #[must_use]
    pub fn turned(self, by: i64) -> Self {
        let at = Self::ALL.iter().position(|&pane| pane == self).unwrap_or(0) as i64;
        let count = Self::ALL.len() as i64;
        Self::ALL[(at + by).rem_euclid(count) as usize]
    }
}

/// View-only state; nothing of it changes what is computed.
#[derive(Debug, Default)]
pub struct Face {
    /// The pane that keys like Enter are meant for.
    pub focus: Focus,
    /// Whether that pane fills the screen.
    pub zoomed: bool,
    /// Page of the keys that is shown over the screen.
    pub help: Option<usize>,
    /// What is being typed, with what stands before it; none when nothing is.
    pub prompt: Option<String>,
    /// What can be chosen while a line is typed.
    pub palette: Option<PaletteView>,
    /// The expert whose Gaussian is shown beside the belief, by its place in the list.
    pub expert: usize,
    /// Colours of the terminal.
    pub depth: Depth,
    /// The terminal's own images, where it has them.
    pub pixels: Option<Pixels>,
}

impl Face {
    /// Whether a pane has the focus, for the mark before its title; a zoomed one needs none.
    pub fn is_focused(&self, pane: Focus) -> bool {
        self.focus == pane && !self.zoomed
    }
}
