//! A run can be trusted: the same again to the byte, stopped, killed or not; and what is not finite ends it in time.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use candle_core::Device;
use poescope::data::{Episodes, Store, align};
use poescope::episode::Episode;
use poescope::model::Model;
use poescope::model::checkpoint::{self, CONFIG, PROBE, WEIGHTS};
use poescope::model::config::Config;
use poescope::model::network::Slot;
use poescope::sim::{Params, simulate};
use poescope::train::batch::choose;
use poescope::train::metrics::METRICS;
use poescope::train::schedule::Budget;
use poescope::train::state::{Origin, STATE, State};
use poescope::train::totals::Totals;
use poescope::train::{Outcome, Run, TrainError, run, statistics};
use serde_json::Value;
use tempfile::TempDir;

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

/// The same episodes in memory, or with no room there.
fn stored(episodes: &[Episode], memory: u64, folder: &Path) -> Store {
    let mut store = Store::new(memory, folder);
    for episode in episodes {
        store.push(episode.clone()).unwrap();
    }
    store
}

const TRAIN: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
const VAL: [usize; 2] = [8, 9];

/// A sitting that ends at the budget, or after update `until`; every update leaves a checkpoint.
fn sit(
    model: &Model,
    state: &mut State,
    store: &Store,
    folder: &Path,
    until: Option<u64>,
) -> Result<Outcome, TrainError> {
    let stop = AtomicBool::new(false);
    let sitting = Run {
        train: Episodes::new(store, &TRAIN),
        val: Episodes::new(store, &VAL),
        folder,
        checkpoint_every: Duration::ZERO,
        stop: &stop,
    };
    run(model, state, sitting, |progress| {
        stop.store(until == Some(progress.update), Ordering::Relaxed);
    })
}

/// Three epochs of two updates.
fn origin() -> Origin {
    Origin {
        seed: 9,
        budget: Budget {
            epochs: Some(3),
            ..Budget::default()
        },
        ..Origin::default()
    }
}

fn scaled(episodes: &[Episode], folder: &Path) -> Config {
    let mut config = planar();
    let store = stored(episodes, u64::MAX, folder);
    let totals = Totals::of(Episodes::new(&store, &TRAIN)).unwrap();
    statistics::complete(&mut config, &totals);
    config
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
    let folder = tempfile::tempdir().unwrap();
    let episodes = episodes(&planar());
    let config = scaled(&episodes, folder.path());
    let [in_memory, on_disk] = [u64::MAX, 0].map(|room| stored(&episodes, room, folder.path()));
    assert_eq!((in_memory.spilled(), on_disk.spilled()), (0, 10));
    let new = |seed| Model::new(config.clone(), seed, &Device::Cpu).unwrap();

    let whole_folder = tempfile::tempdir().unwrap();
    let (whole, mut whole_state) = (new(1), State::new(origin()));
    let before = bits(&whole, &whole_state);
    let sat = sit(
        &whole,
        &mut whole_state,
        &in_memory,
        whole_folder.path(),
        None,
    );
    assert_eq!((sat.unwrap(), whole_state.update), (Outcome::Finished, 6));

    // The stop falls within the second epoch.
    let (first, mut state) = (new(1), State::new(origin()));
    let sat = sit(&first, &mut state, &in_memory, folder.path(), Some(3));
    assert_eq!((sat.unwrap(), state.update), (Outcome::Stopped, 3));
    // Another process begins with other numbers, and has nothing but the file; its data may lie elsewhere.
    let second = new(2);
    let mut state = State::load(&second, folder.path()).unwrap();
    assert_eq!(bits(&second, &state), bits(&first, &state));
    let sat = sit(&second, &mut state, &on_disk, folder.path(), None);
    assert_eq!((sat.unwrap(), state.update), (Outcome::Finished, 6));

    let after = bits(&whole, &whole_state);
    assert!(after == bits(&second, &state), "resumed to other numbers");
    assert!(before.iter().all(|(name, theta)| after[name] != *theta));
}

