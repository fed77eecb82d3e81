//! What is sensed and what is multiplied: modalities, experts, and how each looks in every face.
//!
//! One modality has one colour, one letter and one fill everywhere (Okabe and Ito's palette, which holds for
//! the colour-blind), so nothing is ever said by hue alone.

use serde::{Deserialize, Serialize};

/// A sensed stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Modality {
    /// Camera frames.
    Vision,
    /// Force and torque at the end effector.
    Haptic,
    /// Position and velocity of the end effector.
    Proprio,
}

impl Modality {
    /// All of them, in the order in which faces list them.
    pub const ALL: [Self; 3] = [Self::Vision, Self::Haptic, Self::Proprio];

    /// Its name in help, messages and state strings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vision => "vision",
            Self::Haptic => "haptic",
            Self::Proprio => "proprio",
        }
    }
}

/// One Gaussian factor over the latent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Expert {
    /// The image encoder.
    Vision,
    /// The encoder of force and torque windows.
    Haptic,
    /// The encoder of position and velocity windows.
    Proprio,
    /// One encoder of haptic and proprio windows together (the paper's).
    Joint,
    /// One encoder of everything, embeddings side by side under one head (the paper's baseline).
    Concat,
    /// The learned dynamics, `p(z_t | z_{t-1}, u_{t-1})`.
    Prior,
}

impl Expert {
    /// All experts, in the order in which faces list them.
    pub const ALL: [Self; 6] = [
        Self::Vision,
        Self::Haptic,
        Self::Proprio,
        Self::Joint,
        Self::Concat,
        Self::Prior,
    ];

    /// The modalities this expert looks at; none for the prior.
    pub fn modalities(self) -> &'static [Modality] {
        match self {
            Self::Vision => &[Modality::Vision],
            Self::Haptic => &[Modality::Haptic],
            Self::Proprio => &[Modality::Proprio],
            Self::Joint => &[Modality::Haptic, Modality::Proprio],
            Self::Concat => &[Modality::Vision, Modality::Haptic, Modality::Proprio],
            Self::Prior => &[],
        }
    }

    /// What it looks at, each piece with networks of its own: itself, but for the concatenation; nothing for the prior.
    pub fn streams(self) -> &'static [Self] {
        match self {
            Self::Vision => &[Self::Vision],
            Self::Haptic => &[Self::Haptic],
            Self::Proprio => &[Self::Proprio],
            Self::Joint => &[Self::Joint],
            Self::Concat => &[Self::Vision, Self::Joint],
            Self::Prior => &[],
        }
    }

    /// The letter that stands for it: V, H, P, J, C, and D for the dynamics prior.
    pub fn letter(self) -> char {
        match self {
            Self::Vision => 'V',
            Self::Haptic => 'H',
            Self::Proprio => 'P',
            Self::Joint => 'J',
            Self::Concat => 'C',
            Self::Prior => 'D',
        }
    }

    /// Its name in help, messages and state strings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vision => "vision",
            Self::Haptic => "haptic",
            Self::Proprio => "proprio",
            Self::Joint => "joint",
            Self::Concat => "concat",
            Self::Prior => "prior",
        }
    }

    /// Its colour as sRGB bytes.
    pub fn rgb(self) -> (u8, u8, u8) {
        match self {
            Self::Vision => (0x00, 0x72, 0xB2),
            Self::Haptic => (0xD5, 0x5E, 0x00),
            Self::Proprio => (0x00, 0x9E, 0x73),
            Self::Joint => (0xE6, 0x9F, 0x00),
            Self::Concat => (0xCC, 0x79, 0xA7),
            Self::Prior => (0x99, 0x99, 0x99),
        }
    }

    /// The fill that carries the same meaning without colour.
    pub fn fill(self) -> char {
        match self {
            Self::Vision | Self::Concat => '█',
            Self::Haptic | Self::Joint => '▓',
            Self::Proprio => '▒',
            Self::Prior => '░',
        }
    }
}

/// A set of a model's sensor experts, by their position in the model's list; the prior is not a member.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ExpertSet(pub u8);

impl ExpertSet {
    /// The set of the first `n` experts: everything a model with `n` sensor experts has.
    pub fn full(n: usize) -> Self {
        Self(((1_u16 << n) - 1) as u8)
    }

    /// Whether expert `i` is a member.
    pub fn contains(self, i: usize) -> bool {
        self.0 >> i & 1 == 1
    }
}
