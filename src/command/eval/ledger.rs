//! Scores of every model on every episode: kept apart in files that a stopped run goes on with and shards come together
//! in, and joined for the tables.

use std::mem::take;
use std::path::Path;

use anyhow::{Context, bail};

use super::entrants::{Entrant, Source};
use super::ground::Ground;
use super::kept::Kept;
use super::scores::{FORM, Head, Outcome, Outcomes, Scores};
use crate::eval::score::{Contest, EpisodeScores};
use crate::eval::setting::Setting;

/// Where scores lie in the folder of the tables.
const SCORES: &str = "scores";

/// Outcomes of each model.
pub struct Ledger {
    models: Vec<Kept>,
    /// The model of each of the contest's candidates: the same one may be named twice.
    of: Vec<usize>,
}

/// Where scores are kept.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    /// The folder of the tables; none to keep nothing.
    pub out: Option<&'a Path>,
    /// Which part of the episodes is scored, of how many.
    pub shard: Option<(usize, usize)>,
    /// Whether what is there is only summed up.
    pub merge: bool,
}

/// Scores of every row, and their episodes' places in the dataset.
#[derive(Default)]
pub struct Joined {
    /// Places in the dataset.
    pub indices: Vec<usize>,
    /// As many episodes.
    pub all: Vec<EpisodeScores>,
    /// Why each other episode was left out.
    pub left_out: Vec<String>,
}

impl Ledger {
    /// Takes up what lies in the folder of the tables, and what was named itself.
    pub fn open(
        place: Place<'_>,
        ground: &Ground,
        contest: &Contest,
        entrants: &mut [Entrant],
    ) -> anyhow::Result<Self> {
        let (mut models, mut of) = (Vec::new(), Vec::with_capacity(entrants.len()));
        for candidate in 0..entrants.len() {
            let (before, rest) = entrants.split_at_mut(candidate);
            let Some(entrant) = rest.first_mut() else {
                continue;
            };
            let hash = &entrant.about.hash;
            if let Some(same) = before.iter().position(|other| other.about.hash == *hash) {
                of.push(of[same]);
                continue;
            }
            of.push(models.len());
            let scope = &ground.scope;
            let head = Head {
                scores: FORM,
                poescope: env!("CARGO_PKG_VERSION").to_owned(),
                data: scope.data.clone(),
                data_hash: scope.data_hash.clone(),
                split: scope.split.clone(),
                episodes: ground.episodes.clone(),
                protocol: contest.protocol,
                settings: contest.settings(candidate),
                model: entrant.about.clone(),
            };
            models.push(match (&mut entrant.source, place.out) {
                (Source::Scores(scores), _) => {
                    let named = || entrant.path.display().to_string();
                    Kept::fixed(picked(scores, &head).with_context(named)?)
                }
                (Source::Weights(_), Some(out)) => {
                    Kept::open(&out.join(SCORES), &head, place.shard, place.merge)?
                }
                (Source::Weights(_), None) => Kept::default(),
            });
        }
        Ok(Self { models, of })
    }

    /// Whether an episode is not scored by a candidate yet.
    pub fn lacks(&self, candidate: usize, index: usize) -> bool {
        !self.models[self.of[candidate]].has(index)
    }

    /// The candidates that an episode is to be scored by, each model once.
    pub fn lacking(&self, index: usize) -> Vec<usize> {
        let first = |&c: &usize| self.of.iter().position(|of| *of == self.of[c]) == Some(c);
        let lacking = (0..self.of.len()).filter(|&c| self.lacks(c, index));
        lacking.filter(first).collect()
    }

    /// Adds what came of an episode for a candidate.
    pub fn push(&mut self, candidate: usize, index: usize, outcome: Outcome) -> anyhow::Result<()> {
        self.models[self.of[candidate]].push(index, outcome)
    }

    /// Brings together what every model has scored.
    pub fn joined(mut self, contest: &Contest, wanted: &[usize]) -> Joined {
        let mut joined = Joined::default();
        for &index in wanted {
            let mut scores = Vec::with_capacity(self.models.len());
            let mut left_out = None;
            for model in &mut self.models {
                match model.take(index) {
                    Some(Outcome::Scores(own)) => scores.push(*own),
                    Some(Outcome::LeftOut(why)) => left_out = Some(why),
                    None => {}
                }
            }
            if let Some(why) = left_out {
                joined.left_out.push(why);
            } else if scores.len() == self.models.len() {
                joined.indices.push(index);
                joined.all.push(join(contest, &self.of, scores));
            }
        }
        joined
    }
}

/// An episode's rows in the contest's order, of each model's in its own; what needs no model is the first's.
fn join(contest: &Contest, of: &[usize], mut scores: Vec<EpisodeScores>) -> EpisodeScores {
    let mut next = vec![0; of.len()];
    let subjects = contest.subjects.iter().filter_map(|subject| {
        let row = scores[of[subject.candidate]]
            .subjects
            .get(next[subject.candidate]);
        next[subject.candidate] += 1;
        row.cloned()
    });
    let subjects = subjects.collect();
    EpisodeScores {
        subjects,
        ..scores.swap_remove(of[0])
    }
}

/// The rows that `wanted` asks for, of a score file that was named itself; takes them out of it.
fn picked(scores: &mut Scores, wanted: &Head) -> anyhow::Result<Outcomes> {
    let head = &scores.head;
    if let Some(why) = head.refusal(wanted) {
        bail!("{why}");
    }
    if head.episodes != wanted.episodes {
        bail!(
            "scores of other episodes of split `{}`, which another seed has cut; evaluate them apart",
            head.split
        );
    }
    let place = |setting: &Setting| {
        let place = head.settings.iter().position(|own| own == setting);
        let none = || {
            let name = &setting.name;
            format!("no scores under `{name}`; name its checkpoint folder instead")
        };
        place.with_context(none)
    };
    let places = wanted.settings.iter().map(place);
    let places: Vec<usize> = places.collect::<anyhow::Result<_>>()?;
    let mut outcomes = take(&mut scores.outcomes);
    for outcome in outcomes.values_mut() {
        if let Outcome::Scores(own) = outcome {
            let rows = places.iter().map(|&place| take(&mut own.subjects[place]));
            own.subjects = rows.collect();
        }
    }
    Ok(outcomes)
}
