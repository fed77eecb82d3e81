//! The panes of the fuse view.

pub mod dims;
pub mod divergence;
pub mod pairs;
pub mod response;
pub mod series;

mod bounds;
pub mod empty;

pub use bounds::{mark, range};
