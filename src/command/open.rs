//! Opens a dataset and models by their names on the command line, for whatever shows them.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use super::sample;
use crate::data::{Dataset, Role};
use crate::episode::EpisodeSource;
use crate::model::checkpoint::{self, CONFIG};
use crate::model::config::Config;
use crate::model::observation::{Unsuited, suits};
use crate::session::predict::Predictor;
use crate::session::trained::{Origin, Trained};
use crate::train;
use crate::train::state::STATE;

/// The checkpoint folders that were asked for, else the one that suits the dataset asked for best.
pub fn folders(asked: &[PathBuf], data: Option<&PathBuf>) -> anyhow::Result<Vec<PathBuf>> {
    if !asked.is_empty() {
        return Ok(asked.to_vec());
    }
    let mut models = sample::models(&sample::data(data)?)?;
    models.truncate(1);
    Ok(models)
}

/// A dataset and models for it.
pub struct Opened {
    /// The episodes.
    pub dataset: Arc<Dataset>,
    /// One a folder, in their order.
    pub models: Vec<Arc<dyn Predictor>>,
}

/// Opens the dataset that was asked for, else the sample episodes, and the models of the folders. Refuses data of other
/// units or another rate than any of them was trained on; an episode that is odd by itself says so where it is shown.
pub fn open(
    data: Option<&PathBuf>,
    topics: &[(Role, String)],
    folders: &[PathBuf],
) -> anyhow::Result<Opened> {
    let path = sample::data(data)?;
    let dataset = dataset(&path, topics)?;
    let mut models = Vec::with_capacity(folders.len());
    let mut foreign = Vec::new();
    for folder in folders {
        models.push(model(folder)?);
        let config = checkpoint::load_config(&folder.join(CONFIG))?;
        foreign.extend(unsuited(&config, &dataset));
    }
    if foreign.len() == models.len()
        && let Some(why) = foreign.into_iter().next()
    {
        return Err(why).with_context(|| path.display().to_string());
    }
    Ok(Opened {
        dataset: Arc::new(dataset),
        models,
    })
}

/// Why a model was trained on other data, if both the first episode and the last say so: one of the two may be odd.
fn unsuited(config: &Config, dataset: &Dataset) -> Option<Unsuited> {
    let last = dataset.metas().len().checked_sub(1)?;
    let mut found = None;
    for index in [last, 0] {
        // One that cannot be read, or holds values that are no numbers, says so when it is shown.
        let episode = dataset.episode_aligned(index, config.layout()).ok()?;
        match suits(config, &episode) {
            Ok(()) | Err(Unsuited::NotFinite { .. }) => return None,
            Err(why) => found = Some(why),
        }
    }
    found
}

/// Opens a dataset, and tells what of it nobody should miss without knowing.
pub fn dataset(path: &Path, topics: &[(Role, String)]) -> anyhow::Result<Dataset> {
    let dataset = Dataset::open_with(path, topics)?;
    for warning in dataset.warnings() {
        super::note(&warning);
    }
    Ok(dataset)
}

/// The model of a checkpoint folder, for a session.
pub fn model(folder: &Path) -> anyhow::Result<Arc<dyn Predictor>> {
    let update = checkpoint::update_of(folder);
    let (model, probe, hash) = checkpoint::load_with_hash(folder)?;
    // Without a report that can be read it is looked at all the same.
    let training = Training::of(folder).unwrap_or_default();
    let origin = Origin {
        source: folder.display().to_string(),
        update,
        hash,
        contact_newtons: training.contact_newtons,
    };
    Ok(Arc::new(Trained::new(model, probe, origin)?))
}

/// What a checkpoint's training said of itself, as far as it did.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Training {
    /// Its seed.
    pub seed: Option<u64>,
    /// Updates done.
    pub updates: Option<u64>,
    /// The dataset's name.
    pub data: Option<String>,
    /// What names all that it holds.
    pub data_hash: Option<String>,
    /// The force that counts as contact, in newtons.
    pub contact_newtons: Option<f32>,
}

impl Training {
    /// Of the checkpoint in a folder, by its report; while its run goes on, by what that was started with.
    ///
    /// # Errors
    /// If what is there cannot be read: without its seed a model might be scored on what it was trained on.
    pub fn of(folder: &Path) -> anyhow::Result<Self> {
        let path = folder.join(checkpoint::REPORT);
        match std::fs::read_to_string(&path) {
            Ok(report) => serde_json::from_str(&report).with_context(|| {
                let path = path.display();
                format!("{path}: not the report of a training; copy the checkpoint anew")
            }),
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(error).with_context(|| path.display().to_string())
            }
            Err(_) if folder.join(STATE).exists() => {
                let run = train::state::Origin::read(folder)?;
                Ok(Self {
                    seed: Some(run.seed),
                    data_hash: Some(run.data_hash),
                    ..Self::default()
                })
            }
            Err(_) => Ok(Self::default()),
        }
    }

    /// The seed that it cut its validation split by; 0 where it does not say.
    pub fn split_seed(&self) -> u64 {
        self.seed.unwrap_or(0)
    }
}
