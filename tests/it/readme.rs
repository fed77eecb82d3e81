//! README and docs say what the program does.

use poescope::data::{Role, Topics};
use poescope::measure::corruption::Damage;
use poescope::model::config::{Config, Preset};
use poescope::session::keymap;
use poescope::session::state::State;

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

fn docs(name: &str) -> String {
    let path = format!("{}/docs/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn every_role_is_documented_with_its_topic() {
    let (data, topics) = (docs("data.md"), Topics::default());
    for role in Role::ALL {
        let row = format!("| `{}` | `{}` |", role.name(), topics.topic(role));
        assert!(data.contains(&row), "{row}");
    }
}

#[test]
fn every_key_of_the_state_string_is_documented() {
    let docs = docs("state.md");
    let example = docs.lines().find(|line| line.starts_with("v=1;")).unwrap();
    let (state, complaints) = State::parse(example);
    assert_eq!((complaints, state.unknown), (vec![], vec![]));
    let rows = docs.lines().filter_map(|line| line.strip_prefix("| `"));
    let names: Vec<&str> = rows
        .filter_map(|row| Some(row.split_once(" |")?.0))
        .flat_map(|names| names.split(", ").map(|name| name.trim_matches('`')))
        .collect();
    let damage = Damage::ALL.map(Damage::name);
    assert!(damage.iter().all(|name| names.contains(name)));
    // A key that is known has something to say of a value that is none, or takes it.
    for key in names.iter().filter(|name| !damage.contains(name)) {
        let (state, _) = State::parse(&format!("v=1;{key}=x"));
        assert_eq!(state.unknown, [], "{key}");
    }
    for known in ["samples", "select", "rank", "controls", "loop", "compare"] {
        assert!(names.contains(&known), "{known}");
    }
}
