//! Scores of every model on every episode: kept apart, brought together for the tables.

use std::path::Path;

use anyhow::{Context, bail};

use super::entrants::Entrant;
use super::scores::{Head, Line, ScoreFile};
use crate::cli::EvalArgs;
use crate::data::Dataset;
use crate::episode::EpisodeSource;
use crate::eval::score::{Contest, EpisodeScores, score};
use crate::eval::setting::Setting;
use crate::eval::summary::Scope;
use crate::model::observation::{self, suits};

/// Where scores lie in the folder of the tables.
const SCORES: &str = "scores";

/// A score file of each model, in the order of the contest's candidates.
pub struct Ledger {
    files: Vec<ScoreFile>,
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
    /// Opens those of `--out`, or none that stay, and takes over what was named itself.
    pub fn open(
        args: &EvalArgs,
        scope: &Scope,
        contest: &Contest,
        entrants: &mut [Entrant],
    ) -> anyhow::Result<Self> {
        let folder = args.out.as_ref().map(|out| out.join(SCORES));
        if let Some(folder) = &folder {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("making {}", folder.display()))?;
        }
        let mut files = Vec::with_capacity(entrants.len());
        for (candidate, entrant) in entrants.iter_mut().enumerate() {
            let head = Head {
                poescope: env!("CARGO_PKG_VERSION").to_owned(),
                data: scope.data.clone(),
                data_hash: scope.data_hash.clone(),
                split: scope.split.clone(),
                protocol: contest.protocol,
                settings: settings(contest, candidate),
                model: entrant.about.clone(),
            };
            files.push(match (entrant.scores.take(), &folder) {
                (Some(scores), _) => scores
                    .picked(head)
                    .with_context(|| entrant.path.display().to_string())?,
                (None, Some(folder)) => ScoreFile::open(folder, head, args.shard)?,
                (None, None) => ScoreFile::fleeting(head),
            });
        }
        Ok(Self { files })
    }

    /// The models that an episode is not scored by yet.
    pub fn lacking(&self, index: usize) -> Vec<usize> {
        let files = self.files.iter().enumerate();
        let lacking = files.filter(|(_, file)| file.line(index).is_none());
        lacking.map(|(candidate, _)| candidate).collect()
    }

    /// Adds what came of an episode for some models.
    pub fn push(&mut self, lines: Vec<(usize, Line)>) -> anyhow::Result<()> {
        for (candidate, line) in lines {
            self.files[candidate].push(line)?;
        }
        Ok(())
    }

    /// Brings together what every model has scored.
    pub fn joined(&self, contest: &Contest, wanted: &[usize]) -> Joined {
        let mut joined = Joined::default();
        for &index in wanted {
            let lines: Vec<&Line> = self.files.iter().filter_map(|f| f.line(index)).collect();
            if let Some(why) = lines.iter().find_map(|line| line.left_out.clone()) {
                joined.left_out.push(why);
                continue;
            }
            let scores: Vec<&EpisodeScores> =
                lines.iter().filter_map(|l| l.scores.as_ref()).collect();
            if let (Some(first), true) = (scores.first(), scores.len() == self.files.len()) {
                let mut next = vec![0; scores.len()];
                let rows = contest.subjects.iter().filter_map(|subject| {
                    let candidate = subject.candidate;
                    next[candidate] += 1;
                    scores[candidate].subjects.get(next[candidate] - 1).cloned()
                });
                joined.indices.push(index);
                joined.all.push(EpisodeScores {
                    subjects: rows.collect(),
                    ..(*first).clone()
                });
            }
        }
        joined
    }
}

/// What a model stands in the tables under.
fn settings(contest: &Contest, candidate: usize) -> Vec<Setting> {
    let own = contest.subjects.iter().filter(|s| s.candidate == candidate);
    own.map(|subject| subject.setting.clone()).collect()
}

/// Scores an episode by the models that lack it, or says why it is left out.
pub fn one(
    contest: &Contest,
    entrants: &[Entrant],
    lacking: &[usize],
    dataset: &Dataset,
    (index, path): (usize, &Path),
) -> anyhow::Result<Vec<(usize, Line)>> {
    let left_out = |why: String| {
        let line = |&candidate: &usize| {
            let left_out = Some(why.clone());
            let scores = None;
            (
                candidate,
                Line {
                    index,
                    left_out,
                    scores,
                },
            )
        };
        lacking.iter().map(line).collect()
    };
    let layout = contest.candidates[0].config.layout();
    let episode = match dataset.load(index, layout) {
        Ok(episode) => episode,
        Err(error) => return Ok(left_out(error.to_string())),
    };
    if let Some(why) = super::odd(&episode) {
        return Ok(left_out(why));
    }
    let id = &episode.meta.id;
    for candidate in &contest.candidates {
        let missing = observation::missing(&candidate.config, &episode);
        if !missing.is_empty() {
            bail!(
                "{}: episode `{id}` lacks {}, which model `{}` sees",
                path.display(),
                missing.join(", "),
                candidate.label
            );
        }
        suits(&candidate.config, &episode).with_context(|| path.display().to_string())?;
    }
    let (steps, images) = (episode.steps(), contest.protocol.images());
    if steps < images {
        return Ok(left_out(format!(
            "episode `{id}` has {steps} images of {images}; choose a smaller --horizon"
        )));
    }
    let mut lines = Vec::with_capacity(lacking.len());
    for &candidate in lacking {
        let Some(scorer) = &entrants[candidate].scorer else {
            bail!(
                "{} has no scores of episode `{id}`; name the checkpoint folder instead",
                entrants[candidate].path.display()
            );
        };
        let settings = settings(contest, candidate);
        let scores = score(scorer, &settings, contest.protocol, &episode).with_context(|| {
            format!("`{}`, episode `{id}`", contest.candidates[candidate].label)
        })?;
        let line = Line {
            index,
            left_out: None,
            scores: Some(scores),
        };
        lines.push((candidate, line));
    }
    Ok(lines)
}
