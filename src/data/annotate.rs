//! Writes episodes again with more channels beside the recorded ones: every message as it was, none touched, and notes
//! at the steps they are about.

mod value;

use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use mcap::Writer;
use mcap::records::{MessageHeader, Metadata};

pub use self::value::Value;
use super::cdr::{CompressedImage, Image, decode};
use super::dataset::Dataset;
use super::error::DataError;
use super::index::Channel;
use super::mcap_file::{McapFile, Raw};
use super::message_type::MessageType;
use super::topics::Role;
use super::write::{QOS, entries, options, write_error};

/// A message to be written beside the recorded ones.
#[derive(Clone, Debug)]
pub struct Note<'a> {
    /// Its topic.
    pub topic: String,
    /// The step's stamp: that of its image, in nanoseconds since the Unix epoch.
    pub stamp_nanos: i64,
    /// What it says.
    pub value: Value<'a>,
}

/// An interval of log time and whose it is.
struct Taken {
    start: i64,
    end: i64,
    episode: String,
}

/// A dataset with notes, growing.
pub struct Annotated<W: Write + Seek> {
    /// For messages to the user.
    path: PathBuf,
    writer: Writer<W>,
    /// Recorded channels: file, and number there, to number here.
    channels: BTreeMap<(usize, u16), u16>,
    /// Channels of notes by topic.
    notes: BTreeMap<String, u16>,
    taken: Vec<Taken>,
    payload: Vec<u8>,
}

impl<W: Write + Seek> Annotated<W> {
    /// Begins a file that will be `path`, into `into`.
    ///
    /// # Errors
    /// If it cannot be written to.
    pub fn create(into: W, path: &Path) -> Result<Self, DataError> {
        Ok(Self {
            writer: options().create(into).map_err(write_error(path))?,
            path: path.to_owned(),
            channels: BTreeMap::new(),
            notes: BTreeMap::new(),
            taken: Vec::new(),
            payload: Vec::new(),
        })
    }

    /// Appends episode `index` of `dataset` with its messages, `notes` among them, and its record. A note is logged
    /// with its step's image, so that both appear together. Recorded topics that begin with `replaced` are left out.
    ///
    /// # Errors
    /// If it cannot be read or written, or if its time is another episode's that is in the file already.
    pub fn episode(
        &mut self,
        dataset: &Dataset,
        index: usize,
        notes: &[Note<'_>],
        replaced: &str,
    ) -> Result<(), DataError> {
        let meta = dataset.meta(index)?;
        let (start, end) = (meta.start_nanos, meta.end_nanos);
        let overlaps = |taken: &&Taken| taken.start <= end && start <= taken.end;
        if let Some(taken) = self.taken.iter().find(overlaps) {
            return Err(DataError::Unwritable {
                path: self.path.clone(),
                episode: meta.id.clone(),
                what: format!(
                    "it was recorded while {} was, and one file cannot tell their messages apart; export them to files of their own",
                    taken.episode
                ),
            });
        }
        let (file, recorded) = dataset.messages(index)?;
        let shown = image_log_times(file, &recorded);
        let logged = |note: &Note<'_>| {
            let usual = note.stamp_nanos.clamp(start, end.max(start));
            let usual = u64::try_from(usual).unwrap_or(0);
            shown.get(&note.stamp_nanos).copied().unwrap_or(usual)
        };
        let mut notes: Vec<(u64, &Note<'_>)> =
            notes.iter().map(|note| (logged(note), note)).collect();
        notes.sort_by_key(|&(log, _)| log);
        let mut notes = notes.into_iter().enumerate().peekable();
        for message in &recorded {
            let log = message.header.log_time;
            while let Some((i, (at, note))) = notes.next_if(|(_, (at, _))| *at < log) {
                self.note(i, at, note, &meta.id)?;
            }
            self.message(file, message, replaced)?;
        }
        for (i, (at, note)) in notes {
            self.note(i, at, note, &meta.id)?;
        }
        self.metadata("episode", entries(meta, start, end))?;
        self.taken.push(Taken {
            start,
            end,
            episode: meta.id.clone(),
        });
        Ok(())
    }

    /// Appends a record of facts about the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), DataError> {
        let record = Metadata {
            name: name.to_owned(),
            metadata,
        };
        let written = self.writer.write_metadata(&record);
        written.map_err(write_error(&self.path))
    }

