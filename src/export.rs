//! Ways out: what a session shows of whole episodes, written in the formats that other tools open.
//!
//! ```text
//! Session ── drive: episode by episode, model by model, step by step ─► Run ─► Sink ─► Output, a file once it is whole
//! ```
//! An export is a face without keys: it sees snapshots and the vocabulary, and computes nothing of its own. One
//! episode is in memory at a time, however many there are.

pub mod color;
pub mod csv;
pub mod drive;
pub mod figures;
pub mod json;
pub mod mcap;
pub mod output;
pub mod plot;
pub mod png;
#[cfg(feature = "rerun")]
pub mod rerun;
pub mod step;
pub mod table;

mod facts;

use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;
use thiserror::Error;

use crate::data::DataError;
use crate::episode::{Episode, Split};
use crate::session::predict::Predictor;
use crate::session::snapshot::Snapshot;

/// One episode, as every model sees it.
#[derive(Clone, Debug)]
pub struct Run {
    /// As recorded, in the sizes that the first model wants.
    pub episode: Arc<Episode>,
    /// For each model one snapshot a step that is exported, in order; `Snapshot::cursor` is the step. A model that
    /// could make nothing of the episode has snapshots without beliefs, and their message says why.
    pub models: Vec<Vec<Snapshot>>,
    /// What all of it comes from; the same for every run of an export.
    pub provenance: Arc<Provenance>,
}

/// What an export comes from: enough to make it again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Provenance {
    /// Version of poescope.
    pub poescope: String,
    /// What was opened.
    pub data: DataOrigin,
    /// The models, in the order of [`Run::models`].
    pub models: Vec<ModelOrigin>,
    /// The state string: switches, context, horizon, damage, controls, sampling. An episode's own is in its snapshots.
    pub state: String,
    /// Seed of all noise.
    pub seed: u64,
    /// The split that was asked for; none for episodes asked for by name.
    pub split: Option<Split>,
}

/// Where the episodes come from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DataOrigin {
    /// Name of the file or the folder.
    pub name: String,
    /// The data hash.
    pub hash: String,
}

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelOrigin {
    /// Its name; the second of the same name is `name#2`.
    pub name: String,
    /// Hash of its files; empty for one that has none.
    pub hash: String,
    /// Its folder as it was named.
    pub source: String,
    /// The update of its training run, where that is known.
    pub update: Option<u64>,
    /// Its config, as its `config.toml` says it; empty for one that has none.
    pub config: String,
    /// How positions are read from its latent; none without a probe.
    pub probe: Option<ProbeOrigin>,
}

/// A linear position probe: `p = W μ + b`, with the covariance `W Σ Wᵀ + R_p`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeOrigin {
    /// W, a row of Z for x and one for y, in metres.
    pub weights: Vec<Vec<f32>>,
    /// b in metres.
    pub bias: [f32; 2],
    /// R_p as xx, xy, yy in square metres.
    pub residual: [f32; 3],
}

impl ProbeOrigin {
    /// That of a model.
    pub(crate) fn of(model: &dyn Predictor) -> Option<Self> {
        let weights = model.position_weights()?;
        let rows = weights.chunks_exact((weights.len() / 2).max(1));
        Some(Self {
            weights: rows.map(<[f32]>::to_vec).collect(),
            bias: model.position_bias()?,
            residual: model.position_residual()?,
        })
    }
}

/// A format. It is given one run after the other, and then told that there are no more.
pub trait Sink {
    /// Writes one episode.
    ///
    /// # Errors
    /// If it cannot be written.
    fn take(&mut self, run: &Run) -> Result<(), ExportError>;

    /// Completes the file and gives it its name. A sink that is dropped instead leaves nothing behind.
    ///
    /// # Errors
    /// If it cannot be written.
    fn finish(self: Box<Self>) -> Result<(), ExportError>;
}

/// Why an export did not come about.
#[derive(Debug, Error)]
pub enum ExportError {
    /// There is a file already.
    #[error("{} exists; add --force to replace it, or choose another name", .0.display())]
    Exists(PathBuf),
    /// The name cannot be that of a file.
    #[error("{}: {what}", path.display())]
    Name {
        /// What was asked for.
        path: PathBuf,
        /// What it is instead, and what to do.
        what: &'static str,
    },
    /// The operating system refused.
    #[error("writing {}: {cause}", path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// What it said.
        cause: std::io::Error,
    },
    /// The recording could not be read or written again.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The format refused.
    #[error("writing {}: {what}", path.display())]
    Format {
        /// The file that was to be written.
        path: PathBuf,
        /// What does not fit.
        what: String,
    },
    /// The user asked for an end.
    #[error("stopped; nothing was written")]
    Stopped,
    /// No episode could be exported.
    #[error("nothing was written: {0}")]
    Nothing(String),
}
