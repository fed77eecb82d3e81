//! Scores of every model on every episode: kept apart in files that a stopped run goes on with and shards come together
//! in, and joined for the tables.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::entrants::{Entrant, Source};
use super::ground::Ground;
use super::scores::{FORM, Head, Line, Outcome, Outcomes, Scores};
use crate::cli::EvalArgs;
use crate::eval::score::{Contest, EpisodeScores};
use crate::eval::setting::Setting;
use crate::model::checkpoint::write_atomic;

/// Where scores lie in the folder of the tables.
const SCORES: &str = "scores";

/// Outcomes of each model, in the order of the contest's candidates.
pub struct Ledger {
    models: Vec<Kept>,
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
    /// Takes up what lies in `--out`, and what was named itself.
    pub fn open(
        args: &EvalArgs,
        ground: &Ground,
        contest: &Contest,
        entrants: &[Entrant],
    ) -> anyhow::Result<Self> {
        let Ground {
            scope, episodes, ..
        } = ground;
        let mut models = Vec::with_capacity(entrants.len());
        for (candidate, entrant) in entrants.iter().enumerate() {
            let head = Head {
                scores: FORM,
                poescope: env!("CARGO_PKG_VERSION").to_owned(),
                data: scope.data.clone(),
                data_hash: scope.data_hash.clone(),
                split: scope.split.clone(),
                episodes: episodes.clone(),
                protocol: contest.protocol,
                settings: settings(contest, candidate),
                model: entrant.about.clone(),
            };
            models.push(match (&entrant.source, &args.out) {
                (Source::Scores(scores), _) => Kept {
                    outcomes: picked(scores, &head)
                        .with_context(|| entrant.path.display().to_string())?,
                    file: None,
                },
                (Source::Weights(_), Some(out)) => {
                    Kept::open(&out.join(SCORES), &head, args.shard)?
                }
                (Source::Weights(_), None) => Kept::default(),
            });
        }
        Ok(Self { models })
    }

    /// The models that an episode is not scored by yet.
    pub fn lacking(&self, index: usize) -> Vec<usize> {
        let lacks = |&candidate: &usize| !self.models[candidate].outcomes.contains_key(&index);
        (0..self.models.len()).filter(lacks).collect()
    }

    /// Adds what came of an episode for a model.
    pub fn push(&mut self, candidate: usize, line: Line) -> anyhow::Result<()> {
        self.models[candidate].push(line)
    }

    /// Brings together what every model has scored.
    pub fn joined(&self, contest: &Contest, wanted: &[usize]) -> Joined {
        let mut joined = Joined::default();
        for &index in wanted {
            let outcomes = self.models.iter().map(|model| model.outcomes.get(&index));
            let mut scores = Vec::with_capacity(self.models.len());
            let mut left_out = None;
            for outcome in outcomes.flatten() {
                match outcome {
                    Outcome::Scores(own) => scores.push(own),
                    Outcome::LeftOut(why) => left_out = Some(why.clone()),
                }
            }
            if let Some(why) = left_out {
                joined.left_out.push(why);
            } else if let Some(episode) = join(contest, &scores) {
                joined.indices.push(index);
                joined.all.push(episode);
            }
        }
        joined
    }
}

/// An episode's rows in the contest's order, of each model's in its own; what needs no model is the first's.
fn join(contest: &Contest, scores: &[&EpisodeScores]) -> Option<EpisodeScores> {
    let mut rows: Vec<_> = scores.iter().map(|own| own.subjects.iter()).collect();
    let subjects = contest.subjects.iter();
    let row = |candidate: usize| rows.get_mut(candidate)?.next().cloned();
    let subjects = subjects.map(|subject| subject.candidate).map(row);
    let subjects = subjects.collect::<Option<_>>()?;
    let first = *scores.first()?;
    Some(EpisodeScores {
        episode: first.episode.clone(),
        poses: first.poses.clone(),
        force_newtons: first.force_newtons.clone(),
        held: first.held.clone(),
        mean_frame: first.mean_frame.clone(),
        subjects,
    })
}

/// What a model stands in the tables under.
pub fn settings(contest: &Contest, candidate: usize) -> Vec<Setting> {
    let own = contest.subjects.iter().filter(|s| s.candidate == candidate);
    own.map(|subject| subject.setting.clone()).collect()
}

/// The rows that `wanted` asks for, of a score file that was named itself.
fn picked(scores: &Scores, wanted: &Head) -> anyhow::Result<Outcomes> {
    let Scores { head, outcomes, .. } = scores;
    if let Some(why) = head.refusal(wanted) {
        bail!("{why}");
    }
    if head.episodes != wanted.episodes {
        bail!(
            "scores of other episodes of split `{}`: another seed has cut it",
            head.split
        );
    }
    let place = |setting: &Setting| {
        let place = head.settings.iter().position(|own| own == setting);
        place.with_context(|| {
            format!(
                "no scores under `{}`; name its checkpoint folder",
                setting.name
            )
        })
    };
    let places = wanted.settings.iter().map(place);
    let places: Vec<usize> = places.collect::<anyhow::Result<_>>()?;
    let mut outcomes = outcomes.clone();
    for outcome in outcomes.values_mut() {
        if let Outcome::Scores(own) = outcome {
            let rows = places.iter().filter_map(|&place| own.subjects.get(place));
            own.subjects = rows.cloned().collect();
        }
    }
    Ok(outcomes)
}

