//! What can be looked at: the views, and the panes of each in the order of Tab.
//!
//! ```text
//! v    overview → fuse → predict → position → consistency → lattice → overview
//! Tab  the next pane of the view; Enter shows it alone
//! ```

use crate::session::wants::Wants;

/// One question to an episode, as a screen of panes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// A little of everything.
    #[default]
    Overview,
    /// What the belief at the cursor is made of.
    Fuse,
    /// How sure the rollout is, and whether it should be.
    Predict,
    /// Where the object is, and who pulls it there.
    Position,
    /// Whether what is claimed is held, over all episodes.
    Consistency,
    /// Every set of experts at once.
    Lattice,
}

/// A part of the screen that can have the focus and fill the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    /// Truth, belief, prediction, error.
    Frames,
    /// Frames of every k-th step.
    Strip,
    /// Switches, shares and the readings of each expert.
    Experts,
    /// Shares per latent dimension, and what each carries of the position.
    Dims,
    /// Means and deviations of the latent.
    Latents,
    /// The table from above.
    Position,
    /// Steps, force and shares over time.
    Timeline,
    /// Who disagrees with whom, and how much.
    Pairs,
    /// KL terms, mean and spread apart.
    Divergence,
    /// What rising damage does.
    Response,
    /// Diagnostics over time.
    Series,
    /// Spread of the rollout over its steps, in three ways.
    Spread,
    /// PSNR of belief and prediction over the horizon.
    Quality,
    /// A sample, the mean of samples, and their deviation as images.
    Samples,
    /// What each sensor pulls the position by.
    Pulls,
    /// What the consistency of a split comes to, in words.
    Verdict,
    /// The same in numbers.
    Numbers,
    /// What is claimed against what is held.
    Coverage,
    /// NEES at each horizon.
    Horizons,
    /// Correlation between experts, and the α that fit.
    Dependence,
    /// Every set of experts.
    Sets,
}

impl View {
    /// In the order of `v`.
    pub const ALL: [Self; 6] = [
        Self::Overview,
        Self::Fuse,
        Self::Predict,
        Self::Position,
        Self::Consistency,
        Self::Lattice,
    ];

    /// Its name on the status line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overview => "overview",
            Self::Fuse => "fuse",
            Self::Predict => "predict",
            Self::Position => "position",
            Self::Consistency => "consistency",
            Self::Lattice => "lattice",
        }
    }

    /// The next one, round and round.
    #[must_use]
    pub fn next(self) -> Self {
        turned(&Self::ALL, self, 1)
    }

    /// The panes that Tab goes through; the first has the focus when the view opens.
    pub fn panes(self) -> &'static [Pane] {
        use Pane::{
            Coverage, Dependence, Dims, Divergence, Experts, Frames, Horizons, Latents, Numbers,
            Pairs, Position, Pulls, Quality, Response, Samples, Series, Sets, Spread, Strip,
            Timeline, Verdict,
        };
        match self {
            Self::Overview => &[Frames, Experts, Latents, Position, Timeline],
            Self::Fuse => &[
                Experts, Pairs, Dims, Divergence, Response, Latents, Series, Timeline,
            ],
            Self::Predict => &[Strip, Quality, Spread, Samples, Timeline],
            Self::Position => &[Position, Pulls, Experts, Timeline],
            Self::Consistency => &[Verdict, Horizons, Coverage, Numbers, Dependence, Timeline],
            Self::Lattice => &[Sets, Experts, Timeline],
        }
    }

    /// What has to be computed for it.
    pub fn wants(self) -> Wants {
        Wants {
            lattice: self == Self::Lattice,
            spread: matches!(self, Self::Predict | Self::Position),
            response: self == Self::Fuse,
            board: self == Self::Consistency,
        }
    }
}

impl Pane {
    /// All there are.
    #[cfg(test)]
    pub const ALL: [Self; 21] = [
        Self::Frames,
        Self::Strip,
        Self::Experts,
        Self::Dims,
        Self::Latents,
        Self::Position,
        Self::Timeline,
        Self::Pairs,
        Self::Divergence,
        Self::Response,
        Self::Series,
        Self::Spread,
        Self::Quality,
        Self::Samples,
        Self::Pulls,
        Self::Verdict,
        Self::Numbers,
        Self::Coverage,
        Self::Horizons,
        Self::Dependence,
        Self::Sets,
    ];

    /// Its name on the status line, where it cannot be marked itself.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frames => "frames",
            Self::Strip => "strip",
            Self::Experts => "experts",
            Self::Dims => "dims",
            Self::Latents => "latents",
            Self::Position => "position",
            Self::Timeline => "timeline",
            Self::Pairs => "pairs",
            Self::Divergence => "KL",
            Self::Response => "response",
            Self::Series => "series",
            Self::Spread => "spread",
            Self::Quality => "PSNR",
            Self::Samples => "samples",
            Self::Pulls => "pulls",
            Self::Verdict => "verdict",
            Self::Numbers => "numbers",
            Self::Coverage => "coverage",
            Self::Horizons => "horizons",
            Self::Dependence => "dependence",
            Self::Sets => "sets",
        }
    }

    /// The pane of the view so many places on, round and round.
    #[must_use]
    pub fn turned(self, view: View, by: i64) -> Self {
        turned(view.panes(), self, by)
    }
}

/// The member so many places on; from something that is no member, as from the first.
fn turned<T: Copy + PartialEq>(all: &[T], from: T, by: i64) -> T {
    let at = all.iter().position(|&one| one == from).unwrap_or(0) as i64;
    all[(at + by).rem_euclid(all.len() as i64) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_and_panes_come_round() {
        let mut view = View::default();
        for _ in View::ALL {
            let mut pane = view.panes()[0];
            for &expected in view.panes() {
                assert_eq!(pane, expected);
                pane = pane.turned(view, 1);
            }
            assert_eq!(pane, view.panes()[0]);
            assert_eq!(pane.turned(view, -1), view.panes()[view.panes().len() - 1]);
            view = view.next();
        }
        assert_eq!(view, View::default());
    }

    #[test]
    fn every_view_ends_with_the_timeline() {
        for view in View::ALL {
            assert_eq!(view.panes().last(), Some(&Pane::Timeline));
        }
    }
}
