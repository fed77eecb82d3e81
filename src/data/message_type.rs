//! The ROS 2 message types of the format, with the definitions that are written into files.

/// A message type that poescope can decode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum MessageType {
    Image,
    CompressedImage,
    Wrench,
    Pose,
    Twist,
    Point,
}

pub(super) const RULE: &str =
    "================================================================================\n";
pub(super) const HEADER: &str =
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
pub(super) const TIME: &str = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const VECTOR3: &str = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
pub(super) const POINT: &str = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
pub(super) const QUATERNION: &str =
    "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";

impl MessageType {
    const ALL: [Self; 6] = [
        Self::Image,
        Self::CompressedImage,
        Self::Wrench,
        Self::Pose,
        Self::Twist,
        Self::Point,
    ];

    /// Its full name, as a schema carries it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Image => "sensor_msgs/msg/Image",
            Self::CompressedImage => "sensor_msgs/msg/CompressedImage",
            Self::Wrench => "geometry_msgs/msg/WrenchStamped",
            Self::Pose => "geometry_msgs/msg/PoseStamped",
            Self::Twist => "geometry_msgs/msg/TwistStamped",
            Self::Point => "geometry_msgs/msg/PointStamped",
        }
    }

    /// The type of that name, with or without the `/msg/`.
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|ty| name == ty.name() || name == ty.name().replace("/msg/", "/"))
    }

    /// Its definition with those of its dependencies, in the `ros2msg` encoding.
    pub(super) fn definition(self) -> String {
        let (body, dependencies): (&str, &[&str]) = match self {
            Self::Image => (
                "uint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n",
                &[],
            ),
            Self::CompressedImage => ("string format\nuint8[] data\n", &[]),
            Self::Wrench => (
                "geometry_msgs/Wrench wrench\n",
                &[
                    "MSG: geometry_msgs/Wrench\ngeometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n",
                    VECTOR3,
                ],
            ),
            Self::Pose => (
                "geometry_msgs/Pose pose\n",
                &[
                    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
                    POINT,
                    QUATERNION,
                ],
            ),
            Self::Twist => (
                "geometry_msgs/Twist twist\n",
                &[
                    "MSG: geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
                    VECTOR3,
                ],
            ),
            Self::Point => ("geometry_msgs/Point point\n", &[POINT]),
        };
        let mut text = format!("std_msgs/Header header\n{body}");
        for dependency in dependencies.iter().chain(&[HEADER, TIME]) {
            text.push_str(RULE);
            text.push_str(dependency);
        }
        text
    }
}