/// Outcomes of a model, and the file that new ones go to.
#[derive(Default)]
struct Kept {
    outcomes: Outcomes,
    file: Option<Sink>,
}

impl Kept {
    /// Reads every score file of this model in `folder` and goes on with the shard's own, or with the whole run's, which
    /// takes in what shards have left.
    fn open(folder: &Path, head: &Head, shard: Option<(usize, usize)>) -> anyhow::Result<Self> {
        // The hash tells it from another model in a folder of that name, and from what it was before more training.
        let stem = format!("{}-{}", head.model.folder, head.model.hash);
        let path = folder.join(match shard {
            Some((i, n)) => format!("{stem}-{i}-of-{n}.jsonl"),
            None => format!("{stem}.jsonl"),
        });
        let admitted = |path: &Path| -> anyhow::Result<Option<Scores>> {
            let scores = Scores::read(path)?;
            let others = scores.as_ref().and_then(|scores| {
                let other = || "scores under other settings".to_owned();
                let differ = scores.head.settings != head.settings;
                scores.head.refusal(head).or_else(|| differ.then(other))
            });
            if let Some(why) = others {
                bail!("{} holds {why}, or choose another --out", path.display());
            }
            Ok(scores)
        };
        let mut outcomes = Outcomes::new();
        for sibling in siblings(folder, &stem)? {
            if sibling != path {
                outcomes.extend(admitted(&sibling)?.into_iter().flat_map(|s| s.outcomes));
            }
        }
        let own = if path.exists() {
            admitted(&path)?
        } else {
            None
        };
        let whole = own.as_ref().map_or(0, |own| own.whole);
        let known = own.as_ref().map_or(0, |own| own.outcomes.len());
        let as_is = own
            .as_ref()
            .is_none_or(|own| own.head.model == head.model && own.head.episodes == head.episodes);
        outcomes.extend(own.into_iter().flat_map(|own| own.outcomes));
        let mut sink = Sink {
            path,
            head: serde_json::to_string(head)? + "\n",
            whole,
            file: None,
        };
        if shard.is_none() && (!as_is || outcomes.len() > known) {
            sink.rewrite(&outcomes)?;
        }
        Ok(Self {
            outcomes,
            file: Some(sink),
        })
    }

    fn push(&mut self, line: Line) -> anyhow::Result<()> {
        if let Some(file) = &mut self.file {
            file.push(&(serde_json::to_string(&line)? + "\n"))?;
        }
        self.outcomes.insert(line.index, line.outcome);
        Ok(())
    }
}

/// The score files of a model: that of a whole run, and of shards.
fn siblings(folder: &Path, stem: &str) -> anyhow::Result<Vec<PathBuf>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let of_shard = |rest: &str| {
        let (i, n) = rest.strip_prefix('-')?.split_once("-of-")?;
        Some(i.parse::<usize>().is_ok() && n.parse::<usize>().is_ok())
    };
    let mut found = Vec::new();
    let failed = || folder.display().to_string();
    for entry in std::fs::read_dir(folder).with_context(failed)? {
        let name = entry.with_context(failed)?.file_name();
        let name = name.to_string_lossy();
        let rest = name
            .strip_prefix(stem)
            .and_then(|rest| rest.strip_suffix(".jsonl"));
        if rest.is_some_and(|rest| rest.is_empty() || of_shard(rest) == Some(true)) {
            found.push(folder.join(&*name));
        }
    }
    Ok(found)
}

/// A score file that grows. It is made when there is something to write: a command that fails leaves none.
struct Sink {
    path: PathBuf,
    /// Its first line.
    head: String,
    /// What stands of it; a kill may have left half a line after that.
    whole: u64,
    file: Option<File>,
}

impl Sink {
    fn push(&mut self, line: &str) -> anyhow::Result<()> {
        let path = &self.path;
        let failed = || path.display().to_string();
        if self.file.is_none() {
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder).with_context(failed)?;
            }
            let file = OpenOptions::new().create(true).append(true).open(path);
            let mut file = file.with_context(failed)?;
            file.set_len(self.whole).with_context(failed)?;
            if self.whole == 0 {
                file.write_all(self.head.as_bytes()).with_context(failed)?;
            }
            self.file = Some(file);
        }
        if let Some(file) = &mut self.file {
            // One write a line: a kill leaves at most the last one torn.
            file.write_all(line.as_bytes()).with_context(failed)?;
        }
        Ok(())
    }

    /// Writes all of it anew.
    fn rewrite(&mut self, outcomes: &Outcomes) -> anyhow::Result<()> {
        let mut text = self.head.clone();
        for (&index, outcome) in outcomes {
            let outcome = outcome.clone();
            text += &serde_json::to_string(&Line { index, outcome })?;
            text.push('\n');
        }
        write_atomic(&self.path, text.as_bytes())?;
        self.whole = text.len() as u64;
        Ok(())
    }
}
