//! What every client should show now, and what of it has changed.

use std::collections::HashMap;
use std::sync::Arc;

use super::outbox::Moment;
use super::piece::{Change, Piece};
use super::protocol::Key;

/// All pieces, in the order in which they are made.
#[derive(Debug, Default)]
pub struct Stage {
    pieces: Vec<Piece>,
    places: HashMap<Key, usize>,
}

impl Stage {
    /// Shows these from now on; what has changed.
    pub fn show(&mut self, pieces: Vec<Piece>) -> Moment {
        let mut changes = Vec::new();
        let places: HashMap<Key, usize> = pieces
            .iter()
            .enumerate()
            .map(|(place, piece)| (piece.key.clone(), place))
            .collect();
        for piece in &self.pieces {
            if !places.contains_key(&piece.key) {
                changes.extend(piece.end());
            }
        }
        for piece in &pieces {
            match self.get(&piece.key) {
                None => changes.push(piece.making()),
                Some(earlier) => changes.extend(piece.changes_since(earlier)),
            }
        }
        *self = Self { pieces, places };
        Moment::new(changes.into_iter().map(Arc::new).collect())
    }

    /// The piece of a key.
    pub fn get(&self, key: &Key) -> Option<&Piece> {
        self.pieces.get(*self.places.get(key)?)
    }

    /// What makes all of it of nothing.
    pub fn all(&self) -> Vec<Change> {
        self.pieces.iter().map(Piece::making).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::protocol::envelope::Control;
    use super::super::protocol::progress::ProgressBarProps;
    use super::*;

    fn bar(uuid: &str, value: f64) -> Piece {
        let props = ProgressBarProps {
            order: 1.0,
            animated: false,
            color: None,
            visible: true,
        };
        Piece::of(&Control::new(uuid, "root", Some(value), props))
    }

    fn keys(moment: &Moment) -> Vec<(String, String)> {
        let keys = moment.changes.iter().map(|change| change.key.clone());
        keys.map(|key| (key.id, key.part)).collect()
    }

    #[test]
    fn new_ones_are_made_others_changed_and_old_ones_end() {
        let named = |id: &str, part: &str| (id.to_owned(), part.to_owned());
        let mut stage = Stage::default();
        let made = stage.show(vec![bar("a", 1.0), bar("b", 1.0)]);
        assert_eq!(keys(&made), [named("a", ""), named("b", "")]);
        let changed = stage.show(vec![bar("b", 2.0), bar("c", 1.0)]);
        assert_eq!(
            keys(&changed),
            [named("a", ""), named("b", "value"), named("c", "")]
        );
        assert_eq!(keys(&stage.show(vec![bar("b", 2.0), bar("c", 1.0)])), []);
        assert_eq!(stage.all().len(), 2);
    }
}
