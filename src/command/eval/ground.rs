//! What models are scored on.

use std::collections::HashSet;

use anyhow::{Context, bail};

use super::entrants::{Entrant, Source};
use super::scores::{Outcome, fault};
use crate::cli::EvalArgs;
use crate::command::{note, open, sample};
use crate::data::Dataset;
use crate::episode::{Episode, EpisodeSource, Split};
use crate::eval::score::{Candidate, Contest, score};
use crate::eval::summary::Scope;
use crate::model::config::Config;
use crate::model::observation::{self, suits};

/// What models are scored on: some episodes of a dataset.
pub struct Ground {
    /// The dataset; none where scores alone were named, which say themselves what they are of.
    dataset: Option<Dataset>,
    /// What to call it.
    pub scope: Scope,
    /// The episodes' places in the dataset.
    pub episodes: Vec<usize>,
}

impl Ground {
    /// What was asked for, else the sample's.
    pub fn of(args: &EvalArgs, entrants: &[Entrant]) -> anyhow::Result<Self> {
        if args.data.is_none()
            && let Source::Scores(scores) = &entrants[0].source
            && entrants.iter().all(|entrant| entrant.scorer().is_none())
        {
            if args.shard.is_some() {
                bail!("--shard: there is nothing to score");
            }
            let head = &scores.head;
            let split = args.split.map(|split| split.name().to_owned());
            return Ok(Self {
                dataset: None,
                scope: Scope {
                    data: head.data.clone(),
                    data_hash: head.data_hash.clone(),
                    split: split.unwrap_or_else(|| head.split.clone()),
                    ..Scope::default()
                },
                episodes: head.episodes.clone(),
            });
        }
        let path = sample::data(args.data.as_ref())?;
        let dataset = open::dataset(&path, &args.mapping.topics)?;
        let (split, episodes) = wanted(args, &dataset, entrants)?;
        let scope = Scope {
            data: dataset.name().to_owned(),
            data_hash: dataset.data_hash().to_owned(),
            split: split.name().to_owned(),
            ..Scope::default()
        };
        Ok(Self {
            dataset: Some(dataset),
            scope,
            episodes,
        })
    }

    /// The dataset, where it is at hand.
    pub fn dataset(&self) -> Option<&Dataset> {
        self.dataset.as_ref()
    }

    /// Which splits there are instead: `, but 24 of train`. What names none is of `train`.
    pub fn has(&self) -> String {
        let splits = self.dataset.as_ref().map(|dataset| dataset.splits(0));
        let of = |split: &Split| {
            let count = splits.iter().flatten().filter(|own| *own == split).count();
            (count > 0).then(|| format!("{count} of {}", split.name()))
        };
        let all: Vec<String> = [Split::Train, Split::Val, Split::Test]
            .iter()
            .filter_map(of)
            .collect();
        if all.is_empty() {
            return String::new();
        }
        format!(", but {}", all.join(", "))
    }

    /// Where the episodes come from, as [`Dataset::origin`] has it.
    pub fn origins(&self) -> HashSet<(&str, usize)> {
        let origin = |&i: &usize| self.dataset()?.origin(i);
        self.episodes.iter().filter_map(origin).collect()
    }

