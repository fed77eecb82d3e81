//! The page and viser's own client, driven in a real Chromium against the program: `web/tests/browser`.
//!
//! They are left out, aloud, where npm or Chromium is missing; never in CI.

use std::path::Path;
use std::process::Command;

fn there_is(program: &str) -> bool {
    let found = Command::new("which").arg(program).output();
    found.is_ok_and(|output| output.status.success())
}

/// Runs npm in `web/`; its output is shown where it fails.
fn npm(arguments: &[&str]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("web");
    let output = Command::new("npm")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "npm {arguments:?}: {}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn the_page_works_in_a_browser() {
    let chromium = std::env::var("CHROMIUM").unwrap_or_else(|_| "chromium".to_owned());
    let missing = ["npm", "node", &chromium].map(there_is).contains(&false);
    if missing && std::env::var_os("CI").is_none() {
        eprintln!("left out: the tests of the page need npm and Chromium");
        return;
    }
    npm(&["ci", "--no-audit", "--no-fund"]);
    npm(&["run", "check"]);
    npm(&["test"]);
    let program = env!("CARGO_BIN_EXE_poescope");
    let command = format!("{program} serve --port {{port}}");
    npm(&["run", "browser", "--", "--require", "--command", &command]);
    // The page of the Python package viser 1.1.1, as it came.
    let stock = std::env::var("VISER_CLIENT").unwrap_or_default();
    if stock.is_empty() && std::env::var_os("CI").is_none() {
        eprintln!("left out: VISER_CLIENT names no page of viser 1.1.1");
        return;
    }
    let options = ["--require", "--page", &stock, "--command", &command];
    npm(&[&["run", "stock", "--"][..], &options].concat());
}
