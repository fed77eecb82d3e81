//! One open file: its index, which channel plays which role, and the reading of its episodes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use mcap::MAGIC;
use mcap::records::{Record, op};

use super::block_cache::BlockCache;
use super::chunk::{parse, unpack};
use super::collect::{Collector, Stream};
use super::error::DataError;
use super::index::{Index, Span};
use super::message_type::MessageType;
use super::record::{LENGTH_LIMIT, Records, split_message};
use super::report::LeftOut;
use super::topics::{Role, Topics};
use super::{scan, schema, summary};
use crate::episode::{EpisodeMeta, Recording};

/// A file whose messages are read by seeking, one episode at a time.
#[derive(Debug)]
pub(super) struct McapFile {
    /// Its number in the dataset, for the cache.
    number: usize,
    pub(super) path: PathBuf,
    pub(super) index: Index,
    /// The channels that can be read.
    pub(super) streams: BTreeMap<u16, Stream>,
    pub(super) left_out: Vec<LeftOut>,
}

impl McapFile {
    /// Opens a file: by its summary, or by a scan where it has none that can be used.
    pub(super) fn open(path: &Path, topics: &Topics, number: usize) -> Result<Self, DataError> {
        let mut file = File::open(path).map_err(DataError::io(path))?;
        let length = file.metadata().map_err(DataError::io(path))?.len();
        let mut start = Vec::new();
        file.by_ref()
            .take(16)
            .read_to_end(&mut start)
            .map_err(DataError::io(path))?;
        if !start.starts_with(MAGIC) {
            return Err(DataError::NotMcap {
                path: path.to_owned(),
                what: what_it_is(&start).to_owned(),
            });
        }
        let index = match summary::read(&mut file, length) {
            Ok(index) => index,
            Err(why) => scan::read(&mut file, length, &why).map_err(DataError::io(path))?,
        };
        let mut opened = Self {
            number,
            path: path.to_owned(),
            index,
            streams: BTreeMap::new(),
            left_out: Vec::new(),
        };
        opened.find_streams(topics);
        Ok(opened)
    }

    fn find_streams(&mut self, topics: &Topics) {
        for (&id, channel) in &self.index.channels {
            let Some(role) = topics.role(&channel.topic) else {
                self.left_out.push(LeftOut {
                    what: channel.topic.clone(),
                    why: "has no role; name it in dataset.toml to give it one".to_owned(),
                });
                continue;
            };
            match self.stream(role, id) {
                Ok(stream) => {
                    self.streams.insert(id, stream);
                }
                Err(why) => self.left_out.push(LeftOut {
                    what: channel.topic.clone(),
                    why,
                }),
            }
        }
        for stream in self.streams.iter() {
            let Some(channel) = self.index.channels.get(stream.0) else {
                continue;
            };
            let schema = self.index.schemas.get(&channel.schema_id);
            if schema.is_some_and(|schema| schema.text.is_empty()) {
                self.index.notes.push(format!(
                    "{}: the file has no definition of {}, so the built-in one is used",
                    channel.topic,
                    stream.1.ty.name()
                ));
            }
        }
    }

    /// How to read channel `id` as `role`, or why it cannot be.
    fn stream(&self, role: Role, id: u16) -> Result<Stream, String> {
        let channel = self.index.channels.get(&id).ok_or("it is not described")?;
        let schema = self
            .index
            .schemas
            .get(&channel.schema_id)
            .ok_or("it has no schema, so its type is unknown; record it with its definition")?;
        if channel.encoding != "cdr" {
            return Err(format!(
                "messages of {} are encoded as {:?}; only cdr can be read",
                schema.name, channel.encoding
            ));
        }
        let accepted = role.types();
        let ty = MessageType::from_name(&schema.name)
            .filter(|ty| accepted.contains(ty))
            .ok_or_else(|| {
                let names: Vec<_> = accepted.iter().map(|ty| ty.name()).collect();
                format!(
                    "has type {}; as {} it can be {}",
                    schema.name,
                    role.name(),
                    names.join(" or ")
                )
            })?;
        if schema.text.is_empty() {
            return Ok(Stream { role, ty });
        }
        if schema.encoding != "ros2msg" {
            return Err(format!(
                "the definition of {} is in {:?}; only ros2msg can be read",
                schema.name, schema.encoding
            ));
        }
        let text = std::str::from_utf8(&schema.text)
            .map_err(|_| format!("the definition of {} is no text", schema.name))?;
        schema::check(ty, text).map_err(|why| format!("has type {}, but {why}", schema.name))?;
        Ok(Stream { role, ty })
    }

