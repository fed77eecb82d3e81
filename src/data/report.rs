//! What `info` says of a file.

use std::path::PathBuf;

use serde::Serialize;

use super::topics::Role;

/// One file of a dataset.
#[derive(Clone, Debug, Serialize)]
pub struct FileReport {
    /// Where it is.
    pub path: PathBuf,
    /// Its length.
    pub bytes: u64,
    /// The header's profile; `ros2` for recordings of the format.
    pub profile: String,
    /// What wrote it.
    pub library: String,
    /// How its chunks are compressed: `zstd`, `lz4`, `none`; empty where it is not chunked.
    pub compression: Vec<String>,
    /// How many chunks it has.
    pub chunks: usize,
    /// How many messages.
    pub messages: u64,
    /// First log time, in nanoseconds.
    pub start_nanos: Option<u64>,
    /// Last log time, in nanoseconds.
    pub end_nanos: Option<u64>,
    /// Hash of its length, its summary section and its episode records.
    pub data_hash: String,
    /// How many of its episodes open.
    pub episodes: usize,
    /// Its topics, by name.
    pub topics: Vec<TopicReport>,
    /// What cannot be used, and why.
    pub left_out: Vec<LeftOut>,
    /// How it was opened, where that was not plain.
    pub notes: Vec<String>,
}

/// One topic of a file.
#[derive(Clone, Debug, Serialize)]
pub struct TopicReport {
    /// Its name.
    pub topic: String,
    /// Its message type; none where the file does not say.
    pub message_type: Option<String>,
    /// What it is to an episode; none if left out.
    pub role: Option<Role>,
    /// How many messages it has.
    pub messages: u64,
    /// Messages a second of episode.
    pub rate_hz: Option<f64>,
}

/// Something that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// A topic, an episode's id, or a file.
    pub what: String,
    /// Why, and what to do.
    pub why: String,
}
