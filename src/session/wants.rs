//! What a face is about to show besides the usual: what nobody looks at is not computed.

use super::Session;

/// What to compute besides beliefs, rollout and readings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is wanted on its own")]
pub struct Wants {
    /// Every set of experts at the cursor.
    pub lattice: bool,
    /// The spread of the rollout, with samples.
    pub spread: bool,
    /// The response to damage of rising severity.
    pub response: bool,
    /// Consistency over a split.
    pub board: bool,
}

impl Wants {
    /// What one of two faces wants.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            lattice: self.lattice || other.lattice,
            spread: self.spread || other.spread,
            response: self.response || other.response,
            board: self.board || other.board,
        }
    }
}

impl Session {
    /// Says what is looked at from now on.
    pub fn want(&mut self, wants: Wants) {
        self.own_wants = wants;
        self.hear();
    }
}
