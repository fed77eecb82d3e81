//! Everything a face may show, computed: owned, cheap to clone (the large parts are shared), serialisable.

pub mod board;
pub mod lattice;
mod lookups;
pub mod other;
pub mod reading;
pub mod response;
pub mod spread;
pub mod table;

use std::sync::Arc;

use serde::Serialize;

use super::command::{Looping, Scope};
use super::settings::{ControlEdit, Sampling};
use crate::episode::{Frame, PlanarPose, Split};
use crate::measure::calibration::Error2;
use crate::measure::corruption::Corruption;
use crate::measure::frame::signed_difference;
use crate::modality::{Expert, ExpertSet, Modality};
use board::BoardView;
use lattice::LatticeView;
pub use lookups::estimate_at;
use other::OtherView;
use reading::{FusionView, SeriesView};
use response::ResponseView;
use spread::SpreadView;
use table::TableView;

/// The state of a session at one moment.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Snapshot {
    /// Name of the dataset.
    pub dataset: String,
    /// Every loaded model.
    pub models: Vec<Arc<ModelInfo>>,
    /// Which one is shown.
    pub model: usize,
    /// The episode under the cursor; none while the first one is read, or where none could be.
    pub episode: Option<Arc<EpisodeView>>,
    /// Its index in the dataset.
    pub episode_index: usize,
    /// How many episodes the dataset has.
    pub episode_count: usize,
    /// Step under the cursor, from 0.
    pub cursor: usize,
    /// Whether it plays.
    pub playing: bool,
    /// Playback speed, 1 as recorded.
    pub speed: f32,
    /// What it does at the end.
    pub looping: Looping,
    /// How far the next switch reaches.
    pub scope: Scope,
    /// c, images seen before the rollout.
    pub context: usize,
    /// h, images predicted.
    pub horizon: usize,
    /// The last step the rollout has seen, from 0; predictions are of the `horizon` steps after it.
    pub start: usize,
    /// One entry an expert, the prior last.
    pub experts: Vec<ExpertView>,
    /// Whether the model was trained on the switches at the cursor.
    pub badge: Badge,
    /// Images at the cursor.
    pub frames: FrameRow,
    /// Images of every step that has been decoded, for rows of frames.
    pub strip: Arc<Vec<StripCell>>,
    /// Positions over the episode and at the cursor; none without a probe or without a belief.
    pub position: Option<PositionView>,
    /// The fused belief at the cursor: mean and standard deviation of each latent dimension.
    pub belief: Option<LatentView>,
    /// Per step: PSNR in dB of the belief's and of the prediction's frame, once computed.
    pub psnr_db: Arc<Vec<StepPsnr>>,
    /// What the fusion at the cursor is made of; none before the first belief and without a product.
    pub fusion: Option<Arc<FusionView>>,
    /// The same over the episode; none until computed.
    pub series: Option<Arc<SeriesView>>,
    /// Every set of experts at the cursor; none until computed, and where nobody asked for it.
    pub lattice: Option<Arc<LatticeView>>,
    /// How sure the rollout is, in three ways; none until computed, and where nobody asked for it.
    pub spread: Option<Arc<SpreadView>>,
    /// How the fusion answers to each damage of rising severity; empty until computed, and where nobody asked for it.
    pub responses: Arc<Vec<ResponseView>>,
    /// Consistency over a split; none where nobody asked for it.
    pub board: Option<Arc<BoardView>>,
    /// Every episode of the dataset.
    pub table: Arc<TableView>,
    /// The second model; none where there is only one.
    pub other: Option<Arc<OtherView>>,
    /// Contact onsets and marks, in order.
    pub events: Arc<Vec<Event>>,
    /// Damaged inputs.
    pub corruptions: Vec<(Modality, Corruption)>,
    /// What the rollout does instead of the recorded controls.
    pub control_edit: Option<ControlEdit>,
    /// Mean path or samples.
    pub sampling: Sampling,
    /// The selected steps, first and last, from 0; while the second is not chosen it is the cursor.
    pub selection: Option<(usize, usize)>,
    /// The last thing to tell the user.
    pub message: Option<Message>,
    /// Which of all messages it is: what is told again in the same words has another number. 0 for a fault, which stands.
    pub told: u64,
    /// Whether something asked for is still being computed.
    pub busy: bool,
    /// Whether the images at the cursor are of what was asked for last, and not of what was shown before.
    pub current: bool,
    /// The state string that brings all of this back.
    pub state: String,
}

