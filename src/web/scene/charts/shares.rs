//! Who makes up the belief, step by step: shares one on top of the other, up to 1.

use super::{Chart, dashes, ink, line, wash};
use crate::session::snapshot::Snapshot;
use crate::web::protocol::uplot::{Series, UplotProps};

pub fn chart(snapshot: &Snapshot) -> UplotProps {
    let mut chart = Chart::over_steps(snapshot.steps());
    let mut sum: Vec<f64> = Vec::new();
    let mut below = None;
    for (place, view) in snapshot.experts.iter().enumerate() {
        let share = view.share_over_time.iter().map(|&share| f64::from(share));
        sum = match below {
            None => share.collect(),
            Some(_) => std::iter::zip(&sum, share)
                .map(|(sum, share)| sum + share)
                .collect(),
        };
        let label = format!("{} {}", view.expert.letter(), view.expert.name());
        let color = wash(view.expert.rgb(), 0.45);
        let series = Series {
            // The lowest one goes down to 0; the others down to the one below.
            fill: below.is_none().then(|| color.clone()),
            ..line(&label, &ink(view.expert), dashes(place))
        };
        let number = chart.add(series, sum.iter().copied());
        if let Some(below) = below {
            chart.band(number, below, &color);
        }
        below = Some(number);
    }
    chart.mark(snapshot.cursor, 1.0);
    chart.done(
        "share of precision",
        "share, stacked",
        Some([Some(0.0), Some(1.05)]),
    )
}
