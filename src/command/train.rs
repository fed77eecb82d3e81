//! `poescope train`: opens a dataset, trains a model on it, leaves a checkpoint with its probe and its report.

mod finish;
mod sets;
mod show;

use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use candle_core::Device;

use self::sets::Sets;
use super::open;
use crate::cli::TrainArgs;
use crate::data::Dataset;
use crate::episode::EpisodeSource;
use crate::model::Model;
use crate::model::checkpoint;
use crate::model::config::{Config, Preset};
use crate::model::kernel::memory::keep_pages;
use crate::train::schedule::Budget;
use crate::train::state::{Origin, STATE, State};
use crate::train::totals::Totals;
use crate::train::{self, Outcome, Run, metrics, statistics};

/// The file that a run holds while it goes on.
const LOCK: &str = ".lock";

/// Runs it.
pub fn run(args: &TrainArgs) -> anyhow::Result<()> {
    let stop = super::stop_on_signals()?;
    let resumed = args.resume.then(|| resume(args)).transpose()?;
    let (mut config, origin) = match &resumed {
        Some((config, origin)) => (config.clone(), Some(origin)),
        None => (fresh_config(args)?, None),
    };
    let threads = args
        .threads
        .or(origin.map(|origin| origin.threads))
        .unwrap_or(0);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .context("starting threads")?;
    keep_pages();
    let dataset = open::dataset(&args.data, &args.mapping.topics)?;
    let origin = match origin {
        Some(origin) => same_run(args, origin, &dataset)?,
        None => Origin {
            command: command_line(),
            seed: args.seed.unwrap_or(0),
            data_hash: dataset.data_hash().to_owned(),
            threads: rayon::current_num_threads(),
            budget: asked(args).unwrap_or(Budget {
                epochs: Some(config.training.epochs),
                ..Budget::default()
            }),
        },
    };
    std::fs::create_dir_all(&args.out).with_context(|| format!("making {}", args.out.display()))?;
    let _lock = lock(&args.out)?;
    let sets = Sets::load(
        &dataset,
        &config,
        origin.seed,
        args.memory,
        &args.out,
        &stop,
    )?;
    if sets.train().len() < config.training.batch {
        bail!(
            "{}: {sets}, where a batch needs {} of split `train`; {}",
            args.data.display(),
            config.training.batch,
            sets.remedy()
        );
    }
    super::note(&format!("{}: {sets}", dataset.name()));
    let totals = Totals::of(sets.train())?;
    statistics::complete(&mut config, &totals);
    if resumed.is_some() {
        same_recipe(args, &config, &totals)?;
    }
    let model = Model::new(config, origin.seed, &Device::Cpu)?;
    let mut state = match resumed {
        Some(_) => State::load(&model, &args.out)?,
        None => State::new(origin.clone()),
    };
    state.origin = origin;
    // A probe belongs to the weights it was fitted on, and those are about to change.
    finish::remove(&args.out)?;
    metrics::forget_after(&args.out, state.update)?;
    let bar = super::progress_bar(1000, "{bar:20} {msg}");
    let run = Run {
        train: sets.train(),
        val: sets.val(),
        folder: &args.out,
        checkpoint_every: Duration::from_secs_f64(args.checkpoint_minutes * 60.0),
        stop: &stop,
    };
    let outcome = train::run(&model, &mut state, run, |progress| {
        show::progress(&bar, progress);
    })?;
    bar.finish_and_clear();
    if state.update > 0 {
        super::note(&format!(
            "saved {}; fitting the position probe",
            args.out.display()
        ));
        finish::write(
            state.kept(&model),
            &sets,
            &totals,
            &state,
            &dataset,
            &args.out,
        )?;
    }
    match outcome {
        Outcome::Finished => super::note(&format!("trained: {}", args.out.display())),
        Outcome::Stopped => super::note("stopped; go on with the same command and --resume"),
    }
    Ok(())
}

/// The run folder for this run alone, as long as the file is open: two would write over each other.
fn lock(folder: &Path) -> anyhow::Result<File> {
    let path = folder.join(LOCK);
    let failed = || path.display().to_string();
    let file = File::create(&path).with_context(failed)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => bail!(
            "{}: a run goes on here; wait for its end, or choose another --out",
            folder.display()
        ),
        // Where there are no locks, as on some shared disks, there is none to wait for.
        _ => Ok(file),
    }
}

/// What was typed, but for the program's folder.
fn command_line() -> String {
    let typed = std::env::args_os().skip(1);
    let typed: Vec<String> = typed
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    format!("poescope {}", typed.join(" "))
}

