//! Pose regressors, fitted anew.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context, bail};
use rayon::prelude::*;

use super::entrants::Entrant;
use super::ground::{odd, unsuited};
use crate::command::{note, open, progress_bar};
use crate::data::{Dataset, Role};
use crate::episode::{Episode, EpisodeSource, Split};
use crate::eval::protocol::Protocol;
use crate::eval::regression;
use crate::eval::score::{Candidate, Scorer};
use crate::eval::summary::Refit;
use crate::model::inspect::Inspector;
use crate::model::probe::Regressors;

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
    /// Fits those of each candidate; says on what.
    pub fn each(
        &self,
        candidates: &mut [Candidate],
        entrants: &[Entrant],
    ) -> anyhow::Result<Refit> {
        let mut scorers = Vec::with_capacity(entrants.len());
        for entrant in entrants {
            let path = entrant.path.display();
            let weightless =
                || format!("--fit: {path} has scores alone; name the checkpoint folder instead");
            scorers.push((entrant, entrant.scorer().with_context(weightless)?));
        }
        let dataset = open::dataset(self.data, self.topics)?;
        for (candidate, (entrant, scorer)) in candidates.iter_mut().zip(scorers) {
            let splits = dataset
                .splits(entrant.about.training.split_seed())
                .into_iter();
            let own = |(i, split)| (split == Split::Train).then_some(i);
            let train: Vec<usize> = splits.enumerate().filter_map(own).collect();
            let label = candidate.label.clone();
            candidate.regressors = Some(self.one(scorer, label, &dataset, train)?);
        }
        Ok(Refit {
            data: dataset.name().to_owned(),
            data_hash: dataset.data_hash().to_owned(),
        })
    }

    fn one(
        &self,
        scorer: &Scorer,
        label: String,
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
        let template = "fitting {bar:30} {pos}/{len} episodes, {msg}";
        let bar = progress_bar(train.len(), template);
        bar.set_message(label);
        let model = scorer.inspector.model();
        let layout = model.config.layout();
        let episodes = train.into_par_iter().map(|index| {
            if self.stop.load(Ordering::Relaxed) {
                bail!("stopped");
            }
            bar.inc(1);
            let episode = dataset
                .load(index, layout)
                .map_err(|error| error.to_string());
            let fault = |e: &Episode| odd(e).or_else(|| unsuited(&model.config, e));
            let sound = episode.and_then(|episode| fault(&episode).map_or(Ok(episode), Err));
            if let Err(why) = &sound {
                bar.suspend(|| note(&format!("left out of the fit: {why}")));
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
