//! What may be switched: the rules of a product of experts, as pure functions on [`Switches`].
//!
//! Each verb returns the line to tell the user; a refusal changes nothing.

use super::command::Scope;
use super::snapshot::ModelInfo;
use crate::modality::Expert;
use crate::model::switches::{Reach, Switches, checked_alpha};
use crate::model::trace::{Alphas, count_prior};

/// A line that says why not.
pub type Refusal = String;

impl ModelInfo {
    /// The experts in the order of a snapshot: the sensors, then the prior.
    pub fn all_experts(&self) -> Vec<Expert> {
        let prior = std::iter::once(Expert::Prior);
        self.experts.iter().copied().chain(prior).collect()
    }

    /// The experts that are multiplied: without the prior where the model leaves it out.
    pub fn factors(&self) -> Vec<Expert> {
        let mut factors = self.all_experts();
        if !self.prior_expert {
            factors.pop();
        }
        factors
    }

    /// Whether there is anything to switch.
    pub fn has_product(&self) -> bool {
        self.factors().len() > 1
    }

    /// Whether this expert is one of several that are multiplied.
    pub fn can_switch(&self, expert: Expert) -> bool {
        self.has_product() && self.factors().contains(&expert)
    }

    /// α of an expert at a step; what cannot be switched in this model is as trained.
    pub fn alpha(&self, switches: &Switches, expert: Expert, step: usize) -> f32 {
        if self.can_switch(expert) {
            switches.alpha(expert, step)
        } else {
            1.0
        }
    }

    /// The same for the filter, `(beliefs, M)`: the first belief is at step `frame_stack`.
    pub fn alphas(&self, switches: &Switches, beliefs: usize) -> Alphas {
        let mut own = switches.clone();
        own.retain(|expert| self.can_switch(expert));
        let steps = self.frame_stack..self.frame_stack + beliefs;
        own.alphas(&self.all_experts(), steps)
    }

    /// α that each expert counts with at a step, the prior last: where that is no factor, 0 but beside no sensor.
    pub fn counted(&self, switches: &Switches, step: usize) -> Vec<f32> {
        let experts = self.all_experts();
        let own = experts
            .iter()
            .map(|&expert| self.alpha(switches, expert, step));
        let mut alphas: Vec<f32> = own.collect();
        count_prior(&mut alphas, experts.len(), self.prior_expert);
        alphas
    }

    /// The first step whose belief would be left without any expert. Where the prior is no factor it is what is left.
    pub fn silent_step(&self, switches: &Switches) -> Option<usize> {
        let silent = || switches.silent_step(&self.factors(), self.frame_stack);
        self.prior_expert.then(silent).flatten()
    }
}

/// Where a switch is pulled: the scope and the step of the cursor's belief.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// How far it reaches.
    pub scope: Scope,
    /// Step of the belief under the cursor, from 0.
    pub step: usize,
}

impl Place {
    fn reach(self) -> Reach {
        self.scope.reach(self.step)
    }

    fn words(self) -> String {
        match self.scope {
            Scope::Episode => "in the whole episode".to_owned(),
            Scope::Onward => format!("from step {} on", self.step + 1),
            Scope::Frame => format!("at step {}", self.step + 1),
        }
    }
}

/// Switches an expert off where it is on under the cursor, else on: as it was before, if it was switched off over the
/// same steps, else as trained.
pub fn toggle(
    model: &ModelInfo,
    switches: &mut Switches,
    place: Place,
    position: usize,
) -> Result<String, Refusal> {
    let is_on = switches.alpha(factor_at(model, position)?, place.step) > 0.0;
    turn(model, switches, place, position, !is_on)
}

/// Switches an expert on or off; one that is so already stays as it is.
pub fn turn(
    model: &ModelInfo,
    switches: &mut Switches,
    place: Place,
    position: usize,
    on: bool,
) -> Result<String, Refusal> {
    let expert = factor_at(model, position)?;
    if on != (switches.alpha(expert, place.step) > 0.0) {
        let mut changed = switches.clone();
        if on {
            changed.on(expert, place.reach());
        } else {
            changed.off(expert, place.reach());
        }
        accept(model, switches, changed, expert.name())?;
    }
    let state = if on { "on" } else { "off" };
    Ok(format!("{} {state} {}", expert.name(), place.words()))
}

