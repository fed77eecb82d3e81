//! What has been computed, kept as long as it is likely to be asked for again.
//!
//! An episode is read once for a layout and encoded once for a model; a damaged input encodes its own experts once
//! more; the filter runs once for a setting of the switches. So a switch never encodes, and switching back shows what
//! was there without computing it again.

use std::sync::Arc;

use super::inferred::{Inferred, infer};
use super::lattice::Lattice;
use super::lru::Lru;
use super::opened::Opened;
use super::pictured::Pictured;
use super::readings::{Readings, ReadingsKey};
use super::response::ResponseKey;
use super::spread::{Spread, SpreadKey};
use crate::episode::{Episode, EpisodeSource, Layout, SourceError};
use crate::measure::corruption::{Corruption, corrupt};
use crate::modality::Modality;
use crate::model::trace::{Alphas, ExpertTrace, GaussianTrace};
use crate::session::predict::{PredictError, Predictor};
use crate::session::settings::{ControlEdit, Rollout};
use crate::session::snapshot::response::ResponseView;

/// Episodes and encodings kept.
const EPISODES: usize = 8;
/// Settings of the switches kept, with their decoded frames.
const BELIEFS: usize = 24;
/// Damaged inputs kept.
const DAMAGED: usize = 24;
/// Lattices and spreads kept.
const FEW: usize = 4;

/// One model on one episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Index of the model.
    pub model: usize,
    /// Index of the episode.
    pub episode: usize,
}

/// What is wrong with each modality.
type Damages = Vec<(Modality, Corruption)>;

/// What the experts of a model look at: an episode, damaged or not.
#[derive(Clone, Debug, PartialEq)]
pub struct Sight {
    /// Which.
    pub target: Target,
    /// What is wrong with its modalities.
    pub damage: Damages,
}

/// A setting of the switches over what is seen, compared bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefKey {
    /// What is seen.
    pub sight: Sight,
    alpha_bits: Vec<u32>,
}

/// Which rollout: from where, how far, under which controls; of the mean path, or the first sample of this seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloutKey {
    /// Its steps.
    pub rollout: Rollout,
    /// Other controls than the recorded ones.
    pub controls: Option<ControlEdit>,
    /// Seed of the sample; none for the mean path.
    pub sample: Option<u64>,
}

/// Beliefs and their pictures.
#[derive(Debug)]
pub struct Believed {
    /// The numbers.
    pub inferred: Arc<Inferred>,
    /// The pictures.
    pub pictured: Pictured,
}

/// Everything kept.
#[derive(Debug)]
pub struct Memo {
    episodes: Lru<(usize, Layout), Arc<Episode>>,
    damaged: Lru<(usize, Layout, Damages), Arc<Episode>>,
    opened: Lru<Target, Arc<Opened>>,
    clean: Lru<Target, Arc<ExpertTrace>>,
    seen: Lru<(Sight, usize), Arc<GaussianTrace>>,
    traces: Lru<Sight, Arc<ExpertTrace>>,
    beliefs: Lru<BeliefKey, Believed>,
    rollouts: Lru<(BeliefKey, RolloutKey), Pictured>,
    /// Readings, lattices and spreads.
    pub readings: Lru<ReadingsKey, Arc<Readings>>,
    /// All sets of experts.
    pub lattices: Lru<Sight, Lattice>,
    /// Samples of rollouts.
    pub spreads: Lru<SpreadKey, Spread>,
    /// Responses to damage.
    pub responses: Lru<ResponseKey, ResponseView>,
}

impl Default for Memo {
    fn default() -> Self {
        Self {
            episodes: Lru::new(EPISODES),
            damaged: Lru::new(FEW),
            opened: Lru::new(EPISODES),
            clean: Lru::new(EPISODES),
            seen: Lru::new(DAMAGED),
            traces: Lru::new(DAMAGED),
            beliefs: Lru::new(BELIEFS),
            rollouts: Lru::new(BELIEFS),
            readings: Lru::new(BELIEFS),
            lattices: Lru::new(FEW),
            spreads: Lru::new(FEW),
            responses: Lru::new(DAMAGED),
        }
    }
}

impl Memo {
    /// The aligned episode in a layout.
    pub fn episode(
        &mut self,
        source: &dyn EpisodeSource,
        index: usize,
        layout: Layout,
    ) -> Result<Arc<Episode>, SourceError> {
        let load = || source.load(index, layout).map(Arc::new);
        self.episodes
            .get_or_try_insert((index, layout), load)
            .map(|episode| Arc::clone(episode))
    }

    /// The episode as it is with some of its modalities damaged.
    pub fn damaged(
        &mut self,
        index: usize,
        episode: &Arc<Episode>,
        damage: &[(Modality, Corruption)],
    ) -> Arc<Episode> {
        if damage.is_empty() {
            return Arc::clone(episode);
        }
        let spoil = || {
            let mut spoilt = corrupt(episode, damage[0].0, &damage[0].1);
            for (modality, corruption) in &damage[1..] {
                spoilt = corrupt(&spoilt, *modality, corruption);
            }
            Ok::<_, std::convert::Infallible>(Arc::new(spoilt))
        };
        let key = (index, episode.layout, damage.to_vec());
        match self.damaged.get_or_try_insert(key, spoil) {
            Ok(spoilt) => Arc::clone(spoilt),
            Err(never) => match never {},
        }
    }

