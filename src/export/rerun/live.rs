//! The session in a running viewer: each step once, as it is scrubbed to.
//!
//! A change of switches, model or episode begins a new recording, since it changes every step; the viewer lists them
//! one below the other.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use ::rerun::{
    RecordingStream, RecordingStreamBuilder, RecordingStreamError, RecordingStreamResult,
};
use thiserror::Error;

use super::{blueprint, builder, describe, steps};
use crate::data::{DataError, Dataset};
use crate::episode::{Episode, EpisodeSource, Recording, SourceError};
use crate::export::drive::{Source, provenance_of};
use crate::export::{Provenance, Run};
use crate::measure::failure::Order;
use crate::session::predict::Predictor;
use crate::session::snapshot::Snapshot;
use crate::session::state::State;

/// How long the viewer may take to take a step.
const PATIENCE: Duration = Duration::from_secs(3);

/// Opens a stream to wherever recordings go.
pub type Open =
    Box<dyn FnMut(RecordingStreamBuilder) -> RecordingStreamResult<RecordingStream> + Send>;

/// Why a step did not arrive.
#[derive(Debug, Error)]
pub enum LiveError {
    /// The SDK refused.
    #[error("{0}")]
    Refused(#[from] RecordingStreamError),
    /// The viewer does not take it.
    #[error("the viewer takes nothing more: {0}")]
    Gone(String),
    /// The recording could not be read.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The episode could not be read.
    #[error(transparent)]
    Episode(#[from] SourceError),
}

/// A stream of recordings.
pub struct Live {
    dataset: Arc<Dataset>,
    models: Vec<Arc<dyn Predictor>>,
    open: Open,
    shown: Option<Shown>,
    /// The model that the layout in the viewer is of.
    laid_out: Option<usize>,
}

/// The recording that is written to.
struct Shown {
    identity: String,
    stream: RecordingStream,
    episode: Arc<Episode>,
    sensed: Recording,
    provenance: Arc<Provenance>,
    sent: BTreeSet<usize>,
}

impl Live {
    /// Of a session of this dataset and these models.
    pub fn new(dataset: Arc<Dataset>, models: Vec<Arc<dyn Predictor>>, open: Open) -> Self {
        Self {
            dataset,
            models,
            open,
            shown: None,
            laid_out: None,
        }
    }

    /// To the viewer at this address, `rerun+http://127.0.0.1:9876/proxy` for instance.
    pub fn connect(dataset: Arc<Dataset>, models: Vec<Arc<dyn Predictor>>, url: String) -> Self {
        Self::new(
            dataset,
            models,
            Box::new(move |builder| builder.connect_grpc_opts(url.clone())),
        )
    }

    /// Sends the step under the cursor, if it is whole and was not sent yet. Blocks for as long as the viewer takes, a
    /// few seconds at most: not for the session's thread.
    ///
    /// # Errors
    /// If the viewer does not take it, or if the episode cannot be read.
    pub fn show(&mut self, snapshot: &Snapshot) -> Result<(), LiveError> {
        if snapshot.busy || !snapshot.current || snapshot.episode.is_none() {
            return Ok(());
        }
        let identity = identity(snapshot);
        let mut shown = match self.shown.take() {
            Some(shown) if shown.identity == identity => shown,
            _ => self.begin(snapshot, identity)?,
        };
        if shown.sent.insert(snapshot.cursor) {
            let run = Run {
                episode: Arc::clone(&shown.episode),
                models: vec![vec![snapshot.clone()]],
                provenance: Arc::clone(&shown.provenance),
            };
            steps(&shown.stream, &run, &shown.sensed)?;
            let flushed = shown.stream.flush_with_timeout(PATIENCE);
            flushed.map_err(|error| LiveError::Gone(error.to_string()))?;
        }
        self.shown = Some(shown);
        Ok(())
    }

    /// A recording of its own, with everything that does not change with the cursor.
    fn begin(&mut self, snapshot: &Snapshot, identity: String) -> Result<Shown, LiveError> {
        let model = self.models.get(snapshot.model);
        let layout = model.map(|model| model.layout()).unwrap_or_default();
        let episode = Arc::new(self.dataset.load(snapshot.episode_index, layout)?);
        let sensed = self.dataset.recording_as(snapshot.episode_index, layout)?;
        let source = Source {
            episodes: self.dataset.as_ref(),
            models: &self.models,
        };
        let mut provenance = provenance_of(source, &State::parse(&snapshot.state).0, None);
        // A model in training is followed: what is shown may be newer than what was opened.
        for (origin, info) in provenance.models.iter_mut().zip(&snapshot.models) {
            origin.hash.clone_from(&info.hash);
            origin.update = info.update;
        }
        let run = Run {
            episode: Arc::clone(&episode),
            models: vec![vec![snapshot.clone()]],
            provenance: Arc::new(provenance),
        };
        let stream = (self.open)(builder(&run))?;
        describe(&stream, &run)?;
        // Sent again only for another model: it takes the place of what the user has made of it.
        if self.laid_out != Some(snapshot.model) {
            blueprint::layout(&run, blueprint::Playing::Following)
                .send(&stream, blueprint::ACTIVE)?;
            self.laid_out = Some(snapshot.model);
        }
        Ok(Shown {
            identity,
            stream,
            episode,
            sensed,
            provenance: run.provenance,
            sent: BTreeSet::new(),
        })
    }
}

/// What the steps of a recording have in common: everything but the cursor and what only a face shows.
fn identity(snapshot: &Snapshot) -> String {
    let state = State {
        step: None,
        compare: None,
        scope: None,
        speed: None,
        looping: None,
        marks: BTreeSet::new(),
        selection: None,
        order: Order::default(),
        unknown: Vec::new(),
        ..State::parse(&snapshot.state).0
    };
    let hash = snapshot
        .models
        .get(snapshot.model)
        .map(|info| info.hash.as_str());
    format!(
        "{} {} {state}",
        snapshot.episode_index,
        hash.unwrap_or_default()
    )
}
