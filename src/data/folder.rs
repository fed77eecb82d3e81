//! Which recordings a folder holds: its `.mcap` files, or those of the bags in it, as `ros2 bag record` leaves them.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::DataError;

/// What rosbag2 writes beside the files of one bag.
const BAG: &str = "metadata.yaml";

/// The `.mcap` files of a folder by name; where it has none, those of the folders in it.
///
/// # Errors
/// If the folder cannot be read, or no file is found.
pub(super) fn recordings(folder: &Path) -> Result<Vec<PathBuf>, DataError> {
    let entries = entries(folder)?;
    let mut found = of_kind(&entries, "mcap");
    if found.is_empty() {
        for bag in entries.iter().filter(|entry| entry.is_dir()) {
            // What cannot be looked into is no bag of this user's.
            found.extend(of_kind(&self::entries(bag).unwrap_or_default(), "mcap"));
        }
    }
    if found.is_empty() {
        return Err(DataError::EmptyFolder {
            path: folder.to_owned(),
            found: other(&entries),
        });
    }
    Ok(found)
}

/// The folders whose recordings are parts of one: a bag that was split by size or duration.
pub(super) fn split_bags<'a>(recordings: impl Iterator<Item = &'a Path>) -> Vec<&'a Path> {
    let mut folders: Vec<&Path> = recordings.filter_map(Path::parent).collect();
    folders.sort_unstable();
    let several = folders.chunk_by(|a, b| a == b).filter(|it| it.len() > 1);
    let bags = several.filter_map(|it| it.first().copied());
    bags.filter(|folder| folder.join(BAG).is_file()).collect()
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, DataError> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(DataError::io(folder))? {
        paths.push(entry.map_err(DataError::io(folder))?.path());
    }
    paths.sort();
    Ok(paths)
}

fn of_kind(paths: &[PathBuf], ending: &str) -> Vec<PathBuf> {
    let is_kind = |path: &&PathBuf| path.extension().is_some_and(|own| own == ending);
    paths.iter().filter(is_kind).cloned().collect()
}

/// Recordings of other kinds, and what to do about them.
fn other(paths: &[PathBuf]) -> String {
    let kinds = [
        ("zstd", "unpack it with `zstd -d`"),
        ("db3", "convert the bag with `ros2 bag convert` to MCAP"),
        ("bag", "convert it with rosbags-convert"),
    ];
    let known = kinds.iter().find_map(|(ending, remedy)| {
        let found = of_kind(paths, ending);
        let name = found.first()?.file_name()?.to_string_lossy().into_owned();
        Some(format!(", but {name}: {remedy}"))
    });
    known.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let path = folder.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let paths = recordings(folder).unwrap();
        let name = |path: &PathBuf| path.strip_prefix(folder).unwrap().display().to_string();
        paths.iter().map(name).collect()
    }

    #[test]
    fn its_own_recordings_go_before_those_of_bags_in_it() {
        let bags = ["b/b_0.mcap", "a/a_1.mcap", "a/a_0.mcap", "a/metadata.yaml"];
        let of_bags = folder(&bags);
        let own = folder(&[&bags[..], &["z.mcap", "c.txt"]].concat());
        assert_eq!(
            names(of_bags.path()),
            ["a/a_0.mcap", "a/a_1.mcap", "b/b_0.mcap"]
        );
        assert_eq!(names(own.path()), ["z.mcap"]);
    }

    #[test]
    fn several_files_beside_the_metadata_of_a_bag_are_one_recording() {
        let made = folder(&["a/a_0.mcap", "a/a_1.mcap", "a/metadata.yaml", "b/b_0.mcap"]);
        fs::write(made.path().join("b").join(BAG), "").unwrap();
        let paths = recordings(made.path()).unwrap();
        let split = split_bags(paths.iter().map(PathBuf::as_path));
        assert_eq!(split, [made.path().join("a")]);
    }

    #[test]
    fn recordings_of_other_kinds_are_named_with_what_to_do() {
        for (file, words) in [
            (
                "bag_0.mcap.zstd",
                ", but bag_0.mcap.zstd: unpack it with `zstd -d`; name",
            ),
            ("bag_0.db3", "`ros2 bag convert` to MCAP; name"),
            ("notes.txt", "no .mcap file in this folder; name"),
        ] {
            let made = folder(&[file]);
            let said = recordings(made.path()).unwrap_err().to_string();
            assert!(said.contains(words), "{said}");
        }
    }
}