/// Leaves only this sensor on; the prior stays as it is.
pub fn solo(
    model: &ModelInfo,
    switches: &mut Switches,
    place: Place,
    position: usize,
) -> Result<String, Refusal> {
    let expert = factor_at(model, position)?;
    if expert == Expert::Prior {
        return Err("solo is for sensors; the prior stays as it is".to_owned());
    }
    let alphas: Vec<(Expert, f32)> = model
        .experts
        .iter()
        .map(|&e| (e, f32::from(u8::from(e == expert))))
        .collect();
    change(model, switches, place, &alphas)?;
    Ok(format!(
        "only {} of the sensors {}",
        expert.name(),
        place.words()
    ))
}

/// Tempers an expert.
pub fn temper(
    model: &ModelInfo,
    switches: &mut Switches,
    place: Place,
    position: usize,
    alpha: f32,
) -> Result<String, Refusal> {
    let expert = factor_at(model, position)?;
    let alpha = checked_alpha(alpha)?;
    change(model, switches, place, &[(expert, alpha)])?;
    Ok(format!("{} α {alpha} {}", expert.name(), place.words()))
}

/// Tempers an expert by so many tenths more or less than under the cursor. Whole tenths, so that down and up again
/// comes back to exactly 1.
pub fn temper_by(
    model: &ModelInfo,
    switches: &mut Switches,
    place: Place,
    position: usize,
    tenths: i64,
) -> Result<String, Refusal> {
    let expert = factor_at(model, position)?;
    let now = (switches.alpha(expert, place.step) * 10.0).round() as i64;
    let tenths = now.saturating_add(tenths).max(0);
    temper(model, switches, place, position, tenths as f32 / 10.0)
}

fn factor_at(model: &ModelInfo, position: usize) -> Result<Expert, Refusal> {
    let name = &model.name;
    if !model.has_product() {
        return Err(format!(
            "{name} has no product of experts: there is nothing to switch"
        ));
    }
    let Some(&expert) = model.all_experts().get(position) else {
        let count = model.experts.len();
        return Err(format!(
            "{name} has {count} sensor experts and no number {}",
            position + 1
        ));
    };
    if expert == Expert::Prior && !model.prior_expert {
        return Err(format!(
            "{name} does not multiply its prior in: it cannot be switched"
        ));
    }
    Ok(expert)
}

fn change(
    model: &ModelInfo,
    switches: &mut Switches,
    place: Place,
    alphas: &[(Expert, f32)],
) -> Result<(), Refusal> {
    let mut changed = switches.clone();
    for &(expert, alpha) in alphas {
        changed.set(expert, place.reach(), alpha);
    }
    let last = alphas.iter().find(|(_, alpha)| *alpha == 0.0);
    accept(
        model,
        switches,
        changed,
        last.map_or("this", |(expert, _)| expert.name()),
    )
}

