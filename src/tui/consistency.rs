//! The panes of the consistency view.

pub mod coverage;
pub mod dependence;
pub mod episodes;
pub mod horizons;
