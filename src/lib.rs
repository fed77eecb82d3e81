//! poescope: look inside a product-of-experts fusion.
//!
//! ```text
//! MCAP dataset ─► Episode ─► encoders ─► ExpertTrace ─┐ (once per model and episode, cached)
//! (or simulate)                                       ▼
//!                       switches α[t, expert] ─► filter ─► Belief per step ─► rollout ─► decode
//!                                                    │             └───────► position probe
//!                                                    ▼
//!                                    Snapshot ─► the terminal, browsers
//! ```
//!
//! # Who may import whom
//! ```text
//! episode, modality, lock < measure < model | data | sim < eval | session < train | tui | web | export
//!     < cli < command < main
//! ```
//! A part imports only what stands to its left; parts joined by `|` do not import each other.
//! `tests/it/architecture.rs` reads the `use` lines and fails on any other edge.
//!
//! # Letters of shapes
//! B batch, T steps, W samples of a window, M experts (the prior last), Z latent, U control, K base matrices,
//! C channels. Tensors are batch first; images and windows are channels last, `(B, height, width, C)` and `(B, W, C)`.

pub mod cli;
pub mod command;
pub mod data;
pub mod episode;
pub mod eval;
pub mod export;
pub mod lock;
pub mod measure;
pub mod modality;
pub mod model;
pub mod session;
pub mod sim;
pub mod train;
pub mod tui;
pub mod web;
