//! One connected viewer: what waits for it, what it set last, its keys.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use hyper::body::Bytes;
use tokio::sync::Notify;

use super::outbox::{Moment, Outbox};
use super::piece::{Change, Does};
use super::protocol::inbound::Value;
use super::protocol::pack::{Reader, Token};
use super::protocol::replay::ReplayDone;
use super::protocol::{Key, write};
use super::stage::Stage;
use super::talk::Talk;
use crate::lock::lock;
use crate::session::command::Command;
use crate::session::snapshot::Snapshot;

/// So long after its last use a control is its user's: what comes back meanwhile is late and would make it jump.
pub const HOLD: Duration = Duration::from_millis(250);
/// Controls that one viewer may hold at once; there are fewer.
const HELD: usize = 256;

/// Commands of one viewer that may wait while the session is busy with others'.
const ASKED: usize = 64;

/// One viewer.
#[derive(Debug, Default)]
pub struct Viewer {
    state: Mutex<State>,
    /// Something waits for it.
    pub wake: Notify,
}

#[derive(Debug, Default)]
struct State {
    outbox: Outbox,
    held: BTreeMap<String, Held>,
    asked: VecDeque<Command>,
    talk: Talk,
    told: String,
    close: Option<Farewell>,
}

/// Why a connection ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Farewell {
    /// The code of the websocket protocol.
    pub code: u16,
    /// In words.
    pub reason: String,
}

/// A control in use.
#[derive(Debug)]
struct Held {
    value: Value,
    until: Instant,
}

impl Viewer {
    /// One who has just come and is to be told all of it.
    pub fn come(stage: &Stage) -> Self {
        let viewer = Self::default();
        let mut state = viewer.lock();
        for change in stage.all() {
            state.outbox.add(&Arc::new(change));
        }
        let done = Does::Make(write(&ReplayDone {}));
        let key = Key::client("ReplayDoneMessage");
        state.outbox.add(&Arc::new(Change { key, does: done }));
        drop(state);
        viewer.wake.notify_one();
        viewer
    }

    /// Tells it what happened, but for the values that it holds.
    pub fn tell(&self, moment: &Arc<Moment>, snapshot: &Snapshot) {
        let mut state = self.lock();
        let holds =
            |change: &Change| change.key.part == "value" && state.held.contains_key(&change.key.id);
        if moment.changes.iter().any(|change| holds(change)) {
            let others = moment.changes.iter().filter(|change| !holds(change));
            let others: Vec<Arc<Change>> = others.map(Arc::clone).collect();
            state.outbox.push(&Arc::new(Moment::new(others)));
        } else if !moment.changes.is_empty() {
            state.outbox.push(moment);
        }
        if state.talk.is_in_mode() {
            state.say(snapshot);
        }
        drop(state);
        self.wake.notify_one();
    }

    /// It asks for these; what is too much is dropped.
    pub fn ask(&self, commands: Vec<Command>) {
        let mut state = self.lock();
        if state.close.is_none() {
            let room = ASKED.saturating_sub(state.asked.len());
            state.asked.extend(commands.into_iter().take(room));
        }
    }

    /// Hands on the next thing it asks for; false where there is none, or it was not taken.
    pub fn hand_on(&self, take: impl FnOnce(Command) -> bool) -> bool {
        let asked = &mut self.lock().asked;
        let taken = asked.front().is_some_and(|command| take(command.clone()));
        if taken {
            asked.pop_front();
        }
        taken
    }

    /// It has set a control to a value.
    pub fn hold(&self, uuid: &str, value: &Value) {
        let mut state = self.lock();
        if state.held.len() < HELD || state.held.contains_key(uuid) {
            let until = Instant::now() + HOLD;
            state.held.insert(
                uuid.to_owned(),
                Held {
                    value: value.clone(),
                    until,
                },
            );
        }
    }

    /// Lets go of what was not used for a while, and puts right what the session made something else of. Whether
    /// anything is held still.
    pub fn let_go(&self, stage: &Stage, now: Instant) -> bool {
        let mut state = self.lock();
        let State { held, outbox, .. } = &mut *state;
        let mut corrected = false;
        held.retain(|uuid, held| {
            if held.until > now {
                return true;
            }
            let key = Key::gui(uuid);
            let value = stage.get(&key).and_then(|piece| piece.part("value"));
            if let Some(written) = value.filter(|written| !is(written, &held.value)) {
                let does = Does::Set(written.to_vec());
                outbox.add(&Arc::new(Change {
                    key: key.part("value"),
                    does,
                }));
                corrected = true;
            }
            false
        });
        let holds = !held.is_empty();
        drop(state);
        if corrected {
            self.wake.notify_one();
        }
        holds
    }

