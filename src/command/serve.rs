//! `serve`: opens a dataset and models for browsers, and stays until it is ended.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Instant;

use anyhow::Context;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use super::say;
use super::view::{self, Opening, cache, follow};
use crate::cli::{ServeArgs, ViewArgs};
use crate::session::Session;
use crate::session::command::Command;
use crate::web::assets::Assets;
use crate::web::server::{Options, Server};

/// Wakes that may wait; one is enough to have the session look.
const QUEUE: usize = 4;

/// What wakes the session.
enum Wake {
    /// Something was computed or asked for.
    Done,
    /// The process is to end.
    End,
}

/// Opens and serves.
pub fn run(args: ServeArgs) -> anyhow::Result<()> {
    let assets = match &args.web_root {
        Some(folder) => {
            Assets::of_folder(folder).with_context(|| format!("--web-root {}", folder.display()))?
        }
        None => Assets::built_in(),
    };
    // Before anything is served: a signal must never find nobody listening.
    let signals = Signals::new([SIGINT, SIGTERM, SIGHUP]).context("listening for signals")?;
    let address = SocketAddr::new(args.host, args.port);
    let Opening {
        mut session,
        watched,
        opened,
    } = view::open(&ViewArgs {
        path: args.path,
        data: args.data,
        model: args.model,
        mapping: args.mapping,
        ..ViewArgs::default()
    })?;
    if let Some(cache) = cache::Folder::of_user() {
        session.keep_scores_in(Arc::new(cache));
    }
    if let Some(state) = args.state {
        session.apply(Command::Restore(state));
    } else {
        session.apply(Command::FirstPredicted);
    }
    view::warn(&mut session, &opened);
    let options = Options {
        address,
        read_only: args.read_only,
        assets,
    };
    let server = Server::start(&mut session, options).with_context(|| cannot(address))?;
    let _stream = view::stream(&mut session, &opened, args.rerun.as_deref())?;
    let (sender, events) = sync_channel(QUEUE);
    let waker = sender.clone();
    // A full queue needs no further wake: the session is about to look anyway.
    session.set_waker(Box::new(move || drop(waker.try_send(Wake::Done))));
    end_on(signals, sender)?;
    let follower = follow::Follower::start(watched, follow::PERIOD, session.renewal());
    let _follower = follower.context("starting a thread to watch the models")?;
    session.survey();
    say(&told(&server))?;
    drive(&mut session, &events);
    Ok(())
}

/// Lets browsers look at a session that the terminal owns; who does is to say where.
pub fn attach(
    session: &mut Session,
    address: SocketAddr,
    read_only: bool,
) -> anyhow::Result<Server> {
    let options = Options {
        address,
        read_only,
        assets: Assets::built_in(),
    };
    Server::start(session, options).with_context(|| cannot(address))
}

fn cannot(address: SocketAddr) -> String {
    format!("cannot serve at {address}; name another --port, or another address")
}

/// Where it is to be found.
fn told(server: &Server) -> String {
    let (url, near) = (server.url(), server.near());
    let port = near.port();
    let tunnel = format!("ssh -L {port}:{near} THIS_HOST, then http://127.0.0.1:{port}/");
    match server.token() {
        None => format!("{url}\nfrom another machine: {tunnel}\n"),
        Some(token) => format!(
            "{url}\nfrom another machine: http://THIS_HOST:{port}/?token={token}\nor: {tunnel}?token={token}\n"
        ),
    }
}

/// Passes the first signal on.
fn end_on(mut signals: Signals, sender: SyncSender<Wake>) -> anyhow::Result<()> {
    let listen = move || {
        if signals.forever().next().is_some() {
            // Where the session has ended already there is nobody to tell.
            let _ = sender.send(Wake::End);
        }
    };
    let thread = thread::Builder::new().name("poescope-signals".to_owned());
    thread
        .spawn(listen)
        .context("starting a thread for signals")?;
    Ok(())
}

/// Lets the session work until it is to end. With nothing to play or compute it sleeps.
fn drive(session: &mut Session, events: &Receiver<Wake>) {
    let mut before = Instant::now();
    loop {
        let now = Instant::now();
        session.update(now - before);
        before = now;
        let first = match session.next_wake() {
            Some(soon) => match events.recv_timeout(soon) {
                Ok(wake) => Some(wake),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            },
            None => match events.recv() {
                Ok(wake) => Some(wake),
                Err(_) => return,
            },
        };
        let mut wakes = first.into_iter().chain(events.try_iter().take(QUEUE));
        if wakes.any(|wake| matches!(wake, Wake::End)) {
            return;
        }
    }
}
