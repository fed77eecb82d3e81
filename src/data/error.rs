//! What can be wrong with a dataset: which file, where in it, and what to do.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why data could not be read, laid out or written.
#[derive(Debug, Error)]
pub enum DataError {
    /// The operating system refused.
    #[error("{}: {cause}{}", path.display(), advice(cause))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What it said.
        cause: io::Error,
    },
    /// A folder without recordings.
    #[error("{}: no .mcap file in this folder{found}; name a file, or a folder that holds some", path.display())]
    EmptyFolder {
        /// The folder.
        path: PathBuf,
        /// What there is of other recordings, and what to do about them.
        found: String,
    },
    /// Some other kind of file.
    #[error("{}: {what}", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// What it is instead, and what to do about it.
        what: String,
    },
    /// Bytes that are not what was written.
    #[error("{}: damaged at byte {offset}: {what}; record or copy the file again, or leave the episode out", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where the damaged record begins.
        offset: u64,
        /// What does not fit.
        what: String,
    },
    /// A message that does not decode as its type.
    #[error("{}: {topic}, message logged at {log_time_nanos} ns (record group at byte {offset}): {what}", path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// The topic it was logged on.
        topic: String,
        /// Its log time in nanoseconds.
        log_time_nanos: u64,
        /// Where the chunk that holds it begins.
        offset: u64,
        /// What does not fit.
        what: String,
    },
    /// A recording without the two images that make an episode.
    #[error(
        "{place}: {images} image(s), and an episode needs two; leave it out, or name the camera's with --topic vision=TOPIC"
    )]
    TooFewImages {
        /// Which episode, of which file where that is known.
        place: String,
        /// How many images it has.
        images: usize,
    },
    /// Nothing in the dataset can be shown.
    #[error("{}: no episode can be opened: {why}; record or copy it again, or see what it holds with `poescope info`", path.display())]
    NoEpisode {
        /// The file or folder.
        path: PathBuf,
        /// What was found instead.
        why: String,
    },
    /// An episode that is not there.
    #[error("{}: no episode {index}, the dataset has {count}", path.display())]
    OutOfRange {
        /// The file or folder.
        path: PathBuf,
        /// Which was asked for, from 0.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A `dataset.toml` that cannot be used.
    #[error("{}: {what}; it holds a table [topics] with any of vision, haptic, ee_pose, ee_twist, control, object", path.display())]
    Mapping {
        /// The mapping file.
        path: PathBuf,
        /// What the parser said.
        what: String,
    },
    /// Topics named by the caller that cannot be used.
    #[error("--topic: {0}; give each role one topic, and each topic one role")]
    Named(String),
    /// A topic named by the caller that no recording can be read from.
    #[error("{}: --topic {what}", path.display())]
    NoSuchTopic {
        /// The file or folder.
        path: PathBuf,
        /// The role and the topic, why it cannot be read, and which could.
        what: String,
    },
    /// A recording that cannot be written.
    #[error("{}: episode {episode}: {what}", path.display())]
    Unwritable {
        /// The file being written.
        path: PathBuf,
        /// Its id.
        episode: String,
        /// What does not fit.
        what: String,
    },
    /// The container could not be written.
    #[error("{}: cannot write: {cause}", path.display())]
    Write {
        /// The file being written.
        path: PathBuf,
        /// What went wrong.
        cause: mcap::McapError,
    },
}

impl DataError {
    /// Adds the path to an error of the operating system: `map_err(DataError::io(path))`.
    pub(super) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        |cause| Self::Io {
            path: path.to_owned(),
            cause,
        }
    }
}

/// What to do about an error of the operating system, where that can be known.
fn advice(cause: &io::Error) -> &'static str {
    match cause.kind() {
        ErrorKind::NotFound => "; check the path",
        ErrorKind::PermissionDenied => "; change the permissions, or choose another path",
        ErrorKind::StorageFull => "; make room, or choose another disk",
        _ => "",
    }
}
