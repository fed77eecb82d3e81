//! The models that are compared, with what was fitted for them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail};
use rayon::prelude::*;

use super::names::{Recipe, name};
use crate::command::open;
use crate::data::{Dataset, Role};
use crate::episode::{EpisodeSource, Split};
use crate::eval::regression;
use crate::eval::score::Candidate;
use crate::model::checkpoint::{self, MEAN_FRAME, PROBE};
use crate::model::inspect::Inspector;
use crate::model::probe::Regressors;

/// Opens the checkpoints. They must see episodes in the same sizes.
pub fn open(folders: &[PathBuf]) -> anyhow::Result<Vec<Candidate>> {
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut recipes: Vec<Recipe> = Vec::new();
    for folder in folders {
        let (model, probe) = checkpoint::load(folder)?;
        let path = folder.join(PROBE);
        let regressors = if path.exists() {
            Regressors::read(&path, model.config.latent)?
        } else {
            None
        };
        let report = open::report(folder);
        recipes.push(Recipe::of(&model.config, report["updates"].as_u64()));
        let candidate = Candidate {
            label: String::new(),
            recipe: String::new(),
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
    name(&mut candidates, &recipes, folders);
    Ok(candidates)
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
