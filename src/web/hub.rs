//! Between the session and the viewers: takes snapshots in, tells everybody what changed, hears what they ask for.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use tokio::sync::Notify;
use tokio::time::{sleep, sleep_until};

use super::asked::{Asked, is_kept, of_click, of_control};
use super::piece::{Change, Does};
use super::protocol::inbound::Inbound;
use super::protocol::notification::{Notification, NotificationProps, RemoveNotification};
use super::protocol::{Key, write};
use super::scene::{Composer, Shown};
use super::stage::Stage;
use super::talk::Talk;
use super::viewer::{HOLD, Viewer};
use crate::lock::lock;
use crate::session::attach::Attached;
use crate::session::command::Command;
use crate::session::snapshot::{Message, Snapshot};
use crate::session::wants::Wants;

/// No more often than so: a browser paints no faster.
const PERIOD: Duration = Duration::from_millis(16);

/// But so soon after somebody has asked for something.
const SOON: Duration = Duration::from_millis(6);

/// One picture no more often than so: viser's client complains of one that is replaced before it was loaded.
const PICTURES: Duration = Duration::from_millis(30);

/// What all viewers share.
pub struct Hub {
    attached: Attached,
    /// A snapshot came, or something else is to be looked at.
    pub news: Arc<Notify>,
    read_only: bool,
    spread: AtomicBool,
    /// Somebody has asked for something, and nobody has been told since.
    asked: AtomicBool,
    started: Instant,
    state: Mutex<State>,
}

/// What came of a snapshot.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Told {
    /// It is nothing new.
    Nothing,
    /// It was told.
    All,
    /// Some of it is held back for a moment.
    NotYet,
}

struct State {
    stage: Stage,
    composer: Composer,
    viewers: Vec<Arc<Viewer>>,
    shown: Option<(Arc<Snapshot>, Shown)>,
    /// The message that is shown with its number, and how many notifications there were.
    note: Option<Message>,
    told: u64,
    notes: u64,
}

impl Hub {
    /// Between this session and nobody yet.
    pub fn new(attached: Attached, news: Arc<Notify>, read_only: bool) -> Self {
        let hub = Self {
            attached,
            news,
            read_only,
            spread: AtomicBool::new(false),
            asked: AtomicBool::new(false),
            started: Instant::now(),
            state: Mutex::new(State {
                stage: Stage::default(),
                composer: Composer::paced(PICTURES),
                viewers: Vec::new(),
                shown: None,
                note: None,
                told: 0,
                notes: 0,
            }),
        };
        hub.refresh();
        hub
    }