fn fresh_config(args: &TrainArgs) -> anyhow::Result<Config> {
    let config = asked_config(args, args.model.as_deref().unwrap_or("v-h-p"))?;
    if let Some(model) = &args.model
        && args.config.is_some()
        && *model != config.name
    {
        bail!(
            "--model {model} is not what --config describes, which is {}; leave one of both out",
            config.name
        );
    }
    if args.out.join(STATE).exists() {
        bail!(
            "{} holds a run already; add --resume to go on with it, or choose another --out",
            args.out.display()
        );
    }
    // One that is done with has no state; it is not to be trained over all the same.
    let parts = [checkpoint::CONFIG, checkpoint::WEIGHTS, checkpoint::REPORT];
    if parts.iter().any(|part| args.out.join(part).exists()) {
        bail!(
            "{} holds a checkpoint; choose another --out",
            args.out.display()
        );
    }
    Ok(config)
}

/// What --config, or --preset for `model`, and --set say together.
fn asked_config(args: &TrainArgs, model: &str) -> anyhow::Result<Config> {
    let mut config = match &args.config {
        Some(path) => checkpoint::load_config(path)?,
        None => named(model, args.preset)?,
    };
    for assignment in &args.set {
        config = config
            .set(assignment)
            .map_err(|what| anyhow!("--set {what}"))?;
    }
    Ok(config)
}

/// A model of that name under a preset.
fn named(model: &str, preset: Option<Preset>) -> anyhow::Result<Config> {
    Config::preset(model, preset.unwrap_or(Preset::Fast)).with_context(|| {
        let names = Config::NAMES.join(", ");
        format!("no model {model:?}; there are {names}")
    })
}

/// The limits that were asked for, if any.
fn asked(args: &TrainArgs) -> Option<Budget> {
    let budget = Budget {
        epochs: args.epochs,
        updates: args.updates,
        minutes: args.minutes,
    };
    (budget != Budget::default()).then_some(budget)
}

/// The config and the origin of the run in the run folder. The config is the run's own: what would change it on the way
/// is refused, the same command again is not.
fn resume(args: &TrainArgs) -> anyhow::Result<(Config, Origin)> {
    let nothing = || format!("nothing to resume in {}", args.out.display());
    let config =
        checkpoint::load_config(&args.out.join(checkpoint::CONFIG)).with_context(nothing)?;
    if let Some(model) = &args.model
        && *model != config.name
    {
        bail!(
            "--model {model} is not this run's, which is {}; leave it out, or start a new --out",
            config.name
        );
    }
    for assignment in &args.set {
        let changed = config.clone().set(assignment);
        if changed.map_err(|what| anyhow!("--set {what}"))? != config {
            bail!(
                "--set {assignment} is not what this run was started with; leave it out, or start a new --out"
            );
        }
    }
    let origin = Origin::read(&args.out).with_context(nothing)?;
    Ok((config, origin))
}

/// A whole recipe that is named again has to be the one that goes on, whose config is `config`.
fn same_recipe(args: &TrainArgs, config: &Config, totals: &Totals) -> anyhow::Result<()> {
    let named = match (&args.config, args.preset) {
        (Some(path), _) => format!("--config {}", path.display()),
        (None, Some(preset)) => format!("--preset {}", preset.name()),
        (None, None) => return Ok(()),
    };
    let mut asked = asked_config(args, &config.name)?;
    statistics::complete(&mut asked, totals);
    if asked != *config {
        bail!(
            "{named}, with --set as given, is not what this run was started with; leave it out, or start a new --out"
        );
    }
    Ok(())
}

/// The origin to go on with: the run's own, but for a budget that is asked for anew.
fn same_run(args: &TrainArgs, origin: &Origin, dataset: &Dataset) -> anyhow::Result<Origin> {
    if origin.data_hash != dataset.data_hash() {
        bail!(
            "{} is not the data this run was started on (hash {}, was {}); resume with that, or start a new --out",
            args.data.display(),
            dataset.data_hash(),
            origin.data_hash
        );
    }
    if let Some(seed) = args.seed.filter(|&seed| seed != origin.seed) {
        bail!(
            "--seed {seed} is not this run's, which is {}; leave it out, or start a new --out",
            origin.seed
        );
    }
    if rayon::current_num_threads() != origin.threads {
        super::note(&format!(
            "this run was started with {} threads; with {} its sums round differently from here on",
            origin.threads,
            rayon::current_num_threads()
        ));
    }
    let budget = asked(args).unwrap_or(origin.budget);
    Ok(Origin {
        budget,
        ..origin.clone()
    })
}
