//! The models that are compared, with what was fitted for them.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use super::names::{Recipe, name};
use crate::command::open;
use crate::data::{Dataset, Role};
use crate::episode::{Episode, EpisodeSource, Split};
use crate::eval::protocol::Protocol;
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
        let (model, probe, hash) = checkpoint::load_with_hash(folder)?;
        let report = open::report(folder);
        recipes.push(Recipe::of(&model.config, &report));
        let candidate = Candidate {
            label: String::new(),
            recipe: String::new(),
            seed: report["seed"].as_u64(),
            contact_newtons: report["contact_newtons"].as_f64().map(|n| n as f32),
            regressors: regressors(&folder.join(PROBE), model.config.latent)?,
            inspector: Inspector::new(model)?,
            probe,
            hash,
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

/// The pose regressors that ship with a model.
fn regressors(path: &Path, latent: usize) -> anyhow::Result<Option<Regressors>> {
    if !path.exists() {
        return Ok(None);
    }
    let regressors = Regressors::read(path, latent)?;
    if let Some(found) = regressors.as_ref().map(Regressors::outputs)
        && found != regression::OUTPUTS
    {
        bail!(
            "{}: its regressors give {found} numbers where x, y and yaw's sine and cosine are wanted; \
             train again, or copy the checkpoint anew",
            path.display()
        );
    }
    Ok(regressors)
}

/// What pose regressors are fitted anew on.
pub struct Fit<'a> {
    /// Its training split is taken, for each model as its own training cut it.
    pub data: &'a Path,
    /// Where it has its roles.
    pub topics: &'a [(Role, String)],
    /// How predicted beliefs come about.
    pub protocol: Protocol,
    /// Episodes that are scored, as [`Dataset::origin`] names them.
    pub never: HashSet<(&'a str, usize)>,
    /// Whether to stop.
    pub stop: &'a AtomicBool,
}

impl Fit<'_> {
    /// Fits those of each candidate.
    pub fn each(&self, candidates: &mut [Candidate], folders: &[PathBuf]) -> anyhow::Result<()> {
        let dataset = Dataset::open_with(self.data, self.topics)?;
        for (candidate, folder) in candidates.iter_mut().zip(folders) {
            let splits = dataset.splits(open::split_seed(folder)).into_iter();
            let own = |(i, split)| (split == Split::Train).then_some(i);
            let train: Vec<usize> = splits.enumerate().filter_map(own).collect();
            candidate.regressors = Some(self.one(candidate, &dataset, train)?);
        }
        Ok(())
    }

    fn one(
        &self,
        candidate: &Candidate,
        dataset: &Dataset,
        train: Vec<usize>,
    ) -> anyhow::Result<Regressors> {
        let data = self.data.display();
        let scored = |i: &&usize| dataset.origin(**i).is_some_and(|o| self.never.contains(&o));
        if let Some(&index) = train.iter().find(scored) {
            let id = &dataset.metas()[index].id;
            bail!(
                "--fit {data}: episode `{id}` of its split `train` is one that is scored; score another --split"
            );
        }
        let style = ProgressStyle::with_template("fitting {bar:30} {pos}/{len} episodes, {msg}")?;
        let bar = ProgressBar::new(train.len() as u64).with_style(style);
        bar.set_message(candidate.label.clone());
        let model = candidate.inspector.model();
        let layout = model.config.layout();
        let episodes = train.into_par_iter().map(|index| {
            if self.stop.load(Ordering::Relaxed) {
                bail!("stopped");
            }
            bar.inc(1);
            let episode = dataset
                .load(index, layout)
                .map_err(|error| error.to_string());
            let sound = episode.and_then(|episode| odd(&episode).map_or(Ok(episode), Err));
            if let Err(why) = &sound {
                bar.suspend(|| eprintln!("left out of the fit: {why}"));
            }
            Ok(sound.ok().map(Arc::new))
        });
        let latents = regression::latents(&Inspector::new(model)?, episodes, self.protocol)?;
        bar.finish_and_clear();
        let too_few = "no object pose is recorded in its split `train`, or in too few images";
        latents
            .fit()?
            .with_context(|| format!("--fit {data}: {too_few}"))
    }
}

/// Why an episode says nothing about a model: what was odd when it was recorded, as training has it.
pub fn odd(episode: &Episode) -> Option<String> {
    let flag = episode.flags.first()?;
    let id = &episode.meta.id;
    Some(format!("episode `{id}`: {}: {}", flag.topic, flag.what))
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
