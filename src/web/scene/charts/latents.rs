//! The belief at the cursor, dimension by dimension, with the experts that it is made of.

use super::{BELIEF, Chart, ink, line};
use crate::session::snapshot::{LatentView, Snapshot};
use crate::web::protocol::uplot::{Points, Series, UplotProps};

pub fn chart(snapshot: &Snapshot) -> UplotProps {
    let dimensions = snapshot.shown_model().map_or(0, |model| model.latent);
    let mut chart = Chart::over("latent dimension", (1..=dimensions).map(|d| d as f64));
    let belief = snapshot.belief.as_ref();
    let mean = Series {
        width: Some(2.0),
        ..line("belief μ", BELIEF, &[])
    };
    chart.add(mean, means(belief));
    let upper = chart.add(line("μ + σ", "transparent", &[]), ends(belief, 1.0));
    let lower = chart.add(line("μ − σ", "transparent", &[]), ends(belief, -1.0));
    chart.band(upper, lower, "rgba(122,122,122,0.3)");
    for view in &snapshot.experts {
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
        // One that is off has no part in the belief.
        let latent = view.latent.as_ref().filter(|_| view.alpha > 0.0);
        chart.add(series, means(latent));
    }
    chart.done("belief at this step", "mean, band ± σ", None)
}

/// Its means; nothing where there is none.
fn means(latent: Option<&LatentView>) -> impl Iterator<Item = f64> {
    let means = latent.into_iter().flat_map(|latent| &latent.mean);
    means.map(|&mean| f64::from(mean))
}

/// So many deviations from its means.
fn ends(latent: Option<&LatentView>, deviations: f64) -> impl Iterator<Item = f64> {
    let each = latent
        .into_iter()
        .flat_map(|latent| std::iter::zip(&latent.mean, &latent.sigma));
    each.map(move |(&mean, &sigma)| f64::from(mean) + deviations * f64::from(sigma))
}
