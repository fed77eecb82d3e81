//! What is switched, tempered or damaged while a model is scored.

use serde::{Deserialize, Serialize};

use crate::episode::Episode;
use crate::measure::corruption::{Corruption, corrupt};
use crate::modality::{Expert, Modality};
use crate::model::config::Config;
use crate::model::switches::{Reach, Switches};
use crate::model::trace::Alphas;

/// Everything that is not as trained and recorded.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// As it stands behind a model's name; empty for nothing.
    pub name: String,
    /// α of the experts.
    #[serde(rename = "tempered")]
    pub switches: Switches,
    /// Inputs that are damaged.
    pub damaged: Vec<(Modality, Corruption)>,
}

impl Setting {
    /// The product without the dynamics prior, so that product and prior are told apart.
    pub fn prior_off() -> Self {
        let mut switches = Switches::default();
        switches.set(Expert::Prior, Reach::EPISODE, 0.0);
        Self {
            name: "prior off".to_owned(),
            switches,
            damaged: Vec::new(),
        }
    }

    /// Whether both change the same, whatever they are called.
    pub fn is_like(&self, other: &Self) -> bool {
        (&self.switches, &self.damaged) == (&other.switches, &other.damaged)
    }

    /// Whether a model multiplies every expert that is switched, and sees every input that is damaged.
    pub fn applies_to(&self, config: &Config) -> bool {
        let multiplies = |expert: Expert| {
            config.has_product()
                && match expert {
                    Expert::Prior => config.prior_expert,
                    other => config.experts.contains(&other),
                }
        };
        let sees = |modality: &Modality| {
            let mut experts = config.experts.iter();
            experts.any(|expert| expert.modalities().contains(modality))
        };
        self.switches.switched().all(multiplies) && self.damaged.iter().all(|(m, _)| sees(m))
    }

    /// α of every expert at each of so many beliefs, the prior last.
    pub fn alphas(&self, config: &Config, beliefs: usize) -> Alphas {
        let steps = config.frame_stack..config.frame_stack + beliefs;
        self.switches.alphas(&experts(config), steps)
    }

    /// Whether a belief would be left without any expert, in an episode that is long enough.
    pub fn empties(&self, config: &Config) -> bool {
        let silent = || {
            self.switches
                .silent_step(&experts(config), config.frame_stack)
        };
        // Without the prior as an expert a belief of no sensor is the prior all the same.
        config.prior_expert && silent().is_some()
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

/// The experts of a model, the prior last.
fn experts(config: &Config) -> Vec<Expert> {
    let sensors = config.experts.iter().copied();
    sensors.chain([Expert::Prior]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_reaches_its_steps_and_its_models_only() {
        let model = |name| Config::named(name).expect("a model");
        let mut setting = Setting::prior_off();
        assert!(setting.applies_to(&model("vhp")) && !setting.applies_to(&model("v")));
        let one = Reach {
            from: 2,
            until: Some(3),
        };
        setting.switches.set(Expert::Vision, one, 0.5);
        // With one frame stacked belief 1 is of step 2.
        let alphas = setting.alphas(&model("vhp"), 3);
        assert_eq!(alphas.row(0), [1.0, 1.0, 0.0]);
        assert_eq!(alphas.row(1), [0.5, 1.0, 0.0]);
        assert_eq!(alphas.row(2), [1.0, 1.0, 0.0]);
        assert!(!setting.empties(&model("vhp")));
        let late = Reach {
            from: 30,
            until: None,
        };
        for expert in [Expert::Vision, Expert::Joint] {
            setting.switches.set(expert, late, 0.0);
        }
        assert!(setting.empties(&model("vhp")) && !setting.empties(&model("v-h-p")));
        // Where the prior is no expert it is what is left to believe.
        let without = Config {
            prior_expert: false,
            ..model("vhp")
        };
        assert!(!setting.empties(&without));
        // One expert alone is no product, and is as trained.
        setting.switches = Switches::default();
        setting.switches.set(Expert::Vision, Reach::EPISODE, 0.0);
        assert!(setting.applies_to(&without) && !setting.applies_to(&model("v")));
    }

    #[test]
    fn a_setting_is_what_it_does_and_not_what_it_is_called() {
        let setting = Setting {
            name: "alpha=prior:0".to_owned(),
            ..Setting::prior_off()
        };
        assert!(setting.is_like(&Setting::prior_off()) && setting != Setting::prior_off());
        assert!(!setting.is_like(&Setting::default()));
    }

    #[test]
    fn before_the_first_belief_there_is_none_to_lose() {
        let model = Config::named("v-h-p").expect("a model");
        let mut setting = Setting::default();
        let first = Reach {
            from: 0,
            until: Some(model.frame_stack),
        };
        for expert in experts(&model) {
            setting.switches.set(expert, first, 0.0);
        }
        assert!(!setting.empties(&model));
    }
}
