//! How far the estimates are off over the episode: positions, then frames.

use super::{BELIEF, Chart, PREDICTION, line};
use crate::measure::spread::distance_sigma;
use crate::session::snapshot::{Estimate, PositionView, Snapshot};
use crate::web::protocol::uplot::{Series, UplotProps};

pub fn position(snapshot: &Snapshot) -> UplotProps {
    let mut chart = Chart::over_steps(snapshot.steps());
    let position = snapshot.position.as_ref();
    let claims = position
        .into_iter()
        .flat_map(|position| position.belief.iter());
    let claims = claims.map(|estimate| estimate.map_or(f64::NAN, |it| claim_cm(it.covariance)));
    let fill = Some("rgba(122,122,122,0.25)".to_owned());
    let claimed = Series {
        fill,
        ..line("claimed σ", "transparent", &[])
    };
    chart.add(claimed, claims);
    let belief = position
        .into_iter()
        .flat_map(|position| distances_cm(&position.belief, position));
    let belief: Vec<f64> = belief.collect();
    let now = belief.get(snapshot.cursor).copied().unwrap_or(f64::NAN);
    chart.add(line("belief", BELIEF, &[]), belief);
    let prediction = position
        .into_iter()
        .flat_map(|position| distances_cm(&position.prediction, position));
    chart.add(line("prediction", PREDICTION, &[2, 3]), prediction);
    chart.mark(snapshot.cursor, now);
    chart.done("position error", "cm", Some([Some(0.0), None]))
}

pub fn psnr(snapshot: &Snapshot) -> UplotProps {
    let mut chart = Chart::over_steps(snapshot.steps());
    let value = |value: Option<f32>| value.map_or(f64::NAN, f64::from);
    let belief: Vec<f64> = snapshot
        .psnr_db
        .iter()
        .map(|step| value(step.belief))
        .collect();
    let now = belief.get(snapshot.cursor).copied().unwrap_or(f64::NAN);
    chart.add(line("belief", BELIEF, &[]), belief);
    let prediction = snapshot.psnr_db.iter().map(|step| value(step.prediction));
    chart.add(line("prediction", PREDICTION, &[2, 3]), prediction);
    chart.mark(snapshot.cursor, now);
    chart.done("PSNR of the frames", "dB", None)
}

/// Distances of estimates from the truth; NaN where one of both is not there.
pub fn distances_cm<'a>(
    estimates: &'a [Option<Estimate>],
    position: &'a PositionView,
) -> impl Iterator<Item = f64> + 'a {
    estimates.iter().enumerate().map(|(step, estimate)| {
        let both = estimate.zip(position.truth.get(step));
        both.map_or(f64::NAN, |(estimate, truth)| {
            100.0 * f64::from(estimate.distance_m([truth.x, truth.y]))
        })
    })
}

/// The distance that a covariance in m² claims, as a root of its mean square.
pub fn claim_cm(covariance: [f32; 3]) -> f64 {
    100.0 * f64::from(distance_sigma(covariance))
}
