//! A snapshot as elements of the panel and nodes of the scene. Shows, never computes.

pub mod names;

mod arrows;
mod charts;
mod damage;
mod escape;
mod experts;
mod find;
mod frames;
mod head;
mod meta;
mod nodes;
mod panel;
mod paths;
mod pictures;
mod png;
mod rollout;
mod table;

use std::time::Duration;

use super::piece::Piece;
use super::protocol::panel::PanelLabel;
use super::protocol::theme::Theme;
use crate::session::snapshot::Snapshot;
pub use meta::face_name;
use nodes::Nodes;
use panel::Panel;
use pictures::{Pace, Pictures};

/// What is shown besides the snapshot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Whether nobody may change anything here.
    pub read_only: bool,
    /// Whether the spread of samples is asked for.
    pub spread: bool,
}

/// Makes scenes, and keeps what is dear to make.
#[derive(Debug, Default)]
pub struct Composer {
    pictures: Pictures,
    pace: Pace,
}

impl Composer {
    /// One that shows another file in the place of a picture no more often than so.
    pub fn paced(gap: Duration) -> Self {
        let pace = Pace::new(gap);
        Self {
            pace,
            ..Self::default()
        }
    }

    /// Whether a picture of the last snapshot was held back.
    pub fn is_late(&self) -> bool {
        self.pace.late
    }

    /// All pieces of a snapshot, in the order in which a client is to make them.
    pub fn compose(&mut self, snapshot: &Snapshot, shown: Shown) -> Vec<Piece> {
        let mut panel = Panel::new(shown.read_only);
        panel.pieces.push(Piece::of(&Theme::default()));
        panel.pieces.push(Piece::of(&PanelLabel {
            label: Some("poescope".to_owned()),
        }));
        head::add(&mut panel, snapshot);
        experts::add(&mut panel, snapshot);
        self.pace.late = false;
        frames::add(&mut panel, snapshot, &mut self.pictures, &mut self.pace);
        charts::add(&mut panel, snapshot);
        rollout::add(&mut panel, snapshot, shown.spread);
        damage::add(&mut panel, snapshot);
        find::add(&mut panel);
        panel.root();
        meta::add(&mut panel, snapshot, shown.read_only);
        let mut nodes = Nodes::new(panel.pieces);
        table::add(&mut nodes, snapshot);
        paths::add(&mut nodes, snapshot);
        arrows::add(&mut nodes, snapshot);
        nodes.pieces
    }
}

#[cfg(test)]
mod tests;
