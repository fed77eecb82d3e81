//! One open file: its index, which channel plays which role, and the reading of its episodes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use mcap::MAGIC;
use mcap::records::{MessageHeader, Record, op};

use super::block_cache::BlockCache;
use super::chunk::{parse, unpack};
use super::collect::{Collector, Stream};
use super::error::DataError;
use super::index::{Index, Span};
use super::record::{LENGTH_LIMIT, Records, split_message};
use super::report::LeftOut;
use super::topics::{Role, Topics};
use super::{scan, streams, summary};
use crate::episode::{EpisodeMeta, Recording};

/// A file whose messages are read by seeking, one episode at a time.
#[derive(Debug)]
pub(super) struct McapFile {
    /// Its number in the dataset.
    pub(super) number: usize,
    pub(super) path: PathBuf,
    pub(super) index: Index,
    /// The channels that can be read.
    pub(super) streams: BTreeMap<u16, Stream>,
    pub(super) left_out: Vec<LeftOut>,
}

/// One message as it was recorded; it shares the block that it was unpacked with.
#[derive(Clone, Debug)]
pub(super) struct Raw {
    pub(super) header: MessageHeader,
    block: Arc<Vec<u8>>,
    payload: Range<usize>,
}

impl Raw {
    pub(super) fn payload(&self) -> &[u8] {
        self.block.get(self.payload.clone()).unwrap_or_default()
    }
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
        let mut index = match summary::read(&mut file, length) {
            Ok(index) => index,
            Err(why) => scan::read(&mut file, length, &why).map_err(DataError::io(path))?,
        };
        let found = streams::find(&index, topics);
        index.notes.extend(found.notes);
        Ok(Self {
            number,
            path: path.to_owned(),
            index,
            streams: found.readable,
            left_out: found.left_out,
        })
    }

    /// The episodes that the file names; else all of it is one, if it holds messages. What stands behind the last
    /// record of a file that was cut off is one, too: `unfinished`.
    pub(super) fn episodes(&self) -> Vec<EpisodeMeta> {
        let mut metas = self.index.episodes.clone();
        let Some((first, last)) = self.index.log_times else {
            return metas;
        };
        let nanos = |log_time| i64::try_from(log_time).unwrap_or(i64::MAX);
        let named_until = metas.iter().map(|meta| meta.end_nanos).max();
        let (id, start_nanos) = match named_until {
            None => (
                self.path
                    .file_stem()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into_owned(),
                nanos(first),
            ),
            Some(end) if self.index.cut.is_some() && end < nanos(last) => {
                ("unfinished".to_owned(), end + 1)
            }
            Some(_) => return metas,
        };
        metas.push(EpisodeMeta {
            id,
            start_nanos,
            end_nanos: nanos(last),
            ..EpisodeMeta::default()
        });
        metas
    }

    /// Time that lies in episodes, in seconds; what a cut has taken does not count.
    pub(super) fn recorded_secs(&self) -> f64 {
        let Some((_, last)) = self.index.log_times else {
            return 0.0;
        };
        self.episodes().iter().fold(0.0, |sum, meta| {
            let (start, end) = log_range(meta);
            let end = if self.index.cut.is_some() {
                end.min(last)
            } else {
                end
            };
            sum + end.saturating_sub(start) as f64 * 1e-9
        })
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

    fn spans_of<'a>(&'a self, meta: &'a EpisodeMeta) -> impl Iterator<Item = &'a Span> {
        self.index
            .spans
            .iter()
            .filter(move |span| overlaps(span, meta))
    }

    /// Reads one episode's messages, from the spans that it touches; frames as squares of `frame_size` pixels, if one is
    /// given, so that those of a long recording need not all be held as the camera made them.
    pub(super) fn recording(
        &self,
        meta: &EpisodeMeta,
        frame_size: Option<usize>,
        cache: &BlockCache,
    ) -> Result<Recording, DataError> {
        let mut file = File::open(&self.path).map_err(DataError::io(&self.path))?;
        let (start, end) = log_range(meta);
        let mut collector = Collector::new(frame_size);
        for span in self.spans_of(meta) {
            let block = cache.get((self.number, span.offset), || {
                self.read_span(&mut file, span)
            })?;
            self.each_message(span, &block, |header, payload| {
                let Some(&stream) = self.streams.get(&header.channel_id) else {
                    return Ok(());
                };
                let log = header.log_time;
                if !(start..=end).contains(&log) {
                    return Ok(());
                }
                collector
                    .push(stream, log, payload)
                    .map_err(|what| self.bad_message(span, header.channel_id, log, what))
            })?;
        }
        Ok(collector.finish(meta.clone()))
    }

    /// Every message of one episode as it was recorded, whether it can be read or not, by log time; in the order of the
    /// file where that is equal.
    pub(super) fn messages(
        &self,
        meta: &EpisodeMeta,
        cache: &BlockCache,
    ) -> Result<Vec<Raw>, DataError> {
        let mut file = File::open(&self.path).map_err(DataError::io(&self.path))?;
        let (start, end) = log_range(meta);
        let mut messages = Vec::new();
        for span in self.spans_of(meta) {
            let block = cache.get((self.number, span.offset), || {
                self.read_span(&mut file, span)
            })?;
            self.each_message(span, &block, |header, payload| {
                if (start..=end).contains(&header.log_time) {
                    let until = payload.as_ptr_range().end.addr() - block.as_ptr().addr();
                    messages.push(Raw {
                        header,
                        payload: until - payload.len()..until,
                        block: Arc::clone(&block),
                    });
                }
                Ok(())
            })?;
        }
        messages.sort_by_key(|message| message.header.log_time);
        Ok(messages)
    }

    /// How many images each of `metas` has, exactly: by the message indexes where there are some, else by reading
    /// through the chunks.
    pub(super) fn count_images(&self, metas: &[EpisodeMeta]) -> Result<Vec<u64>, DataError> {
        let mut file = File::open(&self.path).map_err(DataError::io(&self.path))?;
        let mut counts = vec![0; metas.len()];
        for span in &self.index.spans {
            if !metas.iter().any(|meta| overlaps(span, meta)) {
                continue;
            }
            let mut seen = Vec::new();
            if span.message_indexes.is_empty() {
                let block = self.read_span(&mut file, span)?;
                self.each_message(span, &block, |header, _| {
                    let stream = self.streams.get(&header.channel_id);
                    if stream.is_some_and(|stream| stream.role == Role::Vision) {
                        seen.push(header.log_time);
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
                if overlaps(span, meta) {
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

    /// Calls `each` with the messages of a block, whether their channels can be read or not.
    fn each_message(
        &self,
        span: &Span,
        block: &[u8],
        mut each: impl FnMut(MessageHeader, &[u8]) -> Result<(), DataError>,
    ) -> Result<(), DataError> {
        for record in Records::new(block) {
            let (opcode, body) = record.map_err(|what| self.damaged(span.offset, what))?;
            if opcode != op::MESSAGE {
                continue;
            }
            let Some((header, payload)) = split_message(body) else {
                return Err(self.damaged(span.offset, "a message without a head".to_owned()));
            };
            each(header, payload)?;
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

/// Whether a span may hold messages of an episode.
fn overlaps(span: &Span, meta: &EpisodeMeta) -> bool {
    let (start, end) = log_range(meta);
    span.log_times.0 <= end && span.log_times.1 >= start
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
    } else if start.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]) {
        "this is a file that Zstandard has packed, as rosbag2 does by file; unpack it with `zstd -d`"
    } else {
        "this is not an MCAP file (its first bytes are not MCAP's); name an .mcap recording"
    }
}
