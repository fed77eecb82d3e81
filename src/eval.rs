//! The paper's evaluation: how well a model predicts frames and positions open loop, beside predictors that anybody
//! could write, and how sure the comparison is.
//!
//! ```text
//! Episode × Subject ─► score ─► EpisodeScores (a line of the score file) ─► summary ─► tables, figures
//! ```
//! Scores are computed episode by episode, so that a long run can be cut into shards and taken up again; everything
//! after them is read from the scores alone.

pub mod claims;
pub mod comparison;
pub mod contact;
pub mod credit;
pub mod markdown;
pub mod prediction;
pub mod quoted;
pub mod regression;
pub mod score;
pub mod setting;
pub mod spread;
pub mod summary;
pub mod table;
pub mod tables;

pub use self::prediction::open_loop_mse;
pub use crate::measure::protocol::{self, Protocol};
