//! What becomes of a prediction the further ahead it is: its error, what it claims, and what standing still would give.

use super::errors::{claim_cm, distances_cm};
use super::{Chart, PREDICTION, line};
use crate::episode::PlanarPose;
use crate::session::snapshot::Snapshot;
use crate::web::protocol::uplot::UplotProps;

pub fn chart(snapshot: &Snapshot) -> UplotProps {
    let first = snapshot.start + 1;
    let found = snapshot.position.as_ref();
    let steps = found.map_or(0, |position| position.prediction.len());
    let horizon = snapshot.horizon.min(steps.saturating_sub(first));
    let mut chart = Chart::over("steps ahead", (1..=horizon).map(|ahead| ahead as f64));
    let predicted = found
        .into_iter()
        .flat_map(|position| position.prediction.iter());
    let claims = predicted.map(|estimate| estimate.map_or(f64::NAN, |it| claim_cm(it.covariance)));
    let upper = chart.add(line("claimed σ", "transparent", &[]), claims.skip(first));
    let zeros = std::iter::repeat_n(0.0, horizon);
    let lower = chart.add(line("0", "transparent", &[]), zeros);
    chart.band(upper, lower, "rgba(86,180,233,0.3)");
    let errors = found
        .into_iter()
        .flat_map(|position| distances_cm(&position.prediction, position));
    chart.add(line("prediction", PREDICTION, &[]), errors.skip(first));
    let truth = found.map_or(&[][..], |position| position.truth.as_slice());
    let still = truth.get(snapshot.start).into_iter().flat_map(|start| {
        let distance = |pose: &PlanarPose| f64::from((pose.x - start.x).hypot(pose.y - start.y));
        truth.iter().map(move |pose| 100.0 * distance(pose))
    });
    chart.add(
        line("standing still", "#999999", &[8, 3, 2, 3]),
        still.skip(first),
    );
    // Only where samples were asked for; the spread of an earlier start says nothing of this one.
    if let Some(spread) = snapshot
        .spread
        .as_ref()
        .filter(|spread| spread.first_step == first)
    {
        let propagated = spread
            .propagated
            .iter()
            .map(|&covariance| claim_cm(covariance));
        chart.add(line("propagated σ", PREDICTION, &[8, 3]), propagated);
        let sampled = spread
            .sampled
            .iter()
            .map(|&covariance| claim_cm(covariance));
        chart.add(line("sampled σ", PREDICTION, &[2, 3]), sampled);
    }
    chart.done("prediction by horizon", "cm", Some([Some(0.0), None]))
}
