//! The score file: a line an episode, so that a run that was stopped goes on, and shards come together.

use std::collections::BTreeMap;
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

/// What scores must share to stand in one table: the first line of a score file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    poescope: String,
    data_hash: String,
    split: String,
    protocol: Protocol,
    /// Names what the checkpoints' files hold.
    models: Vec<String>,
    /// Names the mean training frame.
    mean_frame: String,
    /// Label, model and setting of each row.
    rows: Vec<(String, usize, Setting)>,
}

impl Identity {
    /// Of a contest.
    pub fn of(contest: &Contest, dataset: &Dataset, split: Split) -> Self {
        let rows = contest.subjects.iter();
        let models = contest.candidates.iter();
        let mean_frame = contest.mean_frame.iter().map(|p| p.to_bits().to_le_bytes());
        let mean_frame: Vec<u8> = mean_frame.flatten().collect();
        Self {
            poescope: env!("CARGO_PKG_VERSION").to_owned(),
            data_hash: dataset.data_hash().to_owned(),
            split: split.name().to_owned(),
            protocol: contest.protocol,
            models: models.map(|c| c.hash.clone()).collect(),
            mean_frame: format!("{:08x}", crc32fast::hash(&mean_frame)),
            rows: rows
                .map(|s| (s.label.clone(), s.candidate, s.setting.clone()))
                .collect(),
        }
    }
}

/// What came of an episode: a further line of a score file.
#[derive(Debug, Serialize, Deserialize)]
pub struct Line {
    /// Its place in the dataset: names need not be unique in a folder of files.
    pub index: usize,
    /// Why it could not be scored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub left_out: Option<String>,
    /// Its scores.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scores: Option<EpisodeScores>,
}

/// Lines so far, and where new ones go.
#[derive(Debug, Default)]
pub struct ScoreFile {
    lines: BTreeMap<usize, Line>,
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
        let mut lines = BTreeMap::new();
        let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
        for entry in entries {
            let name = entry?.file_name();
            let name = name.to_string_lossy();
            if name.starts_with("scores") && name.ends_with(".jsonl") && name != own {
                read(&folder.join(&*name), identity, &mut lines)?;
            }
        }
        let path = folder.join(own);
        let failed = || path.display().to_string();
        let whole = if path.exists() {
            read(&path, identity, &mut lines)?
        } else {
            0
        };
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .with_context(failed)?;
        // A kill may have left half a line. Another shard's may be one that it is writing right now.
        file.set_len(whole).with_context(failed)?;
        if whole == 0 {
            writeln!(file, "{}", serde_json::to_string(identity)?).with_context(failed)?;
        }
        Ok(Self {
            lines,
            file: Some((path, file)),
        })
    }

    /// Whether an episode is done with.
    pub fn has(&self, index: usize) -> bool {
        self.lines.contains_key(&index)
    }

    /// Adds what came of an episode.
    pub fn push(&mut self, line: Line) -> anyhow::Result<()> {
        if let Some((path, file)) = &mut self.file {
            let text = serde_json::to_string(&line)? + "\n";
            // One write a line: a kill leaves at most the last one torn.
            file.write_all(text.as_bytes())
                .with_context(|| path.display().to_string())?;
        }
        self.lines.insert(line.index, line);
        Ok(())
    }

    /// Why each episode that could not be scored was left out.
    pub fn left_out(&self) -> Vec<String> {
        let lines = self.lines.values();
        lines.filter_map(|line| line.left_out.clone()).collect()
    }

    /// Places and scores of the episodes that have some, in the dataset's order.
    pub fn scores(self) -> (Vec<usize>, Vec<EpisodeScores>) {
        let lines = self.lines.into_values();
        lines
            .filter_map(|line| Some((line.index, line.scores?)))
            .unzip()
    }
}

/// Reads a score file but for a torn last line; the length of what is whole.
fn read(
    path: &Path,
    identity: &Identity,
    lines: &mut BTreeMap<usize, Line>,
) -> anyhow::Result<u64> {
    let failed = || path.display().to_string();
    let mut file = BufReader::new(File::open(path).with_context(failed)?);
    let (mut whole, mut text) = (0, Vec::new());
    while file.read_until(b'\n', &mut text).with_context(failed)? > 0 {
        if text.last() != Some(&b'\n') {
            break;
        }
        if whole == 0 {
            let known: Identity = serde_json::from_slice(&text).with_context(|| {
                format!("{}: not a score file; choose another --out", path.display())
            })?;
            if known != *identity {
                bail!(
                    "{} holds scores of other models, data or settings; choose another --out, or remove it",
                    path.display()
                );
            }
        } else {
            let line: Line = serde_json::from_slice(&text)
                .with_context(|| format!("{}: a damaged line; remove the file", path.display()))?;
            lines.insert(line.index, line);
        }
        whole += text.len() as u64;
        text.clear();
    }
    Ok(whole)
}
