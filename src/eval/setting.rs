//! What is switched, tempered or damaged while a model is scored.

use serde::{Deserialize, Serialize};

use crate::episode::Episode;
use crate::measure::corruption::{Corruption, corrupt};
use crate::modality::{Expert, Modality};
use crate::model::config::Config;
use crate::model::trace::Alphas;

/// α of an expert over some steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tempered {
    /// Whose.
    pub expert: Expert,
    /// First step.
    pub from: usize,
    /// The first step it does not reach any more; none to the end.
    pub until: Option<usize>,
    /// 0 off, 1 as trained.
    pub alpha: f32,
}

/// Everything that is not as trained and recorded.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// As it stands behind a model's name; empty for nothing.
    pub name: String,
    /// Later ones win.
    pub tempered: Vec<Tempered>,
    /// Inputs that are damaged.
    pub damaged: Vec<(Modality, Corruption)>,
}

impl Setting {
    /// The product without the dynamics prior, so that product and prior are told apart.
    pub fn prior_off() -> Self {
        Self {
            name: "prior off".to_owned(),
            tempered: vec![Tempered {
                expert: Expert::Prior,
                from: 0,
                until: None,
                alpha: 0.0,
            }],
            damaged: Vec::new(),
        }
    }

    /// Whether a model has every expert that is switched, and sees every input that is damaged.
    pub fn applies_to(&self, config: &Config) -> bool {
        let has = |expert: Expert| match expert {
            Expert::Prior => config.prior_expert,
            other => config.experts.contains(&other),
        };
        let sees = |modality: &Modality| {
            let mut experts = config.experts.iter();
            experts.any(|expert| expert.modalities().contains(modality))
        };
        self.tempered.iter().all(|t| has(t.expert)) && self.damaged.iter().all(|(m, _)| sees(m))
    }

    /// α of every expert at each of so many beliefs, the prior last.
    pub fn alphas(&self, config: &Config, beliefs: usize) -> Alphas {
        let steps = (0..beliefs).map(|belief| belief + config.frame_stack);
        Alphas {
            experts: config.switches(),
            values: steps.flat_map(|step| self.at(config, step)).collect(),
        }
    }

    /// α of every expert at a step, the prior last.
    fn at(&self, config: &Config, step: usize) -> Vec<f32> {
        let reaches = |t: &&Tempered| step >= t.from && t.until.is_none_or(|until| step < until);
        let alpha = |expert: Expert| {
            let mut own = self.tempered.iter().filter(|t| t.expert == expert);
            own.rfind(reaches).map_or(1.0, |t| t.alpha)
        };
        let experts = config.experts.iter().copied().chain([Expert::Prior]);
        experts.map(alpha).collect()
    }

    /// Whether a belief would be left without any expert, in an episode that is long enough.
    pub fn empties(&self, config: &Config) -> bool {
        // Between two changes all beliefs are alike.
        let changes = self.tempered.iter().flat_map(|t| [Some(t.from), t.until]);
        let mut steps = changes.flatten().map(|step| step.max(config.frame_stack));
        // Without the prior as an expert a belief of no sensor is the prior all the same.
        config.prior_expert && steps.any(|step| self.at(config, step).iter().all(|&a| a == 0.0))
    }

    /// The episode as it is seen.
    pub fn damage(&self, episode: &Episode) -> Option<Episode> {
        self.damaged
            .iter()
            .fold(None, |seen: Option<Episode>, (modality, corruption)| {
                Some(corrupt(
                    seen.as_ref().unwrap_or(episode),
                    *modality,
                    corruption,
                ))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_reaches_its_steps_and_its_models_only() {
        let model = |name| Config::named(name).expect("a model");
        let mut setting = Setting::prior_off();
        assert!(setting.applies_to(&model("vhp")) && !setting.applies_to(&model("v")));
        setting.tempered.push(Tempered {
            expert: Expert::Vision,
            from: 2,
            until: Some(3),
            alpha: 0.5,
        });
        // With one frame stacked belief 1 is of step 2.
        let alphas = setting.alphas(&model("vhp"), 3);
        assert_eq!(alphas.row(0), [1.0, 1.0, 0.0]);
        assert_eq!(alphas.row(1), [0.5, 1.0, 0.0]);
        assert_eq!(alphas.row(2), [1.0, 1.0, 0.0]);
        assert!(!setting.empties(&model("vhp")));
        for expert in [Expert::Vision, Expert::Joint] {
            setting.tempered.push(Tempered {
                expert,
                from: 30,
                until: None,
                alpha: 0.0,
            });
        }
        assert!(setting.empties(&model("vhp")) && !setting.empties(&model("v-h-p")));
    }
}
