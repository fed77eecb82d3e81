//! The steps something reaches: nothing for all, `@4`, `@4-7`, `@4-`. Counted from 1, the last one included.

use super::names::count;
use crate::model::switches::Reach;

/// As it follows what reaches so far.
pub fn text(reach: Reach) -> String {
    match reach {
        Reach::EPISODE => String::new(),
        Reach { from, until: None } => format!("@{}-", from + 1),
        Reach {
            from,
            until: Some(until),
        } if until == from + 1 => format!("@{until}"),
        Reach {
            from,
            until: Some(until),
        } => format!("@{}-{until}", from + 1),
    }
}

/// What is before the `@`, and the reach after it; none where that is not one.
pub fn split(text: &str) -> Option<(&str, Reach)> {
    let Some((before, steps)) = text.split_once('@') else {
        return Some((text, Reach::EPISODE));
    };
    let (from, until) = match steps.split_once('-') {
        None => (count(steps).ok()?, Some(count(steps).ok()?)),
        Some((from, "")) => (count(from).ok()?, None),
        Some((from, until)) => (count(from).ok()?, Some(count(until).ok()?)),
    };
    let from = from - 1;
    until
        .is_none_or(|until| from < until)
        .then_some((before, Reach { from, until }))
}
