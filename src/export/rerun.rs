//! Rerun recordings: one for each episode, all models in it under prefixes of their own, with a layout to open in.
//!
//! ```text
//! Run ─► describe: what things are, how they look, where it comes from ─────────────────────┐
//!     └► steps: what was recorded and what every model says, on `step`, `t` and `stamp` ────┴─► RecordingStream
//!                                                         a file (Recording) or a viewer (Live) ◄───┘
//! ```
//! Paths: `recorded/…` is what was sensed, `MODEL/…` what a model makes of it, `table/…` the same in space.

mod about;
mod blueprint;
pub mod live;
mod log;
mod model;
mod recorded;
mod space;
mod style;
mod writer;

use std::path::Path;
use std::sync::Arc;

use ::rerun::components::Timestamp;
use ::rerun::datatypes::TimeInt;
use ::rerun::{
    RecordingStream, RecordingStreamBuilder, RecordingStreamError, RecordingStreamResult,
};

use self::log::{AtSteps, Log};
use self::writer::Writer;
use super::output::Output;
use super::step::Step;
use super::{ExportError, Run, Sink};
use crate::data::Dataset;
use crate::episode::{Layout, Recording as Sensed};
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;

/// The file, growing.
pub struct Recording {
    dataset: Arc<Dataset>,
    writer: Writer,
}

impl Recording {
    /// Begins the file; `dataset` is where the runs come from.
    ///
    /// # Errors
    /// If it cannot be begun, or if the environment has Rerun off.
    pub fn create(out: &Path, force: bool, dataset: Arc<Dataset>) -> Result<Self, ExportError> {
        if is_off() {
            return Err(ExportError::Format {
                path: out.to_owned(),
                what: OFF.to_owned(),
            });
        }
        let output = Output::create(out, force)?;
        Ok(Self {
            dataset,
            writer: Writer::new(output)?,
        })
    }
}

impl Sink for Recording {
    fn take(&mut self, run: &Run) -> Result<(), ExportError> {
        let Some(first) = run.models.iter().flatten().next() else {
            return Ok(());
        };
        let sensed = self
            .dataset
            .recording_as(first.episode_index, Layout::default())?;
        let refused = |error: RecordingStreamError| self.writer.failed(error);
        let crc = crc32fast::hash(identity(run, first.episode_index).as_bytes());
        // An id of one's own turns the properties off, unless they are asked for after it.
        let builder = builder(run)
            .recording_id(format!("{} {crc:08x}", title(run)))
            .send_properties(true);
        let (_, store, info, batches, hooks, _) = builder.into_args();
        let sink = Box::new(self.writer.clone());
        let stream = RecordingStream::new(store, info, batches, hooks, sink).map_err(refused)?;
        write(&stream, run, &sensed).map_err(refused)?;
        let flushed = stream.flush_blocking();
        flushed.map_err(|error| self.writer.failed(error))?;
        drop(stream);
        self.writer.check()
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        self.writer.finish()?.commit()
    }
}

/// With `RERUN=off` in the environment the SDK would write nothing and say nothing.
pub fn is_off() -> bool {
    !::rerun::decide_logging_enabled(true)
}

/// What to do about it.
pub const OFF: &str = "the environment has RERUN set to off; unset it";

/// Everything about a run.
fn write(stream: &RecordingStream, run: &Run, sensed: &Sensed) -> RecordingStreamResult<()> {
    describe(stream, run)?;
    steps(stream, run, sensed)?;
    blueprint::layout(run, blueprint::Playing::Paused).send(stream, blueprint::ACTIVE)
}

/// What does not depend on the steps that are shown.
fn describe(stream: &RecordingStream, run: &Run) -> RecordingStreamResult<()> {
    stream.set_log_time_enabled(false);
    let log = Log::new(stream, &run.episode);
    about::describe(&log, run)?;
    stream.send_property("poescope", &about::property(run))?;
    recorded::describe(&log)?;
    space::describe(&log, run)?;
    each(run).try_for_each(|model| model::describe(&log, &model))
}

/// The steps of the run: what was recorded, and what every model says.
fn steps(stream: &RecordingStream, run: &Run, sensed: &Sensed) -> RecordingStreamResult<()> {
    let log = Log::new(stream, &run.episode);
    recorded::steps(&log, run, sensed)?;
    space::recorded(&log, run)?;
    each(run).try_for_each(|model| {
        model::steps(&log, &model)?;
        space::believed(&log, &model)
    })
}

/// One model of a run.
struct Shown<'a> {
    run: &'a Run,
    /// What its paths begin with.
    name: String,
    /// What it shows at each step; at least one.
    snapshots: &'a [Snapshot],
}

impl<'a> Shown<'a> {
    fn first(&self) -> &'a Snapshot {
        &self.snapshots[0]
    }

    fn steps(&self) -> impl Iterator<Item = Step<'a>> {
        let run = self.run;
        self.snapshots.iter().map(move |at| Step { run, at })
    }

    /// Something at each step.
    fn at_each<T>(&self, of: impl Fn(&Step<'a>) -> Option<T>) -> AtSteps<T> {
        self.steps()
            .map(|step| (step.at.cursor, of(&step)))
            .collect()
    }

    /// What the path of an expert is.
    fn of_expert(&self, expert: Expert) -> String {
        format!("{}/experts/{}", self.name, expert.name())
    }

    /// What a series or a view is called: with the model's name where there are several.
    fn says(&self, what: &str) -> String {
        if self.run.models.len() < 2 {
            what.to_owned()
        } else {
            format!("{} {what}", self.name)
        }
    }
}

/// The models that show something.
fn each(run: &Run) -> impl Iterator<Item = Shown<'_>> {
    let names = run.provenance.topic_names();
    run.models.iter().filter_map(move |snapshots| {
        let name = names.get(snapshots.first()?.model)?.clone();
        Some(Shown {
            run,
            name,
            snapshots,
        })
    })
}

/// What the viewer lists a recording as.
fn title(run: &Run) -> String {
    let shown = run.models.iter().filter_map(|snapshots| {
        let model = run.provenance.models.get(snapshots.first()?.model)?;
        Some(model.name.as_str())
    });
    let names: Vec<&str> = shown.collect();
    format!("{} · {}", run.episode.meta.id, names.join(", "))
}

/// A recording of its name and time, under another id each time.
fn builder(run: &Run) -> RecordingStreamBuilder {
    let started = run.episode.steps_nanos.first().copied().unwrap_or_default();
    // What blueprints and recordings belong to in the viewer.
    RecordingStreamBuilder::new("poescope")
        .recording_name(title(run))
        .recording_started(Timestamp::from(TimeInt(started)))
}

/// The same for the same export: two of one episode under other switches are two recordings, and so are two episodes
/// of one name.
fn identity(run: &Run, episode: usize) -> String {
    let (data, state) = (&run.provenance.data.hash, &run.provenance.state);
    let mut identity = format!("{data} {episode} {state}");
    for model in &run.provenance.models {
        identity += &model.hash;
    }
    identity
}
