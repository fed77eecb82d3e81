//! `view`: opens a dataset and models, sends keys, and draws: once as text, or in the terminal until the user quits.

pub(super) mod cache;
mod failures;
pub(super) mod follow;
mod report;
mod take_along;

use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, bail};
use crossterm::terminal::size as terminal_size;
use ratatui::layout::Size;
use ratatui_image::picker::ProtocolType;

use self::follow::{Follower, Watched};
use self::report::Report;
use super::open::{self, Opened};
use super::{say, serve};
use crate::cli::{Colors, ImageProtocol, ViewArgs};
use crate::session::Session;
use crate::session::command::Command;
use crate::session::keys::{Key, parse_script};
use crate::session::snapshot::Message;
use crate::tui::app::{App, Flow};
use crate::tui::face::Face;
use crate::tui::terminal::{self, Ended, Images};
use crate::tui::theme::Depth;

/// The longest that one key of `--keys` may have the model compute.
const PATIENCE: Duration = Duration::from_mins(2);

/// Opens and shows.
pub fn run(args: &ViewArgs) -> anyhow::Result<()> {
    let keys = parse_script(args.keys.as_deref().unwrap_or_default()).context("--keys")?;
    let report = Report::asked(args);
    let in_terminal = report.is_none() && io::stdout().is_terminal();
    if !in_terminal && report.is_none() {
        super::note(
            "poescope: standard output is no terminal, so one frame is drawn as with --print",
        );
    }
    if !in_terminal && args.serve.is_some() {
        bail!("--serve needs a terminal here; `poescope serve` needs none");
    }
    if !in_terminal && args.rerun.is_some() {
        bail!("--rerun needs a terminal here; `poescope serve --rerun` needs none");
    }
    let size = if in_terminal {
        terminal_size().unwrap_or(args.size)
    } else {
        args.size
    };
    let face = Face {
        depth: depth(args.color, in_terminal),
        ..Face::default()
    };
    let Opening {
        session,
        watched,
        opened,
    } = open(args)?;
    let mut app = App::new(session, face, Size::new(size.0, size.1));
    if let Some(cache) = cache::Folder::of_user() {
        app.session.keep_scores_in(Arc::new(cache));
    }
    if arrive(&mut app, args, &keys, in_terminal)? == Flow::Quit {
        return Ok(());
    }
    warn(&mut app.session, &opened);
    if report == Some(Report::Failures) {
        wait(&mut app)?;
        app.session.apply(Command::Failure(1));
    }
    if in_terminal {
        stay(app, args, &opened, watched)
    } else {
        wait(&mut app)?;
        tell(&app, report.unwrap_or(Report::Frame), size)
    }
}

/// Goes where the arguments say: to a state, or to the first predicted step; then by keys, and into an order of episodes.
fn arrive(app: &mut App, args: &ViewArgs, keys: &[Key], in_terminal: bool) -> anyhow::Result<Flow> {
    if let Some(state) = &args.state {
        app.session.apply(Command::Restore(state.clone()));
        // In the terminal it goes on while its episode is read, but for the address of --serve, whose place it must not
        // take once it is answered. What is asked of another episode or model than there is must not be answered for
        // this one.
        if !in_terminal || args.serve.is_some() {
            wait(app)?;
        }
        if !in_terminal && let Some(Message { error: true, text }) = app.session.snapshot().message
        {
            bail!("--state: {text}");
        }
    } else if args.keys.is_none() {
        app.session.apply(Command::FirstPredicted);
    }
    if send(app, keys)? == Flow::Quit {
        return Ok(Flow::Quit);
    }
    if let Some(order) = args.rank {
        // What a state string says of it comes with its episode.
        wait(app)?;
        app.session.apply(Command::RankBy(order));
    }
    Ok(Flow::Go)
}

/// Says what is shown, once.
fn tell(app: &App, report: Report, size: (u16, u16)) -> anyhow::Result<()> {
    let snapshot = app.session.snapshot();
    if report == Report::Failures && snapshot.table.queue.is_empty() {
        bail!(
            "--failures: {}",
            snapshot
                .message
                .map_or("nothing could be scored".to_owned(), |m| m.text)
        );
    }
    say(&report.of(&app.session, &app.face, size)?)
}

/// Shows it in the terminal until the user quits, and to browsers and viewers that were asked for.
fn stay(
    mut app: App,
    args: &ViewArgs,
    opened: &Opened,
    watched: Vec<Watched>,
) -> anyhow::Result<()> {
    app.session.survey();
    let server = args
        .serve
        .map(|address| serve::attach(&mut app.session, address, args.read_only));
    let server = server.transpose()?;
    let _stream = stream(&mut app.session, opened, args.rerun.as_deref())?;
    if let Some(server) = &server {
        announce(&mut app.session, &server.url(), args.rerun.as_deref());
        app.face.address = Some(server.url());
    }
    let folder = std::env::current_dir().unwrap_or_default();
    app.take_along = Some(take_along::taker(&mut app.session, opened, folder));
    let follower = Follower::start(watched, follow::PERIOD, app.session.renewal());
    let _follower = follower.context("starting a thread to watch the models")?;
    match terminal::run(&mut app, images(args.images)).context("the terminal")? {
        Ended::Quit => Ok(()),
        Ended::Signal(signal) => {
            // What is being written is broken off, so that no half file stays.
            app.take_along = None;
            // The terminal is itself again; now end as the signal asks, so that the caller sees it.
            signal_hook::low_level::emulate_default_handler(signal).context("ending on a signal")
        }
    }
}