/// What a face says of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelInfo {
    /// Its name: `v`, `vhp`, `v-h-p`.
    pub name: String,
    /// Where it came from, for the status line.
    pub source: String,
    /// The update of its training run that it is of, where that is known.
    pub update: Option<u64>,
    /// What its answers are kept under: 16 hexadecimal digits of its files, empty for a model that has none.
    pub hash: String,
    /// Sensor experts in the order of the digits.
    pub experts: Vec<Expert>,
    /// Z.
    pub latent: usize,
    /// Frames stacked under each frame: the first belief is at this step.
    pub frame_stack: usize,
    /// Whether the prior is one of the experts that are multiplied.
    pub prior_expert: bool,
    /// The sets of sensor experts it was trained on, the prior always in.
    pub trained_sets: Vec<ExpertSet>,
    /// Its config, as its `config.toml` says it; empty for a model that has none.
    pub config: String,
    /// The force that counts as contact in what it was trained on, in newtons (D25); none where it does not say.
    pub contact_newtons: Option<f32>,
}

/// What a face shows of the episode itself; does not change with the cursor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodeView {
    /// Its name.
    pub id: String,
    /// Its part in the experiment.
    pub split: Option<Split>,
    /// What made it.
    pub source: Option<String>,
    /// Seconds since the first frame, one a step.
    pub secs: Vec<f64>,
    /// Root-mean-square force of each step's window in newtons; empty if not recorded.
    pub force_newtons: Vec<f32>,
    /// Mean force of the pusher on the object over each step's window, as measured: x and y in newtons, along the axes
    /// of the table, the opposite of the recorded force on the pusher. As many as `force_newtons`.
    pub push_newtons: Vec<[f32; 2]>,
    /// What was odd about the recording, with topic and time.
    pub flags: Vec<String>,
    /// The step that each of them concerns.
    pub flagged_steps: Vec<usize>,
    /// Roles the model needs and the recording lacks; empty when the model can run.
    pub missing: Vec<String>,
}

/// One expert at the cursor and over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExpertView {
    /// Which.
    pub expert: Expert,
    /// α at the cursor: 0 off, 1 as trained.
    pub alpha: f32,
    /// Its mean and standard deviation at the cursor; none before the first belief.
    pub latent: Option<LatentView>,
    /// Its share of the belief's precision per latent dimension at the cursor, in [0, 1] (D1).
    pub share: Vec<f32>,
    /// Mean of `share`.
    pub share_mean: f32,
    /// Its share weighted by what moves the position estimate, mean of both axes (D1); none without a probe.
    pub share_position: Option<f32>,
    /// `share_mean` at every step; NaN before the first belief.
    pub share_over_time: Arc<Vec<f32>>,
}

/// A diagonal Gaussian over the latent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LatentView {
    /// Means.
    pub mean: Vec<f32>,
    /// Standard deviations.
    pub sigma: Vec<f32>,
    /// Logarithms of the variances, as the model states them.
    pub log_var: Vec<f32>,
}

impl LatentView {
    /// Mean standard deviation over the dimensions.
    pub fn mean_sigma(&self) -> f32 {
        self.sigma.iter().sum::<f32>() / self.sigma.len().max(1) as f32
    }
}

/// Whether the switches at the cursor were in the model's training.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub enum Badge {
    /// They were.
    Trained,
    /// They were not; why, and what was.
    Untrained(String),
    /// There is nothing to switch: the model has no product.
    #[default]
    NoProduct,
}

