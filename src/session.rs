//! The interactive core: commands in, snapshots out; computation on a worker.
//!
//! ```text
//! face ── apply(Command) ─► Session ── newest request ─► worker: read, encode, filter, roll out, decode
//! face ◄─ snapshot() ────── Session ◄─ newest answer ─── (owns the models; memoises)
//! ```
//! A session is owned by one thread and opens no files. What it is asked changes its state at once; what has to be
//! computed follows, and until then the last picture stays and [`Snapshot::busy`] says so. A command that needs the
//! length of an episode which is still being read waits for it, in order.

pub mod attach;
pub mod badge;
pub mod command;
pub mod fake;
pub mod fusing;
pub mod input;
pub mod keymap;
pub mod keys;
pub mod known;
pub mod palette;
pub mod playback;
pub mod predict;
pub mod renew;
pub mod settings;
pub mod snapshot;
pub mod state;
pub mod survey;
pub mod trained;
pub mod wants;

mod damaging;
mod finding;
mod perform;
mod planning;
mod prompt;
mod restore;
mod show;
mod surveying;
mod table;
mod worker;

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use attach::Lines;
use command::{Command, Needs, Scope};
use known::Known;
use playback::Playback;
use predict::Predictor;
use restore::Restoration;
pub use restore::model_key;
use settings::{History, Sampling, Settings};
use snapshot::board::BoardView;
use snapshot::{Message, ModelInfo, Snapshot};
use survey::Cache;
use surveying::Survey;
use table::Table;
use wants::Wants;
use worker::{Answer, Opened, Request, Shared, Target};
pub use worker::{Found, THREAD};

use crate::episode::EpisodeSource;
use crate::lock::lock;

/// How soon to look again while something is computed, for a face without a waker.
const POLL: Duration = Duration::from_millis(8);
/// Commands that may wait for an episode; more than anyone types in the time.
const MOST_PENDING: usize = 1024;

/// Models, episodes, one cursor.
pub struct Session {
    source: Arc<dyn EpisodeSource>,
    models: Vec<Arc<ModelInfo>>,
    /// What each episode is called in state strings: its name, with a number where an earlier one has the same.
    episode_keys: Vec<String>,
    /// W of each model's position probe.
    position_weights: Vec<Option<Arc<[f32]>>>,
    shared: Arc<Shared>,
    worker: Option<JoinHandle<()>>,
    target: Target,
    playback: Playback,
    settings: Settings,
    history: History,
    /// Keys of a restored state string that mean nothing here, to be written back.
    unknown_keys: Vec<(String, String)>,
    /// The model beside the present one, where one was chosen.
    compare: Option<usize>,
    /// Steps the user marked, by episode.
    marks: BTreeMap<String, BTreeSet<usize>>,
    table: Table,
    survey: Option<Survey>,
    cache: Option<Arc<dyn Cache>>,
    /// What is known of each model's latent.
    known: BTreeMap<usize, Arc<Known>>,
    board: Option<Arc<BoardView>>,
    /// What the face that owns the session looks at.
    own_wants: Wants,
    /// The same with all attached ones.
    wants: Wants,
    lines: Lines,
    /// So many failures on, once the episodes have been scored.
    awaiting_failure: Option<i64>,
    /// What waits for the episode to be read.
    pending: VecDeque<Pending>,
    message: Option<Message>,
    /// How many messages there have been.
    told: u64,
    /// Which oddity of the recording is told next.
    oddity: usize,
    generation: u64,
    wanted: Option<Wanted>,
    answer: Option<Answer>,
    shown: Snapshot,
    /// Whether `shown` has changed since the last `update`.
    news: bool,
}

enum Pending {
    Command(Command),
    Seek(usize),
    Restoration(Box<Restoration>),
}

/// What a generation of requests asks for. The cursor only orders the work, unless something is looked at that is
/// computed for its step alone.
#[derive(PartialEq)]
struct Wanted {
    target: Target,
    other: Option<usize>,
    settings: Settings,
    wants: Wants,
    detail: Option<usize>,
    known: Option<usize>,
}

impl Wanted {
    /// The same for somebody who looks at numbers over a whole split.
    fn without_what_only_pictures_show(mut self) -> Self {
        self.settings.controls = None;
        self.settings.sampling = Sampling::default();
        self.settings.corruptions.clear();
        Self {
            wants: Wants::default(),
            detail: None,
            known: None,
            ..self
        }
    }
}

