//! What the user sees of an export while it runs, and how it is stopped.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::ProgressBar;

use crate::command::{note, progress_bar};
use crate::export::drive::Onlooker;

/// Names come from recordings, and a terminal would obey what is not to be read in them.
fn plain(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// A bar on standard error, where that is a terminal.
pub(super) struct Progress {
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
}

impl Progress {
    /// Of so many episodes; `stop` is set by a signal.
    pub(super) fn new(episodes: usize, stop: Arc<AtomicBool>) -> Self {
        let bar = progress_bar(episodes, "{bar:30} {pos}/{len} episodes, {eta} left: {msg}");
        Self { bar, stop }
    }

    /// The episodes are written; what is left is to close the file.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Onlooker for Progress {
    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn begins(&mut self, episode: &str) {
        self.bar.set_message(plain(episode));
    }

    fn done(&mut self) {
        self.bar.inc(1);
    }

    fn note(&mut self, text: &str) {
        let text = plain(text);
        self.bar.suspend(|| note(&format!("poescope: {text}")));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
