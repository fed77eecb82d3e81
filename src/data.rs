//! Datasets: ROS 2 MCAP files in and out, and their streams laid out on steps and windows.
//!
//! [`Dataset`] opens files and reads episodes, [`DatasetWriter`] makes them, [`align`] puts a recording on the clock
//! of its images, a [`Store`] keeps more of them than memory holds. What a network wants of an episode (tensors, scaling) is the model's business, not this folder's.
//!
//! ```text
//! file ─► index (summary, or scan) ─► spans of an episode ─► messages ─► cdr, image ─► Recording ─► align ─► Episode
//! ```

mod align;
mod annotate;
mod block_cache;
mod cdr;
mod chunk;
mod collect;
mod dataset;
mod error;
mod folder;
mod hash;
mod image;
mod index;
mod mcap_file;
mod message_type;
mod record;
mod report;
mod scan;
mod schema;
mod split;
mod store;
mod streams;
mod summary;
mod topics;
mod write;

pub use align::align;
pub use annotate::{Annotated, Note, Value};
pub use dataset::Dataset;
pub use error::DataError;
pub use report::{FileReport, LeftOut, TopicReport};
pub use store::{Episodes, Store};
pub use topics::{NOTES, Role, Topics};
pub use write::DatasetWriter;