/// Says where browsers may join, together with the stream, whose own message would take its place.
fn announce(session: &mut Session, url: &str, rerun: Option<&str>) {
    let stream = rerun.map_or_else(String::new, |to| format!("; streaming to Rerun at {to}"));
    session.say(Message {
        error: false,
        text: format!("also at {url}{stream}"),
    });
}

/// A session that was opened.
pub(super) struct Opening {
    pub session: Session,
    /// The folders that training runs write to, to be watched.
    pub watched: Vec<Watched>,
    /// What it is of.
    pub opened: Opened,
}

/// Says what of the recordings is not there, where nothing else is to be said.
pub(super) fn warn(session: &mut Session, opened: &Opened) {
    let text = opened.dataset.warnings().join("; ");
    if !text.is_empty() && session.snapshot().message.is_none() {
        session.say(Message { error: false, text });
    }
}

/// Opens what the arguments name.
pub(super) fn open(args: &ViewArgs) -> anyhow::Result<Opening> {
    let data = args.path.as_ref().or(args.data.as_ref());
    let folders = open::folders(&args.model, data)?;
    // Before the models are read: what is written meanwhile is seen.
    let watched = folders.iter().enumerate();
    let watched = watched.filter_map(|(model, folder)| Watched::new(model, folder));
    let watched = watched.collect();
    let opened = open::open(data, &args.mapping.topics, &folders)?;
    let session = Session::new(Arc::clone(&opened.dataset) as _, opened.models.clone());
    Ok(Opening {
        session,
        watched,
        opened,
    })
}

/// Streams to Rerun where that was asked for, for as long as what is returned lives.
#[cfg(feature = "rerun")]
pub(super) fn stream(
    session: &mut Session,
    opened: &Opened,
    url: Option<&str>,
) -> anyhow::Result<Option<super::stream::Streaming>> {
    url.map(|url| super::stream::start(session, opened, url))
        .transpose()
}

/// This build has no Rerun in it.
#[cfg(not(feature = "rerun"))]
pub(super) fn stream(_: &mut Session, _: &Opened, url: Option<&str>) -> anyhow::Result<()> {
    if url.is_some() {
        bail!(
            "--rerun: this build has no Rerun in it; build it with the feature `rerun`, which is on by default"
        );
    }
    Ok(())
}

/// Presses the keys one after the other, each once what the one before it asked for has been computed.
fn send(app: &mut App, keys: &[Key]) -> anyhow::Result<Flow> {
    for key in keys {
        wait(app)?;
        if app.press(key) == Flow::Quit {
            return Ok(Flow::Quit);
        }
    }
    Ok(Flow::Go)
}

fn wait(app: &mut App) -> anyhow::Result<()> {
    loop {
        let scored = app.session.surveyed();
        if app.session.wait_idle(PATIENCE) {
            return Ok(());
        }
        // Scoring a large dataset takes as long as it takes.
        if app.session.surveyed() <= scored {
            bail!("the model has not answered within {} s", PATIENCE.as_secs());
        }
    }
}

/// A printed frame goes to a file or a pager, which says nothing of colours, so only `NO_COLOR` counts there. What was
/// asked for by name wins over all.
fn depth(colors: Colors, in_terminal: bool) -> Depth {
    let variable = |name: &str| std::env::var(name).ok();
    match Depth::detect(variable) {
        _ if colors == Colors::True => Depth::True,
        _ if colors == Colors::Indexed => Depth::Indexed,
        _ if colors == Colors::Sixteen => Depth::Sixteen,
        _ if colors == Colors::Never => Depth::Plain,
        depth if in_terminal => depth,
        _ if variable("NO_COLOR").is_some_and(|value| !value.is_empty()) => Depth::Plain,
        _ => Depth::True,
    }
}

fn images(protocol: ImageProtocol) -> Images {
    match protocol {
        ImageProtocol::Auto => Images::Ask,
        ImageProtocol::Halfblocks => Images::HalfBlocks,
        ImageProtocol::Kitty => Images::Force(ProtocolType::Kitty),
        ImageProtocol::Sixel => Images::Force(ProtocolType::Sixel),
        ImageProtocol::Iterm2 => Images::Force(ProtocolType::Iterm2),
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;
    use crate::session::fake::{FakePredictor, FakeSource};

    fn app() -> App {
        let source = Arc::new(FakeSource::new(3));
        let session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
        App::new(session, Face::default(), Size::new(80, 24))
    }

    #[test]
    fn what_keys_ask_for_is_computed_before_the_next_one() {
        let mut app = app();
        let keys = parse_script("lllll 1 p").unwrap();
        assert_eq!(send(&mut app, &keys).unwrap(), Flow::Go);
        wait(&mut app).unwrap();
        let snapshot = app.session.snapshot();
        assert!(!snapshot.busy);
        assert_eq!((snapshot.cursor, snapshot.start), (5, 5));
        assert!(snapshot.experts[0].alpha.abs() < f32::EPSILON);
    }

    #[test]
    fn a_key_may_end_it() {
        let keys = parse_script("lq l").unwrap();
        assert_eq!(send(&mut app(), &keys).unwrap(), Flow::Quit);
    }

    #[test]
    fn a_script_that_cannot_be_read_is_named() {
        let args = ViewArgs {
            keys: Some("<nokey>".to_owned()),
            print: true,
            ..ViewArgs::default()
        };
        let told = format!("{:#}", run(&args).unwrap_err());
        assert!(
            told.starts_with("--keys: no key is named <nokey>"),
            "{told}"
        );
    }
}
