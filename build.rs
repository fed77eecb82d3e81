//! Builds the page of `web/` with npm and hands it to the crate as `web_assets.rs`. Never fails the build.
//!
//! npm runs in the release profile only, and only when the page's sources are not those that the bundle in `OUT_DIR`
//! was made of. Editors check in the dev profile; where rust-analyzer is told to use another one it is known by
//! `RA_RUSTC_WRAPPER`. `POESCOPE_WEB=off` leaves the page out wherever npm is not wanted, `cargo check --release` say.
//! Without a bundle there is a plain page that says what is missing.

use std::collections::hash_map::DefaultHasher;
use std::fmt::Write as _;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

/// What the bundle is made of, in `web/`. Tests are not.
const SOURCES: [&str; 7] = [
    ".npmrc",
    "index.html",
    "package.json",
    "package-lock.json",
    "src",
    "tsconfig.json",
    "vite.config.ts",
];

/// npm writes it last.
const INSTALLED: &str = "node_modules/.package-lock.json";

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=build.rs");
    for variable in ["POESCOPE_WEB", "RA_RUSTC_WRAPPER"] {
        println!("cargo:rerun-if-env-changed={variable}");
    }
    for source in SOURCES {
        println!("cargo:rerun-if-changed=web/{source}");
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let missing = why_not().or_else(|| {
        let failed = bundle(Path::new("web"), &out.join("web")).err()?;
        println!("cargo:warning=the page of `serve` is left out: {failed}");
        Some(failed)
    });
    let generated = if let Some(reason) = missing {
        let page = out.join("missing.html");
        fs::write(&page, plain_page(&reason))?;
        listing(&out, &[page])
    } else {
        let dist = out.join("web/dist");
        listing(&dist, &files_below(&dist)?)
    };
    fs::write(out.join("web_assets.rs"), generated)
}

/// Why npm is not to be asked at all.
fn why_not() -> Option<String> {
    if env::var("POESCOPE_WEB").is_ok_and(|value| value == "off") {
        return Some("POESCOPE_WEB is off".to_owned());
    }
    if env::var_os("RA_RUSTC_WRAPPER").is_some() {
        return Some("this is an editor's check".to_owned());
    }
    let profile = env::var("PROFILE").unwrap_or_default();
    (profile != "release").then(|| {
        format!("this is the {profile} profile; `cargo run --release -- serve` has the page")
    })
}

/// Makes `work/dist` from `web` unless it is of these very sources. The source tree itself stays as it is.
fn bundle(web: &Path, work: &Path) -> Result<(), String> {
    let fingerprint = fingerprint(web).map_err(|error| format!("web/ cannot be read: {error}"))?;
    let stamp = work.join("fingerprint");
    if fs::read_to_string(&stamp).is_ok_and(|made| made == fingerprint)
        && work.join("dist/index.html").is_file()
    {
        return Ok(());
    }
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    if Command::new(npm)
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_err()
    {
        return Err("npm is not installed; install Node.js (20.19 or newer), then `touch build.rs` and build again".to_owned());
    }
    // The packages of the last time will do while they are those of the lockfile.
    let lock = |folder: &Path| fs::read(folder.join("package-lock.json")).ok();
    let installed = lock(work) == lock(web) && work.join(INSTALLED).is_file();
    let copied = (|| {
        fs::create_dir_all(work)?;
        // Whatever was deleted there must not live on here.
        remove(&work.join("src"))?;
        remove(&stamp)?;
        SOURCES
            .iter()
            .try_for_each(|source| copy(&web.join(source), &work.join(source)))
    })();
    copied.map_err(|error: io::Error| {
        format!("web/ cannot be copied to {}: {error}", work.display())
    })?;
    let quiet = [
        "--omit=dev",
        "--ignore-scripts",
        "--no-audit",
        "--no-fund",
        "--loglevel=error",
    ];
    if !installed {
        run(Command::new(npm).arg("ci").args(quiet), work)?;
    }
    run(
        Command::new("node")
            .args([
                "node_modules/vite/bin/vite.js",
                "build",
                "--logLevel",
                "error",
            ])
            .env("POESCOPE_WEB_OUT", "dist"),
        work,
    )?;
    fs::write(&stamp, fingerprint)
        .map_err(|error| format!("{} cannot be written: {error}", stamp.display()))
}

/// Runs it to its end; what it said first is the error.
fn run(command: &mut Command, folder: &Path) -> Result<(), String> {
    let name = format!("{command:?}");
    let output = command.current_dir(folder).stdin(Stdio::null()).output();
    let output = output.map_err(|error| format!("{name} does not start: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    let lines: Vec<&str> = said
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty())
        .collect();
    let first = lines[..lines.len().min(4)].join(" · ");
    Err(format!(
        "{name} failed ({}): {first}; `touch build.rs` to try again",
        output.status
    ))
}

/// A number that changes with any name or byte of the sources.
fn fingerprint(web: &Path) -> io::Result<String> {
    let mut hasher = DefaultHasher::new();
    for source in SOURCES {
        for file in files_below(&web.join(source))? {
            file.hash(&mut hasher);
            fs::read(&file)?.hash(&mut hasher);
        }
    }
    Ok(format!("{:016x}", hasher.finish()))
}

/// The file itself, or every file of a folder, sorted; nothing of what is not there.
fn files_below(path: &Path) -> io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(path
            .is_file()
            .then(|| path.to_owned())
            .into_iter()
            .collect());
    }
    let mut entries = fs::read_dir(path)?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<io::Result<Vec<_>>>()?;
    entries.sort();
    let mut files = Vec::new();
    for entry in entries {
        files.extend(files_below(&entry)?);
    }
    Ok(files)
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    for file in files_below(from)? {
        let target = to.join(file.strip_prefix(from).unwrap_or(&file));
        // A file joined with nothing gets a slash at its end.
        let target = if from == file { to.to_owned() } else { target };
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::copy(&file, &target)?;
    }
    Ok(())
}

fn remove(path: &Path) -> io::Result<()> {
    let removed = if path.is_dir() {
        fs::remove_dir_all(path)
    } else {
        fs::remove_file(path)
    };
    match removed {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// A Rust expression: path, media type and bytes of each file of the page, as the server hands them out.
fn listing(root: &Path, files: &[PathBuf]) -> String {
    let mut text = String::from("&[\n");
    for file in files {
        let path = file.strip_prefix(root).unwrap_or(file);
        let path = format!("/{}", path.to_string_lossy().replace('\\', "/"));
        let (path, kind) = match path.as_str() {
            "/index.html" | "/missing.html" => ("/", media_type("html")),
            path => (path, media_type(path)),
        };
        let source = file.to_string_lossy();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "    ({path:?}, {kind:?}, include_bytes!({source:?})),"
        );
    }
    text.push_str("]\n");
    text
}

fn media_type(path: &str) -> &'static str {
    match path.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        "txt" => "text/plain; charset=utf-8",
        "json" | "map" => "application/json",
        _ => "application/octet-stream",
    }
}

fn plain_page(reason: &str) -> String {
    let reason = reason
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>poescope: no page</title>\n\
         <h1>poescope is running, its page was not built</h1>\n<p>{reason}</p>\n\
         <p>The server works. The page needs Node.js at build time only: install it, then\n\
         <code>touch build.rs</code> and <code>cargo build --release</code>. Until then viser's own web client\n\
         shows the same session: open it with <code>?websocket=</code> and this page's address with\n\
         <code>ws:</code> in the place of <code>http:</code>. In a terminal, <code>poescope view</code> needs neither.</p>\n"
    )
}
