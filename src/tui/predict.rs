//! The panes of the predict view.

pub mod fan;
pub mod samples;
pub mod spread;
