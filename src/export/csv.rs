//! Two tables: one row a step and model, one row an episode and model. RFC 4180 with `\n`; what is not known is empty.

mod episodes;
mod field;

use std::io::Write;
use std::path::{Path, PathBuf};

pub use self::episodes::{EXPERT_MEANS, KEYS as EPISODE_KEYS, MEANS};
pub(super) use self::field::Fields;
use self::field::number;
use super::output::Output;
use super::step::{READINGS, Step, readings_of};
use super::{ExportError, Run, Sink};
use crate::modality::Expert;

/// Both tables, growing.
pub struct Tables {
    steps: Output,
    episodes: Output,
    /// Columns of experts: every one that some model has. None before the first run.
    experts: Option<Vec<Expert>>,
}

/// The file of episodes beside the one of steps: `a.csv` has `a.episodes.csv`, and `run.v1` has `run.v1.episodes.csv`.
pub fn episodes_path(steps: &Path) -> PathBuf {
    let ending = steps.extension().unwrap_or_default();
    let name = if ending.eq_ignore_ascii_case("csv") {
        steps.file_stem()
    } else {
        steps.file_name()
    };
    let mut name = name.unwrap_or_default().to_owned();
    name.push(".episodes.csv");
    steps.with_file_name(name)
}

impl Tables {
    /// Begins both files; `out` is that of the steps.
    ///
    /// # Errors
    /// If one of them cannot be begun.
    pub fn create(out: &Path, force: bool) -> Result<Self, ExportError> {
        Ok(Self {
            steps: Output::create(out, force)?,
            episodes: Output::create(&episodes_path(out), force)?,
            experts: None,
        })
    }
}

impl Sink for Tables {
    fn take(&mut self, run: &Run) -> Result<(), ExportError> {
        if self.experts.is_none() {
            let experts = experts(run);
            write(&mut self.steps, head(&experts))?;
            write(&mut self.episodes, episodes::head(&experts))?;
            self.experts = Some(experts);
        }
        let experts = self.experts.as_deref().unwrap_or_default();
        for step in Step::of(run) {
            write(&mut self.steps, row(&step, experts))?;
        }
        for snapshots in &run.models {
            let steps = snapshots.iter().map(|at| Step { run, at });
            let row = episodes::row(&steps.collect::<Vec<_>>(), experts);
            write(&mut self.episodes, row)?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        // The one that was asked for comes last: where it is, the other is whole as well.
        self.episodes.commit()?;
        self.steps.commit()
    }
}

fn write(output: &mut Output, fields: Fields) -> Result<(), ExportError> {
    let failed = output.failed();
    output
        .write_all(fields.into_line().as_bytes())
        .map_err(failed)
}

/// The experts of all models, in the order of faces.
fn experts(run: &Run) -> Vec<Expert> {
    let firsts = run.models.iter().filter_map(|snapshots| snapshots.first());
    let models: Vec<_> = firsts.flat_map(|at| &at.models).collect();
    let is_there = |expert: &Expert| models.iter().any(|m| m.all_experts().contains(expert));
    Expert::ALL.into_iter().filter(is_there).collect()
}

/// What every row of steps begins with, and what it is.
pub const STEP_KEYS: [(&str, &str); 9] = [
    ("episode", "its name"),
    ("split", "`train`, `val` or `test`, where the data name one"),
    ("model", "its name; the second of the same name is `name#2`"),
    ("step", "counted from 1"),
    (
        "stamp_ns",
        "when the image was taken, ns since the Unix epoch",
    ),
    ("secs", "the same in s since the episode's first image"),
    ("context", "images seen before the rollout"),
    ("horizon", "images predicted"),
    ("active", "letters of the experts that are on: `VHPD`"),
];

fn head(experts: &[Expert]) -> Fields {
    let mut fields = Fields::default();
    for (name, _) in STEP_KEYS {
        fields.push(name);
    }
    for reading in READINGS {
        fields.push(reading.name);
    }
    for &expert in experts {
        for reading in readings_of(expert) {
            fields.push(&format!("{}_{}", expert.name(), reading.name));
        }
    }
    fields
}

fn row(step: &Step<'_>, experts: &[Expert]) -> Fields {
    let at = step.at;
    let own: Vec<Expert> = step.experts().collect();
    let mut fields = Fields::default();
    let meta = &step.run.episode.meta;
    fields.push(&meta.id);
    fields.push(meta.split.map_or("", |split| split.name()));
    fields.push(step.model().map_or("", |model| &model.name));
    fields.push(&(at.cursor + 1).to_string());
    fields.push(
        &step
            .stamp_nanos()
            .map_or_else(String::new, |s| s.to_string()),
    );
    fields.push(&step.secs().map_or_else(String::new, |s| format!("{s:?}")));
    fields.push(&at.context.to_string());
    fields.push(&at.horizon.to_string());
    let on = own.iter().enumerate().filter(|&(i, _)| step.alpha(i) > 0.0);
    fields.push(&on.map(|(_, expert)| expert.letter()).collect::<String>());
    for reading in READINGS {
        fields.push(&number((reading.of)(step)));
    }
    for &expert in experts {
        let place = own.iter().position(|own| *own == expert);
        for reading in readings_of(expert) {
            fields.push(&number(place.and_then(|i| (reading.of)(step, i))));
        }
    }
    fields
}
