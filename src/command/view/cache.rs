//! Results that can be made again, as files of the user's cache folder.

use std::fs;
use std::path::PathBuf;

use crate::session::survey::Cache;

/// A folder of files, one a key.
#[derive(Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// `$XDG_CACHE_HOME/poescope`, else `~/.cache/poescope`; none where neither is known.
    pub fn of_user() -> Option<Self> {
        let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        let base = set("XDG_CACHE_HOME")
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
            .or_else(|| set("HOME").map(|home| PathBuf::from(home).join(".cache")));
        base.map(|base| Self(base.join("poescope")))
    }
}

impl Cache for Folder {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        fs::read(self.0.join(key)).ok()
    }

    /// Whole or not at all: two programs may write the same key.
    fn store(&self, key: &str, bytes: &[u8]) {
        let write = || -> std::io::Result<()> {
            fs::create_dir_all(&self.0)?;
            let mut file = tempfile::NamedTempFile::new_in(&self.0)?;
            std::io::Write::write_all(&mut file, bytes)?;
            file.persist(self.0.join(key))?;
            Ok(())
        };
        // A full disk only costs the time to make it again.
        let _ = write();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_stored_comes_back_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Folder(folder.path().join("new"));
        assert_eq!(cache.load("a.json"), None);
        cache.store("a.json", b"1");
        cache.store("a.json", b"22");
        assert_eq!(cache.load("a.json").as_deref(), Some(&b"22"[..]));
        let count = fs::read_dir(folder.path().join("new")).map(Iterator::count);
        assert_eq!(count.ok(), Some(1));
    }
}
