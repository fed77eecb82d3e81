//! The belief at the cursor, dimension by dimension, with the experts that it is made of.

use super::{BELIEF, Chart, ink, line};
use crate::session::snapshot::Snapshot;
use crate::web::protocol::uplot::{Points, Series, UplotProps};

pub fn chart(snapshot: &Snapshot) -> UplotProps {
    let latent = snapshot.belief.as_ref();
    let dimensions = latent.map_or(0, |latent| latent.mean.len());
    let mut chart = Chart::over("latent dimension", (1..=dimensions).map(|d| d as f64));
    if let Some(belief) = latent {
        let end = |sign: f64| {
            std::iter::zip(&belief.mean, &belief.sigma)
                .map(move |(&mean, &sigma)| f64::from(mean) + sign * f64::from(sigma))
        };
        let mean = belief.mean.iter().map(|&mean| f64::from(mean));
        chart.add(
            Series {
                width: Some(2.0),
                ..line("belief μ", BELIEF, &[])
            },
            mean,
        );
        let upper = chart.add(line("μ + σ", "transparent", &[]), end(1.0));
        let lower = chart.add(line("μ − σ", "transparent", &[]), end(-1.0));
        chart.band(upper, lower, "rgba(122,122,122,0.3)");
    }
    for view in &snapshot.experts {
        // One that is off has no part in the belief.
        let Some(latent) = view.latent.as_ref().filter(|_| view.alpha > 0.0) else {
            continue;
        };
        let color = ink(view.expert);
        let label = format!("{} μ", view.expert.letter());
        let series = Series {
            width: Some(0.0),
            points: Some(Points {
                show: true,
                size: 5.0,
                fill: color.clone(),
            }),
            ..line(&label, &color, &[])
        };
        chart.add(series, latent.mean.iter().map(|&mean| f64::from(mean)));
    }
    chart.done("belief at this step", "mean, band ± σ", None)
}
