//! Frame metrics and diagnostics of a fusion: pure functions over plain numbers, used by evaluation, session and
//! training alike. Knows no network and no file.

pub mod bootstrap;
pub mod calibration;
pub mod chi2;
pub mod correlation;
pub mod corruption;
pub mod ellipse;
pub mod frame;
pub mod fusion;
pub mod gaussian;
pub mod tempering;

#[cfg(test)]
mod synthetic;
