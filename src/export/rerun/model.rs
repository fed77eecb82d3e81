//! What one model says at each step: frames, Gaussians, shares, and every reading under its name.

use ::rerun::RecordingStreamResult;
use ::rerun::datatypes::ColorModel;

use super::log::{AtSteps, Log};
use super::{Shown, style};
use crate::episode::Frame;
use crate::export::color;
use crate::export::step::{READINGS, Step, readings_of};
use crate::modality::Expert;
use crate::session::snapshot::{LatentView, Snapshot};

/// Names and colours of its series.
pub(super) fn describe(log: &Log<'_>, model: &Shown<'_>) -> RecordingStreamResult<()> {
    let root = &model.name;
    let first = model.first();
    let latent = first.shown_model().map_or(0, |info| info.latent);
    let dimensions = |path: &str| log.names(path, (1..=latent).map(|d| format!("z{d}")), None);
    let gaussian = |path: &str| {
        let mut parts = ["mean", "sigma", "log_var"].into_iter();
        parts.try_for_each(|of| dimensions(&format!("{path}/{of}")))
    };
    gaussian(&format!("{root}/belief"))?;
    for view in &first.experts {
        let path = model.of_expert(view.expert);
        gaussian(&path)?;
        dimensions(&format!("{path}/share"))?;
        for reading in readings_of(view.expert) {
            // Plots say which reading they show: a short legend hides less of them.
            let names = [model.says(view.expert.name())];
            let entity = format!("{path}/{}", reading.name);
            log.names(&entity, names, Some(view.expert.rgb()))?;
        }
    }
    for reading in READINGS {
        let names = [model.says(&reading.name.replace('_', " "))];
        let entity = format!("{root}/readings/{}", reading.name);
        log.names(&entity, names, color_of(reading.name))?;
    }
    Ok(())
}

/// The colour of whose it is; none for what is nobody's.
fn color_of(reading: &str) -> Option<style::Rgb> {
    if reading.contains("prediction") {
        Some(style::PREDICTION)
    } else if reading.contains("belief") {
        Some(style::BELIEF)
    } else {
        (reading == "force_n").then(|| Expert::Haptic.rgb())
    }
}

/// Its steps.
pub(super) fn steps(log: &Log<'_>, model: &Shown<'_>) -> RecordingStreamResult<()> {
    frames(log, model)?;
    let root = &model.name;
    gaussian(log, &format!("{root}/belief"), model, |at| {
        at.belief.as_ref()
    })?;
    for (i, view) in model.first().experts.iter().enumerate() {
        let path = model.of_expert(view.expert);
        gaussian(log, &path, model, |at| at.experts.get(i)?.latent.as_ref())?;
        let shares = model.steps().filter_map(|step| {
            let share = &step.expert(i)?.share;
            (!share.is_empty()).then_some((step.at.cursor, share))
        });
        log.numbers(&format!("{path}/share"), shares)?;
        for reading in readings_of(view.expert) {
            let of = |step: Step<'_>| Some((step.at.cursor, [(reading.of)(&step, i)?]));
            let entity = format!("{path}/{}", reading.name);
            log.numbers(&entity, model.steps().filter_map(of))?;
        }
    }
    for reading in READINGS {
        let of = |step: Step<'_>| Some((step.at.cursor, [(reading.of)(&step)?]));
        let entity = format!("{root}/readings/{}", reading.name);
        log.numbers(&entity, model.steps().filter_map(of))?;
    }
    Ok(())
}

/// Mean, standard deviation and log-variance, a series a dimension.
fn gaussian<'a>(
    log: &Log<'_>,
    path: &str,
    model: &Shown<'a>,
    of: impl Fn(&'a Snapshot) -> Option<&'a LatentView>,
) -> RecordingStreamResult<()> {
    let views = || {
        let steps = model.snapshots.iter();
        steps.filter_map(|at| Some((at.cursor, of(at)?)))
    };
    log.numbers(
        &format!("{path}/mean"),
        views().map(|(t, view)| (t, &view.mean)),
    )?;
    log.numbers(
        &format!("{path}/sigma"),
        views().map(|(t, view)| (t, &view.sigma)),
    )?;
    log.numbers(
        &format!("{path}/log_var"),
        views().map(|(t, view)| (t, &view.log_var)),
    )
}

/// The decoded belief and prediction, and the error of the prediction where there is one, else of the belief.
fn frames(log: &Log<'_>, model: &Shown<'_>) -> RecordingStreamResult<()> {
    let cells = || model.steps().filter_map(|step| step.cell());
    let Some(first) = cells().next() else {
        return Ok(());
    };
    let size = [first.truth.width, first.truth.height];
    let say = |what: &str, colors, rows: AtSteps<Vec<u8>>| {
        log.pictures(&format!("{}/frames/{what}", model.name), size, colors, rows)
    };
    let grey = |frame: Option<&Frame>| frame.map(|frame| frame.pixels.clone());
    let beliefs = cells().map(|cell| (cell.step, grey(cell.belief.as_deref())));
    say("belief", ColorModel::L, beliefs.collect())?;
    let predictions = cells().map(|cell| (cell.step, grey(cell.prediction.as_deref())));
    say("prediction", ColorModel::L, predictions.collect())?;
    let errors = cells().map(|cell| {
        let compared = cell.prediction.as_ref().or(cell.belief.as_ref());
        let error = compared.and_then(|frame| color::error(frame, &cell.truth));
        (cell.step, error.map(Vec::into_flattened))
    });
    say("error", ColorModel::RGB, errors.collect())
}
