//! The interactive core: commands in, snapshots out; computation on a worker.

pub mod command;
pub mod predict;
pub mod snapshot;
