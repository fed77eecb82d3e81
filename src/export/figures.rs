//! The paper's figures, drawn from a summary.

mod contact;
mod ellipses;
mod horizons;
mod strips;
mod style;
mod training;

pub use self::contact::contact;
pub use self::ellipses::ellipses;
pub use self::horizons::horizons;
pub use self::strips::{Frames, Strip, strips};
pub use self::training::training;
