//! The rows of the tables: each model as trained, each product without its prior, and what --state asks for.

use anyhow::{Context, anyhow, bail};

use crate::eval::score::{Candidate, Subject};
use crate::eval::setting::Setting;
use crate::session::state::State;

/// Every row.
pub fn subjects(candidates: &[Candidate], states: &[String]) -> anyhow::Result<Vec<Subject>> {
    let mut settings = vec![Setting::default(), Setting::prior_off()];
    for text in states {
        let setting = read(text).with_context(|| format!("--state {text}"))?;
        if !settings.iter().any(|known| known.is_like(&setting)) {
            settings.push(setting);
        }
    }
    let mut subjects = Vec::new();
    for setting in &settings {
        let before = subjects.len();
        for (candidate, model) in candidates.iter().enumerate() {
            let config = &model.config;
            if !setting.applies_to(config) {
                continue;
            }
            if setting.empties(config) {
                bail!(
                    "{}: leaves no expert of model `{}` on",
                    setting.name,
                    model.label
                );
            }
            let label = match setting.name.as_str() {
                "" => model.label.clone(),
                name => format!("{} ({name})", model.label),
            };
            subjects.push(Subject {
                label,
                candidate,
                setting: setting.clone(),
            });
        }
        if subjects.len() == before && *setting != Setting::prior_off() {
            bail!(
                "--state {}: no model multiplies these experts",
                setting.name
            );
        }
    }
    Ok(subjects)
}

/// Switches and damage of a state string, and named by them: where it looks and what it compares does not count here.
fn read(text: &str) -> anyhow::Result<Setting> {
    let (state, complaints) = State::parse(text);
    if !complaints.is_empty() {
        return Err(anyhow!(complaints.join("; ")));
    }
    if let Some((key, _)) = state.unknown.first() {
        bail!("{key}: no such key; write alpha=haptic:0 or corrupt=vision:noise:0.5");
    }
    if state.controls.is_some() {
        bail!("controls: a prediction from other controls has no truth to be scored by");
    }
    let mut counted = State {
        switches: state.switches.clone(),
        corruptions: state.corruptions.clone(),
        ..State::default()
    };
    // Of what is not damaged no noise is drawn.
    if !counted.corruptions.is_empty() {
        counted.sampling.seed = state.sampling.seed;
    }
    let counted = counted.to_string();
    let setting = Setting {
        name: counted
            .split_once(';')
            .map_or("", |(_, name)| name)
            .to_owned(),
        switches: state.switches,
        damaged: state.corruptions.into_iter().collect(),
    };
    if setting.is_like(&Setting::default()) {
        bail!("it switches and damages nothing; write alpha=haptic:0 or corrupt=vision:noise:0.5");
    }
    Ok(setting)
}
