//! A file that is there whole or not at all.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::ExportError;

/// What is written so far. It lies in the folder of the file to be, hidden, under a name that says what it was going
/// to be (`.steps.csv.Ab3dE6.partial`), and takes its name when it is committed. Dropped before, it is removed; after
/// a kill it stays and may be deleted.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    force: bool,
    writer: BufWriter<NamedTempFile>,
}

impl Output {
    /// Begins the file that will be `path`; `force` replaces one that is there.
    ///
    /// # Errors
    /// If there is one and `force` is not set, if it is no regular file, or if its folder cannot be written to.
    pub fn create(path: &Path, force: bool) -> Result<Self, ExportError> {
        let refused = |what| ExportError::Name {
            path: path.to_owned(),
            what,
        };
        match path.symlink_metadata() {
            Ok(found) if found.is_dir() => {
                return Err(refused("this is a folder; name a file"));
            }
            Ok(found) if !found.is_file() && !found.is_symlink() => {
                return Err(refused("this is no regular file; name one"));
            }
            Ok(_) if !force => return Err(ExportError::Exists(path.to_owned())),
            _ => {}
        }
        let Some(name) = path.file_name() else {
            return Err(refused("this is no name of a file; name one"));
        };
        let folder = folder(path);
        if !folder.is_dir() {
            return Err(refused("its folder is not there; make it first"));
        }
        let mut builder = Builder::new();
        let prefix = format!(".{}.", name.to_string_lossy());
        builder.prefix(&prefix).suffix(".partial");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As any new file: the umask takes its part.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder).map_err(io_error(path))?;
        Ok(Self {
            path: path.to_owned(),
            force,
            writer: BufWriter::with_capacity(1 << 16, file),
        })
    }

    /// The name that it will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where it lies until then, for writers that open files by name.
    pub fn partial(&self) -> &Path {
        self.writer.get_ref().path()
    }

    /// Adds to an error what was being written: `map_err(output.failed())`.
    pub fn failed(&self) -> impl Fn(io::Error) -> ExportError + use<> {
        io_error(&self.path)
    }

    /// Gives it its name, once it is on the disk.
    ///
    /// # Errors
    /// If the disk refuses, or if another file has taken the name meanwhile and must not be replaced.
    pub fn commit(self) -> Result<(), ExportError> {
        let Self {
            path,
            force,
            writer,
        } = self;
        let failed = io_error(&path);
        let file = writer
            .into_inner()
            .map_err(|error| failed(error.into_error()))?;
        // Not through the handle: what another writer has put there under the name counts as well.
        OpenOptions::new()
            .write(true)
            .open(file.path())
            .and_then(|file| file.sync_all())
            .map_err(&failed)?;
        let named = if force {
            file.persist(&path)
        } else {
            file.persist_noclobber(&path)
        };
        named.map_err(|refused| match refused.error.kind() {
            ErrorKind::AlreadyExists => ExportError::Exists(path.clone()),
            _ => failed(refused.error),
        })?;
        // The name itself is on the disk once the folder is; a system that cannot say so still has the file.
        let _ = File::open(folder(&path)).and_then(|folder| folder.sync_all());
        Ok(())
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

impl Seek for Output {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.writer.seek(to)
    }
}

fn folder(path: &Path) -> &Path {
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}

fn io_error(path: &Path) -> impl Fn(io::Error) -> ExportError + use<> {
    let path = path.to_owned();
    move |cause| ExportError::Io {
        path: path.clone(),
        cause,
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let name = |entry: io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<_> = entries
            .map(|entry| name(entry).to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_has_its_name_only_once_it_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut output = Output::create(&path, false).unwrap();
        output.write_all(b"1,2\n").unwrap();
        let [partial] = &names(folder.path())[..] else {
            panic!("one file");
        };
        assert!(partial.starts_with(".a.csv.") && partial.ends_with(".partial"));
        output.commit().unwrap();
        assert_eq!(names(folder.path()), ["a.csv"]);
        assert_eq!(std::fs::read(&path).unwrap(), b"1,2\n");
        drop(Output::create(&path, true).unwrap());
        assert_eq!(names(folder.path()), ["a.csv"], "nothing is left behind");
    }

    #[test]
    fn a_file_that_is_there_is_kept_unless_it_may_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let early = Output::create(&path, false).unwrap();
        std::fs::write(&path, b"mine").unwrap();
        assert!(matches!(
            Output::create(&path, false),
            Err(ExportError::Exists(_))
        ));
        let said = early.commit().unwrap_err().to_string();
        assert!(said.contains("--force"), "{said}");
        assert_eq!(std::fs::read(&path).unwrap(), b"mine");
        let mut forced = Output::create(&path, true).unwrap();
        forced.write_all(b"new").unwrap();
        forced.commit().unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn what_can_be_no_file_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        for (path, word) in [
            (folder.path().to_owned(), "folder"),
            (folder.path().join("no/a.csv"), "make it first"),
            (PathBuf::from("/"), "folder"),
            #[cfg(unix)]
            (PathBuf::from("/dev/null"), "no regular file"),
        ] {
            let said = Output::create(&path, true).unwrap_err().to_string();
            assert!(said.contains(word), "{said}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_it_as_far_as_the_umask_lets_them() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let usual = folder.path().join("usual");
        std::fs::write(&usual, b"").unwrap();
        let path = folder.path().join("a.csv");
        Output::create(&path, false).unwrap().commit().unwrap();
        let mode = |path: &Path| path.metadata().unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&usual));
    }
}
