//! The rows of the tables: each model as trained, each product without its prior, and what --state asks for.

use anyhow::{Context, anyhow, bail};

use crate::eval::protocol::Protocol;
use crate::eval::score::{Candidate, Subject};
use crate::eval::setting::{Setting, Tempered};
use crate::modality::Expert;
use crate::session::state::State;

/// Every row.
pub fn subjects(
    candidates: &[Candidate],
    states: &[String],
    protocol: Protocol,
) -> anyhow::Result<Vec<Subject>> {
    let mut settings = vec![Setting::default(), Setting::prior_off()];
    for text in states {
        settings.push(read(text).with_context(|| format!("--state {text}"))?);
    }
    let mut subjects = Vec::new();
    for setting in &settings {
        let before = subjects.len();
        for (candidate, model) in candidates.iter().enumerate() {
            let config = &model.config;
            if !setting.applies_to(config) {
                continue;
            }
            if setting.empties(config, protocol.images() - config.frame_stack) {
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
            bail!("--state {}: no model has these experts", setting.name);
        }
    }
    Ok(subjects)
}

/// Switches and damage of a state string; what else it says does not count here.
fn read(text: &str) -> anyhow::Result<Setting> {
    let versioned = if text.split(';').any(|part| part.trim().starts_with("v=")) {
        text.to_owned()
    } else {
        format!("v=1;{text}")
    };
    let (state, complaints) = State::parse(&versioned);
    if !complaints.is_empty() {
        return Err(anyhow!(complaints.join("; ")));
    }
    let tempered: Vec<Tempered> = Expert::ALL
        .into_iter()
        .flat_map(|expert| {
            let runs = state.switches.runs(expert).into_iter();
            runs.map(move |run| Tempered {
                expert,
                from: run.reach.from,
                until: run.reach.until,
                alpha: run.alpha,
            })
        })
        .collect();
    let setting = Setting {
        name: text.trim().to_owned(),
        tempered,
        damaged: state.corruptions.into_iter().collect(),
    };
    if setting.tempered.is_empty() && setting.damaged.is_empty() {
        bail!("it switches and damages nothing; write alpha=haptic:0 or corrupt=vision:noise:0.5");
    }
    Ok(setting)
}
