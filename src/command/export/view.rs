//! `export --figure view`: what the terminal shows, as a picture.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, bail};
use ratatui::layout::Size;

use crate::cli::ExportArgs;
use crate::command::open::{self, Opened};
use crate::export::drive::{Source, provenance_of, wait};
use crate::export::output::Output;
use crate::export::png;
use crate::session::Session;
use crate::session::command::Command;
use crate::session::keys::parse_script;
use crate::session::state::State;
use crate::tui::app::{App, Flow};
use crate::tui::face::Face;
use crate::tui::picture;
use crate::tui::theme::Depth;

/// Opens, sends the keys, draws; `stop` is set by a signal.
pub(super) fn run(args: &ExportArgs, stop: &AtomicBool) -> anyhow::Result<()> {
    if args.split.is_some() || args.episode.len() > 1 || args.steps.is_some() {
        bail!("--figure view is of one moment: --episode names its episode, --state its step too");
    }
    let keys = parse_script(args.keys.as_deref().unwrap_or_default()).context("--keys")?;
    let stops = || stop.load(Ordering::Relaxed);
    let output = Output::create(&args.out, args.force)?;
    let folders = open::folders(&args.model, args.data.as_ref())?;
    let Opened { dataset, models } =
        open::open(args.data.as_ref(), &args.mapping.topics, &folders)?;
    let face = Face {
        depth: Depth::True,
        ..Face::default()
    };
    let session = Session::new(Arc::clone(&dataset) as _, models.clone());
    let mut app = App::new(session, face, Size::new(args.size.0, args.size.1));
    if let Some(state) = &args.state {
        app.session.apply(Command::Restore(state.clone()));
        wait(&mut app.session, stops)?;
        let told = app.session.snapshot().message;
        if let Some(told) = told.filter(|message| message.error) {
            bail!("--state: {}", told.text);
        }
    }
    if args.state.is_none() && args.keys.is_none() {
        app.session.apply(Command::FirstPredicted);
    }
    if !args.episode.is_empty() {
        let episodes = super::choose::episodes(&dataset, &app.session, args, None, || Ok(0))?;
        app.session.apply(Command::SelectEpisode(episodes[0]));
    }
    for key in &keys {
        wait(&mut app.session, stops)?;
        if app.press(key) == Flow::Quit {
            bail!("--keys: they quit, so there is nothing to draw");
        }
    }
    wait(&mut app.session, stops)?;
    let snapshot = app.session.snapshot();
    let drawn = picture(&snapshot, &app.face, args.size);
    let source = Source {
        episodes: dataset.as_ref(),
        models: &models,
    };
    let mut facts = provenance_of(source, &State::parse(&snapshot.state).0, None).facts();
    facts.insert("figure".to_owned(), "view".to_owned());
    facts.insert("state".to_owned(), snapshot.state);
    png::save(output, [drawn.width, drawn.height], &drawn.pixels, &facts)?;
    Ok(())
}
