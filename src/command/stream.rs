//! `--rerun`: streams what a session shows to a running Rerun viewer, from a thread of its own.

use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use anyhow::{Context, bail};
use hyper::Uri;

use super::open::Opened;
use crate::export::rerun::{self, live::Live};
use crate::session::Session;
use crate::session::snapshot::Message;

/// How long a viewer may take to answer at the start.
const PATIENCE: Duration = Duration::from_secs(2);

/// The longest that the last step may take when all else has ended.
const FAREWELL: Duration = Duration::from_secs(3);

/// A stream that goes on until this is dropped.
pub struct Streaming {
    ends: Arc<AtomicBool>,
    wake: SyncSender<()>,
    /// Cut off by the thread's end.
    ended: Receiver<()>,
}

/// Begins to stream `session`, which is of `opened`, to the viewer at `url`.
pub fn start(session: &mut Session, opened: &Opened, url: &str) -> anyhow::Result<Streaming> {
    if rerun::is_off() {
        bail!("--rerun: {}", rerun::OFF);
    }
    look_for(url)?;
    let (wake, wakes) = sync_channel(1);
    let waker = wake.clone();
    // A wake that waits already is enough: the newest snapshot is looked at.
    let face = session.attach(Box::new(move || {
        let _ = waker.try_send(());
    }));
    let live = Live::connect(
        Arc::clone(&opened.dataset),
        opened.models.clone(),
        url.to_owned(),
    );
    let ends = Arc::new(AtomicBool::new(false));
    let (stop, named) = (Arc::clone(&ends), url.to_owned());
    let (alive, ended) = sync_channel::<()>(0);
    let stream = move || {
        // The stream is closed first, and then it has ended.
        let (_alive, mut live) = (alive, live);
        loop {
            if let Err(error) = live.show(&face.snapshot()) {
                face.say(Message {
                    error: true,
                    text: format!("Rerun at {named}: {error}"),
                });
                return;
            }
            if wakes.recv().is_err() || stop.load(Ordering::Relaxed) {
                return;
            }
        }
    };
    let thread = thread::Builder::new().name("poescope-rerun".to_owned());
    thread
        .spawn(stream)
        .context("starting a thread for Rerun")?;
    session.say(Message {
        error: false,
        text: format!("streaming to Rerun at {url}"),
    });
    Ok(Streaming { ends, wake, ended })
}

impl Drop for Streaming {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        let _ = self.wake.try_send(());
        // The SDK waits for good for a viewer that has stopped: then the process ends without it.
        let _ = self.ended.recv_timeout(FAREWELL);
    }
}

/// The SDK would connect to nobody without a word.
fn look_for(url: &str) -> anyhow::Result<()> {
    let not_one =
        || format!("--rerun: {url:?} is no address like rerun+http://127.0.0.1:9876/proxy");
    let uri: Uri = url.parse().with_context(not_one)?;
    let (Some(host), Some(port), true) = (uri.host(), uri.port_u16(), url.starts_with("rerun+"))
    else {
        bail!(not_one());
    };
    let host = host.trim_matches(['[', ']']);
    let mut addresses = (host, port).to_socket_addrs().with_context(not_one)?;
    if addresses.any(|address| TcpStream::connect_timeout(&address, PATIENCE).is_ok()) {
        return Ok(());
    }
    bail!(
        "--rerun: no viewer answers at {host}:{port}; start one with `rerun`, or name its address"
    )
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use std::net::TcpListener;

    use super::*;

    #[test]
    fn a_viewer_that_is_not_there_is_told_at_once() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let url = format!("rerun+http://127.0.0.1:{port}/proxy");
        look_for(&url).unwrap();
        drop(listener);
        let told = look_for(&url).unwrap_err().to_string();
        assert!(told.contains("start one with `rerun`"), "{told}");
    }

    #[test]
    fn what_is_no_address_is_told_with_one_that_is() {
        for url in [
            "127.0.0.1:9876",
            "rerun+http://127.0.0.1/proxy",
            "http://127.0.0.1:9876/proxy",
            "",
        ] {
            let told = look_for(url).unwrap_err().to_string();
            assert!(
                told.contains("rerun+http://127.0.0.1:9876/proxy"),
                "{url}: {told}"
            );
        }
    }
}
