//! A run that can be put down and taken up again: weights, moments and counters in one file, written atomically.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use candle_core::{DType, Device, Tensor};
use serde::{Deserialize, Serialize};

use super::TrainError;
use super::schedule::Budget;
use super::step::Losses;
use crate::model::Model;
use crate::model::checkpoint::{self, CheckpointError};
use crate::model::kernel::adam::Moments;
use crate::model::kernel::running_mean;

/// The largest number in half precision.
const MOST_HALF: f32 = 65504.0;
/// The file that a run is resumed from.
pub const STATE: &str = "state.safetensors";

/// What a run was started with, and goes on with.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// What was typed to start it, for the report.
    pub command: String,
    /// Seed of initial weights, order, noise and masks, and of the validation split where the dataset names none.
    pub seed: u64,
    /// Of the dataset.
    pub data_hash: String,
    /// Threads that gradients are summed over: another number rounds differently.
    pub threads: usize,
    /// When it ends.
    pub budget: Budget,
}

/// Where a run is.
#[derive(Debug, Default)]
pub struct State {
    /// What it was started with.
    pub origin: Origin,
    /// Updates so far.
    pub update: u64,
    /// Time trained, over all sittings.
    pub elapsed: Duration,
    /// Running means of the losses.
    pub losses: Option<Losses>,
    /// Adam's, by network.
    pub moments: BTreeMap<String, Moments>,
    /// The running mean of the weights, where the config wants one.
    pub mean: Option<Model>,
}

/// What is stored beside the tensors.
#[derive(Serialize, Deserialize)]
struct Counters {
    origin: Origin,
    update: u64,
    elapsed_secs: f64,
    #[serde(default)]
    losses: Option<Losses>,
    moment_updates: BTreeMap<String, u32>,
}

impl Origin {
    /// Of the run in `folder`.
    pub fn read(folder: &Path) -> Result<Self, CheckpointError> {
        Ok(Counters::read(&folder.join(STATE))?.origin)
    }
}

impl Counters {
    fn read(path: &Path) -> Result<Self, CheckpointError> {
        let bytes = checkpoint::read_bytes(path)?;
        let refuse = CheckpointError::weights(path);
        let (_, header) = safetensors::SafeTensors::read_metadata(&bytes)
            .map_err(|error| refuse(error.to_string()))?;
        let text = header
            .metadata()
            .as_ref()
            .and_then(|metadata| metadata.get("counters"));
        let text = text.ok_or_else(|| refuse("the counters are missing".to_owned()))?;
        serde_json::from_str(text).map_err(|error| refuse(error.to_string()))
    }
}

impl State {
    /// A run that has not begun.
    pub fn new(origin: Origin) -> Self {
        Self {
            origin,
            ..Self::default()
        }
    }

    /// The weights to look at and to score: their running mean where there is one, else `newest`.
    pub fn kept<'a>(&'a self, newest: &'a Model) -> &'a Model {
        self.mean.as_ref().unwrap_or(newest)
    }

    /// Takes the running mean along after an update: `training.average` of it stays, at first less, so that it soon
    /// forgets the weights it began with.
    pub fn average(&mut self, newest: &Model) -> Result<(), TrainError> {
        let decay = newest.config.training.average;
        if decay <= 0.0 {
            return Ok(());
        }
        let mean = match &mut self.mean {
            Some(mean) => mean,
            none => none.insert(Model::blank(newest.config.clone(), &Device::Cpu)?),
        };
        let n = self.update as f64;
        let part = 1.0 - decay.min((n - 1.0) / (n + 9.0));
        for (mean, newest) in mean.networks().zip(newest.networks()) {
            running_mean::towards(mean.theta(), newest.theta(), part as f32)?;
        }
        Ok(())
    }

