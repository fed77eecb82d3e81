//! An episode as the session shows it: shared pieces, made once.

use std::sync::Arc;

use crate::episode::{Episode, Frame, PlanarPose};
use crate::measure::events::onsets;
use crate::session::snapshot::EpisodeView;

/// What does not depend on any model's answer.
#[derive(Debug)]
pub struct Opened {
    /// What faces say of it.
    pub view: Arc<EpisodeView>,
    /// What was recorded, one a step.
    pub truth: Vec<Arc<Frame>>,
    /// Ground truth; empty if not recorded.
    pub poses: Arc<Vec<PlanarPose>>,
    /// End-effector positions; empty if not recorded.
    pub tip: Arc<Vec<[f32; 2]>>,
    /// Steps at which contact begins.
    pub onsets: Vec<usize>,
}

/// The force at which contact counts as begun where no training set says it: a quarter of the episode's strongest, and
/// no less than a sensor's noise.
fn own_contact_newtons(force_newtons: &[f32]) -> f32 {
    const NOISE: f32 = 0.1;
    let strongest = force_newtons.iter().copied().fold(0.0, f32::max);
    (0.25 * strongest).max(NOISE)
}

impl Opened {
    /// Shares the pieces of an episode; `missing` are the roles the model lacks, `contact_newtons` is the force that
    /// counts as contact in its training set (D25).
    pub fn new(episode: &Episode, missing: Vec<String>, contact_newtons: Option<f32>) -> Self {
        let steps = episode.steps();
        let force_newtons: Vec<f32> = (0..steps).map_while(|t| episode.force_newtons(t)).collect();
        // Where nothing was ever touched in training, nothing is said of contact.
        let trained = contact_newtons.filter(|&newtons| newtons > 0.0);
        let threshold = trained.unwrap_or_else(|| own_contact_newtons(&force_newtons));
        let onsets = onsets(&force_newtons, threshold);
        let view = EpisodeView {
            id: episode.meta.id.clone(),
            split: episode.meta.split,
            source: episode.meta.source.clone(),
            secs: (0..steps).map(|t| episode.secs_at(t)).collect(),
            force_newtons,
            push_newtons: (0..steps).map_while(|t| episode.push_newtons(t)).collect(),
            flags: episode.oddities().collect(),
            flagged_steps: episode.flagged_steps().collect(),
            missing,
        };
        Self {
            view: Arc::new(view),
            truth: episode.frames.iter().cloned().map(Arc::new).collect(),
            poses: Arc::new(episode.object.clone().unwrap_or_default()),
            tip: Arc::new(episode.tip.clone().unwrap_or_default()),
            onsets,
        }
    }

    /// T.
    pub fn steps(&self) -> usize {
        self.truth.len()
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;
    use crate::episode::{EpisodeSource, Layout};
    use crate::session::fake::FakeSource;

    #[test]
    fn contact_is_what_it_was_in_the_training_set_where_that_says_it() {
        let mut episode = FakeSource::new(1).load(0, Layout::default()).unwrap();
        let window = episode.layout.window;
        let haptic = episode.haptic.as_mut().unwrap();
        haptic.fill(0.0);
        haptic[3 * window * 6..][..window * 6].fill(2.0);
        let onsets = |newtons| Opened::new(&episode, Vec::new(), newtons).onsets;
        assert_eq!([onsets(None), onsets(Some(0.0))], [[3], [3]]);
        assert!(onsets(Some(5.0)).is_empty());
    }

    #[test]
    fn a_push_is_the_mean_of_the_recorded_force_turned_round() {
        let mut episode = FakeSource::new(1).load(0, Layout::default()).unwrap();
        let window = episode.layout.window;
        let haptic = episode.haptic.as_mut().unwrap();
        let samples = haptic.chunks_exact_mut(6).skip(3 * window).take(window);
        for (k, sample) in samples.enumerate() {
            sample[..3].copy_from_slice(&[k as f32, -2.0, 9.0]);
        }
        let view = Opened::new(&episode, Vec::new(), None).view;
        assert_eq!(view.push_newtons.len(), view.force_newtons.len());
        // The mean of 0 to 31 is 15.5.
        assert_eq!(view.push_newtons.get(3), Some(&[-15.5, 2.0]));
        episode.haptic = None;
        let without = Opened::new(&episode, Vec::new(), None).view;
        assert!(without.push_newtons.is_empty());
    }
}
