//! The paper's ellipses of position errors.

use super::style;
use crate::eval::protocol::Protocol;
use crate::eval::regression::{Beliefs, FittedOn, Regressor};
use crate::eval::summary::Summary;
use crate::export::plot::{Anchor, Panel, Plot, Series, Style};
use crate::measure::ellipse::{Ellipse, ONE_SIGMA_MASS};

/// Corners of an outline.
const CORNERS: usize = 72;

/// Mean absolute errors along x and y of predicted positions, with an ellipse of one standard deviation; none where no
/// pose was recorded. Read by least squares, as in the paper, whose MIT set has the network.
pub fn ellipses(summary: &Summary) -> Option<Plot> {
    let regressor = match summary.protocol {
        Protocol::MIT => Regressor::Network,
        _ => Regressor::Linear,
    };
    let of = |fitted_on: FittedOn| {
        let rows = summary.regression.iter().filter(move |r| {
            r.beliefs == Beliefs::Predicted && r.regressor == regressor && r.fitted_on == fitted_on
        });
        rows.collect::<Vec<_>>()
    };
    let mut fitted_on = FittedOn::Train;
    let mut rows = of(fitted_on);
    if rows.is_empty() {
        fitted_on = FittedOn::Scored;
        rows = of(fitted_on);
    }
    let labels: Vec<&str> = rows.iter().map(|r| r.subject.as_str()).collect();
    let series: Vec<Series> = rows
        .iter()
        .flat_map(|r| {
            let centre = r.absolute_cm.map(|axis| axis.mean);
            let style = style::model(&r.subject, &labels);
            let ellipse = Ellipse::of_covariance(r.covariance_cm2);
            let outline = ellipse.outline(centre.map(|c| c as f32), 1.0, CORNERS);
            let outline: Vec<[f64; 2]> = outline.iter().map(|p| p.map(f64::from)).collect();
            let arm = 0.03;
            let cross = [[-arm, 0.0], [arm, 0.0], [0.0, 0.0], [0.0, -arm], [0.0, arm]];
            let cross = cross.map(|[x, y]| [centre[0] + x, centre[1] + y]).to_vec();
            let line = |style, points| Series {
                style,
                points,
                band: Vec::new(),
            };
            let unbroken = Style {
                dash: Vec::new(),
                ..style.clone()
            };
            [line(style, outline), line(unbroken, cross)]
        })
        .collect();
    if series.is_empty() {
        return None;
    }
    let panel = Panel {
        size: [460.0, 420.0],
        title: format!(
            "Absolute position errors, predicted; {} fitted on {}",
            regressor.name(),
            fitted_on.name()
        ),
        axes: ["|x error|, cm".to_owned(), "|y error|, cm".to_owned()],
        series,
        equal: true,
        ..Panel::default()
    };
    let mut plot = panel.draw();
    style::below(&mut plot, &style::named(&labels));
    let mass = format!(
        "Ellipses are one standard deviation: {:.1} % of a Gaussian's mass. Crosses are means.",
        100.0 * ONE_SIGMA_MASS
    );
    plot.text([10.0, plot.size[1] + 12.0], mass, Anchor::Start);
    plot.size[1] += 22.0;
    Some(plot)
}