impl Session {
    /// Shows the first episode with the first model, and starts to compute.
    pub fn new(source: Arc<dyn EpisodeSource>, models: Vec<Arc<dyn Predictor>>) -> Self {
        let infos: Vec<_> = models.iter().map(|m| Arc::new(m.info().clone())).collect();
        let position_weights = models
            .iter()
            .map(|m| m.position_weights().map(Arc::from))
            .collect();
        let shared = Arc::new(Shared::of(models.clone()));
        let mut session = Self {
            shown: show::empty(source.as_ref(), &infos),
            models: infos,
            episode_keys: restore::keys(source.metas().iter().map(|meta| meta.id.as_str())),
            position_weights,
            compare: None,
            marks: BTreeMap::new(),
            table: Table::new(source.metas()),
            survey: None,
            cache: None,
            known: BTreeMap::new(),
            board: None,
            own_wants: Wants::default(),
            wants: Wants::default(),
            lines: Lines::default(),
            awaiting_failure: None,
            worker: None,
            target: Target {
                model: 0,
                episode: 0,
            },
            playback: Playback::default(),
            settings: Settings::default(),
            history: History::default(),
            unknown_keys: Vec::new(),
            pending: VecDeque::new(),
            message: None,
            told: 0,
            oddity: 0,
            generation: 0,
            wanted: None,
            answer: None,
            news: true,
            shared: Arc::clone(&shared),
            source: Arc::clone(&source),
        };
        if source.metas().is_empty() {
            session.complain(format!("{} has no episodes", source.name()));
        } else {
            match worker::spawn(shared, source, models) {
                Ok(worker) => session.worker = Some(worker),
                Err(error) => {
                    session.complain(format!("cannot start a thread to compute on: {error}"));
                }
            }
        }
        session.settle(0);
        session
    }

    /// Does what a user asks. A refusal changes nothing but the message.
    pub fn apply(&mut self, command: Command) {
        let cursor = self.playback.cursor;
        self.message = None;
        if command.leaves() {
            self.awaiting_failure = None;
        }
        if self.opened().is_some() || command.needs() == Needs::Nothing {
            self.perform(command);
        } else if !self.is_busy() {
            self.complain("no episode is open".to_owned());
        } else if self.pending.len() < MOST_PENDING {
            self.pending.push_back(Pending::Command(command));
        } else {
            self.complain("too much waits for the episode to be read; wait for it".to_owned());
        }
        self.settle(cursor);
    }

    /// Lets time go by: takes in what has been computed and plays on. True if the snapshot is another one than
    /// after the last update.
    pub fn update(&mut self, dt: Duration) -> bool {
        let cursor = self.playback.cursor;
        let opened = self.opened().map(Arc::clone);
        // Before what is asked now: `dt` is not time that a playback which begins with it has played.
        if opened.is_some_and(|opened| self.playback.update(dt, &opened.view.secs)) {
            self.settle(cursor);
        }
        self.hear();
        let cursor = self.playback.cursor;
        if self.collect() {
            self.settle(cursor);
        }
        std::mem::take(&mut self.news)
    }

    /// What an episode is called in state strings: its name, with a number where an earlier one has the same.
    pub fn episode_key(&self, index: usize) -> Option<&str> {
        self.episode_keys.get(index).map(String::as_str)
    }

    /// Everything a face may show.
    pub fn snapshot(&self) -> Snapshot {
        self.shown.clone()
    }

    /// When `update` has something to do again; none while nothing plays and nothing is
    /// computed that would not wake the face.
    pub fn next_wake(&self) -> Option<Duration> {
        let secs = self.opened().map_or(&[][..], |opened| &opened.view.secs);
        let computing = (self.is_busy() || self.survey_runs()) && !self.shared.wakes();
        let computing = computing.then_some(POLL);
        let playing = self.playback.next_step_in(secs);
        computing.into_iter().chain(playing).min()
    }

    /// Has `wake` called, on another thread, whenever something has been computed.
    pub fn set_waker(&mut self, wake: Box<dyn Fn() + Send>) {
        *lock(&self.shared.waker) = Some(wake);
    }

    /// Waits until everything asked for has been computed; false if that takes longer than `timeout`.
    pub fn wait_idle(&mut self, timeout: Duration) -> bool {
        let deadline = Instant::now() + timeout;
        loop {
            if !self.is_busy() {
                if !self.awaits_survey() {
                    return true;
                }
                if !self.wait_for_survey(deadline) {
                    return false;
                }
                continue;
            }
            let Some(answer) = self.shared.answers.wait_until(deadline) else {
                return false;
            };
            let cursor = self.playback.cursor;
            if self.take_in(answer) {
                self.settle(cursor);
            }
        }
    }

    /// Shows a line to the user that did not come from a command.
    pub fn say(&mut self, message: Message) {
        self.put(message);
        self.refresh();
    }

    /// The model under the cursor.
    fn model(&self) -> Option<&Arc<ModelInfo>> {
        self.models.get(self.target.model)
    }

