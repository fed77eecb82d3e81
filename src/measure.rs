//! Frame metrics and diagnostics of a fusion: pure functions over plain numbers, used by evaluation, session and
//! training alike. Knows no network and no file.

pub mod active;
pub mod attribution;
pub mod bootstrap;
pub mod calibration;
pub mod chi2;
pub mod correlation;
pub mod corruption;
pub mod divergence;
pub mod ellipse;
pub mod events;
pub mod failure;
pub mod frame;
pub mod fusion;
pub mod gaussian;
pub mod innovation;
pub mod leave_one_out;
mod position;
pub mod protocol;
pub mod pull;
pub mod samples;
pub mod shapley;
pub mod spread;
pub mod ssim;
pub mod tempering;

#[cfg(test)]
mod any_input;
#[cfg(test)]
mod synthetic;
