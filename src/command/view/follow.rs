//! Watches the folders of training runs for a newer checkpoint, on a thread that does nothing else.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::Builder;
use std::time::{Duration, SystemTime};

use crate::command::open;
use crate::model::checkpoint::{self, CONFIG, PROBE, WEIGHTS};
use crate::session::Found;
use crate::session::renew::Renewal;

/// Time between two looks at the files.
pub const PERIOD: Duration = Duration::from_secs(2);

/// When each file of a checkpoint was written and how long it is; none for one that is not there.
type Stamp = [Option<(SystemTime, u64)>; 3];

/// A model's folder, and how it was when the model was read.
#[derive(Debug)]
pub struct Watched {
    /// The model's index in the session.
    index: usize,
    folder: PathBuf,
    stamp: Stamp,
}

impl Watched {
    /// A training run's folder, as it is before its checkpoint is read; none for weights that are of no run.
    pub fn new(index: usize, folder: &Path) -> Option<Self> {
        let stamp = stamp(folder);
        checkpoint::update_of(folder).map(|_| Self {
            index,
            folder: folder.to_owned(),
            stamp,
        })
    }

    /// What has been written since the last look; none if nothing was.
    fn look(&mut self) -> Option<Found> {
        let stamp = stamp(&self.folder);
        if stamp == self.stamp {
            return None;
        }
        // Before reading: what is written meanwhile is for the next look.
        self.stamp = stamp;
        Some(open::model(&self.folder).map_err(|error| format!("{error:#}")))
    }
}

fn stamp(folder: &Path) -> Stamp {
    [CONFIG, WEIGHTS, PROBE].map(|file| {
        let metadata = std::fs::metadata(folder.join(file)).ok()?;
        Some((metadata.modified().ok()?, metadata.len()))
    })
}

/// Watches until it is dropped.
#[derive(Debug)]
pub struct Follower {
    _until_dropped: SyncSender<()>,
}

impl Follower {
    /// Looks every `period`; no thread for nothing to watch.
    pub fn start(
        mut watched: Vec<Watched>,
        period: Duration,
        renewal: Renewal,
    ) -> io::Result<Self> {
        let (until_dropped, ended) = sync_channel(1);
        if !watched.is_empty() {
            Builder::new()
                .name("poescope-follow".to_owned())
                .spawn(move || follow(&mut watched, period, &renewal, &ended))?;
        }
        Ok(Self {
            _until_dropped: until_dropped,
        })
    }
}

fn follow(watched: &mut [Watched], period: Duration, renewal: &Renewal, ended: &Receiver<()>) {
    while ended.recv_timeout(period) == Err(RecvTimeoutError::Timeout) {
        for model in &mut *watched {
            if let Some(found) = model.look() {
                renewal.offer(model.index, found);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use std::sync::Arc;

    use candle_core::{DType, Device};

    use super::*;
    use crate::model::Model;
    use crate::model::config::Config;
    use crate::session::Session;
    use crate::session::command::Command;
    use crate::session::fake::FakeSource;

    #[test]
    fn a_session_on_a_running_run_follows_its_checkpoints() {
        let run = tempfile::tempdir().unwrap();
        let save = |seed, update| {
            let config = Config::named("v").unwrap();
            let model = Model::new(config, seed, &Device::Cpu).unwrap();
            checkpoint::save(&model, run.path(), DType::F16, update).unwrap();
        };
        save(1, None);
        assert!(Watched::new(0, run.path()).is_none(), "of no run");
        save(1, Some(30));
        let watched = Watched::new(0, run.path()).unwrap();
        let mut session = Session::new(
            Arc::new(FakeSource::new(3)),
            vec![open::model(run.path()).unwrap()],
        );
        let (wake, woken) = sync_channel(64);
        session.set_waker(Box::new(move || wake.try_send(()).unwrap_or_default()));
        session.apply(Command::SelectEpisode(1));
        session.apply(Command::SeekTo(6));
        let patience = Duration::from_mins(1);
        assert!(session.wait_idle(patience));
        let old = session.snapshot();
        let follower = Follower::start(vec![watched], Duration::from_millis(5), session.renewal());
        let _follower = follower.unwrap();

        save(2, Some(60));
        while session.snapshot().models[0].update != Some(60) {
            woken.recv_timeout(patience).unwrap();
            session.update(Duration::ZERO);
        }
        assert!(session.wait_idle(patience));
        let new = session.snapshot();
        assert_eq!(old.models[0].update, Some(30));
        assert_eq!(
            (new.cursor, new.episode_index, &new.state),
            (5, 1, &old.state)
        );
        assert_eq!(new.message, None);
        assert!(new.frames.belief.is_some() && new.frames.belief != old.frames.belief);
    }
}
