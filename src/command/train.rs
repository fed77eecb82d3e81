//! `poescope train`: opens a dataset, trains a model on it, leaves a checkpoint with its probe and its report.

use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::{Context, bail};
use candle_core::Device;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use crate::cli::TrainArgs;
use crate::data::Dataset;
use crate::episode::{Episode, EpisodeSource, Layout, Split};
use crate::eval;
use crate::model::Model;
use crate::model::checkpoint;
use crate::model::config::Config;
use crate::model::inspect::Inspector;
use crate::model::observation::observe;
use crate::model::probe::{Positions, Probe};
use crate::model::trace::Alphas;
use crate::train::schedule::Budget;
use crate::train::state::{METRICS, STATE, State};
use crate::train::validate::{Validation, validate};
use crate::train::{self, Outcome, Progress, Run, statistics};

/// Epochs when neither epochs nor minutes are asked for.
const EPOCHS: usize = 20;

/// Runs it.
pub fn run(args: &TrainArgs) -> anyhow::Result<()> {
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .build_global()
            .context("starting threads")?;
    }
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        // The second signal ends the process at once.
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&stop))?;
        signal_hook::flag::register(signal, Arc::clone(&stop))?;
    }
    let mut config = if args.resume {
        checkpoint::load_config(&args.out.join(checkpoint::CONFIG))
            .with_context(|| format!("nothing to resume in {}", args.out.display()))?
    } else {
        fresh_config(args)?
    };
    let dataset = Dataset::open_with(&args.data, &args.mapping.topics)?;
    let sets = load(&dataset, config.layout(), args.seed)?;
    if sets.train.len() < config.training.batch {
        bail!(
            "{} has {} episodes to train on, a batch needs {}; record more, or lower `training.batch` in a --config",
            args.data.display(),
            sets.train.len(),
            config.training.batch
        );
    }
    eprintln!(
        "{}: {} episodes to train on, {} for validation{}",
        dataset.name(),
        sets.train.len(),
        sets.val.len(),
        if sets.left_out > 0 {
            format!(", {} left out (see `poescope info`)", sets.left_out)
        } else {
            String::new()
        },
    );
    statistics::complete(&mut config, &sets.train);
    let model = Model::new(config, args.seed, &Device::Cpu)?;
    std::fs::create_dir_all(&args.out).with_context(|| format!("making {}", args.out.display()))?;
    let mut state = if args.resume {
        State::load(&model, &args.out)?
    } else {
        State::default()
    };
    let budget = Budget {
        epochs: args
            .epochs
            .or_else(|| args.minutes.is_none().then_some(EPOCHS)),
        minutes: args.minutes,
    };
    let bar = bar();
    let run = Run {
        train: &sets.train,
        val: &sets.val,
        folder: &args.out,
        seed: args.seed,
        budget,
        stop: &stop,
    };
    let outcome = train::run(&model, &mut state, run, |progress| show(&bar, progress))?;
    bar.finish();
    let validation = validate(&model, &sets.val)?;
    finish(&model, &sets, &args.out)?;
    let report = Report {
        args,
        dataset: &dataset,
        sets: &sets,
        state: &state,
        model: &model,
    };
    report.write(&validation)?;
    match outcome {
        Outcome::Finished => eprintln!("trained: {}", args.out.display()),
        Outcome::Stopped => {
            eprintln!("stopped and saved; go on with the same command and --resume");
        }
    }
    Ok(())
}

fn fresh_config(args: &TrainArgs) -> anyhow::Result<Config> {
    if args.out.join(STATE).exists() {
        bail!(
            "{} holds a run already; add --resume to go on with it, or choose another --out",
            args.out.display()
        );
    }
    match &args.config {
        Some(path) => Ok(checkpoint::load_config(path)?),
        None => Config::named(&args.model).with_context(|| {
            format!(
                "no model {:?}; there are {}",
                args.model,
                Config::NAMES.join(", ")
            )
        }),
    }
}

/// The episodes of a run.
struct Sets {
    train: Vec<Episode>,
    val: Vec<Episode>,
    left_out: usize,
}

fn load(dataset: &Dataset, layout: Layout, seed: u64) -> anyhow::Result<Sets> {
    let mut sets = Sets {
        train: Vec::new(),
        val: Vec::new(),
        left_out: 0,
    };
    let bar = bar();
    bar.set_length(dataset.metas().len() as u64);
    bar.set_style(ProgressStyle::with_template(
        "reading {bar:30} {pos}/{len} episodes",
    )?);
    for (index, split) in dataset.splits(seed).into_iter().enumerate() {
        bar.inc(1);
        if split == Split::Test {
            continue;
        }
        let episode = dataset.load(index, layout)?;
        let steps = sets.train.first().map_or(episode.steps(), Episode::steps);
        // An odd recording would teach the oddity; one of another length does not fit a batch.
        if !episode.flags.is_empty() || episode.steps() != steps {
            sets.left_out += 1;
        } else if split == Split::Val {
            sets.val.push(episode);
        } else {
            sets.train.push(episode);
        }
    }
    bar.finish_and_clear();
    Ok(sets)
}

