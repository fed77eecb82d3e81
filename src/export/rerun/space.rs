//! The table: plate and tip as boxes, paths, ellipses of position, and what each sensor pulls it by. Metres.

use ::rerun::components::FillMode;
use ::rerun::{LineStrips3D, RecordingStreamResult, ViewCoordinates};

use super::log::{AtSteps, Log};
use super::style::{self, Rgb};
use super::{Shown, each};
use crate::episode::{PLATE_M as PLATE, TIP_HEIGHT_M};
use crate::export::Run;
use crate::export::step::Step;
use crate::measure::ellipse::{Ellipse, SIGMAS_OF_95_PERCENT};
use crate::session::snapshot::Estimate;

/// What all of it lies under.
pub(super) const ROOT: &str = "table";
/// Sides and height of the tip as it is drawn.
const TIP: [f32; 3] = [0.0095, 0.0095, TIP_HEIGHT_M];
/// Just above the plate: what is drawn about it is to be seen.
const ABOVE: f32 = PLATE[2] + 0.005;
/// Half the width of paths.
const THIN: f32 = 0.0008;
/// Half the width of ellipses and arrows.
const THICK: f32 = 0.0014;
/// Pieces of an ellipse.
const ROUND: usize = 48;

/// Which way is up, and the paths over the whole episode.
pub(super) fn describe(log: &Log<'_>, run: &Run) -> RecordingStreamResult<()> {
    log.always(ROOT, &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    let truth = run.episode.object.iter().flatten();
    path(
        log,
        "path",
        style::TRUTH,
        truth.map(|pose| [pose.x, pose.y]),
    )?;
    for model in each(run) {
        let Some(position) = &model.first().position else {
            continue;
        };
        for (name, rgb, estimates) in [
            ("belief", style::BELIEF, &position.belief),
            ("prediction", style::PREDICTION, &position.prediction),
        ] {
            let points = estimates.iter().flatten().map(|at| [at.x, at.y]);
            path(log, &format!("{}/{name}/path", model.name), rgb, points)?;
        }
    }
    Ok(())
}

fn path(
    log: &Log<'_>,
    name: &str,
    rgb: Rgb,
    points: impl Iterator<Item = [f32; 2]>,
) -> RecordingStreamResult<()> {
    let points: Vec<[f32; 3]> = points.map(|[x, y]| [x, y, ABOVE]).collect();
    if points.len() < 2 {
        return Ok(());
    }
    let line = LineStrips3D::new([points])
        .with_colors([style::color(rgb)])
        .with_radii([THIN]);
    log.always(&format!("{ROOT}/{name}"), &line)
}

/// Plate and tip at the steps of the run.
pub(super) fn recorded(log: &Log<'_>, run: &Run) -> RecordingStreamResult<()> {
    let Some(any) = each(run).next() else {
        return Ok(());
    };
    let plates = any.at_each(|step| {
        let [x, y, yaw] = step.truth()?;
        Some(([x, y, 0.5 * PLATE[2]], yaw))
    });
    let plate = (PLATE, style::PLATE, FillMode::Solid);
    log.boxes(&format!("{ROOT}/plate"), plate, plates)?;
    let tips = any.at_each(|step| {
        let [x, y] = step.tip()?;
        Some(([x, y, 0.5 * TIP[2]], 0.0))
    });
    let tip = (TIP, style::TIP, FillMode::Solid);
    log.boxes(&format!("{ROOT}/tip"), tip, tips)
}

/// Where a model believes and predicts the plate to be, and why.
pub(super) fn believed(log: &Log<'_>, model: &Shown<'_>) -> RecordingStreamResult<()> {
    let root = format!("{ROOT}/{}", model.name);
    let (belief, prediction) = (style::BELIEF, style::PREDICTION);
    log.lines(
        &format!("{root}/belief/ellipse_1_sigma"),
        (belief, THICK),
        ellipses(model, Step::belief, 1.0),
    )?;
    log.lines(
        &format!("{root}/belief/ellipse_95"),
        (belief, THIN),
        ellipses(model, Step::belief, SIGMAS_OF_95_PERCENT),
    )?;
    // The prediction's covariance does not grow with the horizon: no mass is claimed for it.
    log.lines(
        &format!("{root}/prediction/ellipse_1_sigma"),
        (prediction, THICK),
        ellipses(model, Step::prediction, 1.0),
    )?;
    let ghosts = model.at_each(|step| {
        let at = step.prediction()?;
        let yaw = step.truth().map_or(0.0, |[.., yaw]| yaw);
        Some(([at.x, at.y, 0.5 * PLATE[2]], yaw))
    });
    let ghost = (PLATE, prediction, FillMode::MajorWireframe);
    log.boxes(&format!("{root}/prediction/plate"), ghost, ghosts)?;
    for (i, view) in model.first().experts.iter().enumerate() {
        let pulls = model.at_each(|step| pull(step, i));
        let path = format!("{root}/pull/{}", view.expert.name());
        log.arrows(&path, (view.expert.rgb(), THICK), pulls)?;
    }
    Ok(())
}

/// From where the prior alone has the plate, by what the expert pulls (D7).
fn pull(step: &Step<'_>, expert: usize) -> Option<[[f32; 3]; 2]> {
    let [x, y] = step.at.fusion.as_ref()?.prior_m?;
    let [dx, dy] = step.reading(expert)?.pull_m?;
    Some([[x, y, ABOVE], [dx, dy, 0.0]])
}

/// The ellipse of a position at each step.
fn ellipses<'a>(
    model: &Shown<'a>,
    of: impl Fn(&Step<'a>) -> Option<Estimate>,
    sigmas: f32,
) -> AtSteps<Vec<[f32; 3]>> {
    model.at_each(|step| Some(outline(of(step)?, sigmas)))
}

/// The ellipse as a closed line: the viewer's own do not turn.
fn outline(at: Estimate, sigmas: f32) -> Vec<[f32; 3]> {
    let points = Ellipse::of_covariance(at.covariance).outline([at.x, at.y], sigmas, ROUND);
    points.into_iter().map(|[x, y]| [x, y, ABOVE]).collect()
}
