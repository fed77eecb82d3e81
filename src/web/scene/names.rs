//! Names of the elements and of what can be chosen, for both directions. `docs/web.md` lists them for clients.

use crate::measure::corruption::Damage;
use crate::modality::Modality;
use crate::session::command::Scope;
use crate::session::snapshot::Snapshot;

/// What every uuid begins with.
const PREFIX: &str = "poescope-";
/// The part of a switch's name before its expert's.
pub const SWITCH: &str = "switch-";
/// The part of an α's name before its expert's.
pub const ALPHA: &str = "alpha-";
/// The part of a damage's name before its modality's.
pub const DAMAGE: &str = "damage-";
/// The part of a severity's name before its modality's.
pub const SEVERITY: &str = "severity-";
/// The node whose places are the steps.
pub const PATH_POINTS: &str = "/path/points";
/// What the choice of a damage says where there is none.
pub const AS_RECORDED: &str = "as recorded";
/// Choices of speed, with the powers of two that they are.
pub const SPEEDS: [(&str, f32); 7] = [
    ("1/8×", 0.125),
    ("1/4×", 0.25),
    ("1/2×", 0.5),
    ("1×", 1.0),
    ("2×", 2.0),
    ("4×", 4.0),
    ("8×", 8.0),
];
/// Choices of scope, in the order in which they follow each other.
pub const SCOPES: [(&str, Scope); 3] = [
    ("whole episode", Scope::Episode),
    ("from here on", Scope::Onward),
    ("this step", Scope::Frame),
];
/// Episodes that a choice lists at most; of more, a block around the present one.
const LISTED: usize = 2000;

/// The uuid of an element.
pub fn uuid(name: &str) -> String {
    format!("{PREFIX}{name}")
}

/// The element of a uuid.
pub fn element(uuid: &str) -> Option<&str> {
    uuid.strip_prefix(PREFIX)
}

/// What the choice of a damage says.
pub fn damage(damage: Option<Damage>) -> &'static str {
    damage.map_or(AS_RECORDED, Damage::name)
}

/// The modality of a name.
pub fn modality(name: &str) -> Option<Modality> {
    Modality::ALL
        .into_iter()
        .find(|modality| modality.name() == name)
}

/// An entry of a choice that stands for a place in a list: its number from 1, then its name.
pub fn entry(index: usize, name: &str) -> String {
    // What comes from a file may hold line breaks or worse.
    let name: String = name.chars().filter(|c| !c.is_control()).take(80).collect();
    format!("{} {name}", index + 1)
}

/// The place that an entry stands for.
pub fn index(entry: &str) -> Option<usize> {
    entry
        .split(' ')
        .next()?
        .parse::<usize>()
        .ok()?
        .checked_sub(1)
}

/// The episodes that the choice lists: all, or of very many a block around the present one.
pub fn episodes(snapshot: &Snapshot) -> Vec<String> {
    let rows = &snapshot.table.rows;
    let first = snapshot.episode_index / LISTED * LISTED;
    let listed = rows.iter().enumerate().skip(first).take(LISTED);
    let named = listed.map(|(index, row)| match row.split {
        Some(split) => entry(index, &format!("{} ({})", row.id, split.name())),
        None => entry(index, &row.id),
    });
    named.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_says_its_place_whatever_its_name_holds() {
        let odd = entry(41, "12 <b>\n\u{1b}[2J");
        assert_eq!((odd.as_str(), index(&odd)), ("42 12 <b>[2J", Some(41)));
        assert_eq!((index("0 x"), index("x"), index("")), (None, None, None));
    }
}
