//! Which topic plays which role: the format's defaults, or a `dataset.toml` beside the files.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::DataError;
use super::message_type::MessageType;

/// What a topic is to an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The planar command.
    Control,
    /// Force and torque at the end effector.
    Haptic,
    /// The end effector's position.
    EePose,
    /// The end effector's velocity.
    EeTwist,
    /// Ground truth of the pushed object.
    Object,
    /// Camera frames.
    Vision,
}

impl Role {
    /// All roles, in the order in which messages of one moment are written.
    pub const ALL: [Self; 6] = [
        Self::Control,
        Self::Haptic,
        Self::EePose,
        Self::EeTwist,
        Self::Object,
        Self::Vision,
    ];

    /// Its key in `dataset.toml`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Control => "control",
            Self::Haptic => "haptic",
            Self::EePose => "ee_pose",
            Self::EeTwist => "ee_twist",
            Self::Object => "object",
            Self::Vision => "vision",
        }
    }

    /// The message types it can be read from, the one it is written as first.
    pub(super) fn types(self) -> &'static [MessageType] {
        match self {
            Self::Control => &[MessageType::Twist, MessageType::Point],
            Self::Haptic => &[MessageType::Wrench],
            Self::EePose | Self::Object => &[MessageType::Pose],
            Self::EeTwist => &[MessageType::Twist],
            Self::Vision => &[MessageType::Image, MessageType::CompressedImage],
        }
    }
}

/// The topic of each role.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Topics {
    /// Camera frames; their stamps are the steps.
    pub vision: String,
    /// Force and torque.
    pub haptic: String,
    /// End-effector position.
    pub ee_pose: String,
    /// End-effector velocity.
    pub ee_twist: String,
    /// Planar command.
    pub control: String,
    /// Ground truth of the object.
    pub object: String,
}

impl Default for Topics {
    fn default() -> Self {
        Self {
            vision: "/camera/image_raw".to_owned(),
            haptic: "/wrench".to_owned(),
            ee_pose: "/ee/pose".to_owned(),
            ee_twist: "/ee/twist".to_owned(),
            control: "/control".to_owned(),
            object: "/object/pose".to_owned(),
        }
    }
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct DatasetToml {
    topics: Topics,
}

impl Topics {
    /// The mapping in `folder/dataset.toml`; the defaults where there is none.
    pub(super) fn beside(folder: &Path) -> Result<Self, DataError> {
        let path = folder.join("dataset.toml");
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::default()),
            Err(error) => return Err(DataError::io(&path)(error)),
        };
        let parsed: DatasetToml = toml::from_str(&text).map_err(|error| DataError::Mapping {
            what: error.message().to_owned(),
            path: path.clone(),
        })?;
        let topics = parsed.topics;
        for (i, a) in Role::ALL.into_iter().enumerate() {
            for b in Role::ALL.into_iter().skip(i + 1) {
                if topics.topic(a) == topics.topic(b) {
                    let topic = topics.topic(a);
                    let what = format!("topic {topic} is both {} and {}", a.name(), b.name());
                    return Err(DataError::Mapping { path, what });
                }
            }
        }
        Ok(topics)
    }

    /// The topic of `role`.
    pub fn topic(&self, role: Role) -> &str {
        match role {
            Role::Control => &self.control,
            Role::Haptic => &self.haptic,
            Role::EePose => &self.ee_pose,
            Role::EeTwist => &self.ee_twist,
            Role::Object => &self.object,
            Role::Vision => &self.vision,
        }
    }

    /// The role of `topic`, if it has one.
    pub(super) fn role(&self, topic: &str) -> Option<Role> {
        Role::ALL
            .into_iter()
            .find(|&role| self.topic(role) == topic)
    }
}
