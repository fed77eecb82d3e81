//! Score files: of each model one, a line an episode. It says what it is of and all that tables need but the weights, so
//! that a model stands in later tables without being scored again.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use super::entrants::About;
use crate::eval::credit::Credit;
use crate::eval::protocol::Protocol;
use crate::eval::regression;
use crate::eval::score::{EpisodeScores, FrameScores, SubjectScores};
use crate::eval::setting::Setting;
use crate::model::probe::Regressors;

/// The form of score files, counted up when what is scored or how it is written changes.
pub const FORM: u32 = 1;
/// Bytes of a line; that of an episode of 42 images in ten rows has 300,000, and the longest there can be has 2,600 times
/// as many images.
const MOST: u64 = 1 << 30;

/// What the scores are of: the first line of a score file.
#[derive(Serialize, Deserialize)]
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
                "scores of {own}, not of {other}; name their dataset by --data, or evaluate them apart"
            ));
        }
        if self.split != wanted.split {
            let (own, other) = (&self.split, &wanted.split);
            return Some(format!(
                "scores of split `{own}`, not of `{other}`; give --split {own}, or evaluate them apart"
            ));
        }
        (self.protocol != wanted.protocol).then(|| {
            format!(
                "scores of {context} images seen and {horizon} predicted; give --context {context} --horizon {horizon}"
            )
        })
    }

    /// What is wrong with it: nothing that is read is taken on trust.
    fn fault(&self) -> Option<String> {
        let About {
            config, regressors, ..
        } = &self.model;
        if let Err(error) = config.validate() {
            return Some(error.to_string());
        }
        let suit = |r: &Regressors| r.suit(config.latent, regression::OUTPUTS);
        if !regressors.as_ref().is_none_or(suit) {
            return Some("its regressors are not of its model's sizes".to_owned());
        }
        if !self.episodes.is_sorted_by(|a, b| a < b) {
            return Some("an episode is listed twice, or out of order".to_owned());
        }
        let Protocol { context, horizon } = self.protocol;
        let nothing = context <= config.frame_stack || horizon == 0 || self.settings.is_empty();
        nothing.then(|| "its protocol or its rows are none".to_owned())
    }
}

/// What is wrong with scores of a model of so many latents, predicting so far, in so many rows. JSON has no number for
/// what is not finite, so that such a line could not be read again.
pub fn fault(scores: &EpisodeScores, [latent, horizon, rows]: [usize; 3]) -> Option<&'static str> {
    let finite = |values: &[f32]| values.iter().all(|v| v.is_finite());
    let of_images =
        |values: &Vec<f64>| values.len() == horizon && values.iter().all(|v| v.is_finite());
    let frames = |scores: &FrameScores| {
        let each = [&scores.squared_error, &scores.ssim, &scores.psnr_db];
        each.into_iter().all(of_images)
    };
    let credit = |credit: &Credit| {
        let gains = credit.nll_gain.iter().chain([&credit.squared_error_gain]);
        let values = credit.nll.iter().flatten().chain(&credit.squared_error);
        gains.chain(values).all(|v| v.is_finite())
    };
    let row = |row: &SubjectScores| {
        frames(&row.frames)
            && row.filtered.len().is_multiple_of(latent)
            && row.predicted.len() == horizon * latent
            && finite(&row.filtered)
            && finite(&row.predicted)
            && row.credit.as_ref().is_none_or(credit)
            && row.shares.iter().flatten().all(|shares| finite(shares))
    };
    if scores.subjects.len() != rows {
        return Some("not as many rows as settings");
    }
    let trivial = frames(&scores.held) && frames(&scores.mean_frame);
    let recorded = scores.poses.iter().flatten().all(|pose| finite(pose));
    let sound = trivial && recorded && finite(&scores.force_newtons);
    let sound = sound && scores.subjects.iter().all(row);
    (!sound).then_some("a number that is missing or not finite")
}

/// What came of an episode.
#[derive(Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// Why it could not be scored.
    LeftOut(String),
    /// Its scores.
    Scores(Box<EpisodeScores>),
}

impl Outcome {
    /// Why there are no scores.
    pub fn left_out(&self) -> Option<&str> {
        match self {
            Self::LeftOut(why) => Some(why),
            Self::Scores(_) => None,
        }
    }
}

/// A further line of a score file.
#[derive(Serialize, Deserialize)]
pub struct Line<O> {
    /// Its place in the dataset.
    pub index: usize,
    /// What came of it: an [`Outcome`].
    pub outcome: O,
}

/// Outcomes by their episodes' places.
pub type Outcomes = BTreeMap<usize, Outcome>;

/// A score file that was read.
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
        let name = path.display();
        let file = File::open(path).with_context(|| name.to_string())?;
        let packed = path.extension().is_some_and(|extension| extension == "zst");
        let source: Box<dyn Read> = if packed {
            Box::new(zstd::Decoder::new(file).with_context(|| name.to_string())?)
        } else {
            Box::new(file)
        };
        let mut source = BufReader::new(source);
        let mut read = None::<Self>;
        let mut number = 0;
        loop {
            let mut text = Vec::new();
            let mut line = source.by_ref().take(MOST);
            line.read_until(b'\n', &mut text)
                .with_context(|| name.to_string())?;
            number += 1;
            let damaged = |what: &dyn Display| {
                format!(
                    "{name}: line {number} is damaged: {what}; remove the file, or name another"
                )
            };
            if text.len() as u64 == MOST {
                bail!(damaged(&"longer than an episode's can be"));
            }
            if text.last() != Some(&b'\n') {
                return Ok(read);
            }
            let bytes = text.len() as u64;
            let Some(scores) = &mut read else {
                read = Some(Self {
                    head: head(&text).with_context(|| name.to_string())?,
                    outcomes: Outcomes::new(),
                    whole: bytes,
                });
                continue;
            };
            let line: Line<Outcome> = match serde_json::from_slice(&text) {
                Ok(line) => line,
                Err(error) => bail!(damaged(&error)),
            };
            let Head {
                model,
                protocol,
                settings,
                ..
            } = &scores.head;
            let sizes = [model.config.latent, protocol.horizon, settings.len()];
            if let Outcome::Scores(own) = &line.outcome
                && let Some(what) = fault(own, sizes)
            {
                bail!(damaged(&what));
            }
            scores.outcomes.insert(line.index, line.outcome);
            scores.whole += bytes;
        }
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
    head.fault()
        .map_or(Ok(head), |what| bail!("a damaged score file: {what}"))
}
