//! What faces ask of a snapshot again and again.

use crate::measure::corruption::{Corruption, Damage};
use crate::modality::{Expert, Modality};
use crate::model::switches::Reach;

use super::{Estimate, ModelInfo, Snapshot};

/// The estimate of a step, where there is one.
pub fn estimate_at(estimates: &[Option<Estimate>], step: usize) -> Option<Estimate> {
    estimates.get(step).copied().flatten()
}

/// Severity of a damage that says nothing else.
const HALF: f32 = 0.5;

impl Snapshot {
    /// T of the episode; 0 while there is none.
    pub fn steps(&self) -> usize {
        self.episode
            .as_ref()
            .map_or(0, |episode| episode.secs.len())
    }

    /// The model that is shown; none where none is loaded.
    pub fn shown_model(&self) -> Option<&ModelInfo> {
        self.models.get(self.model).map(|model| &**model)
    }

    /// The first step, from 0, at which the model has a belief.
    pub fn first_belief(&self) -> usize {
        self.shown_model().map_or(0, |model| model.frame_stack)
    }

    /// What the model's experts look at, in the order in which faces list it.
    pub fn modalities(&self) -> impl Iterator<Item = Modality> {
        let looks = |modality| {
            let mut experts = self.experts.iter();
            experts.any(|view| view.expert.modalities().contains(&modality))
        };
        Modality::ALL
            .into_iter()
            .filter(move |&modality| looks(modality))
    }

    /// What damages a modality's input, at whatever steps.
    pub fn corruption_of(&self, modality: Modality) -> Option<Corruption> {
        let mut all = self.corruptions.iter();
        all.find_map(|&(damaged, corruption)| (damaged == modality).then_some(corruption))
    }

    /// What an expert sees damaged at the cursor, the first of its modalities that is.
    pub fn damage_of(&self, expert: Expert) -> Option<(Modality, Corruption)> {
        let seen = expert.modalities().iter();
        let mut damages =
            seen.filter_map(|&modality| Some((modality, self.corruption_of(modality)?)));
        damages.find(|(_, corruption)| corruption.acts_at(self.cursor))
    }

    /// A new damage as the scope at the cursor has it. Its seed is the session's.
    pub fn aimed(&self, damage: Damage) -> Corruption {
        let Reach { from, until } = self.scope.reach(self.cursor);
        Corruption {
            damage,
            severity: HALF,
            from,
            until,
            seed: self.sampling.seed,
            ..Corruption::default()
        }
    }
}
