//! The models that are compared, with what was fitted for them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail};
use rayon::prelude::*;

use crate::command::open;
use crate::data::{Dataset, Role};
use crate::episode::{EpisodeSource, Split};
use crate::eval::regression;
use crate::eval::score::Candidate;
use crate::model::checkpoint::{self, MEAN_FRAME, PROBE, REPORT};
use crate::model::config::Config;
use crate::model::inspect::Inspector;
use crate::model::probe::Regressors;

/// Opens the checkpoints. They must see episodes in the same sizes.
pub fn open(folders: &[PathBuf]) -> anyhow::Result<Vec<Candidate>> {
    let mut candidates: Vec<Candidate> = Vec::new();
    for folder in folders {
        let (model, probe) = checkpoint::load(folder)?;
        let path = folder.join(PROBE);
        let regressors = if path.exists() {
            Regressors::read(&path, model.config.latent)?
        } else {
            None
        };
        let report = report(folder);
        let candidate = Candidate {
            label: String::new(),
            group: String::new(),
            seed: report["seed"].as_u64(),
            contact_newtons: report["contact_newtons"].as_f64().map(|n| n as f32),
            inspector: Inspector::new(model)?,
            probe,
            regressors,
        };
        if let Some(first) = candidates.first() {
            let layout = |c: &Candidate| c.inspector.model().config.layout();
            if layout(first) != layout(&candidate) {
                bail!(
                    "{} and {} see frames or windows of different sizes; evaluate them apart",
                    folders[0].display(),
                    folder.display()
                );
            }
        }
        candidates.push(candidate);
    }
    name(&mut candidates, folders);
    Ok(candidates)
}

/// What training said of itself; null where it did not.
fn report(folder: &Path) -> serde_json::Value {
    let report = std::fs::read_to_string(folder.join(REPORT)).unwrap_or_default();
    serde_json::from_str(&report).unwrap_or_default()
}

/// What two seeds of one recipe have in common: all but the numbers read off the training set.
fn recipe(config: &Config) -> Config {
    let mut recipe = config.clone();
    for channels in [&mut recipe.haptic, &mut recipe.proprio] {
        channels.mean.clear();
        channels.scale.clear();
    }
    recipe.training.error_weights.clear();
    recipe.step_secs = None;
    recipe
}

/// Names them: by the model's name, by its folder's where two recipes share that, and by the seed within a recipe.
fn name(candidates: &mut [Candidate], folders: &[PathBuf]) {
    let recipes: Vec<Config> = candidates
        .iter()
        .map(|c| recipe(&c.inspector.model().config))
        .collect();
    let names: Vec<String> = recipes.iter().map(|r| r.name.clone()).collect();
    for i in 0..candidates.len() {
        let first = recipes.iter().position(|r| *r == recipes[i]).unwrap_or(i);
        let shared = (0..recipes.len()).any(|j| names[j] == names[i] && recipes[j] != recipes[i]);
        let folder = folders[first]
            .file_name()
            .map(|name| name.to_string_lossy().into_owned());
        let group = folder
            .filter(|_| shared)
            .unwrap_or_else(|| names[i].clone());
        let seeds = recipes.iter().filter(|r| **r == recipes[i]).count();
        candidates[i].label = match (seeds, candidates[i].seed) {
            (1, _) => group.clone(),
            (_, Some(seed)) => format!("{group} seed {seed}"),
            (_, None) => format!("{group}#{}", i + 1),
        };
        candidates[i].group = group;
    }
    // The same checkpoint named twice is told apart all the same.
    for i in 1..candidates.len() {
        if candidates[..i]
            .iter()
            .any(|c| c.label == candidates[i].label)
        {
            candidates[i].label = format!("{}#{}", candidates[i].label, i + 1);
        }
    }
}

/// Fits the pose regressors on the training split of a dataset, for each as its own training cut it.
pub fn fit(
    candidates: &mut [Candidate],
    data: &Path,
    folders: &[PathBuf],
    topics: &[(Role, String)],
) -> anyhow::Result<()> {
    let dataset = Dataset::open_with(data, topics)?;
    for (candidate, folder) in candidates.iter_mut().zip(folders) {
        let model = candidate.inspector.model();
        let splits = dataset
            .splits(open::split_seed(folder))
            .into_iter()
            .enumerate();
        let train: Vec<usize> = splits
            .filter_map(|(i, s)| (s == Split::Train).then_some(i))
            .collect();
        if train.is_empty() {
            bail!("{}: no episode of split `train` to fit on", data.display());
        }
        let layout = model.config.layout();
        let episodes = train
            .into_par_iter()
            .map(|i| anyhow::Ok(Arc::new(dataset.load(i, layout)?)));
        let latents = regression::latents(&Inspector::new(model)?, episodes)?;
        candidate.regressors = latents.fit()?;
    }
    Ok(())
}

/// The mean training frame of a checkpoint, in [0, 1].
pub fn mean_frame(folder: &Path, candidate: &Candidate) -> anyhow::Result<Vec<f32>> {
    let path = folder.join(MEAN_FRAME);
    let frame = image::open(&path)
        .with_context(|| {
            format!(
                "{}: the mean training frame; train writes it",
                path.display()
            )
        })?
        .into_luma8();
    let side = candidate.inspector.model().config.frame_size;
    if frame.width() as usize != side || frame.height() as usize != side {
        bail!("{} is not {side} x {side} pixels", path.display());
    }
    Ok(frame
        .into_raw()
        .into_iter()
        .map(|p| f32::from(p) / 255.0)
        .collect())
}
