//! Metrics as TensorBoard event files, for whoever watches a run there.
//!
//! An event file is a row of framed records (`TFRecord`: length, its checksum, data, its checksum), each of them one
//! `Event` message of TensorBoard's protobuf schema. A scalar needs seven fields of it, so they are written by hand: a
//! protobuf runtime and its generated types would weigh more than what they write.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::TrainError;
use crate::model::checkpoint::CheckpointError;

/// What the name of every event file starts with; TensorBoard knows them by it.
pub const PREFIX: &str = "events.out.tfevents.";

/// An event file that is being written.
#[derive(Debug)]
pub struct EventWriter {
    path: PathBuf,
    file: File,
}

impl EventWriter {
    /// Starts a new event file in `folder`, whose first scalars will be of `next_update`. TensorBoard forgets what
    /// older files of the folder hold of that update and later ones: a run that was killed had gone further than the
    /// checkpoint it is resumed from.
    ///
    /// # Errors
    /// If the folder cannot be listed or the file not be written.
    pub fn append(folder: &Path, next_update: u64) -> Result<Self, TrainError> {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let wall_secs = now.map_or(0.0, |now| now.as_secs_f64());
        let older = std::fs::read_dir(folder)
            .map_err(CheckpointError::io(folder))?
            .flatten()
            .filter(|entry| entry.file_name().to_string_lossy().starts_with(PREFIX))
            .count();
        // Files are read in the order of their names; the running number orders those of one second.
        let path = folder.join(format!("{PREFIX}{wall_secs:010.0}.poescope.{older:04}"));
        let file = OpenOptions::new().append(true).create_new(true).open(&path);
        let file = file.map_err(CheckpointError::io(&path))?;
        let mut writer = Self { path, file };
        let event = || Message::default().double(event::WALL_TIME, wall_secs);
        writer.write(&event().bytes(event::FILE_VERSION, b"brain.Event:2"))?;
        let start = Message::default().varint(session_log::STATUS, session_log::START);
        writer.write(
            &event()
                .varint(event::STEP, next_update)
                .bytes(event::SESSION_LOG, &start.0),
        )?;
        Ok(writer)
    }

    /// Appends the scalars of one update as one record, at once: what is killed loses whole records only, and at most
    /// the last. `wall_secs` counts from 1970.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn scalars<'a>(
        &mut self,
        update: u64,
        wall_secs: f64,
        values: impl IntoIterator<Item = (&'a str, f32)>,
    ) -> Result<(), TrainError> {
        let mut summary = Message::default();
        for (tag, number) in values {
            let value = Message::default()
                .bytes(value::TAG, tag.as_bytes())
                .float(value::SIMPLE_VALUE, number);
            summary = summary.bytes(summary::VALUE, &value.0);
        }
        let event = Message::default()
            .double(event::WALL_TIME, wall_secs)
            .varint(event::STEP, update);
        self.write(&event.bytes(event::SUMMARY, &summary.0))
    }

    fn write(&mut self, event: &Message) -> Result<(), TrainError> {
        let written = self.file.write_all(&record(&event.0));
        Ok(written.map_err(CheckpointError::io(&self.path))?)
    }
}

/// Data in its frame.
fn record(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    let checksums = [&length, data].map(|bytes| masked(crc32c::crc32c(bytes)).to_le_bytes());
    [&length, &checksums[0][..], data, &checksums[1]].concat()
}

/// A checksum as a record stores it: turned and moved, since that of data which holds its own checksum is a weak one.
fn masked(checksum: u32) -> u32 {
    checksum.rotate_right(15).wrapping_add(0xA282_EAD8)
}

/// Field numbers of `Event`.
mod event {
    pub(super) const WALL_TIME: u8 = 1;
    pub(super) const STEP: u8 = 2;
    pub(super) const FILE_VERSION: u8 = 3;
    pub(super) const SUMMARY: u8 = 5;
    pub(super) const SESSION_LOG: u8 = 7;
}

/// Field numbers of `Summary`.
mod summary {
    pub(super) const VALUE: u8 = 1;
}

/// Field numbers of `Summary.Value`.
mod value {
    pub(super) const TAG: u8 = 1;
    pub(super) const SIMPLE_VALUE: u8 = 2;
}

/// A field number of `SessionLog`, and a status.
mod session_log {
    pub(super) const STATUS: u8 = 1;
    pub(super) const START: u64 = 1;
}

/// A protobuf message: each field its number and wire type in a byte, then its value.
#[derive(Default)]
struct Message(Vec<u8>);

impl Message {
    fn varint(mut self, field: u8, value: u64) -> Self {
        self.0.push(field << 3);
        self.0.extend(varint(value));
        self
    }

    fn double(mut self, field: u8, value: f64) -> Self {
        self.0.push(field << 3 | 1);
        self.0.extend(value.to_le_bytes());
        self
    }

    fn bytes(mut self, field: u8, value: &[u8]) -> Self {
        self.0.push(field << 3 | 2);
        self.0.extend(varint(value.len() as u64));
        self.0.extend(value);
        self
    }

    fn float(mut self, field: u8, value: f32) -> Self {
        self.0.push(field << 3 | 5);
        self.0.extend(value.to_le_bytes());
        self
    }
}

/// Seven bits a byte, the lowest first; the top bit says that more follow.
fn varint(mut value: u64) -> impl Iterator<Item = u8> {
    let mut done = false;
    std::iter::from_fn(move || {
        if done {
            return None;
        }
        let low = (value & 0x7F) as u8;
        value >>= 7;
        done = value == 0;
        Some(if done { low } else { low | 0x80 })
    })
}
