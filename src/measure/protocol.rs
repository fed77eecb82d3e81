//! How much is seen and how much is predicted.

use serde::{Deserialize, Serialize};

/// c images are seen with every expert on; the next h are predicted from the known controls alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Protocol {
    /// c, counted in images: with stacked frames there are fewer beliefs.
    pub context: usize,
    /// h.
    pub horizon: usize,
}

impl Protocol {
    /// The paper's on its synthetic set.
    pub const SYNTHETIC: Self = Self {
        context: 4,
        horizon: 11,
    };
    /// The paper's on the MIT set.
    pub const MIT: Self = Self {
        context: 5,
        horizon: 37,
    };

    /// Both by the names of their sets.
    pub const NAMED: [(&str, Self); 2] = [("synthetic", Self::SYNTHETIC), ("mit", Self::MIT)];

    /// The same, cut to an episode of `steps` images.
    #[must_use]
    pub fn within(self, steps: usize) -> Self {
        Self {
            horizon: self.horizon.min(steps.saturating_sub(self.context)),
            ..self
        }
    }

    /// Images that an episode must have.
    pub fn images(self) -> usize {
        self.context + self.horizon
    }
}
