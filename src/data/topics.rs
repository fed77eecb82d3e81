//! Which topic plays which role: the format's defaults, a `dataset.toml` beside the files, what the caller names.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::DataError;
use super::message_type::MessageType;

/// Topics that begin so hold what models made of a recording: an export writes them, and nothing reads them as data.
pub const NOTES: &str = "/poescope/";

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

    /// The role that [`Self::name`] calls so.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }

    /// Its key in `dataset.toml`, and its name on the command line.
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
        match parsed.topics.doubled() {
            Some(what) => Err(DataError::Mapping { path, what }),
            None => Ok(parsed.topics),
        }
    }

    /// The same, but for the roles that `named` gives another topic.
    pub(super) fn with(mut self, named: &[(Role, String)]) -> Result<Self, DataError> {
        for (i, (role, topic)) in named.iter().enumerate() {
            if named[..i].iter().any(|(earlier, _)| earlier == role) {
                let what = format!("role {} has more than one topic", role.name());
                return Err(DataError::Named(what));
            }
            topic.clone_into(self.topic_mut(*role));
        }
        match self.doubled() {
            Some(what) => Err(DataError::Named(what)),
            None => Ok(self),
        }
    }

    /// What is wrong, if a topic has two roles: its messages could be read as one of them only.
    fn doubled(&self) -> Option<String> {
        let mut pairs = Role::ALL
            .into_iter()
            .enumerate()
            .flat_map(|(i, a)| Role::ALL.into_iter().skip(i + 1).map(move |b| (a, b)));
        let (a, b) = pairs.find(|&(a, b)| self.topic(a) == self.topic(b))?;
        Some(format!(
            "topic {} is both {} and {}",
            self.topic(a),
            a.name(),
            b.name()
        ))
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

    fn topic_mut(&mut self, role: Role) -> &mut String {
        match role {
            Role::Control => &mut self.control,
            Role::Haptic => &mut self.haptic,
            Role::EePose => &mut self.ee_pose,
            Role::EeTwist => &mut self.ee_twist,
            Role::Object => &mut self.object,
            Role::Vision => &mut self.vision,
        }
    }

    /// The role of `topic`, if it has one.
    pub(super) fn role(&self, topic: &str) -> Option<Role> {
        Role::ALL
            .into_iter()
            .find(|&role| self.topic(role) == topic)
    }
}