    /// Scores an episode by some candidates, or says of each why it is left out.
    pub fn score(
        &self,
        contest: &Contest,
        entrants: &[Entrant],
        candidates: &[usize],
        index: usize,
    ) -> anyhow::Result<Vec<Outcome>> {
        let Some(dataset) = &self.dataset else {
            bail!("no dataset to score on; name it by --data");
        };
        let left_out = |why: String| vec![Outcome::LeftOut(why); candidates.len()];
        let layout = contest.candidates[0].config.layout();
        let episode = match dataset.load(index, layout) {
            Ok(episode) => episode,
            Err(error) => return Ok(left_out(error.to_string())),
        };
        if let Some(why) = odd(&episode) {
            return Ok(left_out(why));
        }
        let id = &episode.meta.id;
        let (steps, images) = (episode.steps(), contest.protocol.images());
        let by = |&candidate: &usize| {
            let Candidate { label, config, .. } = &contest.candidates[candidate];
            if let Some(why) = unsuited(config, &episode) {
                return Ok(Outcome::LeftOut(format!("model `{label}`: {why}")));
            }
            if steps < images {
                return Ok(Outcome::LeftOut(format!(
                    "episode `{id}` has {steps} images of {images}; choose a smaller --horizon"
                )));
            }
            let scorer = entrants[candidate].scorer().context("no weights")?;
            let settings = contest.settings(candidate);
            let scores = score(scorer, &settings, contest.protocol, &episode)
                .with_context(|| format!("`{label}`, episode `{id}`"))?;
            let sizes = [config.latent, contest.protocol.horizon, settings.len()];
            Ok(match fault(&scores, sizes) {
                Some(what) => Outcome::LeftOut(format!("episode `{id}` by `{label}`: {what}")),
                None => Outcome::Scores(Box::new(scores)),
            })
        };
        candidates.iter().map(by).collect()
    }
}

/// The split that is scored, and its episodes. Where the dataset names no `val`, every training on it has cut its own by
/// its seed: episodes that one model has not seen another was trained on, so such models are refused together.
fn wanted(
    args: &EvalArgs,
    dataset: &Dataset,
    entrants: &[Entrant],
) -> anyhow::Result<(Split, Vec<usize>)> {
    let splits = |entrant: &Entrant| dataset.splits(entrant.about.training.split_seed());
    let trained_on_it = |entrant: &&Entrant| {
        let hash = entrant.about.training.data_hash.as_ref();
        hash.is_none_or(|hash| hash == dataset.data_hash())
    };
    let cutters: Vec<&Entrant> = entrants.iter().filter(trained_on_it).collect();
    let cutter = *cutters.first().unwrap_or(&&entrants[0]);
    let first = splits(cutter);
    let split = args.split.unwrap_or_else(|| {
        let has = |split: &Split| first.contains(split);
        let known = [Split::Test, Split::Val].into_iter().find(has);
        known.unwrap_or(Split::Test)
    });
    let of_split = |splits: &[Split]| -> Vec<usize> {
        let own = splits.iter().enumerate().filter(|(_, own)| **own == split);
        own.map(|(index, _)| index).collect()
    };
    let wanted = of_split(&first);
    let cut = split != Split::Test && !dataset.metas().iter().any(|m| m.split == Some(Split::Val));
    for entrant in cutters
        .iter()
        .filter(|e| cut && e.about.training.seed.is_none())
    {
        note(&format!(
            "note: {} does not say by which seed it was trained; if that was on {}, episodes of this `{}` were trained on",
            entrant.path.display(),
            dataset.name(),
            split.name()
        ));
    }
    for entrant in cutters.into_iter().skip(1) {
        if of_split(&splits(entrant)) != wanted {
            bail!(
                "{} names no split `val`: {} and {} have each cut their own from `train`, by different seeds; evaluate \
                 them apart, or on a dataset that names its splits",
                dataset.name(),
                cutter.path.display(),
                entrant.path.display()
            );
        }
    }
    Ok((split, wanted))
}

/// Why a model can make nothing of an episode: it lacks a sensor, or was measured in other units.
pub fn unsuited(config: &Config, episode: &Episode) -> Option<String> {
    let missing = observation::missing(config, episode);
    if missing.is_empty() {
        return suits(config, episode).err().map(|error| error.to_string());
    }
    let id = &episode.meta.id;
    Some(format!("episode `{id}` lacks {}", missing.join(", ")))
}

/// Why an episode says nothing about a model: what was odd when it was recorded, as training has it.
pub fn odd(episode: &Episode) -> Option<String> {
    let odd = episode.oddities().next()?;
    Some(format!("episode `{}`: {odd}", episode.meta.id))
}
