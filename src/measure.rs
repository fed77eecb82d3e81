//! Measures of frames and of the fusion: pure functions on plain numbers, for eval, session and train.
//!
//! The numbers D1, D2, … are those of the list of diagnostics in the documentation. Nothing here knows a network.

pub mod ellipse;
pub mod frame;
pub mod fusion;
