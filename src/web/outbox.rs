//! What one viewer has yet to be told. It never holds two changes of one key, so however long a viewer is busy, what
//! waits for it is no more than everything there is.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use hyper::body::Bytes;

use super::piece::{Change, Does, messages};
use super::protocol::Key;
use super::protocol::batch::{WINDOW, encode};

/// The changes of one moment, framed once for all who need just these.
#[derive(Debug, Default)]
pub struct Moment {
    /// In order.
    pub changes: Vec<Arc<Change>>,
    frames: OnceLock<Vec<Bytes>>,
}

impl Moment {
    /// Of these.
    pub fn new(changes: Vec<Arc<Change>>) -> Self {
        Self {
            changes,
            frames: OnceLock::new(),
        }
    }

    /// Its frames.
    pub fn frames(&self, secs: f64) -> Vec<Bytes> {
        let frames = || frames(self.changes.iter().map(AsRef::as_ref), secs);
        self.frames.get_or_init(frames).clone()
    }
}

/// Frames of some changes, each of no more messages than a client takes at once.
pub fn frames<'a>(changes: impl IntoIterator<Item = &'a Change>, secs: f64) -> Vec<Bytes> {
    let messages = messages(changes);
    let windows = messages.chunks(WINDOW);
    let encoded = windows.filter_map(|window| encode(window.iter().map(Vec::as_slice), secs).ok());
    encoded.map(Bytes::from).collect()
}

/// What one viewer has yet to be told.
#[derive(Debug, Default)]
pub enum Outbox {
    /// Nothing.
    #[default]
    Empty,
    /// Just what happened at one moment: what most viewers have most of the time.
    Whole(Arc<Moment>),
    /// More.
    Merged(Merged),
}

impl Outbox {
    /// Takes a moment in.
    pub fn push(&mut self, moment: &Arc<Moment>) {
        match self {
            Self::Empty => *self = Self::Whole(Arc::clone(moment)),
            Self::Whole(_) | Self::Merged(_) => {
                for change in &moment.changes {
                    self.add(change);
                }
            }
        }
    }

    /// Takes one change in.
    pub fn add(&mut self, change: &Arc<Change>) {
        let mut merged = match std::mem::take(self) {
            Self::Empty => Merged::default(),
            Self::Merged(merged) => merged,
            Self::Whole(moment) => {
                let mut merged = Merged::default();
                for change in &moment.changes {
                    merged.add(Arc::clone(change));
                }
                merged
            }
        };
        merged.add(Arc::clone(change));
        *self = Self::Merged(merged);
    }

    /// Takes all of it out, framed.
    pub fn take(&mut self, secs: f64) -> Vec<Bytes> {
        match std::mem::take(self) {
            Self::Empty => Vec::new(),
            Self::Whole(moment) => moment.frames(secs),
            Self::Merged(merged) => frames(merged.order.values().map(AsRef::as_ref), secs),
        }
    }
}

/// Changes in order, one a key.
#[derive(Debug, Default)]
pub struct Merged {
    order: BTreeMap<u64, Arc<Change>>,
    places: BTreeMap<Key, u64>,
    next: u64,
}

impl Merged {
    /// A newer change takes the place of an older one of its key, at the end; one that makes or ends a thing makes all
    /// that was to be told of its parts needless.
    fn add(&mut self, change: Arc<Change>) {
        if matches!(change.does, Does::Make(_)) && change.key.part.is_empty() {
            let keys = self.places.range(change.key.clone()..);
            let same = keys.take_while(|(key, _)| key.same_thing(&change.key));
            let same: Vec<Key> = same.map(|(key, _)| key.clone()).collect();
            for key in same {
                // A pose is not part of the making of a node: the node keeps it.
                let is_part = self
                    .places
                    .get(&key)
                    .and_then(|place| self.order.get(place));
                if is_part.is_some_and(|old| matches!(old.does, Does::Set(_))) {
                    self.forget(&key);
                }
            }
        }
        self.forget(&change.key);
        self.places.insert(change.key.clone(), self.next);
        self.order.insert(self.next, change);
        self.next += 1;
    }

    fn forget(&mut self, key: &Key) {
        if let Some(place) = self.places.remove(key) {
            self.order.remove(&place);
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use serde_json::{Value, json};

    use super::super::protocol::{frame, write};
    use super::*;

    fn set(uuid: &str, part: &str, value: u8) -> Arc<Change> {
        let key = Key::gui(uuid).part(part);
        Arc::new(Change {
            key,
            does: Does::Set(write(&value)),
        })
    }

    fn make(uuid: &str) -> Arc<Change> {
        let written = write(&json!({"type": "Made", "uuid": uuid}));
        Arc::new(Change {
            key: Key::gui(uuid),
            does: Does::Make(written),
        })
    }

    fn told(outbox: &mut Outbox) -> Vec<Value> {
        let frames = outbox.take(0.0);
        frames
            .iter()
            .flat_map(|frame| frame::read(frame).unwrap().messages)
            .collect()
    }

    #[test]
    fn the_newest_of_a_key_goes_last_and_alone() {
        let mut outbox = Outbox::default();
        for value in 0..100 {
            let both = vec![set("a", "value", value), set("b", "value", value)];
            outbox.push(&Arc::new(Moment::new(both)));
        }
        outbox.add(&set("a", "value", 200));
        let update = |uuid, value| json!({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}});
        assert_eq!(told(&mut outbox), [update("b", 99), update("a", 200)]);
        assert_eq!(told(&mut outbox), [] as [Value; 0]);
    }

    #[test]
    fn what_is_made_again_needs_no_earlier_changes() {
        let mut outbox = Outbox::default();
        for change in [
            set("a", "value", 1),
            set("ab", "value", 2),
            make("a"),
            set("a", "label", 3),
        ] {
            outbox.add(&change);
        }
        let told = told(&mut outbox);
        let names: Vec<&Value> = told.iter().map(|message| &message["uuid"]).collect();
        assert_eq!(names, ["ab", "a", "a"]);
        assert_eq!(told[1]["type"], "Made");
    }

    #[test]
    fn a_moment_is_framed_once_for_all() {
        let moment = Arc::new(Moment::new(vec![make("a")]));
        let (mut one, mut other) = (Outbox::default(), Outbox::default());
        one.push(&moment);
        other.push(&moment);
        let (one, other) = (one.take(0.0), other.take(1.0));
        assert_eq!(one[0].as_ptr(), other[0].as_ptr());
    }

    #[test]
    fn a_frame_has_no_more_messages_than_a_client_takes() {
        let changes: Vec<_> = (0..300).map(|i| make(&format!("u{i}"))).collect();
        assert_eq!(Moment::new(changes).frames(0.0).len(), 3);
    }
}
