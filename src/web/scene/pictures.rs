//! Files of pictures that were shown last: what did not change is not made again.

use std::sync::Arc;

use super::png;
use crate::episode::Frame;
use crate::session::snapshot::SignedFrame;

/// Kept pictures; a row of frames has few.
const KEPT: usize = 12;

/// Files by the picture that they are of.
#[derive(Debug, Default)]
pub struct Pictures {
    greys: Vec<(Arc<Frame>, Vec<u8>)>,
    errors: Vec<(Arc<SignedFrame>, Vec<u8>)>,
}

impl Pictures {
    /// The file of a grey picture.
    pub fn grey(&mut self, frame: Option<&Arc<Frame>>) -> Option<Vec<u8>> {
        kept(&mut self.greys, frame?, png::grey)
    }

    /// The file of an error.
    pub fn signed(&mut self, frame: Option<&Arc<SignedFrame>>) -> Option<Vec<u8>> {
        kept(&mut self.errors, frame?, png::signed)
    }
}

fn kept<T>(
    files: &mut Vec<(Arc<T>, Vec<u8>)>,
    frame: &Arc<T>,
    encode: fn(&T) -> Option<Vec<u8>>,
) -> Option<Vec<u8>> {
    if let Some((_, file)) = files.iter().find(|(kept, _)| Arc::ptr_eq(kept, frame)) {
        return Some(file.clone());
    }
    let file = encode(frame)?;
    if files.len() == KEPT {
        files.remove(0);
    }
    files.push((Arc::clone(frame), file.clone()));
    Some(file)
}
