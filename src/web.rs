//! The face in a browser, over viser's protocol.
//!
//! ```text
//! session's thread ── snapshot ─► scene: elements and nodes ─► stage: what changed ─► a queue a viewer ─► socket
//!        ▲                                                                                                  │
//!        └────────────── commands ◄── asked: what a control or a click means ◄── inbound messages ◄─────────┘
//! ```
//! All but the session runs on one thread of its own, `poescope-web`.

pub mod asked;
pub mod assets;
pub mod outbox;
pub mod piece;
pub mod protocol;
pub mod scene;
pub mod server;
pub mod stage;
pub mod viewer;

mod hub;
mod talk;
