//! Everything a user can do to a session. Keys, clicks, web messages, scripts and tests all become these.

use serde::{Deserialize, Serialize};

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

/// What playback does at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Looping {
    /// Stops.
    Off,
    /// Starts again at the first step.
    #[default]
    All,
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
    /// Go so many episodes on; it stops at the ends.
    Episode(i64),
    /// Go to the episode of this index.
    SelectEpisode(usize),
    /// Show this model of the list.
    SelectModel(usize),
    /// Switch an expert on or off within the scope: a position in the model's list, the prior last.
    ToggleExpert(usize),
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
    /// Predict open loop from the step under the cursor.
    PredictHere,
    /// c: so many images are seen before the rollout.
    SetContext(usize),
    /// h: so many images are predicted.
    SetHorizon(usize),
    /// Change c by so many.
    Context(i64),
    /// Change h by so many.
    Horizon(i64),
    /// Faster (positive) or slower (negative), by factors of two.
    Speed(i64),
    /// Loop off or all.
    CycleLoop,
    /// Take back the last change of switches, scope, context, horizon or start.
    Undo,
    /// Do it again.
    Redo,
    /// Restore what a state string says.
    Restore(String),
}
