//! `e`: what is on screen as a file beside the work, written while the session goes on.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use crate::command::open::Opened;
use crate::data::Dataset;
use crate::export::drive::{Onlooker, Plan, Source, drive};
use crate::export::{ExportError, Sink};
use crate::session::Session;
use crate::session::predict::Predictor;
use crate::session::snapshot::{Message, Snapshot};
use crate::session::state::State;
use crate::tui::app::TakeAlong;

/// Ending of the files.
const ENDING: &str = if cfg!(feature = "rerun") {
    "rrd"
} else {
    "mcap"
};

/// For the session of `opened`; `folder` is where files go.
pub(super) fn taker(session: &mut Session, opened: &Opened, folder: PathBuf) -> TakeAlong {
    let face = session.attach(Box::new(|| {}));
    let (dataset, models) = (Arc::clone(&opened.dataset), opened.models.clone());
    let busy = Arc::new(AtomicBool::new(false));
    Box::new(move |shown| {
        if busy.swap(true, Ordering::AcqRel) {
            return told(true, "the last export is still being written");
        }
        let job = Job {
            dataset: Arc::clone(&dataset),
            models: on_screen(shown, &models),
            plan: Plan {
                episodes: vec![shown.episode_index],
                state: Some(State::parse(&shown.state).0),
                ..Plan::default()
            },
            out: free_name(&folder, shown),
        };
        let name = job.out.display().to_string();
        let (face, done) = (face.clone(), Arc::clone(&busy));
        let work = move || {
            face.say(job.run());
            done.store(false, Ordering::Release);
        };
        match thread::Builder::new()
            .name("poescope-export".to_owned())
            .spawn(work)
        {
            Ok(_) => told(false, &format!("writing {name}")),
            Err(error) => {
                busy.store(false, Ordering::Release);
                told(true, &format!("starting a thread for {name}: {error}"))
            }
        }
    })
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
    fn run(&self) -> Message {
        let mut heard = Heard::default();
        match self.write(&mut heard) {
            Ok(()) => told(
                false,
                &format!("written: {}{}", self.out.display(), heard.0),
            ),
            Err(error) => told(true, &error.to_string()),
        }
    }

    fn write(&self, heard: &mut Heard) -> Result<(), ExportError> {
        let mut sink = self.sink()?;
        let mut session = Session::new(Arc::clone(&self.dataset) as _, self.models.clone());
        let source = Source {
            episodes: self.dataset.as_ref(),
            models: &self.models,
        };
        drive(&mut session, source, &self.plan, sink.as_mut(), heard)?;
        sink.finish()
    }

    #[cfg(feature = "rerun")]
    fn sink(&self) -> Result<Box<dyn Sink>, ExportError> {
        use crate::export::rerun::Recording;
        Ok(Box::new(Recording::create(
            &self.out,
            false,
            Arc::clone(&self.dataset),
        )?))
    }

    #[cfg(not(feature = "rerun"))]
    fn sink(&self) -> Result<Box<dyn Sink>, ExportError> {
        use crate::export::mcap::Recording;
        Ok(Box::new(Recording::create(
            &self.out,
            false,
            Arc::clone(&self.dataset),
        )?))
    }
}

/// What is to be told besides.
#[derive(Default)]
struct Heard(String);

impl Onlooker for Heard {
    fn stops(&self) -> bool {
        false
    }

    fn begins(&mut self, _: &str) {}

    fn done(&mut self) {}

    fn note(&mut self, text: &str) {
        self.0 += "; ";
        self.0 += text;
    }
}
