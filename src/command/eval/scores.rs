//! The score file: a line an episode, so that a run that was stopped goes on, and shards come together.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use crate::data::Dataset;
use crate::episode::{EpisodeSource, Split};
use crate::eval::protocol::Protocol;
use crate::eval::score::{Contest, EpisodeScores};
use crate::eval::setting::Setting;
use crate::model::checkpoint;

/// What scores must share to stand in one table: the first line of a score file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    poescope: String,
    data_hash: String,
    split: String,
    protocol: Protocol,
    /// Hashes of the checkpoints' files.
    models: Vec<String>,
    /// Label, model and setting of each row.
    rows: Vec<(String, usize, Setting)>,
}

impl Identity {
    /// Of a contest.
    pub fn of(
        contest: &Contest,
        folders: &[PathBuf],
        dataset: &Dataset,
        split: Split,
    ) -> anyhow::Result<Self> {
        let rows = contest.subjects.iter();
        let hashes = folders.iter().map(|folder| checkpoint::hash(folder));
        Ok(Self {
            poescope: env!("CARGO_PKG_VERSION").to_owned(),
            data_hash: dataset.data_hash().to_owned(),
            split: split.name().to_owned(),
            protocol: contest.protocol,
            models: hashes.collect::<Result<_, _>>()?,
            rows: rows
                .map(|s| (s.label.clone(), s.candidate, s.setting.clone()))
                .collect(),
        })
    }
}

/// Scores so far, and where new ones go.
#[derive(Debug, Default)]
pub struct ScoreFile {
    scores: HashMap<String, EpisodeScores>,
    file: Option<(PathBuf, File)>,
}

impl ScoreFile {
    /// Reads every score file of `folder` and goes on with the shard's own, or with the whole run's.
    pub fn open(
        folder: &Path,
        identity: &Identity,
        shard: Option<(usize, usize)>,
    ) -> anyhow::Result<Self> {
        let own = match shard {
            Some((i, n)) => format!("scores-{i}-of-{n}.jsonl"),
            None => "scores.jsonl".to_owned(),
        };
        let mut scores = HashMap::new();
        let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
        for entry in entries {
            let name = entry?.file_name();
            let name = name.to_string_lossy();
            if name.starts_with("scores") && name.ends_with(".jsonl") {
                read(&folder.join(&*name), identity, &mut scores)?;
            }
        }
        let path = folder.join(own);
        let failed = || path.display().to_string();
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .with_context(failed)?;
        if file.metadata().with_context(failed)?.len() == 0 {
            writeln!(file, "{}", serde_json::to_string(identity)?).with_context(failed)?;
        }
        Ok(Self {
            scores,
            file: Some((path, file)),
        })
    }

    /// Whether an episode is scored.
    pub fn has(&self, episode: &str) -> bool {
        self.scores.contains_key(episode)
    }

    /// Adds an episode's scores.
    pub fn push(&mut self, scores: EpisodeScores) -> anyhow::Result<()> {
        if let Some((path, file)) = &mut self.file {
            let line = serde_json::to_string(&scores)? + "\n";
            // One write a line: a kill leaves at most the last one torn.
            file.write_all(line.as_bytes())
                .with_context(|| path.display().to_string())?;
        }
        self.scores.insert(scores.episode.clone(), scores);
        Ok(())
    }

    /// The scores of the episodes, in their order.
    pub fn in_order(mut self, episodes: &[&str]) -> Vec<EpisodeScores> {
        episodes
            .iter()
            .filter_map(|id| self.scores.remove(*id))
            .collect()
    }
}

/// Reads a score file; a torn last line is cut off.
fn read(
    path: &Path,
    identity: &Identity,
    scores: &mut HashMap<String, EpisodeScores>,
) -> anyhow::Result<()> {
    let failed = || path.display().to_string();
    let mut lines = BufReader::new(File::open(path).with_context(failed)?);
    let (mut whole, mut line) = (0, Vec::new());
    let mut first = true;
    while lines.read_until(b'\n', &mut line).with_context(failed)? > 0 {
        if line.last() != Some(&b'\n') {
            break;
        }
        if first {
            let known: Identity = serde_json::from_slice(&line).with_context(|| {
                format!("{}: not a score file; choose another --out", path.display())
            })?;
            if known != *identity {
                bail!(
                    "{} holds scores of other models, data or settings; choose another --out, or remove it",
                    path.display()
                );
            }
            first = false;
        } else {
            let episode: EpisodeScores = serde_json::from_slice(&line)
                .with_context(|| format!("{}: a damaged line; remove the file", path.display()))?;
            scores.insert(episode.episode.clone(), episode);
        }
        whole += line.len() as u64;
        line.clear();
    }
    if !line.is_empty() {
        let file = OpenOptions::new()
            .write(true)
            .open(path)
            .with_context(failed)?;
        file.set_len(whole).with_context(failed)?;
    }
    Ok(())
}
