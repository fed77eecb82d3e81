//! Score files: of each model one, a line an episode. It says what it is of and all that tables need but the weights, so
//! that a model stands in later tables without being scored again.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use super::entrants::About;
use crate::eval::protocol::Protocol;
use crate::eval::regression;
use crate::eval::score::{EpisodeScores, FrameScores};
use crate::eval::setting::Setting;

/// The form of score files, counted up when what is scored or how it is written changes.
pub const FORM: u32 = 1;
/// Bytes of a line; that of an episode of 42 images in ten rows has 300,000.
const MOST: u64 = 1 << 26;

/// What the scores are of: the first line of a score file.
#[derive(Debug, Serialize, Deserialize)]
pub struct Head {
    /// [`FORM`].
    pub scores: u32,
    /// The version that scored.
    pub poescope: String,
    /// The dataset's name.
    pub data: String,
    /// Names what it holds.
    pub data_hash: String,
    /// The split.
    pub split: String,
    /// Its episodes, by their places in the dataset: names need not be unique in a folder of files.
    pub episodes: Vec<usize>,
    /// How much is seen and predicted.
    pub protocol: Protocol,
    /// What each row of a line was scored under.
    pub settings: Vec<Setting>,
    /// Whose.
    pub model: About,
}

impl Head {
    /// Why scores of `self` cannot stand for what `wanted` asks for, and what to do.
    pub fn refusal(&self, wanted: &Self) -> Option<String> {
        let Protocol { context, horizon } = self.protocol;
        if self.data_hash != wanted.data_hash {
            let name = |head: &Self| format!("{} ({})", head.data, head.data_hash);
            let (own, other) = (name(self), name(wanted));
            return Some(format!(
                "scores of {own}, not of {other}; name its dataset by --data"
            ));
        }
        if self.split != wanted.split {
            let (own, other) = (&self.split, &wanted.split);
            return Some(format!(
                "scores of split `{own}`, not of `{other}`; give --split {own}"
            ));
        }
        if self.protocol != wanted.protocol {
            return Some(format!(
                "scores of {context} images seen and {horizon} predicted; give --context {context} --horizon {horizon}"
            ));
        }
        let other_frame = self.model.mean_frame != wanted.model.mean_frame;
        other_frame.then(|| "scores beside another mean training frame".to_owned())
    }

    /// What is wrong with it: nothing that is read is taken on trust.
    fn complaint(&self) -> Option<String> {
        let About {
            config, regressors, ..
        } = &self.model;
        if let Err(error) = config.validate() {
            return Some(error.to_string());
        }
        let fit = |r: &crate::model::probe::Regressors| r.fit(config.latent, regression::OUTPUTS);
        if !regressors.as_ref().is_none_or(fit) {
            return Some("its regressors are not of its model's sizes".to_owned());
        }
        let Protocol { context, horizon } = self.protocol;
        let empty = context <= config.frame_stack || horizon == 0 || self.settings.is_empty();
        empty.then(|| "it has neither rows nor predictions".to_owned())
    }

    /// What is wrong with a line.
    fn complaint_of(&self, scores: &EpisodeScores) -> Option<&'static str> {
        let horizon = self.protocol.horizon;
        let latent = self.model.config.latent;
        let frames = |scores: &FrameScores| {
            let FrameScores {
                squared_error,
                ssim,
                psnr_db,
            } = scores;
            let sound = |v: &Vec<f64>| v.len() == horizon && v.iter().all(|v| v.is_finite());
            [squared_error, ssim, psnr_db].into_iter().all(sound)
        };
        let rows = &scores.subjects;
        if rows.len() != self.settings.len() {
            return Some("not as many rows as settings");
        }
        let rows_frames = rows.iter().map(|row| &row.frames);
        if !rows_frames
            .chain([&scores.held, &scores.mean_frame])
            .all(frames)
        {
            return Some("not a score for each predicted image");
        }
        let beliefs = |means: &Vec<f32>| {
            means.len().is_multiple_of(latent) && means.iter().all(|mean| mean.is_finite())
        };
        let predicted = |means: &Vec<f32>| beliefs(means) && means.len() == horizon * latent;
        let sound = rows
            .iter()
            .all(|row| beliefs(&row.filtered) && predicted(&row.predicted));
        (!sound).then_some("beliefs that are none of its model")
    }
}

/// What came of an episode.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Why it could not be scored.
    LeftOut(String),
    /// Its scores.
    Scores(EpisodeScores),
}

/// A further line of a score file.
#[derive(Debug, Serialize, Deserialize)]
pub struct Line {
    /// Its place in the dataset.
    pub index: usize,
    /// What came of it.
    pub outcome: Outcome,
}

/// Outcomes by their episodes' places.
pub type Outcomes = BTreeMap<usize, Outcome>;

/// A score file that was read.
#[derive(Debug)]
pub struct Scores {
    /// What they are of.
    pub head: Head,
    /// Episode by episode.
    pub outcomes: Outcomes,
    /// Bytes up to the end of the last whole line: a kill may have left half of one.
    pub whole: u64,
}

impl Scores {
    /// Reads a score file, as it is or packed by `zstd`, but for a torn last line; none where not even its head is whole.
    pub fn read(path: &Path) -> anyhow::Result<Option<Self>> {
        let name = || path.display().to_string();
        let file = File::open(path).with_context(name)?;
        let packed = path.extension().is_some_and(|extension| extension == "zst");
        let source: Box<dyn Read> = if packed {
            Box::new(zstd::Decoder::new(file).with_context(name)?)
        } else {
            Box::new(file)
        };
        let mut source = BufReader::new(source);
        let mut line = || -> anyhow::Result<Option<Vec<u8>>> {
            let mut text = Vec::new();
            source
                .by_ref()
                .take(MOST)
                .read_until(b'\n', &mut text)
                .with_context(name)?;
            Ok((text.last() == Some(&b'\n')).then_some(text))
        };
        let Some(text) = line()? else {
            return Ok(None);
        };
        let head = head(&text).with_context(name)?;
        let mut scores = Self {
            head,
            outcomes: Outcomes::new(),
            whole: text.len() as u64,
        };
        let mut number = 1;
        while let Some(text) = line()? {
            number += 1;
            let damaged =
                |what: String| format!("{}: line {number} is damaged: {what}", path.display());
            let Line { index, outcome } = match serde_json::from_slice(&text) {
                Ok(line) => line,
                Err(error) => bail!(damaged(error.to_string())),
            };
            if let Outcome::Scores(own) = &outcome
                && let Some(what) = scores.head.complaint_of(own)
            {
                bail!(damaged(what.to_owned()));
            }
            scores.outcomes.insert(index, outcome);
            scores.whole += text.len() as u64;
        }
        Ok(Some(scores))
    }
}

/// The first line.
fn head(text: &[u8]) -> anyhow::Result<Head> {
    #[derive(Deserialize)]
    struct Form {
        scores: u32,
    }
    let Form { scores } = serde_json::from_slice(text).context("not a score file")?;
    if scores != FORM {
        bail!("a score file of form {scores}, this poescope reads form {FORM}; score anew");
    }
    let head: Head = serde_json::from_slice(text).context("a damaged score file")?;
    head.complaint()
        .map_or(Ok(head), |what| bail!("a damaged score file: {what}"))
}
