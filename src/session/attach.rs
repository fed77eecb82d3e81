//! Other faces of the same session: each hands in commands and sees the newest snapshot, from a thread of its own.
//!
//! The session stays with the one thread that owns it. What a face asks for lies in a bounded queue until that thread
//! looks; each snapshot that it makes takes the place of the one before. Whoever is late misses what is old, and holds
//! nobody up.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, Weak};

use super::Session;
use super::command::Command;
use super::predict::Predictor;
use super::snapshot::{Message, Snapshot};
use super::wants::Wants;
use super::worker::Shared;
use crate::lock::lock;

/// Commands of one face that may wait; more than anyone asks for between two looks.
const QUEUE: usize = 256;

/// Called, on the session's thread, after each new snapshot.
pub type Notify = Box<dyn Fn() + Send + Sync>;

/// One face's end. Dropped, it is attached no more.
#[derive(Clone)]
pub struct Attached {
    line: Arc<Line>,
    said: Said,
    shared: Arc<Shared>,
}

/// What both ends hold.
struct Line {
    asked: Mutex<Asked>,
    newest: Mutex<Arc<Snapshot>>,
    notify: Notify,
}

#[derive(Default)]
struct Asked {
    commands: VecDeque<Command>,
    wants: Wants,
}

impl Attached {
    /// Asks for something; false where so much waits already that it is dropped.
    pub fn apply(&self, command: Command) -> bool {
        let mut asked = lock(&self.line.asked);
        let fits = asked.commands.len() < QUEUE;
        if fits {
            asked.commands.push_back(command);
        }
        drop(asked);
        self.shared.wake();
        fits
    }

    /// Says what this face looks at.
    pub fn want(&self, wants: Wants) {
        lock(&self.line.asked).wants = wants;
        self.shared.wake();
    }

    /// Tells the user something, through every face; also by one that leaves with it.
    pub fn say(&self, message: Message) {
        *lock(&self.said) = Some(message);
        self.shared.wake();
    }

    /// The models as they are now: a run that is followed leaves newer ones.
    pub fn models(&self) -> Vec<Arc<dyn Predictor>> {
        self.shared.models()
    }

    /// The newest snapshot.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&lock(&self.line.newest))
    }
}

/// What a face has to tell the user.
type Said = Arc<Mutex<Option<Message>>>;

/// The session's ends of all lines.
#[derive(Default)]
pub(super) struct Lines {
    faces: Vec<Weak<Line>>,
    said: Said,
}

impl Session {
    /// Attaches a face; `notify` is called on this session's thread after each new snapshot, and must be quick.
    pub fn attach(&mut self, notify: Notify) -> Attached {
        let line = Arc::new(Line {
            asked: Mutex::default(),
            newest: Mutex::new(Arc::new(self.shown.clone())),
            notify,
        });
        self.lines.faces.push(Arc::downgrade(&line));
        Attached {
            line,
            said: Arc::clone(&self.lines.said),
            shared: Arc::clone(&self.shared),
        }
    }

    /// Does what attached faces have asked for since.
    pub(super) fn hear(&mut self) {
        let faces = &mut self.lines.faces;
        faces.retain(|line| line.strong_count() > 0);
        let lines: Vec<Arc<Line>> = faces.iter().filter_map(Weak::upgrade).collect();
        let mut wants = self.own_wants;
        for line in lines {
            let mut asked = lock(&line.asked);
            wants = wants.and(asked.wants);
            let commands = std::mem::take(&mut asked.commands);
            drop(asked);
            for command in commands {
                self.apply(command);
            }
        }
        // Last, so that it is what stays on the screen.
        let said = lock(&self.lines.said).take();
        if let Some(message) = said {
            self.say(message);
        }
        if self.wants != wants {
            self.wants = wants;
            self.settle(self.playback.cursor);
        }
    }

    /// Shows attached faces what is new.
    pub(super) fn tell(&self) {
        if self.lines.faces.is_empty() {
            return;
        }
        let newest = Arc::new(self.shown.clone());
        for line in self.lines.faces.iter().filter_map(Weak::upgrade) {
            *lock(&line.newest) = Arc::clone(&newest);
            (line.notify)();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    use super::*;
    use crate::session::fake::{FakePredictor, FakeSource};

    fn session() -> Session {
        let source = Arc::new(FakeSource::new(2));
        let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
        assert!(session.wait_idle(Duration::from_secs(20)));
        session
    }

    #[test]
    fn what_one_face_asks_for_every_face_sees() {
        let mut session = session();
        let told = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&told);
        let one = session.attach(Box::new(move || {
            count.fetch_add(1, Ordering::Relaxed);
        }));
        let other = session.attach(Box::new(|| {}));
        assert!(one.apply(Command::SeekTo(6)) && other.apply(Command::ToggleExpert(1)));
        assert_eq!(one.snapshot().cursor, 0, "nobody has looked yet");
        session.update(Duration::ZERO);
        assert_eq!((one.snapshot().cursor, other.snapshot().cursor), (5, 5));
        assert!(session.wait_idle(Duration::from_secs(20)));
        assert!(one.snapshot().experts[1].alpha.abs() < f32::EPSILON);
        assert_eq!(one.snapshot().state, session.snapshot().state);
        assert!(told.load(Ordering::Relaxed) > 0);
    }

    #[test]
    fn the_wait_for_a_key_is_no_time_that_it_has_played() {
        let mut session = session();
        let face = session.attach(Box::new(|| {}));
        assert!(face.apply(Command::TogglePlay));
        session.update(Duration::from_mins(1));
        assert_eq!((face.snapshot().playing, face.snapshot().cursor), (true, 0));
        for _ in 0..4 {
            session.update(Duration::from_mins(1));
        }
        assert!(face.snapshot().cursor > 0);
    }

    #[test]
    fn what_any_face_wants_is_computed_until_it_leaves() {
        let mut session = session();
        let face = session.attach(Box::new(|| {}));
        face.want(Wants {
            lattice: true,
            ..Wants::default()
        });
        session.update(Duration::ZERO);
        assert!(session.wait_idle(Duration::from_secs(20)));
        assert!(face.snapshot().lattice.is_some());
        drop(face);
        session.update(Duration::ZERO);
        assert_eq!(session.wants, Wants::default());
    }

    #[test]
    fn what_one_face_says_every_face_tells() {
        let mut session = session();
        let (one, other) = (
            session.attach(Box::new(|| {})),
            session.attach(Box::new(|| {})),
        );
        let message = Message {
            error: false,
            text: "written".to_owned(),
        };
        one.say(message.clone());
        // It is heard although the face has gone.
        drop(one);
        session.update(Duration::ZERO);
        assert_eq!(other.snapshot().message.as_ref(), Some(&message));
        assert_eq!(session.snapshot().message, Some(message));
    }

    #[test]
    fn a_face_that_floods_loses_its_own_commands() {
        let mut session = session();
        let face = session.attach(Box::new(|| {}));
        let taken = (0..2 * QUEUE)
            .filter(|_| face.apply(Command::Step(1)))
            .count();
        assert_eq!(taken, QUEUE);
        session.update(Duration::ZERO);
        assert!(face.apply(Command::First));
    }
}
