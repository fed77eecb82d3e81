//! What is known of a file before its messages are read.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::{ChunkIndex, Metadata, Record};

use super::hash::Fnv;
use crate::episode::{EpisodeMeta, Split};

/// A definition that came with a file.
#[derive(Clone, Debug)]
pub(super) struct Schema {
    pub(super) name: String,
    pub(super) encoding: String,
    pub(super) text: Vec<u8>,
}

/// One stream of messages.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) encoding: String,
    pub(super) schema_id: u16,
    /// What else its record says, like the quality of service it was offered with.
    pub(super) metadata: BTreeMap<String, String>,
}

/// A stretch of the data section that is read at once: a chunk record, or a run of plain messages.
#[derive(Clone, Debug)]
pub(super) struct Span {
    /// Where its first record begins.
    pub(super) offset: u64,
    /// Its bytes, the record's head included.
    pub(super) length: u64,
    /// First and last log time in it.
    pub(super) log_times: (u64, u64),
    /// Where each channel's message index lies; empty where the file has none.
    pub(super) message_indexes: BTreeMap<u16, u64>,
}

impl From<ChunkIndex> for Span {
    fn from(index: ChunkIndex) -> Self {
        Self {
            offset: index.chunk_start_offset,
            length: index.chunk_length,
            log_times: (index.message_start_time, index.message_end_time),
            message_indexes: index.message_index_offsets,
        }
    }
}

/// A file's table of contents.
#[derive(Debug, Default)]
pub(super) struct Index {
    pub(super) bytes: u64,
    pub(super) profile: String,
    pub(super) library: String,
    /// Kinds of chunks: `zstd`, `lz4`, `none`.
    pub(super) compression: BTreeSet<String>,
    pub(super) chunks: usize,
    pub(super) schemas: BTreeMap<u16, Schema>,
    pub(super) channels: BTreeMap<u16, Channel>,
    pub(super) counts: BTreeMap<u16, u64>,
    /// In file order.
    pub(super) spans: Vec<Span>,
    /// First and last log time; none without messages.
    pub(super) log_times: Option<(u64, u64)>,
    /// What the file's `episode` records say.
    pub(super) episodes: Vec<EpisodeMeta>,
    /// Whether it comes from a pass over the records, not from a summary.
    pub(super) scanned: bool,
    /// Where the file ends in the middle, in words; none for a whole one.
    pub(super) cut: Option<String>,
    /// What is worth telling about how it was opened.
    pub(super) notes: Vec<String>,
    /// The data hash, 16 hexadecimal digits.
    pub(super) hash: String,
}

impl Index {
    /// Takes in a record of the kinds that describe a file.
    pub(super) fn describe(&mut self, record: Record<'_>) {
        match record {
            Record::Header(header) => {
                self.profile = header.profile;
                self.library = header.library;
            }
            Record::Schema { header, data } => {
                let schema = Schema {
                    name: header.name,
                    encoding: header.encoding,
                    text: data.into_owned(),
                };
                self.schemas.insert(header.id, schema);
            }
            Record::Channel(channel) => {
                let kept = Channel {
                    topic: channel.topic,
                    encoding: channel.message_encoding,
                    schema_id: channel.schema_id,
                    metadata: channel.metadata,
                };
                self.channels.insert(channel.id, kept);
            }
            Record::Metadata(metadata) if metadata.name == "episode" => self.episode(&metadata),
            _ => {}
        }
    }

    /// Counts a kind of chunk.
    pub(super) fn chunk(&mut self, compression: &str) {
        let name = if compression.is_empty() {
            "none"
        } else {
            compression
        };
        if !self.compression.contains(name) {
            self.compression.insert(name.to_owned());
        }
        self.chunks += 1;
    }

    fn episode(&mut self, record: &Metadata) {
        let value = |key: &str| record.metadata.get(key).cloned();
        let nanos = |key| value(key).and_then(|text| text.parse::<i64>().ok());
        let id = value("id").unwrap_or_else(|| format!("episode-{}", self.episodes.len()));
        let (Some(start_nanos), Some(end_nanos)) = (nanos("start_ns"), nanos("end_ns")) else {
            self.notes.push(format!(
                "the record of episode {id} has no start_ns and end_ns: left out"
            ));
            return;
        };
        let split = value("split");
        let meta = EpisodeMeta {
            split: split.as_deref().and_then(Split::from_name),
            object: value("object"),
            surface: value("surface"),
            source: value("source"),
            seed: value("seed").and_then(|text| text.parse().ok()),
            start_nanos,
            end_nanos,
            id,
        };
        if let (Some(name), None) = (split, meta.split) {
            self.notes.push(format!(
                "episode {} is of split {name:?}; known are train, val, test",
                meta.id
            ));
        }
        self.episodes.push(meta);
    }

    /// Sets the data hash: of the length, of the bytes that index the file and sum up what is not packed, and of the
    /// episode records.
    pub(super) fn seal(&mut self, indexing: &[u8]) {
        let mut hash = Fnv::new();
        hash.update(&self.bytes.to_le_bytes());
        hash.update(indexing);
        for meta in &self.episodes {
            for text in [
                Some(meta.id.as_str()),
                meta.split.map(Split::name),
                meta.object.as_deref(),
                meta.surface.as_deref(),
                meta.source.as_deref(),
            ] {
                hash.update(text.unwrap_or_default().as_bytes());
                hash.update(&[0]);
            }
            hash.update(&meta.start_nanos.to_le_bytes());
            hash.update(&meta.end_nanos.to_le_bytes());
            hash.update(&meta.seed.unwrap_or_default().to_le_bytes());
        }
        self.hash = hash.hex();
    }
}
