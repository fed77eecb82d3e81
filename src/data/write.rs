//! Writes the format: ROS 2 MCAP with zstd chunks, an `episode` record behind each episode's messages.

mod check;

use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, McapError, WriteOptions, Writer};
use serde::Serialize;

use super::cdr::{Header, Image, Pose, Quaternion, Stamped, Twist, Vector3, Wrench, encode};
use super::error::DataError;
use super::topics::{Role, Topics};
use crate::episode::{EpisodeMeta, Frame, Recording, Split};

/// Reliable and keeping the last ten, as `ros2 topic` offers by default.
pub(super) const QOS: &str = "- history: keep_last\n  depth: 10\n  reliability: reliable\n  durability: volatile\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: automatic\n  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false";

/// Writes recordings into one file.
///
/// The same recordings make the same bytes.
pub struct DatasetWriter<W: Write + Seek> {
    /// For messages to the user.
    path: PathBuf,
    writer: Writer<W>,
    topics: Topics,
    channels: BTreeMap<Role, u16>,
    /// End of the last episode, in nanoseconds.
    end_nanos: Option<i64>,
    payload: Vec<u8>,
}

impl<W: Write + Seek> DatasetWriter<W> {
    /// Begins a dataset that will be `path`, into `into`.
    ///
    /// # Errors
    /// If it cannot be written to.
    pub fn create(into: W, path: &Path) -> Result<Self, DataError> {
        Ok(Self {
            writer: options().create(into).map_err(write_error(path))?,
            path: path.to_owned(),
            topics: Topics::default(),
            channels: BTreeMap::new(),
            end_nanos: None,
            payload: Vec::new(),
        })
    }

    /// Appends one episode: its messages in log-time order (log time, publish time and header stamp are all the
    /// sample's), then its record. An interval left zero in its metadata is that of its samples.
    ///
    /// # Errors
    /// If it overlaps the episode before it, has samples outside its own interval, or cannot be written.
    pub fn write(&mut self, recording: &Recording) -> Result<(), DataError> {
        let (start_nanos, end_nanos) = check::interval(recording, self.end_nanos)
            .map_err(|what| self.unwritable(recording, what))?;
        let mut messages = check::schedule(recording);
        messages.sort_by_key(|message| message.stamp_nanos);
        for message in messages {
            let channel = self.channel(message.role)?;
            encode_sample(
                recording,
                message.role,
                message.index,
                message.stamp_nanos,
                &mut self.payload,
            )
            .map_err(|what| self.unwritable(recording, what))?;
            let nanos = message.stamp_nanos as u64;
            let header = MessageHeader {
                channel_id: channel,
                sequence: message.index as u32,
                log_time: nanos,
                publish_time: nanos,
            };
            self.writer
                .write_to_known_channel(&header, &self.payload)
                .map_err(write_error(&self.path))?;
        }
        let record = Metadata {
            name: "episode".to_owned(),
            metadata: entries(&recording.meta, start_nanos, end_nanos),
        };
        self.writer
            .write_metadata(&record)
            .map_err(write_error(&self.path))?;
        self.end_nanos = Some(end_nanos);
        Ok(())
    }

    /// Completes the file and gives back what it was written into.
    ///
    /// # Errors
    /// If that cannot be written to.
    pub fn finish(mut self) -> Result<W, DataError> {
        self.writer.finish().map_err(write_error(&self.path))?;
        Ok(self.writer.into_inner())
    }

    /// The channel of `role`, made when it is first needed.
    fn channel(&mut self, role: Role) -> Result<u16, DataError> {
        if let Some(&channel) = self.channels.get(&role) {
            return Ok(channel);
        }
        let [ty, ..] = role.types() else {
            return Ok(0);
        };
        let writer = &mut self.writer;
        let qos = BTreeMap::from([("offered_qos_profiles".to_owned(), QOS.to_owned())]);
        let topic = self.topics.topic(role);
        let channel = writer
            .add_schema(ty.name(), "ros2msg", ty.definition().as_bytes())
            .and_then(|schema| writer.add_channel(schema, topic, "cdr", &qos))
            .map_err(write_error(&self.path))?;
        self.channels.insert(role, channel);
        Ok(channel)
    }