#[test]
fn a_state_with_a_weight_that_is_no_number_is_not_gone_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let episodes = episodes(&planar());
    let config = scaled(&episodes, folder.path());
    let store = stored(&episodes, u64::MAX, folder.path());
    let model = Model::new(config, 1, &Device::Cpu).unwrap();
    let mut state = State::new(origin());
    sit(&model, &mut state, &store, folder.path(), Some(1)).unwrap();
    let path = folder.path().join(STATE);
    let mut bytes = fs::read(&path).unwrap();
    let (header, about) = safetensors::SafeTensors::read_metadata(&bytes).unwrap();
    let tensors = about.tensors();
    let (name, info) = tensors.iter().find(|(n, _)| n.ends_with("theta")).unwrap();
    let first = 8 + header + info.data_offsets.0;
    bytes[first..first + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    fs::write(&path, bytes).unwrap();
    let refused = State::load(&model, folder.path()).unwrap_err().to_string();
    let said = refused.contains(STATE) && refused.contains(&format!("`{name}` is not finite"));
    assert!(said, "{refused}");
}

/// Trains until a number is not finite: which update, what it was, among which episodes.
fn fails(
    model: &Model,
    state: &mut State,
    store: &Store,
    folder: &Path,
) -> (u64, String, Vec<String>) {
    match sit(model, state, store, folder, None) {
        Err(TrainError::NotFinite {
            update,
            what,
            episodes,
            ..
        }) => (update, what, episodes),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_episode_that_is_not_finite_is_named_and_leaves_the_checkpoint_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut episodes = episodes(&planar());
    let config = scaled(&episodes, folder.path());
    // Of the second update of the first epoch, which takes those that the first did not.
    let poisoned = choose(TRAIN.len(), config.training.batch, 2, origin().seed, 1)[2];
    episodes[poisoned].haptic.as_mut().unwrap()[78] = f32::NAN;
    let store = stored(&episodes, u64::MAX, folder.path());
    let model = Model::new(config.clone(), 1, &Device::Cpu).unwrap();
    let mut state = State::new(origin());
    let first = bits(&model, &state);
    let (update, what, named) = fails(&model, &mut state, &store, folder.path());
    assert_eq!((update, named.len()), (1, config.training.batch));
    assert!(what.starts_with("the loss"), "{what}");
    assert!(named.contains(&episodes[poisoned].meta.id), "{named:?}");
    // The last weights that were seen to give a finite loss.
    let kept = Model::blank(config, &Device::Cpu).unwrap();
    let state = State::load(&kept, folder.path()).unwrap();
    assert_eq!((state.update, bits(&kept, &state)), (0, first));
}

#[test]
fn a_rate_that_is_too_high_stops_before_it_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let episodes = episodes(&planar());
    let mut config = scaled(&episodes, folder.path());
    config.training.learning_rate = 1e30;
    let store = stored(&episodes, u64::MAX, folder.path());
    let model = Model::new(config.clone(), 1, &Device::Cpu).unwrap();
    let mut state = State::new(origin());
    let first = bits(&model, &state);
    let (update, ..) = fails(&model, &mut state, &store, folder.path());
    assert_eq!(update, 1);
    let kept = Model::blank(config, &Device::Cpu).unwrap();
    let state = State::load(&kept, folder.path()).unwrap();
    assert_eq!((state.update, bits(&kept, &state)), (0, first));
    checkpoint::load(folder.path()).unwrap();
}

#[test]
fn a_gradient_that_is_not_finite_reaches_neither_weights_nor_moments() {
    let folder = tempfile::tempdir().unwrap();
    let episodes = episodes(&planar());
    let config = scaled(&episodes, folder.path());
    let store = stored(&episodes, u64::MAX, folder.path());
    let model = Model::new(config, 1, &Device::Cpu).unwrap();
    // Weight norm makes the weight the same whatever the length of v, but its gradient goes with 1 / ‖v‖.
    let network = &model.decoders[0].network;
    let mut numbers: Vec<_> = network.tensors().unwrap().into_iter().rev().collect();
    let shrunk = |slot: &Slot| {
        let (_, tensor) = numbers.pop().unwrap();
        let scale = if slot.name.ends_with("_v") {
            1e-19
        } else {
            1.0
        };
        tensor.affine(scale, 0.0)?.flatten_all()?.to_vec1()
    };
    network.fill(shrunk).unwrap();
    let mut state = State::new(origin());
    let first = bits(&model, &state);
    let (update, what, named) = fails(&model, &mut state, &store, folder.path());
    assert_eq!((update, named.len()), (0, 4));
    assert!(what.starts_with("the gradient of `img_dec`"), "{what}");
    assert!(bits(&model, &state) == first && state.moments.is_empty());
}

/// Twenty episodes of a planar setup to train on, five updates an epoch, three epochs, through the program.
struct Trial {
    folder: TempDir,
}

