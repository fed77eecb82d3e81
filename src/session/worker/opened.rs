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

/// The force at which contact counts as begun: a quarter of the episode's strongest, and no less than a sensor's noise.
fn contact_newtons(force_newtons: &[f32]) -> f32 {
    const NOISE: f32 = 0.1;
    let strongest = force_newtons.iter().copied().fold(0.0, f32::max);
    (0.25 * strongest).max(NOISE)
}

impl Opened {
    /// Shares the pieces of an episode; `missing` are the roles the model lacks.
    pub fn new(episode: &Episode, missing: Vec<String>) -> Self {
        let steps = episode.steps();
        let first = episode.steps_nanos.first().copied().unwrap_or_default();
        let force_newtons: Vec<f32> = (0..steps).map_while(|t| episode.force_newtons(t)).collect();
        let onsets = onsets(&force_newtons, contact_newtons(&force_newtons));
        let view = EpisodeView {
            id: episode.meta.id.clone(),
            split: episode.meta.split,
            source: episode.meta.source.clone(),
            secs: (0..steps).map(|t| episode.secs_at(t)).collect(),
            force_newtons,
            flags: episode
                .flags
                .iter()
                .map(|flag| {
                    let secs = flag.stamp_nanos.saturating_sub(first) as f64 * 1e-9;
                    format!("{} at {secs:.2} s: {}", flag.topic, flag.what)
                })
                .collect(),
            flagged_steps: episode
                .flags
                .iter()
                .map(|flag| {
                    episode
                        .steps_nanos
                        .partition_point(|&step| step <= flag.stamp_nanos)
                        .saturating_sub(1)
                })
                .collect(),
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