fn bar() -> ProgressBar {
    if std::io::stderr().is_terminal() {
        ProgressBar::new(1000)
    } else {
        ProgressBar::hidden()
    }
}

fn show(bar: &ProgressBar, progress: &Progress) {
    let losses = progress.losses;
    let minutes = progress.elapsed.as_secs_f64() / 60.0;
    let left = minutes / progress.fraction.max(1e-9) * (1.0 - progress.fraction);
    let line = format!(
        "epoch {} update {}  loss {:.2}  vision {:.2}  windows {:.2}  KL {:.2}  {minutes:.1} min, {left:.1} left",
        progress.update / progress.epoch_updates,
        progress.update,
        losses.loss,
        losses.vision,
        losses.windows,
        losses.kl,
    );
    bar.set_style(
        ProgressStyle::with_template("{bar:20} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    bar.set_position((progress.fraction * 1000.0) as u64);
    bar.set_message(line.clone());
    if let Some(Validation { losses, psnr_db }) = &progress.validation {
        let mean = psnr_db.iter().sum::<f64>() / psnr_db.len().max(1) as f64;
        let line = format!(
            "{line}  | val vision {:.2} KL {:.2} open loop {mean:.2} dB",
            losses.vision, losses.kl
        );
        if bar.is_hidden() {
            eprintln!("{line}");
        } else {
            bar.println(line);
        }
    }
}

/// Filtered beliefs of some episodes on the mean path, with the recorded positions.
fn positions(inspector: &Inspector<&Model>, episodes: &[Episode]) -> anyhow::Result<Positions> {
    let config = &inspector.model().config;
    let mut positions = Positions::default();
    positions.beliefs.latent = config.latent;
    for episode in episodes {
        let Some(object) = &episode.object else {
            continue;
        };
        let seen = observe(config, episode)?;
        let experts = inspector.encode(&seen)?;
        let beliefs =
            inspector.filter(&experts, &Alphas::trained(seen.beliefs, config.switches()))?;
        positions.beliefs.mean.extend(beliefs.posterior.mean);
        positions.beliefs.log_var.extend(beliefs.posterior.log_var);
        positions.truth.extend(
            object[config.frame_stack..]
                .iter()
                .map(|pose| [pose.x, pose.y]),
        );
    }
    Ok(positions)
}

/// Writes what goes beside the weights: the position probe and the mean training frame.
fn finish(model: &Model, sets: &Sets, folder: &Path) -> anyhow::Result<()> {
    let inspector = Inspector::new(model)?;
    let fit = positions(&inspector, &sets.train)?;
    let held_out = positions(
        &inspector,
        if sets.val.is_empty() {
            &sets.train
        } else {
            &sets.val
        },
    )?;
    if let Some(probe) = Probe::fit(&fit, &held_out) {
        probe.write(&folder.join(checkpoint::PROBE))?;
    }
    let pixels = eval::mean_frame(sets.train.iter())
        .into_iter()
        .map(|p| (p * 255.0).round() as u8)
        .collect();
    let side = model.config.frame_size as u32;
    let frame = image::GrayImage::from_raw(side, side, pixels)
        .context("frames of another size than the model's")?;
    let mut png = std::io::Cursor::new(Vec::new());
    frame.write_to(&mut png, image::ImageFormat::Png)?;
    checkpoint::write_atomic(&folder.join(checkpoint::MEAN_FRAME), &png.into_inner())?;
    Ok(())
}

/// What was typed, but for the program's folder.
fn command_line() -> String {
    let typed: Vec<String> = std::env::args().skip(1).collect();
    format!("poescope {}", typed.join(" "))
}

/// How a checkpoint came to be.
struct Report<'a> {
    args: &'a TrainArgs,
    dataset: &'a Dataset,
    sets: &'a Sets,
    state: &'a State,
    model: &'a Model,
}

impl Report<'_> {
    fn write(&self, validation: &Validation) -> anyhow::Result<()> {
        let updates_of_an_epoch = (self.sets.train.len() / self.model.config.training.batch).max(1);
        let report = json!({
            "poescope": env!("CARGO_PKG_VERSION"),
            "command": command_line(),
            "model": self.model.config.name,
            "parameters": self.model.parameters(),
            "data": self.dataset.name(),
            "data_hash": self.dataset.data_hash(),
            "train_episodes": self.sets.train.len(),
            "val_episodes": self.sets.val.len(),
            "left_out": self.sets.left_out,
            "seed": self.args.seed,
            "updates": self.state.update,
            "epochs": self.state.update as f64 / updates_of_an_epoch as f64,
            "minutes": self.state.elapsed.as_secs_f64() / 60.0,
            "threads": rayon::current_num_threads(),
            "val": validation,
            "metrics": METRICS,
        });
        let text = serde_json::to_string_pretty(&report)? + "\n";
        checkpoint::write_atomic(&self.args.out.join(checkpoint::REPORT), text.as_bytes())?;
        Ok(())
    }
}
