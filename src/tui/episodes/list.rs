//! Which row of the list is meant, and what a key does while the list is open.

use crate::session::command::Command;
use crate::session::keys::Key;
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::table::{Column, TableView};

/// The open list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct List {
    /// The selected episode, by its index in the dataset: sorting does not lose it.
    pub selected: usize,
    /// Whether keys are letters of the filter.
    pub is_typing: bool,
}

/// What a key asked of those around the list.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// Nothing.
    Nothing,
    /// This of the session.
    Command(Command),
    /// To open this episode, and close the list.
    Open(usize),
    /// To close the list.
    Close,
    /// What the key always does.
    Usual,
}

impl List {
    /// Opens on the current episode.
    pub fn open(snapshot: &Snapshot) -> Self {
        Self {
            selected: snapshot.episode_index,
            is_typing: false,
        }
    }

    /// The place of the selected row among those that are shown; the first one where it is not.
    pub fn place(&self, table: &TableView) -> usize {
        let is_selected = |&index: &usize| index == self.selected;
        table.shown.iter().position(is_selected).unwrap_or(0)
    }

    /// Takes a key.
    pub fn press(&mut self, key: &Key, snapshot: &Snapshot) -> Asked {
        let table = &*snapshot.table;
        if self.is_typing {
            return self.typed(key, table);
        }
        let digit = key.as_char().and_then(|c| c.to_digit(10));
        match key.name() {
            "<esc>" | "E" => return Asked::Close,
            "<enter>" => {
                let index = table.shown.get(self.place(table)).copied();
                return index.map_or(Asked::Nothing, Asked::Open);
            }
            // A search leaves matches alone, so the next match is the next row.
            "<down>" | "j" | "n" => self.go(table, 1),
            "<up>" | "k" | "N" => self.go(table, -1),
            "<pagedown>" | "<s-down>" | "<c-d>" | "<c-f>" => self.go(table, 10),
            "<pageup>" | "<s-up>" | "<c-u>" | "<c-b>" => self.go(table, -10),
            "<home>" | "g" => self.go(table, isize::MIN),
            "<end>" | "G" => self.go(table, isize::MAX),
            "/" => self.is_typing = true,
            "o" => return Asked::Command(Command::CycleFailureOrder),
            "<" => return Self::sort(table, Self::neighbour(table.sort, -1)),
            ">" => return Self::sort(table, Self::neighbour(table.sort, 1)),
            "<c-c>" | "q" | "?" | "<f1>" => return Asked::Usual,
            _ => {
                let column =
                    digit.and_then(|digit| Column::ALL.get((digit as usize).checked_sub(1)?));
                if let Some(&column) = column {
                    return Asked::Command(Command::SortBy(column));
                }
            }
        }
        Asked::Nothing
    }

    /// At the ends there is no other column, and the same one would turn the order round.
    fn sort(table: &TableView, column: Column) -> Asked {
        if column == table.sort {
            Asked::Nothing
        } else {
            Asked::Command(Command::SortBy(column))
        }
    }

    fn typed(&mut self, key: &Key, table: &TableView) -> Asked {
        let mut filter = table.filter.clone();
        match key.name() {
            "<c-c>" => return Asked::Usual,
            "<enter>" => {
                self.is_typing = false;
                return Asked::Nothing;
            }
            "<esc>" => {
                self.is_typing = false;
                filter.clear();
            }
            "<backspace>" if filter.pop().is_none() => self.is_typing = false,
            "<backspace>" => {}
            _ => filter.extend(key.as_char()),
        }
        if filter == table.filter {
            Asked::Nothing
        } else {
            Asked::Command(Command::Filter(filter))
        }
    }

    fn go(&mut self, table: &TableView, by: isize) {
        let last = table.shown.len().saturating_sub(1);
        let place = self.place(table).saturating_add_signed(by).min(last);
        if let Some(&index) = table.shown.get(place) {
            self.selected = index;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tui::fixture;

    fn pressed(list: &mut List, snapshot: &Snapshot, keys: &[&str]) -> Vec<Asked> {
        let keys = keys.iter().filter_map(|key| Key::of_spelling(key).ok());
        keys.map(|key| list.press(&key, snapshot)).collect()
    }

    #[test]
    fn keys_move_open_sort_and_close() {
        let snapshot = fixture::snapshot(8, 16);
        let mut list = List::open(&snapshot);
        pressed(&mut list, &snapshot, &["j", "<down>", "n", "k", "N"]);
        assert_eq!(list.selected, snapshot.episode_index + 1);
        let asked = pressed(
            &mut list,
            &snapshot,
            &["<enter>", "7", "<", ">", "o", "<esc>", "G"],
        );
        assert_eq!(
            asked,
            [
                Asked::Open(3),
                Asked::Command(Command::SortBy(Column::Nees)),
                Asked::Nothing,
                Asked::Command(Command::SortBy(Column::Id)),
                Asked::Command(Command::CycleFailureOrder),
                Asked::Close,
                Asked::Nothing,
            ]
        );
        assert_eq!(list.selected, 23);
    }

    #[test]
    fn while_the_filter_is_typed_letters_are_letters() {
        let mut snapshot = fixture::snapshot(8, 16);
        let mut list = List::open(&snapshot);
        let asked = pressed(&mut list, &snapshot, &["/", "j"]);
        assert_eq!(asked[1], Asked::Command(Command::Filter("j".to_owned())));
        let mut table = (*snapshot.table).clone();
        table.filter = "j".to_owned();
        table.shown = Arc::default();
        snapshot.table = Arc::new(table);
        let asked = pressed(&mut list, &snapshot, &["<backspace>", "<enter>", "<enter>"]);
        assert_eq!(
            asked,
            [
                Asked::Command(Command::Filter(String::new())),
                Asked::Nothing,
                Asked::Nothing
            ]
        );
        assert!(!list.is_typing);
    }
}