    /// The first step, from 0, at which the model has a belief.
    fn first_belief(&self) -> usize {
        self.model().map_or(0, |model| model.frame_stack)
    }

    /// What there is of the present model and episode; after a switch, of the switches before it until the new
    /// beliefs are there.
    fn answered(&self) -> Option<&Answer> {
        self.answer
            .as_ref()
            .filter(|answer| answer.target == self.target)
    }

    fn opened(&self) -> Option<&Arc<Opened>> {
        self.answered()?.opened.as_ref()
    }

    /// T of the episode under the cursor; 0 until it is read.
    fn steps(&self) -> usize {
        self.opened().map_or(0, |opened| opened.steps())
    }

    /// Puts the cursor on a step of an episode that may be yet to be read.
    fn seek_when_open(&mut self, step: usize) {
        match self.opened().map(|opened| opened.steps()) {
            Some(steps) => self.playback.seek(step, steps),
            None => self.pending.push_back(Pending::Seek(step)),
        }
    }

    fn is_busy(&self) -> bool {
        let is_done = |answer: &Answer| answer.done && answer.generation == self.generation;
        self.worker.is_some() && !self.answer.as_ref().is_some_and(is_done)
    }

    fn inform(&mut self, text: String) {
        self.put(Message { error: false, text });
    }

    fn complain(&mut self, text: String) {
        self.put(Message { error: true, text });
    }

    fn put(&mut self, message: Message) {
        self.message = Some(message);
        self.told += 1;
    }

    /// Takes newer models, and what the worker has left; true if there was anything of use.
    fn collect(&mut self) -> bool {
        let renewed = self.take_renewed();
        let surveyed = self.collect_survey();
        let answer = self.shared.answers.take();
        answer.is_some_and(|answer| self.take_in(answer)) || renewed || surveyed
    }

    /// Drops an answer to an earlier request; else does what waited for its episode.
    fn take_in(&mut self, answer: Answer) -> bool {
        if answer.generation != self.generation {
            return false;
        }
        let steps = answer.opened.as_ref().map(|opened| opened.steps());
        let done = answer.done;
        let before = self.answer.take();
        self.answer = Some(match before {
            Some(before) if before.target == answer.target => answer.after(&before),
            _ => answer,
        });
        if let Some(steps) = steps {
            if self.playback.cursor >= steps {
                self.playback.seek(steps, steps);
            }
            for pending in std::mem::take(&mut self.pending) {
                match pending {
                    Pending::Command(command) => self.perform(command),
                    Pending::Seek(step) => self.playback.seek(step, steps),
                    Pending::Restoration(restoration) => self.finish(*restoration),
                }
            }
        } else if done {
            // What a state string says of every episode waits for one that can be read.
            self.pending
                .retain(|pending| matches!(pending, Pending::Restoration(_)));
        }
        true
    }

    /// Asks for what is wanted now and is not yet asked for, and shows the new state.
    fn settle(&mut self, cursor_before: usize) {
        let wanted = self.wanted();
        let is_new = self.wanted.as_ref() != Some(&wanted);
        let moved = self.playback.cursor != cursor_before;
        if is_new {
            self.generation += 1;
            self.wanted = Some(wanted);
        }
        if is_new || (moved && self.is_busy()) {
            self.shared.requests.put(Request {
                generation: self.generation,
                target: self.target,
                settings: self.settings.clone(),
                cursor: self.playback.cursor,
                other: self.other(),
                wants: self.wants,
                known: self.known.get(&self.target.model).map(Arc::clone),
            });
        }
        self.ask_survey();
        self.refresh();
    }

    /// What there should be now.
    fn wanted(&self) -> Wanted {
        let detailed = self.wants.lattice || self.wants.spread;
        Wanted {
            target: self.target,
            other: self.other(),
            settings: Settings {
                scope: Scope::default(),
                ..self.settings.clone()
            },
            wants: self.wants,
            detail: detailed.then_some(self.playback.cursor),
            known: self.known.get(&self.target.model).map(|k| k.episodes),
        }
    }

    /// The model beside the present one: the chosen one, else the next.
    fn other(&self) -> Option<usize> {
        let count = self.models.len();
        let chosen = self.compare.filter(|&model| model < count);
        let other = chosen.filter(|&model| model != self.target.model);
        other.or_else(|| (count > 1).then(|| (self.target.model + 1) % count))
    }

    fn refresh(&mut self) {
        self.shown = self.show();
        self.news = true;
        self.tell();
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        self.end_survey();
        self.shared.requests.close();
        if let Some(worker) = self.worker.take() {
            // The worker catches panics; one that got past it has nothing left to tell.
            let _ = worker.join();
        }
    }
}
