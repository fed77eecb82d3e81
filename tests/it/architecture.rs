//! Imports run one way: every `use crate::…` in `src` points to a part further left in the picture in `lib.rs`.

use std::path::Path;

/// Parts from left to right; those of one row do not import each other.
const ORDER: [&[&str]; 8] = [
    &["episode", "modality", "lock"],
    &["measure"],
    &["model", "data", "sim"],
    &["eval", "session"],
    &["train", "tui", "web", "export"],
    &["cli"],
    &["command"],
    &["main"],
];

fn rank(part: &str) -> Option<usize> {
    ORDER.iter().position(|row| row.contains(&part))
}

/// Paths that follow `crate::` in a source text, in braces or not, down to their first segment.
fn imported(text: &str) -> Vec<String> {
    let code: String = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n");
    let mut parts = Vec::new();
    for (at, prefix) in code
        .match_indices("crate::")
        .chain(code.match_indices("poescope::"))
    {
        let rest = &code[at + prefix.len()..];
        let name = |text: &str| {
            text.trim_start()
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .next()
                .map(str::to_owned)
        };
        match rest.strip_prefix('{') {
            None => parts.extend(name(rest)),
            Some(group) => {
                // The first segments of a group: what stands at depth one, up to `:`, `,` or the closing brace.
                let (mut depth, mut start) = (1, Some(0));
                for (i, c) in group.char_indices() {
                    if let (Some(from), 1, ':' | ',' | '}') = (start, depth, c) {
                        parts.extend(name(&group[from..i]).filter(|name| !name.is_empty()));
                        start = None;
                    }
                    match c {
                        '{' => depth += 1,
                        '}' => depth -= 1,
                        ',' if depth == 1 => start = Some(i + 1),
                        _ => {}
                    }
                    if depth == 0 {
                        break;
                    }
                }
            }
        }
    }
    parts
}

fn files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn imports_run_one_way() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    files(&source, &mut found);
    assert!(found.len() > 50, "the sources were not found");
    let mut edges = 0;
    for path in found {
        let inside = path.strip_prefix(&source).unwrap();
        let own = inside
            .iter()
            .next()
            .unwrap()
            .to_str()
            .unwrap()
            .trim_end_matches(".rs")
            .to_owned();
        if own == "lib" {
            continue;
        }
        let from = rank(&own).unwrap_or_else(|| panic!("{own} has no place in the picture"));
        let mut text = std::fs::read_to_string(&path).unwrap();
        if inside.components().count() == 1 {
            // In a file at the top, outside of modules within it, the parent is the crate.
            text = text.replace("\nuse super::", "\nuse crate::");
        }
        for part in imported(&text) {
            if part == own {
                continue;
            }
            let Some(to) = rank(&part) else { continue };
            assert!(
                to < from,
                "{}: `{own}` must not import `{part}`",
                inside.display()
            );
            edges += 1;
        }
    }
    assert!(edges > 50, "the imports were not read");
}

#[test]
fn a_wrong_edge_would_be_seen() {
    assert_eq!(
        imported("use crate::{cli::Args, sim::{self, World}, data};\nlet x = crate::tui::draw();"),
        ["cli", "sim", "data", "tui"]
    );
    assert!(rank("tui") > rank("session") && rank("model") == rank("sim"));
}
