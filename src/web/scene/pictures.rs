//! Files of pictures that were shown last: what did not change is not made again.

use std::sync::Arc;
use std::time::{Duration, Instant};

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

/// How often the picture at one place may become another one.
#[derive(Debug, Default)]
pub struct Pace {
    gap: Duration,
    /// Whether something was held back.
    pub late: bool,
    /// What each place shows, and since when.
    places: Vec<(&'static str, Option<Vec<u8>>, Instant)>,
}

impl Pace {
    /// No more often than so.
    pub fn new(gap: Duration) -> Self {
        Self {
            gap,
            ..Self::default()
        }
    }

    /// What a place shows now if it is to show this: this, or for a moment still what it showed before.
    pub fn hold(&mut self, place: &'static str, file: Option<Vec<u8>>) -> Option<Vec<u8>> {
        let now = Instant::now();
        let Some((_, shown, since)) = self.places.iter_mut().find(|(name, ..)| *name == place)
        else {
            self.places.push((place, file.clone(), now));
            return file;
        };
        if *shown == file {
            return file;
        }
        if now.duration_since(*since) < self.gap {
            self.late = true;
            return shown.clone();
        }
        (*shown, *since) = (file.clone(), now);
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_waits_for_its_turn_and_others_do_not_wait_for_it() {
        let mut pace = Pace::new(Duration::from_hours(1));
        let file = |byte| Some(vec![byte]);
        assert_eq!(pace.hold("a", file(1)), file(1));
        assert_eq!((pace.hold("a", file(1)), pace.late), (file(1), false));
        assert_eq!((pace.hold("a", file(2)), pace.late), (file(1), true));
        assert_eq!(pace.hold("b", file(2)), file(2));
        pace.gap = Duration::ZERO;
        assert_eq!(pace.hold("a", file(2)), file(2));
    }
}