    /// The server's clock.
    pub fn secs(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Tells everybody what is new, whenever there is something, for ever.
    pub async fn run(&self) {
        let mut last = Instant::now();
        let (mut waiting, mut holding) = (false, false);
        loop {
            let asked = self.asked.load(Ordering::Relaxed);
            let due = last + if asked { SOON } else { PERIOD };
            tokio::select! {
                () = self.news.notified() => {
                    waiting = true;
                    // The session has looked: there is room again for what waits.
                    self.hand_on();
                    continue;
                }
                () = sleep_until(due.into()), if waiting => {}
                () = sleep(HOLD / 2), if holding => {}
            }
            let told = self.refresh();
            waiting = told == Told::NotYet;
            if told != Told::Nothing {
                last = Instant::now();
                self.asked.store(false, Ordering::Relaxed);
            }
            holding = self.let_go();
        }
    }

    /// Takes the newest snapshot in; what there was to tell.
    fn refresh(&self) -> Told {
        let snapshot = self.attached.snapshot();
        let shown = Shown {
            read_only: self.read_only,
            spread: self.spread.load(Ordering::Relaxed),
        };
        let mut state = self.lock();
        let same = state
            .shown
            .as_ref()
            .is_some_and(|(before, how)| Arc::ptr_eq(before, &snapshot) && *how == shown);
        if same {
            return Told::Nothing;
        }
        let pieces = state.composer.compose(&snapshot, shown);
        let mut moment = state.stage.show(pieces);
        moment.changes.extend(state.notify(&snapshot));
        let any = !moment.changes.is_empty();
        let moment = Arc::new(moment);
        for viewer in &state.viewers {
            viewer.tell(&moment, &snapshot);
        }
        if state.composer.is_late() {
            state.shown = None;
            return Told::NotYet;
        }
        state.shown = Some((snapshot, shown));
        if any { Told::All } else { Told::Nothing }
    }

    /// Lets viewers go of what they have not used for a while; whether anything is held still.
    fn let_go(&self) -> bool {
        let (state, now) = (self.lock(), Instant::now());
        let stage = &state.stage;
        let viewers = state.viewers.iter();
        viewers.fold(false, |holding, viewer| viewer.let_go(stage, now) | holding)
    }

    /// Takes a viewer in; none where there are so many already.
    pub fn join(&self, most: usize) -> Option<Arc<Viewer>> {
        let mut state = self.lock();
        if state.viewers.len() >= most {
            return None;
        }
        let viewer = Arc::new(Viewer::come(&state.stage));
        state.viewers.push(Arc::clone(&viewer));
        Some(viewer)
    }

    /// Lets a viewer go.
    pub fn leave(&self, viewer: &Arc<Viewer>) {
        let mut state = self.lock();
        state.viewers.retain(|other| !Arc::ptr_eq(other, viewer));
        // What nobody looks at is not computed.
        if state.viewers.is_empty() && self.spread.swap(false, Ordering::Relaxed) {
            self.attached.want(Wants::default());
        }
    }

    /// Ends every connection.
    pub fn close_all(&self, code: u16, reason: &str) {
        for viewer in &self.lock().viewers {
            viewer.close(code, reason);
        }
    }

    /// Does what a viewer says.
    pub fn hear(&self, viewer: &Viewer, message: &Inbound) {
        let snapshot = self.attached.snapshot();
        let asked = match message {
            Inbound::Update { uuid, updates } => {
                let Some(value) = &updates.value else {
                    return;
                };
                if is_kept(uuid) {
                    viewer.hold(uuid, value);
                    self.news.notify_one();
                }
                of_control(uuid, value, &snapshot)
            }
            Inbound::Click {
                name,
                instance_index,
            } => of_click(name, *instance_index),
            Inbound::Other => Asked::Nothing,
        };
        let commands = match asked {
            Asked::Commands(commands) => commands,
            Asked::Key(key, number) => viewer.talk(&snapshot, |talk| {
                let command = talk.press(&key, number, &snapshot);
                self.permitted(talk, command)
            }),
            Asked::Line(line, number) => viewer.talk(&snapshot, |talk| {
                let command = talk.line(&line, number, &snapshot);
                self.permitted(talk, command)
            }),
            Asked::Spread(on) => {
                if !self.read_only {
                    self.spread.store(on, Ordering::Relaxed);
                    self.attached.want(Wants {
                        spread: on,
                        ..Wants::default()
                    });
                    self.news.notify_one();
                }
                return;
            }
            Asked::Nothing => return,
        };
        if !self.read_only {
            self.asked.store(true, Ordering::Relaxed);
            viewer.ask(commands);
            self.hand_on();
        }
    }

    /// Hands what viewers ask for to the session, one a viewer in turn: whoever asks for too much waits for itself.
    fn hand_on(&self) {
        let viewers = self.lock().viewers.clone();
        let mut any = true;
        while std::mem::take(&mut any) {
            for viewer in &viewers {
                any |= viewer.hand_on(|command| self.attached.apply(command));
            }
        }
    }

    fn permitted(&self, talk: &mut Talk, command: Option<Command>) -> Vec<Command> {
        if self.read_only && command.is_some() {
            talk.refuse();
            return Vec::new();
        }
        command.into_iter().collect()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }
}

impl State {
    /// A message that is another one than before, as a notification; the one before goes. They are not for those who
    /// come later.
    fn notify(&mut self, snapshot: &Snapshot) -> Vec<Arc<Change>> {
        if snapshot.message == self.note && snapshot.told == self.told {
            return Vec::new();
        }
        let mut changes = Vec::new();
        let uuid = |number: u64| format!("poescope-note-{number}");
        // Keys are the same for all, so that of many unsent ones only the newest is sent.
        if self.note.is_some() {
            let end = write(&RemoveNotification {
                uuid: uuid(self.notes),
            });
            changes.push(Change {
                key: Key::note("end"),
                does: Does::Make(end),
            });
        }
        if let Some(message) = &snapshot.message {
            self.notes += 1;
            let (title, color, secs) = if message.error {
                ("That did not work", "red", 8.0)
            } else {
                ("poescope", "gray", 3.0)
            };
            let show = Notification {
                uuid: uuid(self.notes),
                props: NotificationProps {
                    title: title.to_owned(),
                    body: message.text.clone(),
                    loading: false,
                    with_close_button: true,
                    auto_close_seconds: Some(secs),
                    color: Some(color.to_owned()),
                },
            };
            changes.push(Change {
                key: Key::note("show"),
                does: Does::Make(write(&show)),
            });
        }
        self.note.clone_from(&snapshot.message);
        self.told = snapshot.told;
        changes.into_iter().map(Arc::new).collect()
    }
}