impl Trial {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let sizes = "--planar --window 10 --rate-hz 180 --steps 6";
        let sizes: Vec<&str> = sizes.split(' ').collect();
        simulated(folder.path().join("pushes.mcap"), 22, &sizes);
        let config = toml::to_string(&planar()).unwrap();
        fs::write(folder.path().join("planar.toml"), config).unwrap();
        Self { folder }
    }

    fn out(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn train(&self, name: &str, options: &[&str]) -> Command {
        let mut command = poescope();
        command.args(["train", "--epochs", "3", "--threads", "2", "--config"]);
        command.arg(self.out("planar.toml"));
        command.arg("--data").arg(self.out("pushes.mcap"));
        command.args(options).arg("--out").arg(self.out(name));
        command
    }

    /// Starts a run and waits until a checkpoint of `update` or a later one is there.
    fn started(&self, name: &str, options: &[&str], update: u64) -> Child {
        let mut child = self.train(name, options);
        let mut child = child.stderr(Stdio::null()).spawn().unwrap();
        let patience = Instant::now() + Duration::from_mins(1);
        while saved_update(&self.out(name)).is_none_or(|saved| saved < update) {
            assert!(Instant::now() < patience && child.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(2));
        }
        child
    }

    fn state(&self, name: &str) -> Vec<(String, Vec<u8>)> {
        tensors(&self.out(name).join(STATE))
    }

    fn bytes(&self, name: &str, file: &str) -> Vec<u8> {
        fs::read(self.out(name).join(file)).unwrap()
    }

    /// The lines of metrics but for what tells the time.
    fn metrics(&self, name: &str) -> Vec<Value> {
        let text = fs::read_to_string(self.out(name).join(METRICS)).unwrap();
        let lines = text.lines().map(|line| {
            let mut line: Value = serde_json::from_str(line).unwrap();
            let line_object = line.as_object_mut().unwrap();
            for timed in ["elapsed_secs", "secs_per_update", "waited_secs"] {
                assert!(line_object.remove(timed).unwrap().is_f64());
            }
            line
        });
        lines.collect()
    }
}

/// The update that a run's checkpoint is of; none before there is one.
fn saved_update(run: &Path) -> Option<u64> {
    let bytes = fs::read(run.join(STATE)).ok()?;
    let (_, header) = safetensors::SafeTensors::read_metadata(&bytes).ok()?;
    let counters = header.metadata().as_ref()?.get("counters")?.clone();
    serde_json::from_str::<Value>(&counters).unwrap()["update"].as_u64()
}

#[test]
fn runs_agree_to_the_byte_whether_they_were_interrupted_killed_or_not() {
    let trial = Trial::new();
    answer(&mut trial.train("whole", &[]));
    // Once more, from the disk.
    answer(&mut trial.train("again", &["--memory", "0"]));
    for file in [WEIGHTS, CONFIG, PROBE] {
        assert!(
            trial.bytes("whole", file) == trial.bytes("again", file),
            "{file}"
        );
    }
    let metrics = trial.metrics("whole");
    assert_eq!((metrics.len(), &metrics), (3, &trial.metrics("again")));

    let often = ["--checkpoint-minutes", "0"];
    let mut child = trial.started("interrupted", &often, 2);
    let mut kill = Command::new("kill");
    kill.args(["-INT", &child.id().to_string()]);
    assert!(kill.status().unwrap().success());
    assert!(child.wait().unwrap().success());
    let stopped = saved_update(&trial.out("interrupted")).unwrap();
    assert!(
        (2..15).contains(&stopped),
        "not interrupted in time: {stopped}"
    );
    answer(&mut trial.train("interrupted", &["--resume"]));

    // Killed twice without a warning, in the midst of an update or of a checkpoint.
    for (options, update) in [(&often[..], 2), (&[often[0], often[1], "--resume"], 7)] {
        let mut child = trial.started("killed", options, update);
        child.kill().unwrap();
        child.wait().unwrap();
        let stopped = saved_update(&trial.out("killed")).unwrap();
        assert!(
            (update..15).contains(&stopped),
            "not killed in time: {stopped}"
        );
        assert!(!trial.out("killed").join(PROBE).exists());
    }
    answer(&mut trial.train("killed", &["--resume"]));

    for run in ["interrupted", "killed"] {
        assert!(trial.state(run) == trial.state("whole"), "{run}");
        assert!(
            trial.bytes(run, WEIGHTS) == trial.bytes("whole", WEIGHTS),
            "{run}"
        );
        assert_eq!(trial.metrics(run).len(), 3, "{run}");
    }
}
