//! Damaged inputs, edited controls, samples: what may be asked of them.

use super::Session;
use super::fusing::Refusal;
use super::settings::{ControlEdit, SAMPLES, SCALES};
use crate::measure::corruption::{Corruption, applies};
use crate::modality::{Expert, Modality};
use crate::model::switches::Reach;

impl Session {
    /// Exactly these experts as trained, in the whole episode.
    pub(super) fn use_set(&mut self, active: &[bool]) -> Result<String, Refusal> {
        let Some(model) = self.model() else {
            return Err("no model is loaded".to_owned());
        };
        let factors = model.factors();
        let name = &model.name;
        if !model.has_product() {
            return Err(format!(
                "{name} has no product of experts: there is nothing to switch"
            ));
        }
        let on = |i: usize| active.get(i).copied().unwrap_or(false);
        if !(0..factors.len()).any(on) {
            return Err(if on(factors.len()) {
                format!("{name} does not multiply its prior in: it cannot be switched")
            } else {
                "a belief needs an expert".to_owned()
            });
        }
        for (i, &expert) in factors.iter().enumerate() {
            let alpha = f32::from(u8::from(on(i)));
            self.settings.switches.set(expert, Reach::EPISODE, alpha);
        }
        let members = factors.iter().enumerate().filter(|&(i, _)| on(i));
        let names: Vec<&str> = members.map(|(_, expert)| expert.name()).collect();
        Ok(format!("only {} in the whole episode", names.join(", ")))
    }

    /// Damages or mends an input.
    pub(super) fn corrupt(
        &mut self,
        modality: Modality,
        corruption: Option<Corruption>,
    ) -> Result<String, Refusal> {
        let name = modality.name();
        let Some(corruption) = corruption else {
            self.settings.corruptions.remove(&modality);
            return Ok(format!("{name} input undamaged"));
        };
        let looks = |expert: &Expert| expert.modalities().contains(&modality);
        if let Some(model) = self.model().filter(|m| !m.experts.iter().any(looks)) {
            return Err(format!("{} does not look at {name}", model.name));
        }
        let kind = corruption.damage.name();
        if !applies(corruption.damage, modality) {
            return Err(format!("{kind} is for frames, not for {name}"));
        }
        if !(0.0..=1.0).contains(&corruption.severity)
            || !corruption.patch.iter().all(|at| (0.0..=1.0).contains(at))
        {
            return Err("severity and patch are numbers from 0 to 1".to_owned());
        }
        if corruption
            .until
            .is_some_and(|until| until <= corruption.from)
        {
            return Err("damage reaches at least one step".to_owned());
        }
        let seed = self.settings.sampling.seed;
        let corruption = Corruption { seed, ..corruption };
        self.settings.corruptions.insert(modality, corruption);
        let reach = match (corruption.from, corruption.until) {
            (0, None) => "in the whole episode".to_owned(),
            (from, None) => format!("from step {} on", from + 1),
            (from, Some(until)) if until == from + 1 => format!("at step {until}"),
            (from, Some(until)) => format!("in steps {} to {until}", from + 1),
        };
        Ok(format!(
            "{name} input damaged: {kind} {} {reach}",
            corruption.severity
        ))
    }

    /// Predicts with other controls than the recorded ones.
    pub(super) fn edit_controls(&mut self, edit: Option<ControlEdit>) -> Result<String, Refusal> {
        let Some(edit) = edit else {
            self.settings.controls = None;
            return Ok("controls as recorded".to_owned());
        };
        let (least, most) = (SCALES.start(), SCALES.end());
        if !edit.rotate_deg.is_finite() || !SCALES.contains(&edit.scale) {
            return Err(format!(
                "controls are turned by degrees and scaled by {least} to {most}"
            ));
        }
        self.settings.controls = edit.turned(0.0).unless_identity();
        Ok(format!("{}; the prediction follows them", edit.words()))
    }

    pub(super) fn set_samples(&mut self, count: usize) -> Result<String, Refusal> {
        if !SAMPLES.contains(&count) {
            let (least, most) = (SAMPLES.start(), SAMPLES.end());
            return Err(format!("samples are from {least} to {most}"));
        }
        self.settings.sampling.count = count;
        Ok(format!("{count} samples of the rollout"))
    }

    pub(super) fn show_samples(&mut self, shown: bool) -> String {
        let sampling = &mut self.settings.sampling;
        sampling.shown = shown;
        if shown {
            format!("predictions show a sample, seed {}", sampling.seed)
        } else {
            "predictions show the mean path".to_owned()
        }
    }
}

impl ControlEdit {
    /// `controls from step 6: turned 30°, × 0.5, mirrored`.
    pub fn words(&self) -> String {
        format!("controls from step {}: {}", self.from + 1, self.what())
    }

    /// `turned 30°, × 0.5, mirrored`.
    pub fn what(&self) -> String {
        if self.scale == 0.0 {
            return "stopped".to_owned();
        }
        let mut parts = Vec::new();
        if self.rotate_deg != 0.0 {
            parts.push(format!("turned {}°", self.rotate_deg));
        }
        if (self.scale - 1.0).abs() > f32::EPSILON {
            parts.push(format!("× {}", self.scale));
        }
        if self.mirror {
            parts.push("mirrored".to_owned());
        }
        if parts.is_empty() {
            return "as recorded".to_owned();
        }
        parts.join(", ")
    }
}
