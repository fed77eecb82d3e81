//! Frame metrics and diagnostics of a fusion: pure functions over plain numbers, used by evaluation, session and
//! training alike. Knows no network and no file.

pub mod attribution;
pub mod bootstrap;
pub mod calibration;
pub mod chi2;
pub mod correlation;
pub mod corruption;
pub mod divergence;
pub mod ellipse;
pub mod failure;
pub mod frame;
pub mod fusion;
pub mod innovation;
pub mod tempering;
