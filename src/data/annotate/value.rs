//! What a note can say, as the ROS 2 messages that every tool knows.

use serde::Serialize;

use crate::data::cdr::{Header, Image, Pose, Quaternion, Vector3, encode};
use crate::data::message_type::{HEADER, MessageType, POINT, QUATERNION, RULE, TIME};
use crate::data::write::image;
use crate::episode::Frame;

/// What a note says.
#[derive(Clone, Debug)]
pub enum Value<'a> {
    /// A number: `std_msgs/msg/Float64`.
    Number(f64),
    /// Some numbers: `std_msgs/msg/Float64MultiArray` of one dimension.
    Numbers(Vec<f64>),
    /// A grey image: `sensor_msgs/msg/Image`, `mono8`.
    Grey(&'a Frame),
    /// A picture: `sensor_msgs/msg/Image`, `rgb8`.
    Picture {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// `height * width` pixels, row major.
        pixels: Vec<[u8; 3]>,
    },
    /// A position on the table with its covariance: `geometry_msgs/msg/PoseWithCovarianceStamped` in the frame `world`,
    /// unturned; what is not estimated has covariance 0.
    Position {
        /// x, y in metres.
        at: [f64; 2],
        /// xx, xy, yy in square metres.
        covariance: [f64; 3],
    },
}

/// `std_msgs/MultiArrayDimension`.
#[derive(Clone, Copy, Serialize)]
struct Dimension {
    label: &'static str,
    size: u32,
    stride: u32,
}

/// `geometry_msgs/PoseWithCovarianceStamped`.
#[derive(Serialize)]
struct PoseWithCovariance<'a> {
    header: Header<'a>,
    pose: Pose,
    /// Row major: x, y, z, and the turns about them.
    covariance: [[f64; 6]; 6],
}

impl Value<'_> {
    /// Name and definition of its message type.
    pub(super) fn schema(&self) -> (&'static str, String) {
        match self {
            Self::Number(_) => ("std_msgs/msg/Float64", "float64 data\n".to_owned()),
            Self::Numbers(_) => (
                "std_msgs/msg/Float64MultiArray",
                format!(
                    "std_msgs/MultiArrayLayout layout\nfloat64[] data\n\
                     {RULE}MSG: std_msgs/MultiArrayLayout\nstd_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n\
                     {RULE}MSG: std_msgs/MultiArrayDimension\nstring label\nuint32 size\nuint32 stride\n"
                ),
            ),
            Self::Grey(_) | Self::Picture { .. } => {
                (MessageType::Image.name(), MessageType::Image.definition())
            }
            Self::Position { .. } => (
                "geometry_msgs/msg/PoseWithCovarianceStamped",
                format!(
                    "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n\
                     {RULE}MSG: geometry_msgs/PoseWithCovariance\ngeometry_msgs/Pose pose\nfloat64[36] covariance\n\
                     {RULE}MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n\
                     {RULE}{POINT}{RULE}{QUATERNION}{RULE}{HEADER}{RULE}{TIME}"
                ),
            ),
        }
    }

    /// Writes it over what is in `payload`.
    ///
    /// # Errors
    /// A phrase that says what does not fit.
    pub(super) fn encode(&self, stamp_nanos: i64, payload: &mut Vec<u8>) -> Result<(), String> {
        let header =
            |frame| Header::new(stamp_nanos, frame).ok_or("a stamp after the year 2038".to_owned());
        match self {
            Self::Number(number) => encode(number, payload),
            Self::Numbers(numbers) => {
                let size = numbers.len() as u32;
                let label = "latent";
                // A sequence of one, not an array of one: that would have no length in front.
                let dimensions = [Dimension {
                    label,
                    size,
                    stride: size,
                }];
                encode(&(dimensions.as_slice(), 0_u32, numbers.as_slice()), payload)
            }
            Self::Grey(frame) => encode(&image(header("camera_optical_frame")?, frame), payload),
            Self::Picture {
                width,
                height,
                pixels,
            } => {
                let picture = Image {
                    header: header("camera_optical_frame")?,
                    height: *height as u32,
                    width: *width as u32,
                    encoding: "rgb8",
                    is_bigendian: 0,
                    step: (3 * width) as u32,
                    data: pixels.as_flattened(),
                };
                encode(&picture, payload)
            }
            Self::Position {
                at: [x, y],
                covariance: [xx, xy, yy],
            } => {
                let mut covariance = [[0.0; 6]; 6];
                (covariance[0][0], covariance[0][1]) = (*xx, *xy);
                (covariance[1][0], covariance[1][1]) = (*xy, *yy);
                let message = PoseWithCovariance {
                    header: header("world")?,
                    pose: Pose {
                        position: Vector3::new([*x, *y, 0.0]),
                        orientation: Quaternion::from_yaw(0.0),
                    },
                    covariance,
                };
                encode(&message, payload)
            }
        }
    }
}
