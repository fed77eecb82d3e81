//! The list of episodes over the screen: what its keys come to.

use super::App;
use crate::session::command::Command;
use crate::session::keys::Key;
use crate::session::snapshot::Snapshot;
use crate::tui::episodes::list::{Asked, List};

impl App {
    /// Opens the list of episodes, or closes it.
    pub fn toggle_episodes(&mut self) {
        let open = List::open(&self.session.snapshot());
        self.face.episodes = self.face.episodes.is_none().then_some(open);
    }

    /// Whether the open list has taken the key.
    pub(super) fn list_takes(&mut self, key: &Key, snapshot: &Snapshot) -> bool {
        let Some(list) = self
            .face
            .episodes
            .as_mut()
            .filter(|_| self.face.help.is_none() && self.input.mode().is_none())
        else {
            return false;
        };
        match list.press(key, snapshot) {
            Asked::Usual => return false,
            Asked::Nothing => {}
            Asked::Command(command) => self.session.apply(command),
            Asked::Close => self.face.episodes = None,
            Asked::Open(index) => {
                self.face.episodes = None;
                self.session.apply(Command::SelectEpisode(index));
            }
        }
        true
    }
}
