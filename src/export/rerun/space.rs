//! The table: plate and tip as boxes, paths, ellipses of position, and what each sensor pulls it by. Metres.

use ::rerun::components::FillMode;
use ::rerun::{Boxes3D, LineStrips3D, RecordingStream, RecordingStreamResult, ViewCoordinates};

use super::columns::{Clock, Shapes};
use super::{each, style};
use crate::export::Run;
use crate::measure::ellipse::{Ellipse, SIGMAS_OF_95_PERCENT};
use crate::session::snapshot::{Estimate, Snapshot};

/// What all of it lies under.
pub(super) const ROOT: &str = "table";
/// Sides and height of the plate as it is drawn; a recording does not say them.
const PLATE: [f32; 3] = [0.09, 0.09, 0.013];
/// Sides and height of the tip as it is drawn.
const TIP: [f32; 3] = [0.0095, 0.0095, 0.06];
/// Just above the plate: what is drawn about it is to be seen.
const ABOVE: f32 = 0.018;
/// Half the width of paths.
const THIN: f32 = 0.0008;
/// Half the width of ellipses and arrows.
const THICK: f32 = 0.0014;
/// Pieces of an ellipse.
const ROUND: usize = 48;

/// Which way is up, and the paths over the whole episode.
pub(super) fn describe(stream: &RecordingStream, run: &Run) -> RecordingStreamResult<()> {
    stream.log_static(ROOT, &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    let truth: Vec<[f32; 3]> = run
        .episode
        .object
        .iter()
        .flatten()
        .map(|p| [p.x, p.y, ABOVE])
        .collect();
    path(stream, "path", truth, style::TRUTH)?;
    for (model, snapshots) in each(run) {
        let Some(position) = snapshots.first().and_then(|first| first.position.as_ref()) else {
            continue;
        };
        let points = |estimates: &[Option<Estimate>]| -> Vec<[f32; 3]> {
            estimates
                .iter()
                .flatten()
                .map(|at| [at.x, at.y, ABOVE])
                .collect()
        };
        let (belief, prediction) = (points(&position.belief), points(&position.prediction));
        path(
            stream,
            &format!("{model}/belief/path"),
            belief,
            style::BELIEF,
        )?;
        path(
            stream,
            &format!("{model}/prediction/path"),
            prediction,
            style::PREDICTION,
        )?;
    }
    Ok(())
}

fn path(
    stream: &RecordingStream,
    name: &str,
    points: Vec<[f32; 3]>,
    color: (u8, u8, u8),
) -> RecordingStreamResult<()> {
    if points.len() < 2 {
        return Ok(());
    }
    let line = LineStrips3D::new([points])
        .with_colors([style::color(color)])
        .with_radii([THIN]);
    stream.log_static(format!("{ROOT}/{name}"), &line)
}

/// Plate and tip at the steps of the run.
pub(super) fn recorded(
    stream: &RecordingStream,
    clock: &Clock,
    run: &Run,
) -> RecordingStreamResult<()> {
    let Some(snapshots) = run.models.first() else {
        return Ok(());
    };
    let steps = || snapshots.iter().map(|at| at.cursor);
    let middle = 0.5 * PLATE[2];
    if let Some(poses) = &run.episode.object {
        let plates =
            steps().map(|step| (step, poses.get(step).map(|p| ([p.x, p.y, middle], p.yaw))));
        let solid = solid(PLATE, (0x96, 0xA0, 0xAC)).with_fill_mode(FillMode::Solid);
        Shapes::new(plates).log_boxes(stream, clock, &format!("{ROOT}/plate"), &solid)?;
    }
    if let Some(tip) = &run.episode.tip {
        let tips = steps().map(|step| {
            (
                step,
                tip.get(step).map(|&[x, y]| ([x, y, 0.5 * TIP[2]], 0.0)),
            )
        });
        let solid = solid(TIP, (0xE0, 0xE0, 0x90)).with_fill_mode(FillMode::Solid);
        Shapes::new(tips).log_boxes(stream, clock, &format!("{ROOT}/tip"), &solid)?;
    }
    Ok(())
}

fn solid(sides: [f32; 3], color: (u8, u8, u8)) -> Boxes3D {
    Boxes3D::update_fields()
        .with_half_sizes([sides.map(|side| 0.5 * side)])
        .with_colors([style::color(color)])
}

/// Where a model believes and predicts the plate to be, and why.
pub(super) fn believed(
    stream: &RecordingStream,
    clock: &Clock,
    model: &str,
    snapshots: &[Snapshot],
) -> RecordingStreamResult<()> {
    let read = |at: &Snapshot, predicted: bool| -> Option<Estimate> {
        let position = at.position.as_ref()?;
        let of = if predicted {
            &position.prediction
        } else {
            &position.belief
        };
        *of.get(at.cursor)?
    };
    for (name, predicted, color) in [
        ("belief", false, style::BELIEF),
        ("prediction", true, style::PREDICTION),
    ] {
        let round = |sigmas: f32| {
            Shapes::new(
                snapshots
                    .iter()
                    .map(|at| (at.cursor, read(at, predicted).map(|at| outline(at, sigmas)))),
            )
        };
        let root = format!("{ROOT}/{model}/{name}");
        round(1.0).log_lines(
            stream,
            clock,
            &format!("{root}/ellipse_1_sigma"),
            style::color(color),
            THICK,
        )?;
        // The prediction's covariance does not grow with the horizon: no mass is claimed for it.
        if !predicted {
            round(SIGMAS_OF_95_PERCENT).log_lines(
                stream,
                clock,
                &format!("{root}/ellipse_95"),
                style::color(color),
                THIN,
            )?;
        }
    }
    let ghosts = snapshots.iter().map(|at| {
        let yaw = at
            .position
            .as_ref()
            .and_then(|p| p.truth.get(at.cursor))
            .map_or(0.0, |pose| pose.yaw);
        (
            at.cursor,
            read(at, true).map(|at| ([at.x, at.y, 0.5 * PLATE[2]], yaw)),
        )
    });
    let ghost = solid(PLATE, style::PREDICTION).with_fill_mode(FillMode::MajorWireframe);
    Shapes::new(ghosts).log_boxes(
        stream,
        clock,
        &format!("{ROOT}/{model}/prediction/plate"),
        &ghost,
    )?;
    let experts = snapshots.first().map_or(&[][..], |first| &first.experts);
    for (i, view) in experts.iter().enumerate() {
        let pulls = snapshots.iter().map(|at| (at.cursor, pull(at, i)));
        let path = format!("{ROOT}/{model}/pull/{}", view.expert.name());
        Shapes::new(pulls).log_arrows(
            stream,
            clock,
            &path,
            style::of_expert(view.expert),
            THICK,
        )?;
    }
    Ok(())
}

/// From where the prior alone has the plate, by what the expert pulls (D7).
fn pull(at: &Snapshot, expert: usize) -> Option<[[f32; 3]; 2]> {
    let fusion = at.fusion.as_ref()?;
    let ([x, y], [dx, dy]) = (fusion.prior_m?, fusion.experts.get(expert)?.pull_m?);
    Some([[x, y, ABOVE], [dx, dy, 0.0]])
}

/// The ellipse as a closed line: the viewer's own do not turn.
fn outline(at: Estimate, sigmas: f32) -> Vec<[f32; 3]> {
    let mut points = Ellipse::of_covariance(at.covariance).outline([at.x, at.y], sigmas, ROUND);
    points.extend(points.first().copied());
    points.into_iter().map(|[x, y]| [x, y, ABOVE]).collect()
}
