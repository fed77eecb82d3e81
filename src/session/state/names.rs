//! What has a name, and what is counted, as state strings and typed commands write it.

use crate::measure::failure::Order;
use crate::modality::Modality;
use crate::session::command::{Looping, Scope};

pub const SCOPES: [(&str, Scope); 3] = [
    ("episode", Scope::Episode),
    ("onward", Scope::Onward),
    ("frame", Scope::Frame),
];
pub const LOOPINGS: [(&str, Looping); 3] = [
    ("off", Looping::Off),
    ("all", Looping::All),
    ("selection", Looping::Selection),
];

/// The modality of that name; else a complaint that lists the names there are.
pub fn modality(text: &str) -> Result<Modality, String> {
    one_of(
        text,
        &Modality::ALL.map(|modality| (modality.name(), modality)),
    )
}

/// The order of that name; else a complaint that lists the names there are.
pub fn order(text: &str) -> Result<Order, String> {
    one_of(text, &Order::ALL.map(|order| (order.name(), order)))
}

/// What a name stands for; else a complaint that lists the names there are.
pub fn one_of<T: Copy>(text: &str, table: &[(&str, T)]) -> Result<T, String> {
    let found = table.iter().find(|(name, _)| *name == text);
    found.map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<&str> = table.iter().map(|&(name, _)| name).collect();
        format!("{text:?} is not one of {}", names.join(", "))
    })
}

/// The name of a value; each of its type is in its table.
pub fn name_of<T: Copy + PartialEq>(value: T, table: &[(&str, T)]) -> String {
    let found = table.iter().find(|(_, v)| *v == value);
    found.map_or("", |(name, _)| name).to_owned()
}

/// A count from 1 on.
pub fn count(text: &str) -> Result<usize, String> {
    let number: Option<usize> = text.parse().ok();
    number
        .filter(|&n| n > 0 && n < usize::MAX)
        .ok_or_else(|| format!("{text:?} is not a number from 1 on"))
}
