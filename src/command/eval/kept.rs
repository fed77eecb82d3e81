//! The score files of one model in a folder: read whole, and one of them gone on with.

use std::collections::BTreeSet;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use crate::model::checkpoint::write_atomic;

use super::scores::{Head, Line, Outcome, Outcomes, Scores};

/// Outcomes of a model, and the file that new ones go to.
#[derive(Default)]
pub struct Kept {
    outcomes: Outcomes,
    /// Episodes that were left out and are looked at again: a damaged chunk may have been mended since, which the data
    /// hash does not know.
    again: BTreeSet<usize>,
    sink: Option<Sink>,
}

impl Kept {
    /// To which nothing is added.
    pub fn fixed(outcomes: Outcomes) -> Self {
        Self {
            outcomes,
            ..Self::default()
        }
    }

    /// Reads every score file of this model in `folder` and goes on with the shard's own, or with the whole run's, which
    /// takes in what shards have left. What was left out is looked at again, unless all is only summed up (`merge`).
    pub fn open(
        folder: &Path,
        head: &Head,
        shard: Option<(usize, usize)>,
        merge: bool,
    ) -> anyhow::Result<Self> {
        let stem = format!("{}-{}", head.model.folder, head.model.hash);
        let path = folder.join(match shard {
            Some((i, n)) => format!("{stem}-{i}-of-{n}.jsonl"),
            None => format!("{stem}.jsonl"),
        });
        let mut outcomes = Outcomes::new();
        for sibling in siblings(folder, &head.model.hash)? {
            if sibling != path {
                let scores = admitted(&sibling, head)?;
                take_in(&mut outcomes, scores.map(|scores| scores.outcomes));
            }
        }
        let mut sink = Sink {
            path,
            head: serde_json::to_string(head)? + "\n",
            file: None,
        };
        // Nobody else writes to it from here on, so that what is read and cut is what it stays.
        let own = if sink.path.exists() {
            sink.take_up()?;
            admitted(&sink.path, head)?
        } else {
            None
        };
        if sink.file.is_some() {
            let whole = own.as_ref().map_or(0, |own| own.whole);
            sink.cut(whole)?;
            if whole == 0 {
                sink.write(&sink.head)?;
            }
        }
        let known = own.as_ref().map_or(0, |own| own.outcomes.len());
        let as_is = own.as_ref().is_none_or(|Scores { head: own, .. }| {
            own.model == head.model && own.episodes == head.episodes
        });
        take_in(&mut outcomes, own.map(|own| own.outcomes));
        if shard.is_none() && (!as_is || outcomes.len() > known) {
            sink.rewrite(&outcomes)?;
        }
        let left_out = outcomes.iter().filter(|(_, o)| o.left_out().is_some());
        let again = left_out.map(|(&index, _)| index).filter(|_| !merge);
        Ok(Self {
            again: again.collect(),
            outcomes,
            sink: Some(sink),
        })
    }

    /// Whether an episode is done with.
    pub fn has(&self, index: usize) -> bool {
        self.outcomes.contains_key(&index) && !self.again.contains(&index)
    }

    /// Takes out what came of an episode.
    pub fn take(&mut self, index: usize) -> Option<Outcome> {
        self.outcomes.remove(&index)
    }

    /// Adds what came of an episode.
    pub fn push(&mut self, index: usize, outcome: Outcome) -> anyhow::Result<()> {
        self.again.remove(&index);
        let before = self.outcomes.get(&index).and_then(Outcome::left_out);
        let said = before.is_some() && before == outcome.left_out();
        if let (false, Some(sink)) = (said, &mut self.sink) {
            sink.push(&line(index, &outcome)?)?;
        }
        self.outcomes.insert(index, outcome);
        Ok(())
    }
}

/// Adds outcomes to those of other files. What one run left out another may have scored since.
fn take_in(outcomes: &mut Outcomes, others: Option<Outcomes>) {
    for (index, outcome) in others.into_iter().flatten() {
        if outcome.left_out().is_none() || !outcomes.contains_key(&index) {
            outcomes.insert(index, outcome);
        }
    }
}

fn line(index: usize, outcome: &Outcome) -> serde_json::Result<String> {
    Ok(serde_json::to_string(&Line { index, outcome })? + "\n")
}

