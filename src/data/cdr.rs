//! The messages of the format as serde types, and their CDR encoding (4 bytes of header, then the aligned body).

use re_cdr::{BigEndian, LittleEndian};
use serde::{Deserialize, Serialize};

/// Bytes that may follow a body to fill up a word.
const PADDING: usize = 3;

/// Reads a message, borrowing from `payload`.
///
/// # Errors
/// A phrase that says what does not fit.
pub(super) fn decode<'a, T: Deserialize<'a>>(payload: &'a [u8]) -> Result<T, String> {
    let Some((head, body)) = payload.split_first_chunk::<4>() else {
        return Err(format!("{} bytes are no CDR message", payload.len()));
    };
    let (value, consumed) = match head {
        [0, 0, ..] => re_cdr::from_bytes::<T, BigEndian>(body),
        [0, 1, ..] => re_cdr::from_bytes::<T, LittleEndian>(body),
        [a, b, ..] => {
            return Err(format!(
                "its encapsulation is {a:02x} {b:02x}; only plain CDR (00 00, 00 01) can be read"
            ));
        }
    }
    .map_err(|error| format!("it does not decode as its type: {error}"))?;
    if body.len() > consumed + PADDING {
        let left = body.len() - consumed;
        return Err(format!("{left} bytes are left over after its last field"));
    }
    Ok(value)
}

/// Writes a message, little-endian, over what is in `payload`.
///
/// # Errors
/// A phrase that says what does not fit.
pub(super) fn encode<T: Serialize>(value: &T, payload: &mut Vec<u8>) -> Result<(), String> {
    let body = re_cdr::to_vec::<T, LittleEndian>(value).map_err(|error| error.to_string())?;
    payload.clear();
    payload.extend_from_slice(&[0, 1, 0, 0]);
    payload.extend_from_slice(&body);
    Ok(())
}

/// `builtin_interfaces/Time`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Time {
    sec: i32,
    nanosec: u32,
}

/// `std_msgs/Header`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Header<'a> {
    stamp: Time,
    frame_id: &'a str,
}

impl<'a> Header<'a> {
    /// A header of that stamp and frame of reference; `None` where the stamp does not fit 32 bits of seconds.
    pub(super) fn new(stamp_nanos: i64, frame_id: &'a str) -> Option<Self> {
        let stamp = Time {
            sec: i32::try_from(stamp_nanos.div_euclid(1_000_000_000)).ok()?,
            nanosec: stamp_nanos.rem_euclid(1_000_000_000) as u32,
        };
        Some(Self { stamp, frame_id })
    }

    /// When it was measured, in nanoseconds; the log time where the sender left the stamp zero.
    pub(super) fn stamp_or(&self, log_time_nanos: u64) -> i64 {
        match i64::from(self.stamp.sec) * 1_000_000_000 + i64::from(self.stamp.nanosec) {
            0 => i64::try_from(log_time_nanos).unwrap_or(i64::MAX),
            stamp => stamp,
        }
    }
}

/// Any `…Stamped` message of a header and one value.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Stamped<'a, T> {
    #[serde(borrow)]
    pub(super) header: Header<'a>,
    pub(super) value: T,
}

/// `geometry_msgs/Vector3` and `Point`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Vector3 {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) z: f64,
}

impl Vector3 {
    /// From x, y, z.
    pub(super) fn new([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }

    /// As x, y, z.
    pub(super) fn xyz(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }
}

/// `geometry_msgs/Quaternion`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl Quaternion {
    /// The rotation by `yaw` radians about z.
    pub(super) fn from_yaw(yaw: f64) -> Self {
        let (z, w) = (yaw / 2.0).sin_cos();
        Self {
            x: 0.0,
            y: 0.0,
            z,
            w,
        }
    }

    /// The angle about z in radians; the quaternion need not have length 1.
    pub(super) fn yaw(self) -> f64 {
        let Self { x, y, z, w } = self;
        (2.0 * (w * z + x * y)).atan2(w * w + x * x - y * y - z * z)
    }
}

/// `geometry_msgs/Wrench`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Wrench {
    pub(super) force: Vector3,
    pub(super) torque: Vector3,
}

/// `geometry_msgs/Pose`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Pose {
    pub(super) position: Vector3,
    pub(super) orientation: Quaternion,
}

/// `geometry_msgs/Twist`.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Twist {
    pub(super) linear: Vector3,
    pub(super) angular: Vector3,
}

/// `sensor_msgs/Image`, its pixels borrowed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Image<'a> {
    #[serde(borrow)]
    pub(super) header: Header<'a>,
    pub(super) height: u32,
    pub(super) width: u32,
    pub(super) encoding: &'a str,
    pub(super) is_bigendian: u8,
    pub(super) step: u32,
    #[serde(borrow, with = "serde_bytes")]
    pub(super) data: &'a [u8],
}

/// `sensor_msgs/CompressedImage`.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct CompressedImage<'a> {
    #[serde(borrow)]
    pub(super) header: Header<'a>,
    #[expect(
        dead_code,
        reason = "the bytes say their format themselves, and more reliably"
    )]
    format: &'a str,
    #[serde(borrow, with = "serde_bytes")]
    pub(super) data: &'a [u8],
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]
    #![expect(clippy::float_cmp, reason = "nothing is computed on the way")]

    use super::*;

    #[test]
    fn both_byte_orders_are_read() {
        let header = Header::new(1_500_000_000_250_000_000, "base_link").unwrap();
        let sent = Stamped {
            header,
            value: Vector3::new([1.5, -2.0, 0.1]),
        };
        let mut little = Vec::new();
        encode(&sent, &mut little).unwrap();
        let mut big = vec![0, 0, 0, 0];
        big.extend(re_cdr::to_vec::<_, BigEndian>(&sent).unwrap());
        big.extend([0, 0, 0]); // padding
        assert_ne!(little[4..8], big[4..8]);
        for payload in [little, big] {
            let read: Stamped<Vector3> = decode(&payload).unwrap();
            assert_eq!(read.value.xyz(), [1.5, -2.0, 0.1]);
            assert_eq!(read.header.stamp_or(7), 1_500_000_000_250_000_000);
            assert_eq!(read.header.frame_id, "base_link");
        }
    }

    #[test]
    fn what_is_no_plain_cdr_is_refused_by_name() {
        for (payload, word) in [
            (&[0_u8, 1][..], "2 bytes"),
            (&[0, 3, 0, 0, 1], "00 03"),
            (&[0, 1, 0, 0, 1], "does not decode"),
            (
                &[0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 9, 9, 9, 9],
                "left over",
            ),
        ] {
            let said = decode::<Time>(payload).unwrap_err();
            assert!(said.contains(word), "{said}");
        }
    }

    #[test]
    fn yaw_survives_a_quaternion() {
        for i in -31..=31 {
            let yaw = f64::from(i) * 0.1;
            let back = Quaternion::from_yaw(yaw).yaw();
            assert!((back - yaw).abs() < 1e-15, "{yaw} {back}");
        }
    }
}
