//! What goes beside the weights once they stand: the position probe, the mean training frame, the report.

use std::io::{Cursor, ErrorKind};
use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::sets::Sets;
use crate::data::{Dataset, Episodes};
use crate::episode::{Episode, EpisodeSource};
use crate::eval::prediction::believe;
use crate::eval::{Protocol, regression};
use crate::measure::events::contact_newtons;
use crate::model::Model;
use crate::model::checkpoint::{MEAN_FRAME, PROBE, REPORT, write_atomic};
use crate::model::inspect::Inspector;
use crate::model::probe::{Positions, Probe, Regressors};
use crate::model::trace::GaussianTrace;
use crate::train::epoch_updates;
use crate::train::metrics::METRICS;
use crate::train::state::State;
use crate::train::statistics;
use crate::train::totals::Totals;
use crate::train::validate::validate;

/// Removes what [`write`] wrote.
pub fn remove(folder: &Path) -> anyhow::Result<()> {
    for name in [PROBE, REPORT] {
        let path = folder.join(name);
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(error).with_context(|| format!("removing {}", path.display()));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Writes probe, mean frame and report into `folder`.
pub fn write(
    model: &Model,
    sets: &Sets,
    totals: &Totals,
    state: &State,
    dataset: &Dataset,
    folder: &Path,
) -> anyhow::Result<()> {
    let probe = fit_probe(model, sets, folder)?;
    write_mean_frame(model, totals, folder)?;
    let config = &model.config;
    let names: Vec<&str> = config
        .streams()
        .iter()
        .map(|stream| stream.name())
        .collect();
    let at_mean = statistics::error_at_the_mean(config, totals);
    let error_at_mean: Vec<Value> = names
        .iter()
        .zip(at_mean)
        .zip(&config.training.error_weights)
        .map(|((name, error), weight)| json!({ "expert": name, "error_at_mean": error, "weight": weight }))
        .collect();
    let epoch_updates = epoch_updates(sets.train(), config);
    let peaks = peaks(sets.train())?;
    let report = json!({
        "poescope": env!("CARGO_PKG_VERSION"),
        "command": state.origin.command,
        "model": config.name,
        "parameters": model.parameters(),
        "data": dataset.name(),
        "data_hash": state.origin.data_hash,
        "train_episodes": sets.train().len(),
        "val_episodes": sets.val().len(),
        "left_out": sets.left_out,
        "seed": state.origin.seed,
        "threads": state.origin.threads,
        "updates": state.update,
        "epochs": state.update as f64 / epoch_updates as f64,
        "minutes": state.elapsed.as_secs_f64() / 60.0,
        "error_terms": error_at_mean,
        "val": validate(model, sets.val(), usize::MAX)?,
        "probe": probe,
        "contact_newtons": (!peaks.is_empty()).then(|| contact_newtons(peaks)),
        "metrics": METRICS,
    });
    let text = serde_json::to_string_pretty(&report)? + "\n";
    Ok(write_atomic(&folder.join(REPORT), text.as_bytes())?)
}

/// Fits the probe on `train` and its residual covariance on `val`, or on `train` where there is no `val`; what it says
/// of itself, or null where no positions were recorded.
fn fit_probe(model: &Model, sets: &Sets, folder: &Path) -> anyhow::Result<Value> {
    let inspector = Inspector::new(model)?;
    let train = positions(&inspector, sets.train())?;
    let val = positions(&inspector, sets.val())?;
    let (held_out, split) = if val.truth.is_empty() {
        (&train, "train")
    } else {
        (&val, "val")
    };
    let Some(probe) = Probe::fit(&train, held_out) else {
        return Ok(Value::Null);
    };
    let regressors = regressors(&inspector, sets.train())?;
    probe.write(&folder.join(PROBE), regressors.as_ref())?;
    Ok(json!({
        "fitted_on": "train",
        "residual_covariance_on": split,
        "rmse_filtered_cm": { "train": rmse_cm(&probe, &train), "val": rmse_cm(&probe, &val) },
    }))
}

/// The largest force of each episode in which one was recorded.
fn peaks(train: Episodes) -> anyhow::Result<Vec<f32>> {
    let peak = |i: usize| -> anyhow::Result<Option<f32>> {
        let episode = train.get(i)?;
        let forces = (0..episode.steps()).filter_map(|t| episode.force_newtons(t));
        Ok(forces.reduce(f32::max))
    };
    let each = (0..train.len()).into_par_iter().map(peak);
    let each: Vec<Option<f32>> = each.collect::<anyhow::Result<_>>()?;
    Ok(each.into_iter().flatten().collect())
}

/// Fits the pose regressors on `train`; none with too few beliefs.
fn regressors(
    inspector: &Inspector<&Model>,
    train: Episodes,
) -> anyhow::Result<Option<Regressors>> {
    let episodes = (0..train.len()).into_par_iter();
    let episodes = episodes.map(|i| anyhow::Ok(Some(train.get(i)?)));
    let latents = regression::latents(inspector, episodes, Protocol::SYNTHETIC)?;
    Ok(latents.fit()?)
}

/// Root mean squared distance from the recorded positions; none for none.
fn rmse_cm(probe: &Probe, positions: &Positions) -> Option<f64> {
    let squares = positions.truth.iter().enumerate().map(|(i, truth)| {
        let [x, y] = probe.position(positions.beliefs.row(i).0);
        f64::from((x - truth[0]).powi(2) + (y - truth[1]).powi(2))
    });
    let count = positions.truth.len();
    (count > 0).then(|| 100.0 * (squares.sum::<f64>() / count as f64).sqrt())
}

/// Filtered beliefs on the mean path with every expert, and the recorded positions they should give.
fn positions(inspector: &Inspector<&Model>, episodes: Episodes) -> anyhow::Result<Positions> {
    let config = &inspector.model().config;
    let one = |episode: &Episode| -> anyhow::Result<(GaussianTrace, Vec<[f32; 2]>)> {
        let Some(object) = &episode.object else {
            return Ok((GaussianTrace::default(), Vec::new()));
        };
        let (_, beliefs) = believe(inspector, episode)?;
        let truth = object[config.frame_stack..]
            .iter()
            .map(|pose| [pose.x, pose.y])
            .collect();
        Ok((beliefs.posterior, truth))
    };
    let each: Vec<_> = (0..episodes.len())
        .into_par_iter()
        .map(|i| one(&*episodes.get(i)?))
        .collect::<anyhow::Result<_>>()?;
    let mut all = Positions::default();
    all.beliefs.latent = config.latent;
    for (beliefs, truth) in each {
        all.beliefs.mean.extend(beliefs.mean);
        all.beliefs.log_var.extend(beliefs.log_var);
        all.truth.extend(truth);
    }
    Ok(all)
}

fn write_mean_frame(model: &Model, totals: &Totals, folder: &Path) -> anyhow::Result<()> {
    let side = model.config.frame_size as u32;
    let frame = image::GrayImage::from_raw(side, side, totals.mean_frame())
        .context("frames of another size than the model's")?;
    let mut png = Cursor::new(Vec::new());
    frame.write_to(&mut png, image::ImageFormat::Png)?;
    Ok(write_atomic(&folder.join(MEAN_FRAME), &png.into_inner())?)
}
