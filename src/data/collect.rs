//! Gathers an episode's decoded messages into a [`Recording`].

use super::align::square;
use super::cdr::{
    CompressedImage, Image, Pose, Quaternion, Stamped, Twist, Vector3, Wrench, decode,
};
use super::image::{grey, grey_from_compressed};
use super::message_type::MessageType;
use super::topics::Role;
use crate::episode::{EpisodeMeta, Frame, Recording, Track};

/// What a channel's messages are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    pub(super) role: Role,
    pub(super) ty: MessageType,
}

/// Log time, stamp, value.
type Row<T> = (u64, i64, T);

/// The messages so far, in file order.
#[derive(Default)]
pub(super) struct Collector {
    frame_size: Option<usize>,
    frames: Vec<Row<Frame>>,
    wrench: Vec<Row<[f64; 6]>>,
    ee_position: Vec<Row<[f64; 3]>>,
    ee_velocity: Vec<Row<[f64; 3]>>,
    control: Vec<Row<[f64; 2]>>,
    object: Vec<Row<[f64; 3]>>,
}

impl Collector {
    /// One that makes frames squares of `frame_size` pixels, or leaves them as they are.
    pub(super) fn new(frame_size: Option<usize>) -> Self {
        Self {
            frame_size,
            ..Self::default()
        }
    }

    /// Decodes one message.
    ///
    /// # Errors
    /// A phrase that says what does not fit.
    pub(super) fn push(&mut self, stream: Stream, log: u64, payload: &[u8]) -> Result<(), String> {
        match stream.ty {
            MessageType::Image => {
                let image: Image<'_> = decode(payload)?;
                self.frame(log, image.header.stamp_or(log), grey(&image)?);
            }
            MessageType::CompressedImage => {
                let image: CompressedImage<'_> = decode(payload)?;
                let frame = grey_from_compressed(image.data)?;
                self.frame(log, image.header.stamp_or(log), frame);
            }
            MessageType::Wrench => {
                let Stamped { header, value } = decode::<Stamped<'_, Wrench>>(payload)?;
                let [fx, fy, fz] = value.force.xyz();
                let [tx, ty, tz] = value.torque.xyz();
                let stamp = header.stamp_or(log);
                self.wrench.push((log, stamp, [fx, fy, fz, tx, ty, tz]));
            }
            MessageType::Pose => {
                let Stamped { header, value } = decode::<Stamped<'_, Pose>>(payload)?;
                self.pose(
                    stream.role,
                    log,
                    header.stamp_or(log),
                    value.position,
                    value.orientation,
                );
            }
            MessageType::Twist => {
                let Stamped { header, value } = decode::<Stamped<'_, Twist>>(payload)?;
                let stamp = header.stamp_or(log);
                if stream.role == Role::Control {
                    self.control.push((log, stamp, planar(value.linear)));
                } else {
                    self.ee_velocity.push((log, stamp, value.linear.xyz()));
                }
            }
            MessageType::Point => {
                let Stamped { header, value } = decode::<Stamped<'_, Vector3>>(payload)?;
                self.control
                    .push((log, header.stamp_or(log), planar(value)));
            }
        }
        Ok(())
    }

    fn frame(&mut self, log: u64, stamp: i64, frame: Frame) {
        let frame = match self.frame_size {
            Some(size) => square(&frame, size),
            None => frame,
        };
        self.frames.push((log, stamp, frame));
    }

    fn pose(&mut self, role: Role, log: u64, stamp: i64, at: Vector3, turned: Quaternion) {
        if role == Role::Object {
            self.object.push((log, stamp, [at.x, at.y, turned.yaw()]));
        } else {
            self.ee_position.push((log, stamp, at.xyz()));
        }
    }

    /// The recording, each stream in log-time order (file order where that is equal).
    pub(super) fn finish(self, meta: EpisodeMeta) -> Recording {
        let frames = in_log_order(self.frames);
        Recording {
            meta,
            frame_stamps_nanos: frames.iter().map(|&(_, stamp, _)| stamp).collect(),
            frames: frames.into_iter().map(|(_, _, frame)| frame).collect(),
            wrench: track(self.wrench),
            ee_position: track(self.ee_position),
            ee_velocity: track(self.ee_velocity),
            control: track(self.control),
            object: track(self.object),
            flags: Vec::new(),
        }
    }
}

fn planar(vector: Vector3) -> [f64; 2] {
    [vector.x, vector.y]
}

fn in_log_order<T>(mut rows: Vec<Row<T>>) -> Vec<Row<T>> {
    rows.sort_by_key(|&(log, ..)| log);
    rows
}

fn track<const N: usize>(rows: Vec<Row<[f64; N]>>) -> Track<N> {
    let (stamps_nanos, values) = in_log_order(rows)
        .into_iter()
        .map(|(_, stamp, value)| (stamp, value))
        .unzip();
    Track {
        stamps_nanos,
        values,
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use std::io::Cursor;

    use super::super::cdr::{Header, encode};
    use super::*;

    #[test]
    fn pictures_and_points_are_read_and_a_zero_stamp_is_the_log_time() {
        let mut png = Cursor::new(Vec::new());
        let picture = image::GrayImage::from_raw(2, 1, vec![7, 250]).unwrap();
        picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let mut payload = Vec::new();
        let mut collector = Collector::default();

        let unstamped = Header::new(0, "camera").unwrap();
        let compressed = (unstamped, "png", serde_bytes::Bytes::new(png.get_ref()));
        encode(&compressed, &mut payload).unwrap();
        let camera = Stream {
            role: Role::Vision,
            ty: MessageType::CompressedImage,
        };
        collector.push(camera, 40, &payload).unwrap();

        let control = Stream {
            role: Role::Control,
            ty: MessageType::Point,
        };
        // Logged late: log order, not file order.
        for (log, x) in [(60, 2.0), (50, 1.0)] {
            let point = Stamped {
                header: Header::new(x as i64, "base_link").unwrap(),
                value: Vector3::new([x, -x, 9.0]),
            };
            encode(&point, &mut payload).unwrap();
            collector.push(control, log, &payload).unwrap();
        }

        let recording = collector.finish(EpisodeMeta::default());
        assert_eq!(recording.frame_stamps_nanos, [40]);
        assert_eq!(recording.frames[0].pixels, [7, 250]);
        assert_eq!(recording.control.stamps_nanos, [1, 2]);
        assert_eq!(recording.control.values, [[1.0, -1.0], [2.0, -2.0]]);
    }
}
