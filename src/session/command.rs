//! Everything a user can do to a session. Keys, clicks, web messages, scripts and tests all become these.

use serde::{Deserialize, Serialize};

use super::settings::ControlEdit;
use super::snapshot::table::Column;
use crate::measure::corruption::Corruption;
use crate::measure::failure::Order;
use crate::measure::protocol::Protocol;
use crate::modality::Modality;
use crate::model::switches::Reach;

/// How far a switch reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scope {
    /// Every step of the episode.
    #[default]
    Episode,
    /// The step under the cursor and all later ones.
    Onward,
    /// The step under the cursor only.
    Frame,
}

impl Scope {
    /// The steps it means at a step.
    pub fn reach(self, step: usize) -> Reach {
        let until = match self {
            Self::Episode => return Reach::EPISODE,
            Self::Onward => None,
            Self::Frame => Some(step + 1),
        };
        Reach { from: step, until }
    }
}

/// What playback does at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Looping {
    /// Stops.
    Off,
    /// Starts again at the first step.
    #[default]
    All,
    /// Goes round the selected steps.
    Selection,
}

/// One thing a user asks of the session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Play or pause.
    TogglePlay,
    /// Move the cursor by so many steps; it stops at the ends.
    Step(i64),
    /// Put the cursor on a step counted from 1, as shown; one outside the episode is refused.
    SeekTo(usize),
    /// Put the cursor on the nearest step to this index from 0: dragging.
    SeekClamped(usize),
    /// First step.
    First,
    /// Last step.
    Last,
    /// The first predicted step: of truth, belief and prediction there is something to see.
    FirstPredicted,
    /// Go so many episodes on; it stops at the ends.
    Episode(i64),
    /// Go to the episode of this index.
    SelectEpisode(usize),
    /// Show this model of the list.
    SelectModel(usize),
    /// Show this model of the list beside it.
    CompareWith(usize),
    /// Go so many places on in the queue of failures.
    Failure(i64),
    /// Rank failures by the next quantity.
    CycleFailureOrder,
    /// Rank failures by this.
    RankBy(Order),
    /// Sort the episodes by a column; the same again turns the order round.
    SortBy(Column),
    /// List only episodes whose name or split contains this.
    Filter(String),
    /// Tell what is odd about the recording: the next of what there is.
    Oddity,
    /// Go so many events on: contact onsets and marks.
    Event(i64),
    /// Mark the step under the cursor, or take its mark away.
    ToggleMark,
    /// Begin a selection of steps at the cursor, or end it there; a third time forgets it.
    Select,
    /// Switch an expert on or off within the scope: a position in the model's list, the prior last.
    ToggleExpert(usize),
    /// Switch it on or off whatever it is now: of two faces that want it off neither switches it on again.
    SwitchExpert {
        /// Position in the model's list, the prior last.
        expert: usize,
        /// Whether it is to be on.
        on: bool,
    },
    /// Only this expert, within the scope; the prior stays as it is.
    Solo(usize),
    /// Every expert as trained, everywhere.
    AllOn,
    /// Set the tempering of an expert within the scope.
    SetAlpha {
        /// Position in the model's list, the prior last.
        expert: usize,
        /// 0 off, 1 as trained.
        alpha: f32,
    },
    /// Change the tempering of an expert within the scope by so many tenths.
    Temper {
        /// Position in the model's list, the prior last.
        expert: usize,
        /// How many tenths; it stops at 0.
        tenths: i64,
    },
    /// Next scope: episode, from here on, this frame.
    CycleScope,
    /// This scope.
    SetScope(Scope),
    /// Exactly these experts as trained, the others off, in the whole episode: the model's list, the prior last.
    UseSet(Vec<bool>),
    /// Damage what a modality's experts see, within the corruption's steps; none mends it.
    Corrupt {
        /// Whose input.
        modality: Modality,
        /// How.
        corruption: Option<Corruption>,
    },
    /// Predict with other controls than the recorded ones; none takes the recorded ones again.
    EditControls(Option<ControlEdit>),
    /// Show the mean path, or a sample.
    ToggleSamples,
    /// Show a sample, or the mean path.
    ShowSamples(bool),
    /// So many samples.
    SetSamples(usize),
    /// Seed of the samples' and the corruptions' noise.
    SetSeed(u64),
    /// Predict open loop from the step under the cursor.
    PredictHere,
    /// c: so many images are seen before the rollout.
    SetContext(usize),
    /// h: so many images are predicted.
    SetHorizon(usize),
    /// Both of these, as the paper has them.
    Predict(Protocol),
    /// Change c by so many.
    Context(i64),
    /// Change h by so many.
    Horizon(i64),
    /// Faster (positive) or slower (negative), by factors of two.
    Speed(i64),
    /// As many times as fast as recorded: a power of two from 1/8 to 8.
    SetSpeed(f32),
    /// Loop off, all, or the selection.
    CycleLoop,
    /// Take back the last change of switches, scope, context, horizon, damage, controls or samples.
    Undo,
    /// Do it again.
    Redo,
    /// Restore what a state string says.
    Restore(String),
}

/// What a command needs of the episode that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Nothing: it is carried out at once.
    Nothing,
    /// That it is there; where another one is gone to meanwhile, that one.
    Episode,
    /// That it is there, and the very one: it is about one of its steps.
    Step,
}

impl Command {
    /// What it needs.
    pub fn needs(&self) -> Needs {
        match self {
            Self::TogglePlay
            | Self::Speed(_)
            | Self::SetSpeed(_)
            | Self::CycleLoop
            | Self::Episode(_)
            | Self::SelectEpisode(_)
            | Self::SelectModel(_)
            | Self::CompareWith(_)
            | Self::Failure(_)
            | Self::CycleFailureOrder
            | Self::RankBy(_)
            | Self::SortBy(_)
            | Self::Filter(_)
            | Self::Restore(_) => Needs::Nothing,
            Self::Step(_)
            | Self::SeekTo(_)
            | Self::SeekClamped(_)
            | Self::Event(_)
            | Self::ToggleMark
            | Self::Select
            | Self::PredictHere => Needs::Step,
            Self::First
            | Self::Last
            | Self::FirstPredicted
            | Self::Oddity
            | Self::ToggleExpert(_)
            | Self::SwitchExpert { .. }
            | Self::Solo(_)
            | Self::AllOn
            | Self::SetAlpha { .. }
            | Self::Temper { .. }
            | Self::CycleScope
            | Self::SetScope(_)
            | Self::UseSet(_)
            | Self::Corrupt { .. }
            | Self::EditControls(_)
            | Self::ToggleSamples
            | Self::ShowSamples(_)
            | Self::SetSamples(_)
            | Self::SetSeed(_)
            | Self::SetContext(_)
            | Self::SetHorizon(_)
            | Self::Predict(_)
            | Self::Context(_)
            | Self::Horizon(_)
            | Self::Undo
            | Self::Redo => Needs::Episode,
        }
    }

    /// Whether it goes to another place, so that nobody wants to be taken away from there later.
    pub fn leaves(&self) -> bool {
        matches!(
            self,
            Self::Step(_)
                | Self::SeekTo(_)
                | Self::SeekClamped(_)
                | Self::First
                | Self::Last
                | Self::FirstPredicted
                | Self::Event(_)
                | Self::Episode(_)
                | Self::SelectEpisode(_)
                | Self::SelectModel(_)
                | Self::Restore(_)
        )
    }
}
