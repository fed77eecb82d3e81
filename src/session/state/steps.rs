//! Steps that stand out: marks, `3,7`, and a selection, `4-9`, or `4-` while its end is open. Counted from 1.

use std::collections::BTreeSet;

use super::names::count;

/// Marked steps, in order.
pub fn marks_text(marks: &BTreeSet<usize>) -> String {
    let marks = marks.iter().map(|step| (step + 1).to_string());
    marks.collect::<Vec<_>>().join(",")
}

/// The inverse.
pub fn marks(text: &str) -> Result<BTreeSet<usize>, String> {
    let marks = text.split(',').filter(|mark| !mark.is_empty());
    marks.map(|mark| Ok(count(mark)? - 1)).collect()
}

/// First and last step.
pub fn selection_text((first, last): (usize, Option<usize>)) -> String {
    let last = last.map_or(String::new(), |last| (last + 1).to_string());
    format!("{}-{last}", first + 1)
}

/// The inverse.
pub fn selection(text: &str) -> Result<(usize, Option<usize>), String> {
    let selection = text.split_once('-').and_then(|(first, last)| {
        let first = count(first).ok()? - 1;
        if last.is_empty() {
            return Some((first, None));
        }
        let last = count(last).ok()? - 1;
        (first <= last).then_some((first, Some(last)))
    });
    selection.ok_or_else(|| format!("{text:?} is not like 4-9 or 4-"))
}
