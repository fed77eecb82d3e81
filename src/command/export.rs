//! `export`: takes a session through episodes and writes what it shows as a file for other tools.

mod choose;
mod progress;
mod sink;
mod view;

use std::sync::Arc;

use anyhow::{Context, anyhow, bail};

use self::progress::Progress;
use super::open::{self, Opened};
use crate::cli::{ExportArgs, ExportFormat, Figure};
use crate::export::drive::{Plan, Source, drive};
use crate::session::state::State;
use crate::session::{Session, model_key};

/// Runs it.
pub fn run(args: &ExportArgs) -> anyhow::Result<()> {
    let format = args.format.or_else(|| sink::by_ending(&args.out));
    let Some(format) = format else {
        bail!(
            "{}: its ending says no format; name one with --format",
            args.out.display()
        );
    };
    let of_view = format == ExportFormat::Png && args.figure == Figure::View;
    if args.keys.is_some() && !of_view {
        bail!("--keys: only a PNG of --figure view has keys to press");
    }
    if format != ExportFormat::Png && (args.every.is_some() || args.zoom.is_some()) {
        bail!("--every and --zoom: only a PNG has them; choose steps with --steps");
    }
    let state = args.state.as_deref().map(read).transpose()?;
    let stop = super::stop_on_signals()?;
    if of_view {
        return view::run(args, &stop);
    }
    let folders = open::folders(&args.model, args.data.as_ref())?;
    let Opened { dataset, models } =
        open::open(args.data.as_ref(), &args.mapping.topics, &folders)?;
    let infos: Vec<_> = models.iter().map(|m| Arc::new(m.info().clone())).collect();
    if let Some(name) = state.as_ref().and_then(|state| state.model.as_ref())
        && !(0..infos.len()).any(|model| model_key(&infos, model) == *name)
    {
        bail!("--state: no model named {name:?} is loaded; add it with --model FOLDER");
    }
    let mut session = Session::new(Arc::clone(&dataset) as _, models.clone());
    let plan = Plan {
        episodes: choose::episodes(&dataset, &session, args, state.as_ref(), || {
            Ok(open::Training::of(&folders[0])?.split_seed())
        })?,
        split: args.split,
        steps: choose::steps(args, state.as_ref()),
        state,
    };
    // Before the work begins: an --out that cannot be written should not cost an hour.
    let mut sink = sink::sink(format, args, &dataset)?;
    let mut progress = Progress::new(plan.episodes.len(), stop);
    let source = Source {
        episodes: dataset.as_ref(),
        models: &models,
    };
    let blind = drive(&mut session, source, &plan, sink.as_mut(), &mut progress)?;
    progress.finish();
    sink.finish()?;
    match blind {
        None => Ok(()),
        Some(why) => bail!(
            "{}: written, but without any belief: {why}",
            args.out.display()
        ),
    }
}

/// Reads a state string; what it says wrongly is refused, what means nothing here is told.
fn read(text: &str) -> anyhow::Result<State> {
    let (state, complaints) = State::parse(text);
    if !complaints.is_empty() {
        return Err(anyhow!(complaints.join("; "))).context("--state");
    }
    if !state.unknown.is_empty() {
        let keys: Vec<&str> = state.unknown.iter().map(|(key, _)| key.as_str()).collect();
        super::note(&format!(
            "--state: without a meaning here: {}",
            keys.join(", ")
        ));
    }
    Ok(state)
}
