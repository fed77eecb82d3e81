//! `e`: what is on screen as a file beside the work, written while the session goes on.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use crate::command::open::Opened;
use crate::data::Dataset;
use crate::export::drive::{Onlooker, Plan, Source, drive};
use crate::export::{ExportError, Sink};
use crate::session::Session;
use crate::session::attach::Attached;
use crate::session::predict::Predictor;
use crate::session::snapshot::{Message, Snapshot};
use crate::session::state::State;
use crate::tui::app::TakeAlong;

#[cfg(not(feature = "rerun"))]
use crate::export::mcap::Recording;
#[cfg(feature = "rerun")]
use crate::export::rerun::Recording;

/// Ending of the files.
const ENDING: &str = if cfg!(feature = "rerun") {
    "rrd"
} else {
    "mcap"
};

/// For the session of `opened`; `folder` is where files go. Dropped, it breaks off what is still being written.
pub(super) fn taker(session: &mut Session, opened: &Opened, folder: PathBuf) -> TakeAlong {
    let face = session.attach(Box::new(|| {}));
    let dataset = Arc::clone(&opened.dataset);
    let mut last: Option<Writing> = None;
    Box::new(move |shown| {
        if last.as_ref().is_some_and(Writing::goes_on) {
            return told(true, "the last export is still being written");
        }
        let state = State::parse(&shown.state).0;
        let job = Job {
            dataset: Arc::clone(&dataset),
            models: on_screen(shown, &face.models()),
            plan: Plan {
                episodes: vec![shown.episode_index],
                steps: state.selected(),
                state: Some(state),
                ..Plan::default()
            },
            out: free_name(&folder, shown),
        };
        let name = job.out.display().to_string();
        match Writing::start(job, face.clone()) {
            Ok(writing) => {
                last = Some(writing);
                told(false, &format!("writing {name}"))
            }
            Err(error) => told(true, &format!("starting a thread for {name}: {error}")),
        }
    })
}

/// An export on a thread of its own.
struct Writing {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Writing {
    fn start(job: Job, face: Attached) -> io::Result<Self> {
        let stop = Arc::new(AtomicBool::new(false));
        let heard = Heard {
            stop: Arc::clone(&stop),
            notes: String::new(),
        };
        let thread = thread::Builder::new().name("poescope-export".to_owned());
        let thread = Some(thread.spawn(move || face.say(job.run(heard)))?);
        Ok(Self { stop, thread })
    }

    fn goes_on(&self) -> bool {
        self.thread
            .as_ref()
            .is_some_and(|thread| !thread.is_finished())
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // It leaves nothing half-written behind; what went wrong it has said.
            let _ = thread.join();
        }
    }
}

fn told(error: bool, text: &str) -> Message {
    Message {
        error,
        text: text.to_owned(),
    }
}

/// The model that is shown, and the one beside it.
fn on_screen(shown: &Snapshot, models: &[Arc<dyn Predictor>]) -> Vec<Arc<dyn Predictor>> {
    let other = shown.other.as_ref().map(|other| other.model);
    let both = std::iter::once(shown.model).chain(other);
    both.filter_map(|model| models.get(model).cloned())
        .collect()
}

/// `poescope-EPISODE.rrd`, with a number where there is one already.
fn free_name(folder: &Path, shown: &Snapshot) -> PathBuf {
    let id = shown
        .episode
        .as_ref()
        .map_or("episode", |episode| episode.id.as_str());
    let plain = |c: char| {
        if c.is_alphanumeric() || c == '-' || c == '_' {
            c
        } else {
            '_'
        }
    };
    let id: String = id.chars().map(plain).collect();
    let named = |n: usize| match n {
        1 => folder.join(format!("poescope-{id}.{ENDING}")),
        n => folder.join(format!("poescope-{id}-{n}.{ENDING}")),
    };
    let mut n = 1;
    while named(n).exists() {
        n += 1;
    }
    named(n)
}

/// One export.
struct Job {
    dataset: Arc<Dataset>,
    models: Vec<Arc<dyn Predictor>>,
    plan: Plan,
    out: PathBuf,
}

impl Job {
    /// Does it, and says how it went.
    fn run(&self, mut heard: Heard) -> Message {
        match self.write(&mut heard) {
            Ok(()) => {
                let (out, notes) = (self.out.display(), heard.notes);
                told(false, &format!("written: {out}{notes}"))
            }
            Err(error) => told(true, &error.to_string()),
        }
    }

    fn write(&self, heard: &mut Heard) -> Result<(), ExportError> {
        let recording = Recording::create(&self.out, false, Arc::clone(&self.dataset))?;
        let mut sink: Box<dyn Sink> = Box::new(recording);
        let mut session = Session::new(Arc::clone(&self.dataset) as _, self.models.clone());
        let source = Source {
            episodes: self.dataset.as_ref(),
            models: &self.models,
        };
        drive(&mut session, source, &self.plan, sink.as_mut(), heard)?;
        sink.finish()
    }
}

/// What is to be told besides, and whether to go on.
struct Heard {
    stop: Arc<AtomicBool>,
    notes: String,
}

impl Onlooker for Heard {
    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn begins(&mut self, _: &str) {}

    fn done(&mut self) {}

    fn note(&mut self, text: &str) {
        self.notes += "; ";
        self.notes += text;
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use std::time::Duration;

    use super::*;
    use crate::command::open;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn it_takes_a_name_that_is_free_and_an_end_leaves_no_half_file() {
        let folder = tempfile::tempdir().unwrap();
        let mine = folder.path().join(format!("poescope-ep00000.{ENDING}"));
        std::fs::write(&mine, b"mine").unwrap();
        let opened = open::open(None, &[], &open::folders(&[], None).unwrap()).unwrap();
        let mut session = Session::new(Arc::clone(&opened.dataset) as _, opened.models.clone());
        assert!(session.wait_idle(Duration::from_mins(2)));
        let mut take = taker(&mut session, &opened, folder.path().to_owned());
        let said = take(&session.snapshot());
        assert!(
            !said.error && said.text.contains("poescope-ep00000-2"),
            "{}",
            said.text
        );
        let written = |session: &Session| {
            session
                .snapshot()
                .message
                .is_some_and(|m| m.text.starts_with("written"))
        };
        while !written(&session) {
            session.update(Duration::from_millis(1));
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(std::fs::read(&mine).unwrap(), b"mine");
        assert!(names(folder.path()).contains(&format!("poescope-ep00000-2.{ENDING}")));
        take(&session.snapshot());
        drop(take);
        let left = names(folder.path());
        assert!(
            !left.iter().any(|name| name.contains("partial")),
            "{left:?}"
        );
    }
}