    /// Writes the state, and the weights as a checkpoint that can be looked at while the run goes on: in half
    /// precision, where that holds them; it costs a hundredth of a decibel at most. The state keeps every bit. Each file is replaced in
    /// one go, and none by numbers that are not finite.
    pub fn save(&self, model: &Model, folder: &Path) -> Result<(), TrainError> {
        for network in model.networks() {
            let theta = network.theta().to_vec1::<f32>()?;
            if !theta.iter().all(|x| x.is_finite()) {
                return Err(TrainError::NotFinite {
                    what: format!("a weight of `{}`", network.name),
                    update: self.update,
                    episodes: Vec::new(),
                    kept: self.update > 0,
                });
            }
        }
        let kept = self.kept(model);
        let mut dtype = DType::F16;
        for network in kept.networks() {
            let theta = network.theta().to_vec1::<f32>()?;
            if theta.iter().any(|x| x.abs() > MOST_HALF) {
                dtype = DType::F32;
            }
        }
        checkpoint::save(kept, folder, dtype, Some(self.update))?;
        let mut tensors = Vec::new();
        for network in model.networks() {
            tensors.push((
                format!("{}.theta", network.name),
                network.theta().as_tensor().clone(),
            ));
        }
        for network in self.mean.iter().flat_map(Model::networks) {
            tensors.push((
                format!("{}.mean", network.name),
                network.theta().as_tensor().clone(),
            ));
        }
        for (name, moments) in &self.moments {
            let flat = |numbers: &[f32]| Tensor::from_slice(numbers, numbers.len(), &Device::Cpu);
            tensors.push((format!("{name}.first"), flat(&moments.first)?));
            tensors.push((format!("{name}.second"), flat(&moments.second)?));
        }
        let counters = Counters {
            origin: self.origin.clone(),
            update: self.update,
            elapsed_secs: self.elapsed.as_secs_f64(),
            losses: self.losses,
            moment_updates: self
                .moments
                .iter()
                .map(|(name, moments)| (name.clone(), moments.updates))
                .collect(),
        };
        let path = folder.join(STATE);
        let refuse = CheckpointError::weights(&path);
        let counters =
            serde_json::to_string(&counters).map_err(|error| refuse(error.to_string()))?;
        let about = Some(("counters", counters));
        Ok(checkpoint::write_tensors(&path, tensors, about)?)
    }

    /// Reads what [`Self::save`] wrote, and fills the model's parameters.
    pub fn load(model: &Model, folder: &Path) -> Result<Self, TrainError> {
        let path = folder.join(STATE);
        let counters = Counters::read(&path)?;
        let refuse = CheckpointError::weights(&path);
        let tensors = checkpoint::read_tensors(&path)?;
        let numbers = |name: &str| -> Result<Tensor, CheckpointError> {
            tensors
                .get(name)
                .cloned()
                .ok_or_else(|| refuse(format!("tensor `{name}` is missing")))
        };
        let fill = |model: &Model, kind: &str| -> Result<(), CheckpointError> {
            for network in model.networks() {
                let name = format!("{}.{kind}", network.name);
                let theta = numbers(&name)?;
                let set = network.theta().set(&theta);
                set.map_err(|error| refuse(checkpoint::first_line(&error)))?;
                let read = theta.to_vec1::<f32>();
                let read = read.map_err(|error| refuse(checkpoint::first_line(&error)))?;
                if !read.iter().all(|x| x.is_finite()) {
                    return Err(refuse(format!("tensor `{name}` is not finite")));
                }
            }
            Ok(())
        };
        fill(model, "theta")?;
        let mean = if model.config.training.average > 0.0 && counters.update > 0 {
            let mean = Model::blank(model.config.clone(), &Device::Cpu)?;
            fill(&mean, "mean")?;
            Some(mean)
        } else {
            None
        };
        let mut moments = BTreeMap::new();
        for (name, updates) in counters.moment_updates {
            let first = numbers(&format!("{name}.first"))?.to_vec1()?;
            let second = numbers(&format!("{name}.second"))?.to_vec1()?;
            let network = model.networks().into_iter().find(|own| own.name == name);
            let wanted = network.map(|network| network.theta().elem_count());
            if [Some(first.len()), Some(second.len())] != [wanted; 2] {
                return Err(refuse(format!("the moments of `{name}` are of another model")).into());
            }
            moments.insert(
                name,
                Moments {
                    first,
                    second,
                    updates,
                },
            );
        }
        let elapsed = Duration::try_from_secs_f64(counters.elapsed_secs)
            .map_err(|error| refuse(error.to_string()))?;
        Ok(Self {
            origin: counters.origin,
            update: counters.update,
            elapsed,
            losses: counters.losses,
            moments,
            mean,
        })
    }
}
