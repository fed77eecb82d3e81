//! Planar pushing in simulation: a seed in, a recording out.
//!
//! A rod driven by random planar velocities meets a square plate on a table and pushes it, as in the synthetic set of
//! the paper. The physics is rapier's, the pictures are drawn by tiny-skia, and the instruments have the filters and
//! the noise of real ones. It knows nothing of files and models.
//!
//! ```text
//! pusher (policy, arm) ─► world (rapier) ─► contact ─► sensor ─► Recording
//!                            └─► render (camera, light, solid, polygon) ─┘
//! ```

mod camera;
mod contact;
mod light;
mod motion;
mod params;
mod polygon;
mod pusher;
#[cfg(test)]
mod quasi_static;
mod record;
mod render;
mod scene;
mod sensor;
mod sheet;
mod solid;
mod world;

pub use motion::{Motion, Motions};
pub use params::{Params, ParamsError};
pub use record::simulate;
pub use scene::Scene;
pub use sheet::sheet;
