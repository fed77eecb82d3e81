//! The table of episodes: where each row comes from, and means over its exported steps.

use super::field::{Fields, number};
use crate::export::step::{OfExpert, READINGS, Reading, Step, readings_of};
use crate::modality::Expert;

/// What every row begins with, and what it is.
pub const KEYS: [(&str, &str); 19] = [
    ("episode", "its name"),
    ("split", "`train`, `val` or `test`, where the data name one"),
    ("model", "its name; the second of the same name is `name#2`"),
    ("object", "what was pushed, where known"),
    ("surface", "on what, where known"),
    ("source", "what made the recording, where known"),
    ("seed", "of the simulator, where there was one"),
    ("steps", "images of the episode"),
    ("exported", "steps of it in the table of steps"),
    ("secs", "from the first image to the last, s"),
    ("context", "images seen before the rollout"),
    ("horizon", "images predicted"),
    ("flags", "oddities seen in the recording"),
    (
        "problem",
        "why the model makes nothing of it, or what of `--state` it refused; else empty",
    ),
    ("data_hash", "of the data"),
    ("model_hash", "of the model's files"),
    ("poescope", "version that wrote this"),
    ("noise_seed", "of samples and damage"),
    (
        "state",
        "state string that brings this back: `poescope view --state`",
    ),
];

/// The readings of a step that have a mean here, of those of [`READINGS`].
pub const MEANS: [&str; 9] = [
    "psnr_belief_db",
    "psnr_prediction_db",
    "squared_error_belief",
    "squared_error_prediction",
    "belief_error_m",
    "prediction_error_m",
    "nees",
    "nees_without_rp",
    "conflict",
];

/// The readings of an expert that have a mean here, of those of [`readings_of`].
pub const EXPERT_MEANS: [&str; 5] = [
    "alpha",
    "share_mean",
    "share_position",
    "nis_head",
    "nis_propagated",
];

pub(super) fn head(experts: &[Expert]) -> Fields {
    let mut fields = Fields::default();
    for (name, _) in KEYS {
        fields.push(name);
    }
    for name in MEANS {
        fields.push(&format!("mean_{name}"));
    }
    for &expert in experts {
        for reading in means_of(expert) {
            fields.push(&format!("mean_{}_{}", expert.name(), reading.name));
        }
    }
    fields
}

/// The row of one model's steps.
pub(super) fn row(steps: &[Step<'_>], experts: &[Expert]) -> Fields {
    let mut fields = Fields::default();
    let Some(first) = steps.first() else {
        return fields;
    };
    let (meta, at) = (&first.run.episode.meta, first.at);
    let (provenance, model) = (&first.run.provenance, first.model());
    let text = |text: &Option<String>| text.clone().unwrap_or_default();
    let view = at.episode.as_deref();
    let secs = view.and_then(|view| view.secs.last().copied());
    let problem = at.message.as_ref().filter(|message| message.error);
    let keys: [String; KEYS.len()] = [
        meta.id.clone(),
        meta.split.map_or("", |split| split.name()).to_owned(),
        model.map_or_else(String::new, |model| model.name.clone()),
        text(&meta.object),
        text(&meta.surface),
        text(&meta.source),
        meta.seed.map_or_else(String::new, |seed| seed.to_string()),
        first.run.episode.steps().to_string(),
        steps.len().to_string(),
        secs.map_or_else(String::new, |secs| format!("{secs:?}")),
        at.context.to_string(),
        at.horizon.to_string(),
        first.run.episode.flags.len().to_string(),
        problem.map_or_else(String::new, |problem| problem.text.clone()),
        provenance.data.hash.clone(),
        model.map_or_else(String::new, |model| model.hash.clone()),
        provenance.poescope.clone(),
        provenance.seed.to_string(),
        at.state.clone(),
    ];
    for key in &keys {
        fields.push(key);
    }
    for name in MEANS {
        let reading = READINGS.iter().find(|reading| reading.name == name);
        let values = steps.iter().filter_map(|step| (reading?.of)(step));
        fields.push(&number(mean(values)));
    }
    for &expert in experts {
        let place = first.experts().position(|own| own == expert);
        for reading in means_of(expert) {
            let values = steps
                .iter()
                .filter_map(|step| (reading.of)(step, place?))
                .filter(|value| value.is_finite());
            fields.push(&number(mean(values)));
        }
    }
    fields
}

fn means_of(expert: Expert) -> impl Iterator<Item = &'static Reading<OfExpert>> {
    readings_of(expert).filter(|reading| EXPERT_MEANS.contains(&reading.name))
}

/// Over the steps that have one.
fn mean(values: impl Iterator<Item = f32>) -> Option<f32> {
    let (sum, count) = values.fold((0.0_f64, 0_u32), |(sum, count), value| {
        (sum + f64::from(value), count + 1)
    });
    (count > 0).then(|| (sum / f64::from(count)) as f32)
}
