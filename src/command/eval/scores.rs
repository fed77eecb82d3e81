//! Score files: of each model one, a line an episode, so that a run that was stopped goes on, shards come together, and
//! a model stands in later tables without being scored again, or without its weights.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use super::entrants::About;
use crate::eval::protocol::Protocol;
use crate::eval::score::EpisodeScores;
use crate::eval::setting::Setting;

/// What the scores are of: the first line of a score file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// The version that scored.
    pub poescope: String,
    /// The dataset's name.
    pub data: String,
    /// Names what it holds.
    pub data_hash: String,
    /// The split.
    pub split: String,
    /// How much is seen and predicted.
    pub protocol: Protocol,
    /// What each row of a line was scored under.
    pub settings: Vec<Setting>,
    /// Whose.
    pub model: About,
}

impl Head {
    /// Why scores of `self` cannot stand for what `wanted` asks for.
    fn refusal(&self, wanted: &Self) -> Option<String> {
        let version = |head: &Self| format!("poescope {}", head.poescope);
        let data = |head: &Self| format!("{} ({})", head.data, head.data_hash);
        let split = |head: &Self| format!("split `{}`", head.split);
        let protocol = |head: &Self| {
            let Protocol { context, horizon } = head.protocol;
            format!("{context} images seen and {horizon} predicted")
        };
        let weights = |head: &Self| format!("weights {}", head.model.hash);
        let parts: [&dyn Fn(&Self) -> String; 5] = [&version, &data, &split, &protocol, &weights];
        let differs = parts.iter().find(|part| part(self) != part(wanted));
        if let Some(part) = differs {
            return Some(format!("scores of {}, not of {}", part(self), part(wanted)));
        }
        let other_frame = self.model.mean_frame != wanted.model.mean_frame;
        other_frame.then(|| "scores beside another mean training frame".to_owned())
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
#[derive(Debug)]
pub struct ScoreFile {
    head: Head,
    lines: BTreeMap<usize, Line>,
    file: Option<(PathBuf, File)>,
}

impl ScoreFile {
    /// That of a run that keeps nothing.
    pub fn fleeting(head: Head) -> Self {
        Self {
            head,
            lines: BTreeMap::new(),
            file: None,
        }
    }

    /// What an earlier run left, as it is or packed by `zstd`.
    pub fn published(path: &Path) -> anyhow::Result<Self> {
        let mut lines = BTreeMap::new();
        let (head, _) = read(path, None, &mut lines)?;
        let empty = || format!("{}: no score file, nor a checkpoint folder", path.display());
        Ok(Self {
            head: head.with_context(empty)?,
            lines,
            file: None,
        })
    }

    /// Reads every score file of this model in `folder` and goes on with the shard's own, or with the whole run's.
    pub fn open(folder: &Path, head: Head, shard: Option<(usize, usize)>) -> anyhow::Result<Self> {
        // The hash tells it from another model of a folder of that name, and from what it was before more training.
        let short: String = head.model.hash.chars().take(8).collect();
        let stem = format!("{}-{short}", head.model.folder);
        let own = match shard {
            Some((i, n)) => format!("{stem}-{i}-of-{n}.jsonl"),
            None => format!("{stem}.jsonl"),
        };
        let mut lines = BTreeMap::new();
        let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
        for entry in entries {
            let name = entry?.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(&stem) && name.ends_with(".jsonl") && name != own {
                read(&folder.join(&*name), Some(&head), &mut lines)?;
            }
        }
        let path = folder.join(own);
        let failed = || path.display().to_string();
        let (known, whole) = if path.exists() {
            read(&path, Some(&head), &mut lines)?
        } else {
            (None, 0)
        };
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .with_context(failed)?;
        // A kill may have left half a line. Another shard's may be one that it is writing right now.
        file.set_len(whole).with_context(failed)?;
        if known.is_none() {
            writeln!(file, "{}", serde_json::to_string(&head)?).with_context(failed)?;
        }
        Ok(Self {
            head: known.unwrap_or(head),
            lines,
            file: Some((path, file)),
        })
    }

    /// What the scores are of.
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// The rows that `wanted` asks for, of what an earlier run left.
    pub fn picked(mut self, wanted: Head) -> anyhow::Result<Self> {
        if let Some(why) = self.head.refusal(&wanted) {
            bail!("{why}");
        }
        let place = |setting: &Setting| {
            let place = self.head.settings.iter().position(|own| own == setting);
            place.with_context(|| format!("no scores under `{}`", setting.name))
        };
        let places: Vec<usize> = wanted
            .settings
            .iter()
            .map(place)
            .collect::<anyhow::Result<_>>()?;
        for scores in self.lines.values_mut().filter_map(|l| l.scores.as_mut()) {
            let rows = places
                .iter()
                .map(|&place| scores.subjects.get(place).cloned());
            scores.subjects = rows
                .collect::<Option<_>>()
                .context("a line without its rows")?;
        }
        self.head = wanted;
        Ok(self)
    }

    /// The places in the dataset that are done with.
    pub fn indices(&self) -> impl Iterator<Item = usize> {
        self.lines.keys().copied()
    }

    /// What came of an episode; none while it is not done with.
    pub fn line(&self, index: usize) -> Option<&Line> {
        self.lines.get(&index)
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
}

/// Reads a score file but for a torn last line, refusing one that cannot stand for `wanted`: its head, and the length of
/// what is whole.
fn read(
    path: &Path,
    wanted: Option<&Head>,
    lines: &mut BTreeMap<usize, Line>,
) -> anyhow::Result<(Option<Head>, u64)> {
    let failed = || path.display().to_string();
    let file = File::open(path).with_context(failed)?;
    let packed = path.extension().is_some_and(|extension| extension == "zst");
    let source: Box<dyn Read> = if packed {
        Box::new(zstd::Decoder::new(file).with_context(failed)?)
    } else {
        Box::new(file)
    };
    let mut source = BufReader::new(source);
    let (mut head, mut whole, mut text) = (None, 0, Vec::new());
    while source.read_until(b'\n', &mut text).with_context(failed)? > 0 {
        if text.last() != Some(&b'\n') {
            break;
        }
        if head.is_none() {
            let known: Head = serde_json::from_slice(&text)
                .with_context(|| format!("{}: not a score file", path.display()))?;
            let others = |wanted: &Head| {
                let other = || "scores under other settings".to_owned();
                let differ = known.settings != wanted.settings;
                known.refusal(wanted).or_else(|| differ.then(other))
            };
            if let Some(why) = wanted.and_then(others) {
                bail!(
                    "{} holds {why}; choose another --out, or remove it",
                    path.display()
                );
            }
            head = Some(known);
        } else {
            let line: Line = serde_json::from_slice(&text)
                .with_context(|| format!("{}: a damaged line; remove the file", path.display()))?;
            lines.insert(line.index, line);
        }
        whole += text.len() as u64;
        text.clear();
    }
    Ok((head, whole))
}
