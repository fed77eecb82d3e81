//! The files that a browser is given: a fixed table, so that no path from a client ever reaches a file system.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use hyper::body::Bytes;

/// Bytes that a folder given instead of the built-in files may hold.
const LARGEST: u64 = 64 << 20;
/// Folders below it that are looked into.
const DEEPEST: usize = 4;

/// One file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asset {
    /// Its media type.
    pub mime: String,
    /// What it holds.
    pub bytes: Bytes,
}

/// Files by path.
#[derive(Clone, Debug, Default)]
pub struct Assets(BTreeMap<String, Asset>);

impl Assets {
    /// Those that were built in: the client's, else a page that says what is missing.
    pub fn built_in() -> Self {
        let files = BUILT_IN.iter().map(|&(path, mime, bytes)| {
            let asset = Asset {
                mime: mime.to_owned(),
                bytes: Bytes::from_static(bytes),
            };
            (path.to_owned(), asset)
        });
        Self(files.collect())
    }

    /// Those of a folder, read once, now.
    pub fn of_folder(folder: &Path) -> io::Result<Self> {
        let mut assets = BTreeMap::new();
        let mut left = LARGEST;
        read(folder, "/", DEEPEST, &mut left, &mut assets)?;
        if let Some(index) = assets.get("/index.html").cloned() {
            assets.insert("/".to_owned(), index);
            return Ok(Self(assets));
        }
        let missing = format!("{} has no index.html", folder.display());
        Err(io::Error::new(io::ErrorKind::NotFound, missing))
    }

    /// The file of a path.
    pub fn get(&self, path: &str) -> Option<&Asset> {
        self.0.get(path)
    }
}

fn read(
    folder: &Path,
    at: &str,
    depth: usize,
    left: &mut u64,
    assets: &mut BTreeMap<String, Asset>,
) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let Ok(name) = entry.file_name().into_string() else {
            continue;
        };
        let path = format!("{at}{name}");
        let kind = entry.file_type()?;
        if kind.is_dir() && depth > 0 {
            read(&entry.path(), &format!("{path}/"), depth - 1, left, assets)?;
        } else if kind.is_file() {
            let size = entry.metadata()?.len();
            *left = left.checked_sub(size).ok_or_else(|| {
                let most = LARGEST >> 20;
                io::Error::other(format!(
                    "{}: more than {most} MiB of files",
                    folder.display()
                ))
            })?;
            let bytes = Bytes::from(fs::read(entry.path())?);
            assets.insert(
                path,
                Asset {
                    mime: mime(&name).to_owned(),
                    bytes,
                },
            );
        }
    }
    Ok(())
}

/// The media type of a name.
fn mime(name: &str) -> &'static str {
    match Path::new(name).extension().and_then(|end| end.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("wasm") => "application/wasm",
        _ => "application/octet-stream",
    }
}

/// Path, media type and bytes of each, as `build.rs` made them.
const BUILT_IN: &[(&str, &str, &[u8])] = include!(concat!(env!("OUT_DIR"), "/web_assets.rs"));

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use super::*;

    #[test]
    fn there_is_always_a_page() {
        let page = Assets::built_in().get("/").cloned().unwrap();
        assert!(page.mime.starts_with("text/html"));
        assert!(String::from_utf8_lossy(&page.bytes).contains("poescope"));
    }

    #[test]
    fn only_what_is_in_the_table_is_there() {
        let folder = tempfile::tempdir().unwrap();
        assert!(Assets::of_folder(folder.path()).is_err());
        fs::write(folder.path().join("index.html"), "page").unwrap();
        fs::create_dir(folder.path().join("assets")).unwrap();
        fs::write(folder.path().join("assets/a.js"), "code").unwrap();
        let assets = Assets::of_folder(folder.path()).unwrap();
        assert_eq!(assets.get("/").unwrap().bytes, "page");
        assert!(
            assets
                .get("/assets/a.js")
                .unwrap()
                .mime
                .contains("javascript")
        );
        for path in [
            "/../Cargo.toml",
            "/assets/../index.html",
            "//",
            "/assets/",
            "index.html",
        ] {
            assert_eq!(assets.get(path), None, "{path}");
        }
    }
}
