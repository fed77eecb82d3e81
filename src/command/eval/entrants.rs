//! The models that take part: each a checkpoint folder, or the scores that an earlier run left of one.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::names::{Recipe, name};
use super::scores::Scores;
use crate::command::open::Training;
use crate::eval::regression;
use crate::eval::score::{Candidate, Scorer};
use crate::model::checkpoint::{self, MEAN_FRAME, PROBE};
use crate::model::config::Config;
use crate::model::inspect::Inspector;
use crate::model::probe::Regressors;
use crate::train::metrics::METRICS;

/// A model that takes part.
pub struct Entrant {
    /// What was named on the command line.
    pub path: PathBuf,
    /// What tables and figures need of it.
    pub about: About,
    /// Where its scores come from.
    pub source: Source,
}

/// Where a model's scores come from.
pub enum Source {
    /// It is scored.
    Weights(Box<Scorer>),
    /// It was.
    Scores(Box<Scores>),
}

impl Entrant {
    /// None where its weights are not at hand.
    pub fn scorer(&self) -> Option<&Scorer> {
        match &self.source {
            Source::Weights(scorer) => Some(scorer),
            Source::Scores(_) => None,
        }
    }
}

/// Everything but the weights: what a score file says of its model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// The name of its folder.
    pub folder: String,
    /// Names what its files hold.
    pub hash: String,
    /// Names the mean training frame.
    pub mean_frame: String,
    /// Experts, sizes, and the recipe of its training.
    pub config: Config,
    /// What the training said of itself.
    pub training: Training,
    /// Updates and validation PSNR of its training, as far as it left them.
    pub curve: Vec<[f64; 2]>,
    /// Its pose regressors.
    pub regressors: Option<Regressors>,
}

/// Opens them. They must see episodes in the same sizes.
pub fn open(paths: &[PathBuf]) -> anyhow::Result<Vec<Entrant>> {
    let mut entrants: Vec<Entrant> = Vec::with_capacity(paths.len());
    for path in paths {
        let entrant = if path.is_dir() {
            checkpoint(path)?
        } else {
            scores(path)?
        };
        if let Some(first) = entrants.first()
            && first.about.config.layout() != entrant.about.config.layout()
        {
            bail!(
                "{} and {} see frames or windows of different sizes; evaluate them apart",
                first.path.display(),
                path.display()
            );
        }
        entrants.push(entrant);
    }
    Ok(entrants)
}

/// Those of the tables, named so that they are told apart.
pub fn candidates(entrants: &[Entrant]) -> Vec<Candidate> {
    let abouts = || entrants.iter().map(|entrant| &entrant.about);
    let candidate = |about: &About| Candidate {
        label: String::new(),
        recipe: String::new(),
        hash: about.hash.clone(),
        seed: about.training.seed,
        config: about.config.clone(),
        contact_newtons: about.training.contact_newtons,
        regressors: about.regressors.clone(),
    };
    let mut candidates: Vec<Candidate> = abouts().map(candidate).collect();
    let recipes: Vec<Recipe> = abouts()
        .map(|about| Recipe::of(&about.config, &about.training))
        .collect();
    let folders: Vec<[String; 2]> = entrants
        .iter()
        .map(|e| [e.about.folder.clone(), e.path.display().to_string()])
        .collect();
    name(&mut candidates, &recipes, &folders);
    candidates
}

/// A model that was scored before.
fn scores(path: &Path) -> anyhow::Result<Entrant> {
    if !path.exists() {
        bail!(
            "{}: no such checkpoint folder or score file",
            path.display()
        );
    }
    let scores = Scores::read(path)?;
    let nothing = || format!("{}: no scores in it; name another file", path.display());
    let scores = scores.with_context(nothing)?;
    Ok(Entrant {
        path: path.to_owned(),
        about: scores.head.model.clone(),
        source: Source::Scores(Box::new(scores)),
    })
}

/// A model with its weights.
fn checkpoint(folder: &Path) -> anyhow::Result<Entrant> {
    // A name also where it is called `.`.
    let name = folder.canonicalize().ok();
    let name = name.as_deref().and_then(Path::file_name);
    let name = name.map_or_else(
        || "model".into(),
        |name| name.to_string_lossy().into_owned(),
    );
    let (model, probe, hash) = checkpoint::load_with_hash(folder)?;
    let config = model.config.clone();
    let mean_frame = mean_frame(folder, config.frame_size)?;
    let bytes: Vec<u8> = mean_frame.iter().flat_map(|p| p.to_le_bytes()).collect();
    Ok(Entrant {
        path: folder.to_owned(),
        about: About {
            folder: name,
            hash,
            mean_frame: format!("{:08x}", crc32fast::hash(&bytes)),
            training: Training::of(folder)?,
            curve: curve(folder),
            regressors: regressors(&folder.join(PROBE), config.latent)?,
            config,
        },
        source: Source::Weights(Box::new(Scorer {
            inspector: Inspector::new(model)?,
            probe,
            mean_frame,
        })),
    })
}

/// The pose regressors that ship with a model.
fn regressors(path: &Path, latent: usize) -> anyhow::Result<Option<Regressors>> {
    if !path.exists() {
        return Ok(None);
    }
    let regressors = Regressors::read(path, latent)?;
    if let Some(found) = regressors.as_ref().map(Regressors::outputs)
        && found != regression::OUTPUTS
    {
        bail!(
            "{}: its regressors give {found} numbers where x, y and yaw's sine and cosine are wanted; \
             train again, or copy the checkpoint anew",
            path.display()
        );
    }
    Ok(regressors)
}

/// The mean training frame of a checkpoint, in [0, 1].
fn mean_frame(folder: &Path, side: usize) -> anyhow::Result<Vec<f32>> {
    let path = folder.join(MEAN_FRAME);
    let missing = || {
        format!(
            "{}: the mean training frame; train writes it",
            path.display()
        )
    };
    let frame = image::open(&path).with_context(missing)?.into_luma8();
    if frame.width() as usize != side || frame.height() as usize != side {
        bail!("{} is not {side} x {side} pixels", path.display());
    }
    let pixels = frame.into_raw().into_iter();
    Ok(pixels.map(|p| f32::from(p) / 255.0).collect())
}

/// Updates and validation PSNR of the run that made a checkpoint, as far as it left them.
fn curve(folder: &Path) -> Vec<[f64; 2]> {
    let metrics = std::fs::read_to_string(folder.join(METRICS)).unwrap_or_default();
    let point = |line: &str| -> Option<[f64; 2]> {
        let line: Value = serde_json::from_str(line).ok()?;
        let horizons = line["val"]["psnr_db"].as_array()?;
        let sum: f64 = horizons.iter().filter_map(Value::as_f64).sum();
        let mean = sum / horizons.len() as f64;
        Some([line["update"].as_f64()?, mean]).filter(|_| mean.is_finite())
    };
    metrics.lines().filter_map(point).collect()
}
