//! What is asked of the worker, and what it has made of it so far.

use std::sync::Arc;

use super::inferred::Inferred;
use super::memo::{Sight, Target};
use super::opened::Opened;
use super::readings::Readings;
use crate::episode::Frame;
use crate::session::known::Known;
use crate::session::settings::Settings;
use crate::session::snapshot::lattice::LatticeView;
use crate::session::snapshot::response::ResponseView;
use crate::session::snapshot::spread::SpreadView;
use crate::session::snapshot::{Estimate, StepPsnr, StripCell};
use crate::session::wants::Wants;

/// What a session wants computed.
#[derive(Clone, Debug)]
pub struct Request {
    /// Rises with each change of what is wanted; stays when only the cursor moves.
    pub generation: u64,
    /// Which model on which episode.
    pub target: Target,
    /// The model beside it.
    pub other: Option<usize>,
    /// With which switches, context and horizon.
    pub settings: Settings,
    /// The step whose frames come first.
    pub cursor: usize,
    /// What is looked at besides the usual.
    pub wants: Wants,
    /// What is known of the model's latent.
    pub known: Option<Arc<Known>>,
}

impl Request {
    /// What a model would see.
    pub fn sight(&self, model: usize) -> Sight {
        let damage = self.settings.corruptions.iter();
        Sight {
            target: Target {
                model,
                ..self.target
            },
            damage: damage
                .map(|(&modality, &damage)| (modality, damage))
                .collect(),
        }
    }
}

/// What has been computed of a request so far.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Of which request.
    pub generation: u64,
    /// Which model on which episode.
    pub target: Target,
    /// The episode, once read.
    pub opened: Option<Arc<Opened>>,
    /// The frames that the model sees instead of the recorded ones; empty where vision is undamaged.
    pub input: Arc<Vec<Arc<Frame>>>,
    /// The beliefs, once filtered.
    pub inferred: Option<Arc<Inferred>>,
    /// Frames and positions.
    pub pictures: Pictures,
    /// The diagnostics, once read.
    pub readings: Option<Arc<Readings>>,
    /// The model beside it.
    pub other: Option<Other>,
    /// Every set of experts.
    pub lattice: Option<Arc<LatticeView>>,
    /// The spread of the rollout.
    pub spread: Option<Arc<SpreadView>>,
    /// Responses to damage.
    pub responses: Arc<Vec<ResponseView>>,
    /// What went wrong.
    pub fault: Option<String>,
    /// Whether nothing more will come.
    pub done: bool,
}

/// What one model makes of an episode, as pictures and positions.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The frames of each step.
    pub strip: Arc<Vec<StripCell>>,
    /// PSNR of each step.
    pub psnr_db: Arc<Vec<StepPsnr>>,
    /// Positions at each step from the beliefs; none without a probe.
    pub belief_positions: Option<Arc<Vec<Option<Estimate>>>>,
    /// Positions at each step from the rollout; none without a probe.
    pub rollout_positions: Option<Arc<Vec<Option<Estimate>>>>,
    /// Positions of the rollout under the recorded controls, where they are edited.
    pub recorded_positions: Option<Arc<Vec<Option<Estimate>>>>,
}

/// A second model.
#[derive(Clone, Debug)]
pub struct Other {
    /// Its index.
    pub model: usize,
    /// What it makes of the episode.
    pub pictures: Pictures,
    /// Why it makes nothing of it.
    pub fault: Option<String>,
}

impl Answer {
    /// The same after an earlier one of its target: what it has not come to yet is shown as it was before.
    #[must_use]
    pub fn after(mut self, before: &Self) -> Self {
        if !self.done {
            self.readings = self.readings.or_else(|| before.readings.clone());
            self.other = self.other.or_else(|| before.other.clone());
            self.lattice = self.lattice.or_else(|| before.lattice.clone());
            self.spread = self.spread.or_else(|| before.spread.clone());
            if self.responses.is_empty() {
                self.responses = Arc::clone(&before.responses);
            }
        }
        self
    }

    /// Nothing yet.
    pub fn new(request: &Request) -> Self {
        Self {
            generation: request.generation,
            target: request.target,
            opened: None,
            input: Arc::default(),
            inferred: None,
            pictures: Pictures::default(),
            readings: None,
            other: None,
            lattice: None,
            spread: None,
            responses: Arc::default(),
            fault: None,
            done: false,
        }
    }
}
