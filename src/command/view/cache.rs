//! Results that can be made again, as files of the user's cache folder.

use std::fs;
use std::path::PathBuf;

use crate::session::survey::Cache;

/// Files that are kept: a run that is followed leaves one for each of its checkpoints, and asks for none again.
const MOST: usize = 100;

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

    /// Removes the oldest files beyond so many.
    fn keep(&self, most: usize) -> std::io::Result<()> {
        let mut files = Vec::new();
        for entry in fs::read_dir(&self.0)? {
            let entry = entry?;
            // Another program may have removed it by now.
            let file = entry.metadata().ok().filter(fs::Metadata::is_file);
            let modified = file.and_then(|file| file.modified().ok());
            files.extend(modified.map(|modified| (modified, entry.path())));
        }
        files.sort();
        let beyond = files.len().saturating_sub(most);
        for (_, path) in &files[..beyond] {
            let _ = fs::remove_file(path);
        }
        Ok(())
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
            self.keep(MOST)
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
        let old = fs::File::options().write(true).open(cache.0.join("a.json"));
        let dated = old.and_then(|file| file.set_modified(std::time::UNIX_EPOCH));
        dated.expect("a file of long ago");
        cache.store("b.json", b"3");
        cache.keep(1).expect("one file is removed");
        assert_eq!(
            (cache.load("a.json"), cache.load("b.json")),
            (None, Some(b"3".to_vec()))
        );
    }
}
