//! What crosses folders, one module a theme.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod align;
mod architecture;
mod common;
mod damage;
mod data;
mod differences;
mod errors;
mod eval;
mod export;
mod exported_mcap;
#[cfg(feature = "rerun")]
mod exported_rerun;
mod failures;
mod golden;
mod info;
mod laws;
mod models;
mod opening;
mod pipeline;
mod portable;
mod readme;
mod resume;
mod sample;
mod tensorboard;
mod topics;
mod training;
mod web;
mod whole_or_absent;
