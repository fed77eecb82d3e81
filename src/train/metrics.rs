//! What is logged of each epoch, a JSON object a line.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use super::TrainError;
use super::state::State;
use super::step::{Gradients, Losses};
use super::tensorboard::EventWriter;
use super::validate::Validation;
use crate::model::checkpoint::{self, CheckpointError};

/// The file that metrics are appended to.
pub const METRICS: &str = "metrics.jsonl";

/// One epoch, or what the budget left of the last one. Two runs of one seed, data and number of threads differ in nothing
/// but the seconds, and in the means over an epoch in which a sitting began.
#[derive(Clone, Debug, Serialize)]
pub struct Line {
    /// Updates so far.
    pub update: u64,
    /// Epochs so far.
    pub epoch: u64,
    /// Time trained, over all sittings.
    pub elapsed_secs: f64,
    /// Of the last update.
    pub learning_rate: f64,
    /// Running means of the losses, 5 % an update.
    pub train: Losses,
    /// Means over the epoch's updates.
    #[serde(flatten)]
    pub meter: Summary,
    /// Scores on the validation split; none where it is empty.
    pub val: Option<Validation>,
}

/// Gathers what the updates of an epoch measure.
#[derive(Debug, Default)]
pub struct Meter {
    updates: u64,
    stepping: Duration,
    waited: Duration,
    norms: BTreeMap<String, Norm>,
    kl_per_latent: Vec<f64>,
}

/// Norm of a network's gradient before clipping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Norm {
    /// Mean over updates.
    pub mean: f64,
    /// The largest.
    pub max: f64,
}

/// What a [`Meter`] has gathered.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Updates that this is a mean of: fewer than an epoch's where a sitting began within it.
    pub updates: u64,
    /// Mean time of an update: forward, backward, clip, Adam.
    pub secs_per_update: f64,
    /// Time that updates waited for their batches, in all.
    pub waited_secs: f64,
    /// By network.
    pub gradient_norm: BTreeMap<String, Norm>,
    /// What each latent adds to the KL of the posterior against the prior, in nats.
    pub kl_per_latent: Vec<f64>,
}

impl Meter {
    /// Adds an update that took `stepping` after it had `waited` for its batch.
    pub fn add(&mut self, gradients: &Gradients, stepping: Duration, waited: Duration) {
        self.updates += 1;
        self.stepping += stepping;
        self.waited += waited;
        for (network, norm) in &gradients.norms {
            let sum = self.norms.entry(network.clone()).or_default();
            sum.mean += f64::from(*norm);
            sum.max = sum.max.max(f64::from(*norm));
        }
        self.kl_per_latent
            .resize(gradients.kl_per_latent.len(), 0.0);
        for (sum, &kl) in self.kl_per_latent.iter_mut().zip(&gradients.kl_per_latent) {
            *sum += f64::from(kl);
        }
    }

    /// What came together since the last time, and begins anew.
    pub fn take(&mut self) -> Summary {
        let Self {
            updates,
            stepping,
            waited,
            norms: mut gradient_norm,
            mut kl_per_latent,
        } = std::mem::take(self);
        let n = updates.max(1) as f64;
        for norm in gradient_norm.values_mut() {
            norm.mean /= n;
        }
        for kl in &mut kl_per_latent {
            *kl /= n;
        }
        Summary {
            updates,
            secs_per_update: stepping.as_secs_f64() / n,
            waited_secs: waited.as_secs_f64(),
            gradient_norm,
            kl_per_latent,
        }
    }
}

impl Line {
    /// Of a run as it stands.
    pub fn of(
        state: &State,
        epoch_updates: u64,
        learning_rate: f64,
        meter: Summary,
        val: Option<Validation>,
    ) -> Self {
        Self {
            update: state.update,
            epoch: state.update / epoch_updates,
            elapsed_secs: state.elapsed.as_secs_f64(),
            learning_rate,
            train: state.losses.unwrap_or_default(),
            meter,
            val,
        }
    }

    /// The same as TensorBoard's tags and values.
    fn scalars(&self) -> BTreeMap<String, f32> {
        let mut all = BTreeMap::new();
        let mut losses = |split: &str, losses: Losses| {
            for (name, value) in losses.named() {
                all.insert(format!("{split}/{name}"), value);
            }
        };
        losses("train", self.train);
        if let Some(val) = &self.val {
            losses("val", val.losses);
            if let Some(mean) = val.mean_psnr_db() {
                all.insert("val/open_loop_psnr_db".to_owned(), mean as f32);
            }
            for (i, &kl) in val.kl_per_latent.iter().enumerate() {
                all.insert(format!("val/kl_per_latent/{i:02}"), kl as f32);
            }
        }
        for (network, norm) in &self.meter.gradient_norm {
            all.insert(format!("gradient_norm/{network}"), norm.mean as f32);
        }
        all.insert("learning_rate".to_owned(), self.learning_rate as f32);
        let meter = &self.meter;
        all.insert(
            "time/secs_per_update".to_owned(),
            meter.secs_per_update as f32,
        );
        all.insert("time/waited_secs".to_owned(), meter.waited_secs as f32);
        all
    }
}

/// Logs an epoch, as a line of JSON and for TensorBoard: the one place that every scalar passes.
pub fn log(folder: &Path, events: &mut EventWriter, line: &Line) -> Result<(), TrainError> {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let wall_secs = now.map_or(0.0, |now| now.as_secs_f64());
    let scalars = line.scalars();
    let scalars = scalars.iter().map(|(tag, &value)| (tag.as_str(), value));
    events.scalars(line.update, wall_secs, scalars)?;
    let path = folder.join(METRICS);
    let line = serde_json::json!(line);
    let written = std::fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(&path)
        .and_then(|mut file| writeln!(file, "{line}"));
    Ok(written.map_err(CheckpointError::io(&path))?)
}

/// Drops the lines past `update`: a run that was killed had gone further than its last checkpoint.
pub fn forget_after(folder: &Path, update: u64) -> Result<(), TrainError> {
    #[derive(Deserialize)]
    struct Line {
        update: u64,
    }
    let path = folder.join(METRICS);
    let bytes = match std::fs::read(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        read => read.map_err(CheckpointError::io(&path))?,
    };
    // A torn line is no line, whatever its bytes are.
    let text = String::from_utf8_lossy(&bytes);
    let kept = text
        .lines()
        .filter(|line| serde_json::from_str::<Line>(line).is_ok_and(|line| line.update <= update));
    let kept: String = kept.flat_map(|line| [line, "\n"]).collect();
    Ok(checkpoint::write_atomic(&path, kept.as_bytes())?)
}
