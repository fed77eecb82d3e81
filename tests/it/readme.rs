//! The README says what the program does.

use poescope::model::config::{Config, Preset};
use poescope::session::keymap;

fn readme() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap()
}

#[test]
fn the_key_table_is_the_keymap() {
    assert!(
        readme().contains(&keymap::markdown()),
        "README.md must contain this table:\n\n{}",
        keymap::markdown()
    );
}

#[test]
fn the_commands_that_ci_runs_are_in_it() {
    for command in ["cargo run --release", "cargo test --release"] {
        assert!(
            readme().contains(command),
            "README.md does not mention `{command}`"
        );
    }
}

/// `training.batch` and its siblings as the table of keys has them: one row each with the presets' values.
#[test]
fn every_key_of_the_config_is_documented_with_its_values() {
    fn rows(prefix: &str, tables: &[toml::Table], found: &mut Vec<String>) {
        for key in tables[0].keys() {
            let path = format!("{prefix}{key}");
            let values: Vec<_> = tables.iter().map(|table| &table[key]).collect();
            if let Some(inner) = values[0].as_table() {
                if !inner.contains_key("names") {
                    let inner: Vec<_> = values
                        .iter()
                        .map(|v| v.as_table().unwrap().clone())
                        .collect();
                    rows(&format!("{path}."), &inner, found);
                }
            } else if !["name", "training.error_weights"].contains(&path.as_str()) {
                let values: Vec<_> = values.iter().map(ToString::to_string).collect();
                found.push(format!("| `{path}` | {} |", values.join(" | ")));
            }
        }
    }
    let table = |preset| toml::Table::try_from(Config::preset("vhp", preset).unwrap()).unwrap();
    let mut wanted = Vec::new();
    rows("", &Preset::ALL.map(table), &mut wanted);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/training.md");
    let text = std::fs::read_to_string(path).unwrap();
    assert!(wanted.len() > 30);
    for row in wanted {
        assert!(
            text.contains(&row),
            "docs/training.md has no row that begins {row}"
        );
    }
}