    /// What can be shown of it before any model has run.
    pub fn opened(
        &mut self,
        target: Target,
        episode: &Episode,
        predictor: Option<&dyn Predictor>,
    ) -> Arc<Opened> {
        let missing = || predictor.map(|p| p.missing(episode)).unwrap_or_default();
        let contact = predictor.and_then(|p| p.info().contact_newtons);
        let opened = || Arc::new(Opened::new(episode, missing(), contact));
        let open = || Ok::<_, std::convert::Infallible>(opened());
        match self.opened.get_or_try_insert(target, open) {
            Ok(opened) => Arc::clone(opened),
            Err(never) => match never {},
        }
    }

    /// Drops what came from a model.
    pub fn forget(&mut self, model: usize) {
        let of = |sight: &Sight| sight.target.model == model;
        self.opened.forget(|target| target.model == model);
        self.clean.forget(|target| target.model == model);
        self.seen.forget(|(sight, _)| of(sight));
        self.traces.forget(of);
        self.beliefs.forget(|key| of(&key.sight));
        self.rollouts.forget(|(key, _)| of(&key.sight));
        self.readings.forget(|key| of(&key.belief.sight));
        self.lattices.forget(of);
        self.spreads.forget(|key| of(&key.belief.sight));
        self.responses.forget(|key| of(&key.belief.sight));
    }

    /// What the experts say of an episode: those whose input is damaged are asked again, the others are not.
    pub fn trace(
        &mut self,
        sight: &Sight,
        episode: &Arc<Episode>,
        predictor: &dyn Predictor,
    ) -> Result<Arc<ExpertTrace>, PredictError> {
        if let Some(trace) = self.traces.get(sight) {
            return Ok(Arc::clone(trace));
        }
        let encode = || predictor.encode(episode).map(Arc::new);
        let clean = self.clean.get_or_try_insert(sight.target, encode)?;
        let mut trace = Arc::clone(clean);
        for (i, expert) in predictor.info().experts.iter().enumerate() {
            let own =
                |(modality, _): &&(Modality, Corruption)| expert.modalities().contains(modality);
            let damage: Vec<_> = sight.damage.iter().filter(own).copied().collect();
            if damage.is_empty() {
                continue;
            }
            let spoilt = self.damaged(sight.target.episode, episode, &damage);
            let encode = || predictor.encode_expert(&spoilt, i).map(Arc::new);
            let only = Sight {
                target: sight.target,
                damage,
            };
            let seen = self.seen.get_or_try_insert((only, i), encode)?;
            Arc::make_mut(&mut trace).experts[i] = GaussianTrace::clone(seen);
        }
        let keep = || Ok::<_, PredictError>(trace);
        self.traces
            .get_or_try_insert(sight.clone(), keep)
            .map(|trace| Arc::clone(trace))
    }

    /// Whether it is known what the experts say of the undamaged episode.
    pub fn is_encoded(&mut self, target: Target) -> bool {
        self.clean.get(&target).is_some()
    }

    /// Filters for one setting of the switches.
    pub fn believe(
        &mut self,
        sight: &Sight,
        trace: &Arc<ExpertTrace>,
        alphas: Alphas,
        steps: usize,
        predictor: &dyn Predictor,
    ) -> Result<BeliefKey, PredictError> {
        let key = BeliefKey {
            sight: sight.clone(),
            alpha_bits: alphas.values.iter().map(|alpha| alpha.to_bits()).collect(),
        };
        let filter = || {
            let inferred = infer(Arc::clone(trace), alphas, steps, predictor)?;
            let posterior = inferred.beliefs.posterior.clone();
            Ok::<_, PredictError>(Believed {
                pictured: Pictured::new(predictor, posterior, predictor.info().frame_stack, steps),
                inferred: Arc::new(inferred),
            })
        };
        self.beliefs.get_or_try_insert(key.clone(), filter)?;
        Ok(key)
    }

    /// Beliefs that were filtered just before.
    pub fn believed(&mut self, key: &BeliefKey) -> Option<&mut Believed> {
        self.beliefs.get(key)
    }

    /// The numbers of beliefs that were filtered just before.
    pub fn inferred(&mut self, key: &BeliefKey) -> Option<Arc<Inferred>> {
        self.beliefs
            .get(key)
            .map(|believed| Arc::clone(&believed.inferred))
    }

    /// Rolls out from these beliefs, where there is a step to predict.
    pub fn roll_out(
        &mut self,
        key: &BeliefKey,
        which: RolloutKey,
        steps: usize,
        predictor: &dyn Predictor,
    ) -> Result<(), PredictError> {
        if which.rollout.horizon == 0 {
            return Ok(());
        }
        let Some(inferred) = self.inferred(key) else {
            return Ok(());
        };
        let first = which.rollout.start + 1;
        let roll = || {
            let trace = inferred.roll_out(which, predictor)?;
            Ok::<_, PredictError>(Pictured::new(predictor, trace, first, steps))
        };
        self.rollouts
            .get_or_try_insert((key.clone(), which), roll)?;
        Ok(())
    }

    /// A rollout that was made just before.
    pub fn rolled_out(&mut self, key: &BeliefKey, which: RolloutKey) -> Option<&mut Pictured> {
        self.rollouts.get(&(key.clone(), which))
    }
}