/// The images at the cursor.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FrameRow {
    /// What was recorded.
    pub truth: Option<Arc<Frame>>,
    /// The decoded belief.
    pub belief: Option<Arc<Frame>>,
    /// The decoded rollout; only after `start`, within the horizon.
    pub prediction: Option<Arc<Frame>>,
    /// Prediction minus truth where there is a prediction, else belief minus truth.
    pub error: Option<Arc<SignedFrame>>,
    /// What `error` is of.
    pub error_of: ErrorOf,
    /// What the model sees instead of `truth`, where vision is damaged at this step.
    pub input: Option<Arc<Frame>>,
}

/// What a signed error compares with the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub enum ErrorOf {
    /// The decoded belief.
    #[default]
    Belief,
    /// The decoded rollout.
    Prediction,
}

/// A difference of two frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SignedFrame {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Grey levels, -255 to 255, row major.
    pub values: Vec<i16>,
}

impl SignedFrame {
    /// An image minus the truth; none where the sizes differ.
    pub fn between(shown: &Frame, truth: &Frame) -> Option<Self> {
        Some(Self {
            width: shown.width,
            height: shown.height,
            values: signed_difference(shown, truth)?,
        })
    }
}

/// One step of a row of frames.
#[derive(Clone, Debug, Serialize)]
pub struct StripCell {
    /// Step, from 0.
    pub step: usize,
    /// What was recorded.
    pub truth: Arc<Frame>,
    /// The decoded belief, once there is one.
    pub belief: Option<Arc<Frame>>,
    /// The decoded rollout, where there is one.
    pub prediction: Option<Arc<Frame>>,
}

/// PSNR of one step, in dB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StepPsnr {
    /// Of the belief's frame.
    pub belief: Option<f32>,
    /// Of the prediction's frame.
    pub prediction: Option<f32>,
}

/// Positions of the object on the table, in metres.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PositionView {
    /// Recorded pose at each step; empty if not recorded.
    pub truth: Arc<Vec<PlanarPose>>,
    /// Recorded end-effector position at each step; empty if not recorded.
    pub tip: Arc<Vec<[f32; 2]>>,
    /// Estimate from the belief at each step; none before the first belief.
    pub belief: Arc<Vec<Option<Estimate>>>,
    /// Estimate from the rollout at each step; none outside the horizon.
    pub prediction: Arc<Vec<Option<Estimate>>>,
    /// The rollout under the recorded controls, where they are edited; else empty.
    pub recorded_controls: Arc<Vec<Option<Estimate>>>,
    /// Distance of the belief's estimate at the cursor from the truth, in metres.
    pub belief_error_m: Option<f32>,
    /// Distance of the prediction's estimate at the cursor from the truth, in metres.
    pub prediction_error_m: Option<f32>,
}

/// A position with its covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Estimate {
    /// Metres.
    pub x: f32,
    /// Metres.
    pub y: f32,
    /// Covariance as xx, xy, yy in square metres.
    pub covariance: [f32; 3],
}

impl Estimate {
    /// How far it is off, with what it claims.
    pub fn error(&self, truth_m: [f32; 2]) -> Error2 {
        Error2 {
            error_m: [truth_m[0] - self.x, truth_m[1] - self.y],
            covariance: self.covariance,
        }
    }

    /// Its distance from a place, in metres.
    pub fn distance_m(&self, [x, y]: [f32; 2]) -> f32 {
        (self.x - x).hypot(self.y - y)
    }
}

/// A step that stands out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Event {
    /// Step, from 0.
    pub step: usize,
    /// Why.
    pub kind: EventKind,
}

/// Why a step stands out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum EventKind {
    /// The contact force rises here.
    Contact,
    /// The user marked it.
    Mark,
}

/// Something to tell the user.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Message {
    /// Whether something went wrong.
    pub error: bool,
    /// One line.
    pub text: String,
}