    /// Lets its keys be heard, and tells it what came of them.
    pub fn talk<T>(&self, snapshot: &Snapshot, hear: impl FnOnce(&mut Talk) -> T) -> T {
        let mut state = self.lock();
        let heard = hear(&mut state.talk);
        state.say(snapshot);
        drop(state);
        self.wake.notify_one();
        heard
    }

    /// Ends its connection, and forgets what it asks for; the first reason counts.
    pub fn close(&self, code: u16, reason: &str) {
        let reason = reason[..reason.floor_char_boundary(120)].to_owned();
        let mut state = self.lock();
        state.close.get_or_insert(Farewell { code, reason });
        state.asked.clear();
        drop(state);
        self.wake.notify_one();
    }

    /// Why it is to be closed, if it is.
    pub fn farewell(&self) -> Option<Farewell> {
        self.lock().close.clone()
    }

    /// What waits for it, framed.
    pub fn take(&self, secs: f64) -> Vec<Bytes> {
        let mut outbox = std::mem::take(&mut self.lock().outbox);
        outbox.take(secs)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        lock(&self.state)
    }
}

impl State {
    fn say(&mut self, snapshot: &Snapshot) {
        let told = self.talk.told(snapshot).to_string();
        if told != self.told {
            let key = Key::gui("poescope-face").part("value");
            self.outbox.add(&Arc::new(Change {
                key,
                does: Does::Set(write(&told)),
            }));
            self.told = told;
        }
    }
}

/// Whether what was written is this value.
fn is(written: &[u8], value: &Value) -> bool {
    match (Reader::new(written).token(), value) {
        (Some(Token::Bool(ours)), Value::Bool(theirs)) => ours == *theirs,
        (Some(Token::Float(ours)), Value::Number(theirs)) => (ours - theirs).abs() < 1e-9,
        (Some(Token::Int(ours)), Value::Number(theirs)) => (ours as f64 - theirs).abs() < 1e-9,
        (Some(Token::Text(ours)), Value::Text(theirs)) => ours == theirs,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use serde_json::{Value as Json, json};

    use super::super::piece::Piece;
    use super::super::protocol::checkbox::CheckboxProps;
    use super::super::protocol::envelope::Control;
    use super::super::protocol::frame;
    use super::super::protocol::props::Base;
    use super::*;
    use crate::session::Session;
    use crate::session::fake::{FakePredictor, FakeSource};

    fn piece(value: bool) -> Piece {
        let props = CheckboxProps {
            base: Base::new(1.0, "s"),
        };
        Piece::of(&Control::new("s", "root", Some(value), props))
    }

    fn told(viewer: &Viewer) -> Vec<Json> {
        let frames = viewer.take(0.0);
        frames
            .iter()
            .flat_map(|frame| frame::read(frame).unwrap().messages)
            .collect()
    }

    fn snapshot() -> Snapshot {
        let source = Arc::new(FakeSource::new(1));
        Session::new(source, vec![Arc::new(FakePredictor::three())]).snapshot()
    }

    #[test]
    fn who_comes_is_told_all_and_then_that_it_was_all() {
        let mut stage = Stage::default();
        stage.show(vec![piece(true)]);
        let told = told(&Viewer::come(&stage));
        let types: Vec<&Json> = told.iter().map(|message| &message["type"]).collect();
        assert_eq!(types, ["GuiCheckboxMessage", "ReplayDoneMessage"]);
    }

    #[test]
    fn its_own_value_does_not_come_back_but_is_put_right() {
        let (snapshot, mut stage) = (snapshot(), Stage::default());
        stage.show(vec![piece(true)]);
        let (one, other) = (Viewer::come(&stage), Viewer::come(&stage));
        told(&one);
        told(&other);
        one.hold("s", &Value::Bool(false));
        let moment = Arc::new(stage.show(vec![piece(false)]));
        one.tell(&moment, &snapshot);
        other.tell(&moment, &snapshot);
        let off = json!({"type": "GuiUpdateMessage", "uuid": "s", "updates": {"value": false}});
        assert_eq!((told(&one), told(&other)), (vec![], vec![off]));
        // The session takes it back while the first one's hand is still on it.
        let moment = Arc::new(stage.show(vec![piece(true)]));
        one.tell(&moment, &snapshot);
        let now = Instant::now();
        assert!(one.let_go(&stage, now) && told(&one).is_empty());
        assert!(!one.let_go(&stage, now + 2 * HOLD));
        assert_eq!(told(&one)[0]["updates"]["value"], json!(true));
    }

    #[test]
    fn the_first_reason_to_close_counts_and_fits_a_frame() {
        let viewer = Viewer::default();
        viewer.close(1008, &"é".repeat(100));
        viewer.close(1001, "later");
        let farewell = viewer.farewell().unwrap();
        assert_eq!((farewell.code, farewell.reason.len()), (1008, 120));
    }
}
