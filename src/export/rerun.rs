//! Rerun recordings: one for each episode, all models in it under prefixes of their own, with a layout to open in.
//!
//! ```text
//! Run ─► describe: what things are, how they look, what was recorded, where it comes from ─┐
//!     └► steps: what every model says, as columns on `step`, `t` and `stamp` ──────────────┴─► RecordingStream
//!                                                         a file (Recording) or a viewer (Live) ◄───┘
//! ```
//! Paths: `recorded/…` is what was sensed, `MODEL/…` what a model makes of it, `table/…` the same in space.

mod about;
mod blueprint;
mod columns;
pub mod live;
mod model;
mod recorded;
mod space;
mod style;
mod writer;

use std::path::Path;
use std::sync::Arc;

use ::rerun::components::Timestamp;
use ::rerun::datatypes::TimeInt;
use ::rerun::external::re_log_types::{StoreInfo, StoreSource};
use ::rerun::{
    ApplicationId, RecordingInfo, RecordingStream, RecordingStreamError, RecordingStreamResult,
    StoreId, StoreKind,
};

use self::columns::Clock;
use self::writer::Writer;
use super::output::Output;
use super::{ExportError, Run, Sink};
use crate::data::Dataset;
use crate::episode::Recording as Sensed;

/// What blueprints and recordings belong to in the viewer.
const APPLICATION: &str = "poescope";

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
        refuse_if_off(out)?;
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
        let sensed = self.dataset.recording(first.episode_index)?;
        let refused = |error: RecordingStreamError| self.writer.failed(error);
        let id = format!(
            "{} {:08x}",
            title(run),
            crc32fast::hash(identity(run).as_bytes())
        );
        let store = StoreId::new(StoreKind::Recording, ApplicationId::from(APPLICATION), id);
        let info = StoreInfo::new(
            store,
            StoreSource::Other(format!("poescope {}", env!("CARGO_PKG_VERSION"))),
        );
        let sink = Box::new(self.writer.clone());
        #[expect(
            clippy::default_trait_access,
            reason = "the SDK does not export the type"
        )]
        let stream = RecordingStream::new(info, Some(named(run)), None, Default::default(), sink)
            .map_err(refused)?;
        write(&stream, run, &sensed).map_err(refused)?;
        stream
            .flush_blocking()
            .map_err(|error| self.writer.failed(error))?;
        drop(stream);
        self.writer.check()
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        self.writer.finish()?.commit()
    }
}

/// Everything about a run.
fn write(stream: &RecordingStream, run: &Run, sensed: &Sensed) -> RecordingStreamResult<()> {
    stream.set_log_time_enabled(false);
    let clock = Clock::of(&run.episode);
    describe(stream, run)?;
    steps(stream, &clock, run, sensed)?;
    blueprint::layout(run, blueprint::Playing::Paused).send(stream, blueprint::ACTIVE)
}

/// What does not depend on the steps that are shown.
fn describe(stream: &RecordingStream, run: &Run) -> RecordingStreamResult<()> {
    about::log(stream, run)?;
    recorded::describe(stream)?;
    space::describe(stream, run)?;
    for (name, snapshots) in each(run) {
        if let Some(first) = snapshots.first() {
            model::describe(stream, &name, first)?;
        }
    }
    Ok(())
}

/// The steps of the run: what was recorded, and what every model says.
fn steps(
    stream: &RecordingStream,
    clock: &Clock,
    run: &Run,
    sensed: &Sensed,
) -> RecordingStreamResult<()> {
    recorded::log(stream, clock, run, sensed)?;
    space::recorded(stream, clock, run)?;
    for (name, snapshots) in each(run) {
        model::log(stream, clock, run, &name, snapshots)?;
        space::believed(stream, clock, &name, snapshots)?;
    }
    Ok(())
}

/// The models that are in a run, with the names of their paths.
fn each(run: &Run) -> impl Iterator<Item = (String, &[crate::session::snapshot::Snapshot])> {
    let names = run.provenance.topic_names();
    run.models.iter().filter_map(move |snapshots| {
        let name = names.get(snapshots.first()?.model)?.clone();
        Some((name, snapshots.as_slice()))
    })
}

/// What the viewer lists a recording as.
fn title(run: &Run) -> String {
    let models = &run.provenance.models;
    let shown = run
        .models
        .iter()
        .filter_map(|s| models.get(s.first()?.model));
    let names: Vec<&str> = shown.map(|model| model.name.as_str()).collect();
    format!("{} · {}", run.episode.meta.id, names.join(", "))
}

fn named(run: &Run) -> RecordingInfo {
    let started = run.episode.steps_nanos.first().copied().unwrap_or_default();
    RecordingInfo::new()
        .with_name(title(run))
        .with_start_time(Timestamp::from(TimeInt(started)))
}

/// The same for the same export: two of one episode under other switches are two recordings.
fn identity(run: &Run) -> String {
    let mut identity = format!("{} {}", run.provenance.data.hash, run.provenance.state);
    for model in &run.provenance.models {
        identity += &model.hash;
    }
    identity
}

/// With `RERUN=off` the SDK would write nothing and say nothing.
fn refuse_if_off(out: &Path) -> Result<(), ExportError> {
    if ::rerun::decide_logging_enabled(true) {
        return Ok(());
    }
    Err(ExportError::Format {
        path: out.to_owned(),
        what: "the environment has RERUN set to off; unset it".to_owned(),
    })
}
