//! What one model says at each step: frames, Gaussians, shares, and every reading under its name.

use ::rerun::datatypes::ColorModel;
use ::rerun::{RecordingStream, RecordingStreamResult};

use super::columns::{Clock, Pictures, Rows};
use super::style;
use crate::episode::Frame;
use crate::export::step::{READINGS, Step, readings_of};
use crate::export::{Run, color};
use crate::modality::Expert;
use crate::session::snapshot::{LatentView, Snapshot};

/// Names and colours of its series.
pub(super) fn describe(
    stream: &RecordingStream,
    model: &str,
    shown: &Snapshot,
) -> RecordingStreamResult<()> {
    let latent = shown.models.get(shown.model).map_or(0, |info| info.latent);
    let dimensions = || (1..=latent).map(|d| format!("z{d}"));
    let mut gaussians = vec![("belief".to_owned(), None)];
    for view in &shown.experts {
        let path = format!("experts/{}", view.expert.name());
        style::series(stream, &format!("{model}/{path}/share"), dimensions(), None)?;
        for reading in readings_of(view.expert) {
            // Its views say what of it they show: a short legend hides less.
            let name = view.expert.name().to_owned();
            let entity = format!("{model}/{path}/{}", reading.name);
            style::series(stream, &entity, [name], Some(style::of_expert(view.expert)))?;
        }
        gaussians.push((path, Some(view.expert)));
    }
    for (path, _) in &gaussians {
        for of in ["mean", "sigma", "log_var"] {
            style::series(stream, &format!("{model}/{path}/{of}"), dimensions(), None)?;
        }
    }
    for reading in READINGS {
        let color = if reading.name.contains("prediction") {
            Some(style::PREDICTION)
        } else if reading.name.contains("belief") {
            Some(style::BELIEF)
        } else if reading.name == "force_n" {
            Some(Expert::Haptic.rgb())
        } else {
            None
        };
        let entity = format!("{model}/readings/{}", reading.name);
        style::series(
            stream,
            &entity,
            [spoken(reading.name)],
            color.map(style::color),
        )?;
    }
    Ok(())
}

fn spoken(name: &str) -> String {
    name.replace('_', " ")
}

/// Its steps.
pub(super) fn log(
    stream: &RecordingStream,
    clock: &Clock,
    run: &Run,
    model: &str,
    snapshots: &[Snapshot],
) -> RecordingStreamResult<()> {
    frames(stream, clock, model, snapshots)?;
    let steps = || snapshots.iter().map(|at| Step { run, at });
    gaussian(stream, clock, &format!("{model}/belief"), snapshots, |at| {
        at.belief.as_ref()
    })?;
    let experts = snapshots.first().map_or(&[][..], |first| &first.experts);
    for (i, view) in experts.iter().enumerate() {
        let path = format!("{model}/experts/{}", view.expert.name());
        gaussian(stream, clock, &path, snapshots, |at| {
            at.experts.get(i)?.latent.as_ref()
        })?;
        let mut shares = Rows::default();
        for at in snapshots {
            if let Some(view) = at.experts.get(i).filter(|view| !view.share.is_empty()) {
                shares.push(at.cursor, &view.share);
            }
        }
        shares.log(stream, clock, &format!("{path}/share"))?;
        for reading in readings_of(view.expert) {
            let mut rows = Rows::default();
            for step in steps() {
                if let Some(value) = (reading.of)(&step, i) {
                    rows.push(step.at.cursor, &[value]);
                }
            }
            rows.log(stream, clock, &format!("{path}/{}", reading.name))?;
        }
    }
    for reading in READINGS {
        let mut rows = Rows::default();
        for step in steps() {
            if let Some(value) = (reading.of)(&step) {
                rows.push(step.at.cursor, &[value]);
            }
        }
        rows.log(stream, clock, &format!("{model}/readings/{}", reading.name))?;
    }
    Ok(())
}

/// Mean, standard deviation and log-variance, a series a dimension.
fn gaussian<'a>(
    stream: &RecordingStream,
    clock: &Clock,
    path: &str,
    snapshots: &'a [Snapshot],
    of: impl Fn(&'a Snapshot) -> Option<&'a LatentView>,
) -> RecordingStreamResult<()> {
    let mut rows: [Rows; 3] = Default::default();
    for at in snapshots {
        if let Some(view) = of(at) {
            for (rows, values) in rows
                .iter_mut()
                .zip([&view.mean, &view.sigma, &view.log_var])
            {
                rows.push(at.cursor, values);
            }
        }
    }
    for (rows, name) in rows.iter().zip(["mean", "sigma", "log_var"]) {
        rows.log(stream, clock, &format!("{path}/{name}"))?;
    }
    Ok(())
}

/// The decoded belief and prediction, and the error of the prediction where there is one, else of the belief.
fn frames(
    stream: &RecordingStream,
    clock: &Clock,
    model: &str,
    snapshots: &[Snapshot],
) -> RecordingStreamResult<()> {
    let cells = || snapshots.iter().filter_map(|at| at.strip.get(at.cursor));
    let Some(first) = cells().next() else {
        return Ok(());
    };
    let size = [first.truth.width, first.truth.height];
    let grey = |frame: Option<&Frame>| frame.map(|frame| frame.pixels.clone());
    let pictures = |model, rows| Pictures { size, model, rows };
    let beliefs = cells()
        .map(|cell| (cell.step, grey(cell.belief.as_deref())))
        .collect();
    pictures(ColorModel::L, beliefs).log(stream, clock, &format!("{model}/frames/belief"))?;
    let predictions = cells()
        .map(|cell| (cell.step, grey(cell.prediction.as_deref())))
        .collect();
    pictures(ColorModel::L, predictions).log(
        stream,
        clock,
        &format!("{model}/frames/prediction"),
    )?;
    let errors = cells().map(|cell| {
        let compared = cell.prediction.as_ref().or(cell.belief.as_ref());
        let error = compared.and_then(|frame| color::error(frame, &cell.truth));
        (cell.step, error.map(Vec::into_flattened))
    });
    pictures(ColorModel::RGB, errors.collect()).log(stream, clock, &format!("{model}/frames/error"))
}
