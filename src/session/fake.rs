//! A made-up model and dataset, for tests and demonstrations: no training, no files, everything known exactly.
//!
//! Each episode is a bright square that is pushed across a dark table; the camera sees it, the "force" and
//! "position" windows carry its coordinates with a small offset each. The model is linear and Gaussian, with a
//! latent of four dimensions of which the first two are the square's centre in parts of the frame.

mod dataset;
mod dynamics;
mod predictor;

pub use dataset::FakeSource;
pub use predictor::{Calls, FakePredictor};