    /// Completes the file and gives back what it was written into.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(mut self) -> Result<W, DataError> {
        self.writer.finish().map_err(write_error(&self.path))?;
        Ok(self.writer.into_inner())
    }

    /// Writes a recorded message as it is.
    fn message(&mut self, file: &McapFile, message: &Raw, replaced: &str) -> Result<(), DataError> {
        let Some(channel) = file.index.channels.get(&message.header.channel_id) else {
            // No reader knows what it is.
            return Ok(());
        };
        if channel.topic.starts_with(replaced) {
            return Ok(());
        }
        let channel_id = self.recorded_channel(file, message.header.channel_id, channel)?;
        let header = MessageHeader {
            channel_id,
            ..message.header
        };
        let written = self
            .writer
            .write_to_known_channel(&header, message.payload());
        written.map_err(write_error(&self.path))
    }

    /// The number here of a recorded channel.
    fn recorded_channel(
        &mut self,
        file: &McapFile,
        number: u16,
        channel: &Channel,
    ) -> Result<u16, DataError> {
        let key = (file.number, number);
        if let Some(&id) = self.channels.get(&key) {
            return Ok(id);
        }
        let failed = write_error(&self.path);
        let schema = match file.index.schemas.get(&channel.schema_id) {
            Some(schema) => self
                .writer
                .add_schema(&schema.name, &schema.encoding, &schema.text)
                .map_err(&failed)?,
            None => 0,
        };
        let (topic, encoding) = (&channel.topic, &channel.encoding);
        let id = self
            .writer
            .add_channel(schema, topic, encoding, &channel.metadata)
            .map_err(failed)?;
        self.channels.insert(key, id);
        Ok(id)
    }

    fn note(
        &mut self,
        sequence: usize,
        log_time: u64,
        note: &Note<'_>,
        episode: &str,
    ) -> Result<(), DataError> {
        note.value
            .encode(note.stamp_nanos, &mut self.payload)
            .map_err(|what| DataError::Unwritable {
                path: self.path.clone(),
                episode: episode.to_owned(),
                what: format!("{}: {what}", note.topic),
            })?;
        let channel_id = self.note_channel(note)?;
        let header = MessageHeader {
            channel_id,
            sequence: sequence as u32,
            log_time,
            publish_time: u64::try_from(note.stamp_nanos).unwrap_or(log_time),
        };
        let written = self.writer.write_to_known_channel(&header, &self.payload);
        written.map_err(write_error(&self.path))
    }

    /// The channel of a note's topic.
    fn note_channel(&mut self, note: &Note<'_>) -> Result<u16, DataError> {
        if let Some(&id) = self.notes.get(&note.topic) {
            return Ok(id);
        }
        let (name, definition) = note.value.schema();
        let qos = BTreeMap::from([("offered_qos_profiles".to_owned(), QOS.to_owned())]);
        let id = self
            .writer
            .add_schema(name, "ros2msg", definition.as_bytes())
            .and_then(|schema| self.writer.add_channel(schema, &note.topic, "cdr", &qos))
            .map_err(write_error(&self.path))?;
        self.notes.insert(note.topic.clone(), id);
        Ok(id)
    }
}

/// When the image of each stamp was logged.
fn image_log_times(file: &McapFile, recorded: &[Raw]) -> BTreeMap<i64, u64> {
    let mut found = BTreeMap::new();
    for message in recorded {
        let stream = file.streams.get(&message.header.channel_id);
        let Some(stream) = stream.filter(|stream| stream.role == Role::Vision) else {
            continue;
        };
        let (log, payload) = (message.header.log_time, message.payload());
        let header = match stream.ty {
            MessageType::CompressedImage => {
                decode::<CompressedImage<'_>>(payload).map(|image| image.header)
            }
            _ => decode::<Image<'_>>(payload).map(|image| image.header),
        };
        // One that does not decode has failed the reading of its episode before.
        if let Ok(header) = header {
            found.entry(header.stamp_or(log)).or_insert(log);
        }
    }
    found
}
