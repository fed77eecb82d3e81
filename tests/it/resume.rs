//! A run that was stopped goes on exactly where it was: as if it had never been.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use candle_core::Device;
use poescope::data::align;
use poescope::episode::Episode;
use poescope::model::Model;
use poescope::model::config::Config;
use poescope::sim::{Params, simulate};
use poescope::train::schedule::Budget;
use poescope::train::state::{Origin, STATE, State};
use poescope::train::{Outcome, Run, run, statistics};

use crate::common::{answer, poescope, simulated, tensors};

/// A small model of the MIT set's channels.
fn planar() -> Config {
    let mut config = Config::named("v-h-p").unwrap();
    config.window = 10;
    config.hidden = 32;
    config.haptic.names = ["fx", "fy", "tz"].map(str::to_owned).to_vec();
    config.proprio.names = ["px", "py"].map(str::to_owned).to_vec();
    config.training.batch = 4;
    config.training.warm_up = 2;
    config
}

fn episodes(config: &Config) -> Vec<Episode> {
    let params = Params {
        steps: 6,
        window: 10,
        rate_hz: 180.0,
        planar: true,
        ..Params::default()
    };
    (0..10)
        .map(|index| align(&simulate(&params, 5, index), config.layout()).unwrap())
        .collect()
}

/// Every trained number and moment, as bits.
fn bits(model: &Model, state: &State) -> BTreeMap<String, Vec<u32>> {
    let flat = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect();
    let mut all = BTreeMap::new();
    for network in model.networks() {
        let theta = network.theta().to_vec1::<f32>().unwrap();
        all.insert(network.name.clone(), flat(&theta));
    }
    for (name, moments) in &state.moments {
        all.insert(format!("{name}.first"), flat(&moments.first));
        all.insert(format!("{name}.second"), flat(&moments.second));
        all.insert(format!("{name}.updates"), vec![moments.updates]);
    }
    all
}

#[test]
fn a_stopped_run_ends_where_an_uninterrupted_one_does() {
    let mut config = planar();
    let episodes = episodes(&config);
    statistics::complete(&mut config, &episodes);
    let (train, val) = episodes.split_at(8);
    // Three epochs of two updates; the stop falls within the second.
    let sit = |model: &Model, state: &mut State, folder: &Path, until: Option<u64>| {
        let stop = AtomicBool::new(false);
        let sitting = Run {
            train,
            val,
            folder,
            stop: &stop,
        };
        let halt = |update| stop.store(until == Some(update), Ordering::Relaxed);
        run(model, state, sitting, |progress| halt(progress.update)).unwrap()
    };
    let origin = Origin {
        seed: 9,
        budget: Budget {
            epochs: Some(3),
            ..Budget::default()
        },
        ..Origin::default()
    };
    let new = |seed| Model::new(config.clone(), seed, &Device::Cpu).unwrap();

    let whole_folder = tempfile::tempdir().unwrap();
    let (whole, mut whole_state) = (new(1), State::new(origin.clone()));
    let before = bits(&whole, &whole_state);
    let outcome = sit(&whole, &mut whole_state, whole_folder.path(), None);
    assert_eq!((outcome, whole_state.update), (Outcome::Finished, 6));

    let folder = tempfile::tempdir().unwrap();
    let (first, mut state) = (new(1), State::new(origin.clone()));
    let outcome = sit(&first, &mut state, folder.path(), Some(3));
    assert_eq!((outcome, state.update), (Outcome::Stopped, 3));
    // Another process begins with other numbers, and has nothing but the file.
    let second = new(2);
    let mut state = State::load(&second, folder.path()).unwrap();
    assert_eq!(bits(&second, &state), bits(&first, &state));
    let outcome = sit(&second, &mut state, folder.path(), None);
    assert_eq!((outcome, state.update), (Outcome::Finished, 6));

    let after = bits(&whole, &whole_state);
    assert!(after == bits(&second, &state), "resumed to other numbers");
    assert!(before.iter().all(|(name, theta)| after[name] != *theta));
}

#[test]
fn an_interrupted_command_resumes_to_the_same_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let sizes = [
        "--planar",
        "--window",
        "10",
        "--rate-hz",
        "180",
        "--steps",
        "6",
    ];
    let data = simulated(folder.path().join("pushes.mcap"), 10, &sizes);
    let config = folder.path().join("planar.toml");
    fs::write(&config, toml::to_string(&planar()).unwrap()).unwrap();
    let train = |out: &Path| {
        let mut command = poescope();
        command.args(["train", "--epochs", "8", "--threads", "2", "--config"]);
        command.arg(&config).arg("--data").arg(&data);
        command.arg("--out").arg(out);
        command
    };
    let [whole, cut] = ["whole", "cut"].map(|name| folder.path().join(name));
    answer(&mut train(&whole));

    let mut command = train(&cut);
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    // The first epoch's line shows that it is under way.
    let patience = Instant::now() + Duration::from_mins(1);
    while !cut.join("metrics.jsonl").exists() && Instant::now() < patience {
        std::thread::sleep(Duration::from_millis(2));
    }
    let pid = child.id().to_string();
    let mut kill = Command::new("sh");
    kill.args(["-c", "kill -INT \"$0\"", &pid]);
    assert!(kill.status().unwrap().success());
    assert!(child.wait().unwrap().success());
    let stopped = tensors(&cut.join(STATE));
    answer(train(&cut).arg("--resume"));

    let ended = tensors(&whole.join(STATE));
    assert!(stopped != ended, "it was not interrupted in time");
    assert!(tensors(&cut.join(STATE)) == ended);
    let weights = |run: &Path| tensors(&run.join("weights.safetensors"));
    assert!(weights(&cut) == weights(&whole));
}
