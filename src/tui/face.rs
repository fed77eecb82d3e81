//! What only this face knows: where the focus is, what lies over the screen, what the terminal can show.

use super::border::Split;
use super::compare::Compare;
use super::episodes::list::List;
use super::pixels::Pixels;
use super::theme::Depth;
use super::view::{Pane, View};
use crate::session::palette::PaletteView;
use crate::session::wants::Wants;

/// View-only state; nothing of it changes what is computed, but for what a view [`wants`](Face::wants).
#[derive(Debug)]
pub struct Face {
    /// What is looked at.
    pub view: View,
    /// The pane that keys like Enter are meant for; one of the view's.
    pub focus: Pane,
    /// Whether that pane fills the screen.
    pub zoomed: bool,
    /// The list of episodes, while it lies over the screen.
    pub episodes: Option<List>,
    /// Page of the keys that is shown over the screen.
    pub help: Option<usize>,
    /// Where browsers may join, with the token if there is one: shown with the keys.
    pub address: Option<String>,
    /// What is being typed, with what stands before it; none when nothing is.
    pub prompt: Option<String>,
    /// What can be chosen while a line is typed.
    pub palette: Option<PaletteView>,
    /// Borders between panes that have been moved.
    pub splits: Vec<Split>,
    /// The expert whose Gaussian is shown beside the belief, by its place in the list.
    pub expert: usize,
    /// The chosen cell of the lattice.
    pub lattice_cell: usize,
    /// How two images share the compared place of the frame row.
    pub compare: Compare,
    /// Colours of the terminal.
    pub depth: Depth,
    /// The terminal's own images, where it has them.
    pub pixels: Option<Pixels>,
}

impl Default for Face {
    fn default() -> Self {
        let view = View::default();
        Self {
            view,
            focus: view.panes()[0],
            zoomed: false,
            episodes: None,
            help: None,
            address: None,
            prompt: None,
            palette: None,
            splits: Vec::new(),
            expert: 0,
            lattice_cell: 0,
            compare: Compare::Off,
            depth: Depth::default(),
            pixels: None,
        }
    }
}

impl Face {
    /// Opens a view, with the focus on its first pane.
    pub fn open(&mut self, view: View) {
        self.view = view;
        self.focus = view.panes()[0];
        self.zoomed = false;
    }

    /// Whether a pane has the focus, for the mark before its title; a zoomed one needs none.
    pub fn is_focused(&self, pane: Pane) -> bool {
        self.focus == pane && !self.zoomed
    }

    /// Whether a pane is alone on the screen.
    pub fn is_zoomed(&self, pane: Pane) -> bool {
        self.focus == pane && self.zoomed
    }

    /// What has to be computed for what is shown.
    pub fn wants(&self) -> Wants {
        self.view.wants()
    }
}
