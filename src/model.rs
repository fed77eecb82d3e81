//! What is learned: tensors in, tensors out. Knows no dataset file and no screen.

pub mod trace;