    fn unwritable(&self, recording: &Recording, what: String) -> DataError {
        DataError::Unwritable {
            path: self.path.clone(),
            episode: recording.meta.id.clone(),
            what,
        }
    }
}

/// What files are written with: one thread, so that the bytes depend on nothing but the data.
pub(super) fn options() -> WriteOptions {
    WriteOptions::new()
        .profile("ros2")
        .library(concat!("poescope ", env!("CARGO_PKG_VERSION")))
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .chunk_size(Some(1 << 20))
}

pub(super) fn write_error(path: &Path) -> impl Fn(McapError) -> DataError + use<> {
    let path = path.to_owned();
    move |cause| DataError::Write {
        path: path.clone(),
        cause,
    }
}

pub(super) fn entries(
    meta: &EpisodeMeta,
    start_nanos: i64,
    end_nanos: i64,
) -> BTreeMap<String, String> {
    let known = [
        ("id", Some(meta.id.clone())),
        ("start_ns", Some(start_nanos.to_string())),
        ("end_ns", Some(end_nanos.to_string())),
        (
            "split",
            meta.split.map(|split: Split| split.name().to_owned()),
        ),
        ("object", meta.object.clone()),
        ("surface", meta.surface.clone()),
        ("source", meta.source.clone()),
        ("seed", meta.seed.map(|seed| seed.to_string())),
    ];
    known
        .into_iter()
        .filter_map(|(key, value)| Some((key.to_owned(), value?)))
        .collect()
}

/// Encodes sample `index` of a role into `payload`.
fn encode_sample(
    recording: &Recording,
    role: Role,
    index: usize,
    stamp_nanos: i64,
    payload: &mut Vec<u8>,
) -> Result<(), String> {
    let frame_id = match role {
        Role::Vision => "camera_optical_frame",
        Role::Object => "world",
        _ => "base_link",
    };
    let header = Header::new(stamp_nanos, frame_id).ok_or("a stamp after the year 2038")?;
    match role {
        Role::Vision => encode(&image(header, &recording.frames[index]), payload),
        Role::Haptic => {
            let [fx, fy, fz, tx, ty, tz] = recording.wrench.values[index];
            let wrench = Wrench {
                force: Vector3::new([fx, fy, fz]),
                torque: Vector3::new([tx, ty, tz]),
            };
            stamped(header, wrench, payload)
        }
        Role::EePose => stamped(
            header,
            pose(recording.ee_position.values[index], 0.0),
            payload,
        ),
        Role::EeTwist => stamped(header, twist(recording.ee_velocity.values[index]), payload),
        Role::Control => {
            let [x, y] = recording.control.values[index];
            stamped(header, twist([x, y, 0.0]), payload)
        }
        Role::Object => {
            let [x, y, yaw] = recording.object.values[index];
            stamped(header, pose([x, y, 0.0], yaw), payload)
        }
    }
}

fn stamped<T: Serialize>(
    header: Header<'_>,
    value: T,
    payload: &mut Vec<u8>,
) -> Result<(), String> {
    encode(&Stamped { header, value }, payload)
}

pub(super) fn image<'a>(header: Header<'a>, frame: &'a Frame) -> Image<'a> {
    Image {
        header,
        height: frame.height as u32,
        width: frame.width as u32,
        encoding: "mono8",
        is_bigendian: 0,
        step: frame.width as u32,
        data: &frame.pixels,
    }
}

fn pose(position: [f64; 3], yaw: f64) -> Pose {
    Pose {
        position: Vector3::new(position),
        orientation: Quaternion::from_yaw(yaw),
    }
}

fn twist(linear: [f64; 3]) -> Twist {
    Twist {
        linear: Vector3::new(linear),
        angular: Vector3::default(),
    }
}
