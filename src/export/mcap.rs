//! The recording as it was, with what the models make of it beside it: standard ROS 2 messages under `/poescope/MODEL/`.

use std::path::Path;
use std::sync::Arc;

use super::color;
use super::output::Output;
use super::step::{READINGS, Step, readings_of};
use super::{ExportError, Provenance, Run, Sink};
use crate::data::{Annotated, Dataset, NOTES, Note, Value};
use crate::episode::Frame;
use crate::session::snapshot::{Estimate, LatentView};

/// Name of the metadata record that says where all of it comes from.
pub const RECORD: &str = "poescope";

/// The file, growing.
pub struct Recording {
    dataset: Arc<Dataset>,
    file: Annotated<Output>,
    provenance: Option<Arc<Provenance>>,
}

impl Recording {
    /// Begins the file; `dataset` is where the runs come from.
    ///
    /// # Errors
    /// If it cannot be begun.
    pub fn create(out: &Path, force: bool, dataset: Arc<Dataset>) -> Result<Self, ExportError> {
        let output = Output::create(out, force)?;
        Ok(Self {
            file: Annotated::create(output, out)?,
            dataset,
            provenance: None,
        })
    }
}

impl Sink for Recording {
    fn take(&mut self, run: &Run) -> Result<(), ExportError> {
        self.provenance = Some(Arc::clone(&run.provenance));
        let Some(first) = run.models.iter().flatten().next() else {
            return Ok(());
        };
        let names = run.provenance.topic_names();
        let mut notes = Vec::new();
        for step in Step::of(run) {
            if let (Some(name), Some(stamp)) = (names.get(step.at.model), step.stamp_nanos()) {
                note(&step, name, stamp, &mut notes);
            }
        }
        let index = first.episode_index;
        self.file.episode(&self.dataset, index, &notes, NOTES)?;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), ExportError> {
        if let Some(provenance) = &self.provenance {
            self.file.metadata(RECORD, provenance.facts())?;
        }
        self.file.finish()?.commit()
    }
}

/// Everything about one model at one step that is known.
fn note<'a>(step: &Step<'a>, model: &str, stamp_nanos: i64, notes: &mut Vec<Note<'a>>) {
    let mut say = |topic: &str, value: Value<'a>| {
        notes.push(Note {
            topic: format!("{NOTES}{model}/{topic}"),
            stamp_nanos,
            value,
        });
    };
    if let Some(cell) = step.cell() {
        let frames: [(&str, &'a Option<Arc<Frame>>); 2] = [
            ("belief/image", &cell.belief),
            ("prediction/image", &cell.prediction),
        ];
        for (topic, frame) in frames {
            if let Some(frame) = frame {
                say(topic, Value::Grey(frame));
            }
        }
        let compared = cell.prediction.as_ref().or(cell.belief.as_ref());
        let pixels = compared.and_then(|frame| color::error(frame, &cell.truth));
        if let Some(pixels) = pixels {
            let (width, height) = (cell.truth.width, cell.truth.height);
            let picture = Value::Picture {
                width,
                height,
                pixels,
            };
            say("error/image", picture);
        }
    }
    let positions = [
        ("position/belief", step.belief()),
        ("position/prediction", step.prediction()),
    ];
    for (topic, at) in positions {
        if let Some(Estimate { x, y, covariance }) = at {
            let (at, covariance) = ([x, y].map(f64::from), covariance.map(f64::from));
            say(topic, Value::Position { at, covariance });
        }
    }
    for reading in READINGS {
        if let Some(value) = (reading.of)(step).filter(|value| value.is_finite()) {
            say(reading.name, Value::Number(value.into()));
        }
    }
    let mut latent = |who: &str, view: &LatentView| {
        say(&format!("{who}/mean"), numbers(&view.mean));
        say(&format!("{who}/log_var"), numbers(&view.log_var));
    };
    if let Some(belief) = step.posterior() {
        latent("belief", belief);
    }
    for view in &step.at.experts {
        if let Some(said) = &view.latent {
            latent(view.expert.name(), said);
        }
    }
    for (i, view) in step.at.experts.iter().enumerate() {
        let name = view.expert.name();
        if !view.share.is_empty() {
            say(&format!("{name}/share"), numbers(&view.share));
        }
        for reading in readings_of(view.expert) {
            if let Some(value) = (reading.of)(step, i).filter(|value| value.is_finite()) {
                say(
                    &format!("{name}/{}", reading.name),
                    Value::Number(value.into()),
                );
            }
        }
    }
}

fn numbers(values: &[f32]) -> Value<'static> {
    Value::Numbers(values.iter().map(|&value| value.into()).collect())
}