/// Reads a score file of a folder, if it can stand for what is wanted.
fn admitted(path: &Path, wanted: &Head) -> anyhow::Result<Option<Scores>> {
    let scores = Scores::read(path)?;
    let refusal = scores.as_ref().and_then(|Scores { head, .. }| {
        let others = [
            (
                head.settings != wanted.settings,
                "scores under other settings; give the same --state",
            ),
            (
                head.model.mean_frame != wanted.model.mean_frame,
                "scores beside another mean training frame; remove it",
            ),
        ];
        let other = others.into_iter().find(|(differ, _)| *differ);
        let other = other.map(|(_, why)| why.to_owned());
        head.refusal(wanted).or(other)
    });
    if let Some(why) = refusal {
        bail!("{} holds {why}, or choose another --out", path.display());
    }
    Ok(scores)
}

/// The score files of a model: of whole runs, and of shards. Its hash alone says whose they are; a folder may have had
/// another name.
fn siblings(folder: &Path, hash: &str) -> anyhow::Result<Vec<PathBuf>> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let ends = format!("-{hash}");
    let is_one = |name: &str| {
        let stem = name.strip_suffix(".jsonl")?;
        let whole = stem.rsplit_once("-of-").and_then(|(stem, n)| {
            let (stem, i) = stem.rsplit_once('-')?;
            let numbers = [i, n].iter().all(|n| n.parse::<usize>().is_ok());
            numbers.then_some(stem)
        });
        Some(whole.unwrap_or(stem).ends_with(&ends))
    };
    let mut found = Vec::new();
    let failed = || folder.display().to_string();
    for entry in std::fs::read_dir(folder).with_context(failed)? {
        let name = entry.with_context(failed)?.file_name();
        if is_one(&name.to_string_lossy()) == Some(true) {
            found.push(folder.join(name));
        }
    }
    found.sort();
    Ok(found)
}

/// A score file that grows. It is made when there is something to write: a command that fails leaves none.
struct Sink {
    path: PathBuf,
    /// Its first line.
    head: String,
    /// Once it is made, and nobody else's.
    file: Option<File>,
}

impl Sink {
    /// Opens it, for this run alone.
    fn take_up(&mut self) -> anyhow::Result<()> {
        let failed = || self.path.display().to_string();
        if let Some(folder) = self.path.parent() {
            std::fs::create_dir_all(folder).with_context(failed)?;
        }
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&self.path);
        let file = file.with_context(failed)?;
        if let Err(std::fs::TryLockError::WouldBlock) = file.try_lock() {
            bail!(
                "{}: another run writes to it; wait for its end, or choose another --out",
                self.path.display()
            );
        }
        self.file = Some(file);
        Ok(())
    }

    /// Cuts off what stands after so many bytes: a kill may have left half a line.
    fn cut(&self, whole: u64) -> anyhow::Result<()> {
        let failed = || self.path.display().to_string();
        self.file
            .as_ref()
            .map_or(Ok(()), |file| file.set_len(whole))
            .with_context(failed)
    }

    fn push(&mut self, line: &str) -> anyhow::Result<()> {
        if self.file.is_none() {
            self.take_up()?;
            let length = self.file.as_ref().map(File::metadata).transpose()?;
            if length.is_some_and(|file| file.len() > 0) {
                bail!(
                    "{}: another run has written it meanwhile; go on with the same command",
                    self.path.display()
                );
            }
            self.write(&self.head)?;
        }
        // One write a line: a kill leaves at most the last one torn.
        self.write(line)
    }

    fn write(&self, text: &str) -> anyhow::Result<()> {
        let failed = || self.path.display().to_string();
        let mut file = self.file.as_ref().with_context(failed)?;
        file.write_all(text.as_bytes()).with_context(failed)
    }

    /// Writes all of it anew, whole or not at all.
    fn rewrite(&mut self, outcomes: &Outcomes) -> anyhow::Result<()> {
        let mut text = self.head.clone();
        for (&index, outcome) in outcomes {
            text += &line(index, outcome)?;
        }
        write_atomic(&self.path, text.as_bytes())?;
        self.take_up()
    }
}
