//! The README says what the program does.

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