    /// The episodes that the file names; else all of it is one, if it holds messages.
    pub(super) fn episodes(&self) -> Vec<EpisodeMeta> {
        if !self.index.episodes.is_empty() {
            return self.index.episodes.clone();
        }
        let whole = self.index.log_times.map(|(first, last)| EpisodeMeta {
            id: self
                .path
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()),
            start_nanos: i64::try_from(first).unwrap_or(i64::MAX),
            end_nanos: i64::try_from(last).unwrap_or(i64::MAX),
            ..EpisodeMeta::default()
        });
        whole.into_iter().collect()
    }

    /// Messages on the camera's channels in the whole file.
    pub(super) fn images(&self) -> u64 {
        self.vision()
            .filter_map(|id| self.index.counts.get(&id))
            .sum()
    }

    fn vision(&self) -> impl Iterator<Item = u16> + '_ {
        self.streams
            .iter()
            .filter(|(_, stream)| stream.role == Role::Vision)
            .map(|(&id, _)| id)
    }

    /// Whether the chunk indexes alone rule out that `meta` has an image.
    pub(super) fn is_blind(&self, meta: &EpisodeMeta) -> bool {
        !self.spans_of(meta).any(|span| {
            span.message_indexes.is_empty()
                || self
                    .vision()
                    .any(|id| span.message_indexes.contains_key(&id))
        })
    }

    fn spans_of<'a>(&'a self, meta: &EpisodeMeta) -> impl Iterator<Item = &'a Span> + use<'a> {
        let (start, end) = log_range(meta);
        self.index
            .spans
            .iter()
            .filter(move |span| span.log_times.0 <= end && span.log_times.1 >= start)
    }

    /// Reads one episode's messages, from the spans that it touches.
    pub(super) fn recording(
        &self,
        meta: &EpisodeMeta,
        cache: &BlockCache,
    ) -> Result<Recording, DataError> {
        let mut file = File::open(&self.path).map_err(DataError::io(&self.path))?;
        let (start, end) = log_range(meta);
        let mut collector = Collector::default();
        for span in self.spans_of(meta) {
            let block = cache.get((self.number, span.offset), || {
                self.read_span(&mut file, span)
            })?;
            self.each_message(span, &block, |id, stream, log, payload| {
                if !(start..=end).contains(&log) {
                    return Ok(());
                }
                collector
                    .push(stream, log, payload)
                    .map_err(|what| self.bad_message(span, id, log, what))
            })?;
        }
        Ok(collector.finish(meta.clone()))
    }

    /// How many images each of `metas` has, exactly: by the message indexes where there are some, else by reading
    /// through the chunks.
    pub(super) fn count_images(&self, metas: &[EpisodeMeta]) -> Result<Vec<u64>, DataError> {
        let mut file = File::open(&self.path).map_err(DataError::io(&self.path))?;
        let mut counts = vec![0; metas.len()];
        for span in &self.index.spans {
            let mut seen = Vec::new();
            if span.message_indexes.is_empty() {
                let block = self.read_span(&mut file, span)?;
                self.each_message(span, &block, |_, stream, log, _| {
                    if stream.role == Role::Vision {
                        seen.push(log);
                    }
                    Ok(())
                })?;
            } else {
                for offset in self.vision().filter_map(|id| span.message_indexes.get(&id)) {
                    self.read_message_index(&mut file, *offset, &mut seen)?;
                }
            }
            for (meta, count) in metas.iter().zip(&mut counts) {
                let (start, end) = log_range(meta);
                if span.log_times.0 <= end && span.log_times.1 >= start {
                    *count += seen
                        .iter()
                        .filter(|&log| (start..=end).contains(log))
                        .count() as u64;
                }
            }
        }
        Ok(counts)
    }

    fn read_message_index(
        &self,
        file: &mut File,
        offset: u64,
        log_times: &mut Vec<u64>,
    ) -> Result<(), DataError> {
        let damaged = |what: String| self.damaged(offset, what);
        let body = summary::record_at(file, self.index.bytes, offset).map_err(damaged)?;
        let Record::MessageIndex(index) = parse(op::MESSAGE_INDEX, &body).map_err(damaged)? else {
            return Ok(());
        };
        log_times.extend(index.records.iter().map(|entry| entry.log_time));
        Ok(())
    }

    /// The records of a span.
    fn read_span(&self, file: &mut File, span: &Span) -> Result<Vec<u8>, DataError> {
        let end = span.offset.checked_add(span.length);
        let fits = end.is_some_and(|end| end <= self.index.bytes);
        if !fits || span.length > LENGTH_LIMIT as u64 * 2 {
            return Err(self.damaged(span.offset, format!("a chunk of {} bytes", span.length)));
        }
        let mut bytes = vec![0; span.length as usize];
        file.seek(SeekFrom::Start(span.offset))
            .and_then(|_| file.read_exact(&mut bytes))
            .map_err(DataError::io(&self.path))?;
        unpack(&bytes).map_err(|what| self.damaged(span.offset, what))
    }

    /// Calls `each` with the messages of readable channels in a block: channel, stream, log time, payload.
    fn each_message(
        &self,
        span: &Span,
        block: &[u8],
        mut each: impl FnMut(u16, Stream, u64, &[u8]) -> Result<(), DataError>,
    ) -> Result<(), DataError> {
        for record in Records::new(block) {
            let (opcode, body) = record.map_err(|what| self.damaged(span.offset, what))?;
            if opcode != op::MESSAGE {
                continue;
            }
            let Some((id, log_time, payload)) = split_message(body) else {
                return Err(self.damaged(span.offset, "a message without a head".to_owned()));
            };
            if let Some(&stream) = self.streams.get(&id) {
                each(id, stream, log_time, payload)?;
            }
        }
        Ok(())
    }

    fn bad_message(&self, span: &Span, id: u16, log_time_nanos: u64, what: String) -> DataError {
        let channel = self.index.channels.get(&id);
        DataError::Message {
            path: self.path.clone(),
            topic: channel.map_or_else(String::new, |channel| channel.topic.clone()),
            log_time_nanos,
            offset: span.offset,
            what,
        }
    }

    fn damaged(&self, offset: u64, what: String) -> DataError {
        DataError::Damaged {
            path: self.path.clone(),
            offset,
            what,
        }
    }
}

/// An episode's first and last log time.
fn log_range(meta: &EpisodeMeta) -> (u64, u64) {
    let start = u64::try_from(meta.start_nanos).unwrap_or(0);
    match u64::try_from(meta.end_nanos) {
        Ok(end) => (start, end),
        // Before 1970: nothing lies in it.
        Err(_) => (u64::MAX, 0),
    }
}

/// What a file without MCAP's first bytes is, and what to do about it.
fn what_it_is(start: &[u8]) -> &'static str {
    if start.is_empty() {
        "the file is empty; record or copy it again"
    } else if start.starts_with(b"#ROSBAG") {
        "this is a ROS 1 bag; convert it with rosbags-convert"
    } else if start.starts_with(b"SQLite format 3") {
        "this is a rosbag2 SQLite file; convert it with `ros2 bag convert` to MCAP"
    } else {
        "this is not an MCAP file (its first bytes are not MCAP's); name an .mcap recording"
    }
}
