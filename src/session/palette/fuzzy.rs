//! How well a few typed letters fit a name.

/// A letter found anywhere.
const FOUND: i32 = 1;
/// More where it follows the one before it at once.
const NEXT: i32 = 8;
/// More where it begins a word.
const BEGINS: i32 = 7;
/// More where it begins the name.
const FIRST: i32 = 3;
/// Less where something stands between it and the one before it.
const GAP: i32 = 3;
/// What a letter must be worth on average: letters here and there in a sentence are no find.
const LEAST: i32 = 2;

/// The best way to find the letters of `typed` in `name` in their order, without regard to case and blanks; none
/// where there is no good way. Letters in a row and beginnings of words count for more.
pub fn score(typed: &str, name: &str) -> Option<i32> {
    let typed: Vec<char> = lower(typed).filter(|c| !c.is_whitespace()).collect();
    let name: Vec<char> = lower(name).collect();
    let Some((&first, rest)) = typed.split_first() else {
        return Some(0);
    };
    let worth = |at: usize| {
        let begins = at == 0 || !name[at - 1].is_alphanumeric();
        FOUND + i32::from(begins) * BEGINS + i32::from(at == 0) * FIRST
    };
    // The best score of the letters so far with the last of them at each place of the name.
    let mut best: Vec<Option<i32>> = (0..name.len())
        .map(|at| (name[at] == first).then(|| worth(at)))
        .collect();
    for &letter in rest {
        let mut before: Option<i32> = None;
        let mut next = vec![None; name.len()];
        for at in 1..name.len() {
            // A blank between two words does not part what is typed in a row.
            let row = match name[at - 1] {
                ' ' if at > 1 => best[at - 2],
                _ => best[at - 1],
            };
            if name[at] == letter {
                let follows = row.map(|score| score + NEXT);
                let later = before.max(best[at - 1]).map(|score| score - GAP);
                next[at] = follows.max(later).map(|score| score + worth(at));
            }
            before = before.max(best[at - 1]);
        }
        best = next;
    }
    let score = best.into_iter().flatten().max()?;
    (score >= LEAST * typed.len() as i32).then_some(score)
}

fn lower(text: &str) -> impl Iterator<Item = char> {
    text.chars().flat_map(char::to_lowercase)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn better(typed: &str, good: &str, bad: &str) {
        let (good, bad) = (score(typed, good), score(typed, bad));
        assert!(good > bad, "{typed}: {good:?} {bad:?}");
    }

    #[test]
    fn words_and_rows_win() {
        better("vf", "view fuse", "leave off");
        better("noise", "corrupt vision noise", "none of its images seen");
        better("ep", "episode N or NAME", "next episode");
        better("ce", "context end", "science");
        better("conte", "context N", "other controls, Esc ends");
        assert_eq!(score("aaaa", "bab bab bab bab"), None, "here and there");
        better("corvis", "corrupt vision zero", "colour of the visible");
        assert_eq!(score("xyz", "corrupt vision zero"), None);
        assert_eq!(score("ba", "ab"), None);
        assert_eq!(score("  ", "anything"), Some(0));
        assert!(score("VIEW FUSE", "view fuse") == score("view fuse", "View Fuse"));
    }

    proptest! {
        #[test]
        fn only_subsequences_are_found_and_beginnings_always(name in "[a-c ]{0,12}", typed in "[a-c]{1,5}") {
            let mut rest = name.chars();
            let is_in_order = typed.chars().all(|letter| rest.any(|c| c == letter));
            let begins_a_word = name.split(' ').any(|word| word.starts_with(&typed));
            let is_found = score(&typed, &name).is_some();
            prop_assert!((!is_found || is_in_order) && (is_found || !begins_a_word));
        }

        #[test]
        fn any_two_texts_can_be_compared(typed in "\\PC{0,12}", name in "\\PC{0,12}") {
            score(&typed, &name);
        }
    }
}