/// Takes the changed switches over, unless they leave a step without any active expert.
fn accept(
    model: &ModelInfo,
    switches: &mut Switches,
    changed: Switches,
    name: &str,
) -> Result<(), Refusal> {
    if let Some(step) = model.silent_step(&changed) {
        return Err(format!(
            "{name} stays on: it is the last active expert at step {}, and a belief needs one",
            step + 1
        ));
    }
    *switches = changed;
    Ok(())
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;
    use crate::modality::ExpertSet;

    fn model(experts: &[Expert], prior_expert: bool, trained_sets: &[u8]) -> ModelInfo {
        ModelInfo {
            name: "m".to_owned(),
            experts: experts.to_vec(),
            latent: 2,
            frame_stack: 1,
            prior_expert,
            trained_sets: trained_sets.iter().map(|&bits| ExpertSet(bits)).collect(),
            ..ModelInfo::default()
        }
    }

    fn vhp() -> ModelInfo {
        model(&[Expert::Vision, Expert::Joint], true, &[3])
    }

    #[test]
    fn off_and_on_again_gives_back_what_an_expert_had() {
        let (model, mut switches) = (vhp(), Switches::default());
        temper(&model, &mut switches, EVERYWHERE, 0, 0.5).unwrap();
        let frame = Place {
            scope: Scope::Frame,
            step: 4,
        };
        toggle(&model, &mut switches, frame, 1).unwrap();
        let before = switches.clone();
        for position in [0, 1] {
            toggle(&model, &mut switches, EVERYWHERE, position).unwrap();
            assert!(switches != before);
            toggle(&model, &mut switches, EVERYWHERE, position).unwrap();
        }
        for step in 0..8 {
            for expert in model.factors() {
                assert!(
                    (switches.alpha(expert, step) - before.alpha(expert, step)).abs()
                        < f32::EPSILON
                );
            }
        }
    }

    const EVERYWHERE: Place = Place {
        scope: Scope::Episode,
        step: 1,
    };

    #[test]
    fn the_last_active_expert_stays_on() {
        let (model, mut switches) = (vhp(), Switches::default());
        toggle(&model, &mut switches, EVERYWHERE, 0).unwrap();
        toggle(&model, &mut switches, EVERYWHERE, 1).unwrap();
        let before = switches.clone();
        let refusal = toggle(
            &model,
            &mut switches,
            Place {
                scope: Scope::Frame,
                step: 4,
            },
            2,
        );
        assert_eq!(
            refusal.unwrap_err(),
            "prior stays on: it is the last active expert at step 5, and a belief needs one"
        );
        assert_eq!(switches, before);
    }

    #[test]
    fn where_the_prior_is_no_factor_it_is_what_is_left() {
        let model = model(&[Expert::Vision, Expert::Joint], false, &[3]);
        let mut switches = Switches::default();
        assert_eq!(model.counted(&switches, 4), [1.0, 1.0, 0.0]);
        toggle(&model, &mut switches, EVERYWHERE, 0).unwrap();
        toggle(&model, &mut switches, EVERYWHERE, 1).unwrap();
        assert_eq!(model.counted(&switches, 4), [0.0, 0.0, 1.0]);
        assert!(toggle(&model, &mut switches, EVERYWHERE, 2).is_err());
    }

    #[test]
    fn one_step_without_an_expert_refuses_the_whole_switch() {
        let (model, mut switches) = (vhp(), Switches::default());
        let frame = Place {
            scope: Scope::Frame,
            step: 6,
        };
        toggle(&model, &mut switches, frame, 1).unwrap();
        toggle(&model, &mut switches, frame, 2).unwrap();
        assert!(
            toggle(&model, &mut switches, EVERYWHERE, 0)
                .unwrap_err()
                .contains("step 7")
        );
    }

    #[test]
    fn a_model_without_a_product_says_so() {
        let (v, mut switches) = (model(&[Expert::Vision], false, &[1]), Switches::default());
        for refusal in [
            toggle(&v, &mut switches, EVERYWHERE, 0),
            solo(&v, &mut switches, EVERYWHERE, 0),
            temper(&v, &mut switches, EVERYWHERE, 0, 0.5),
        ] {
            assert!(refusal.unwrap_err().contains("no product"));
        }
        assert_eq!(switches, Switches::default());
    }

    #[test]
    fn nonsense_is_refused() {
        let (model, mut switches) = (vhp(), Switches::default());
        assert!(toggle(&model, &mut switches, EVERYWHERE, 7).is_err());
        assert!(solo(&model, &mut switches, EVERYWHERE, 2).is_err());
        for alpha in [-0.1, f32::NAN, f32::INFINITY] {
            assert!(temper(&model, &mut switches, EVERYWHERE, 0, alpha).is_err());
        }
        let without_prior = self::model(&[Expert::Vision, Expert::Joint], false, &[3]);
        assert!(toggle(&without_prior, &mut switches, EVERYWHERE, 2).is_err());
    }
}
