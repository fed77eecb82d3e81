//! The paper's curves over the prediction horizon.

use super::style;
use crate::eval::comparison::TRIVIAL;
use crate::eval::summary::Summary;
use crate::export::plot::{Panel, Plot, Series};

/// Squared error, similarity and PSNR over the horizon, each with a band of one standard deviation over episodes.
pub fn horizons(summary: &Summary) -> Plot {
    let labels: Vec<&str> = summary.quality.iter().map(|q| q.subject.as_str()).collect();
    let titles = ["Squared error", "SSIM", "PSNR"];
    let units = ["sum over pixels", "structural similarity", "dB"];
    let size = [360.0, 300.0];
    let mut whole = Plot {
        size: [3.0 * size[0], size[1]],
        title:
            "Prediction quality over the horizon; bands are one standard deviation over episodes"
                .to_owned(),
        marks: Vec::new(),
    };
    for k in 0..3 {
        let series = summary.quality.iter().map(|q| {
            let points = || q.horizons.iter().map(|h| h[k]).enumerate();
            let trivial = TRIVIAL.contains(&q.subject.as_str());
            Series {
                style: style::model(&q.subject, &labels),
                points: points().map(|(h, s)| [h as f64 + 1.0, s.mean]).collect(),
                band: if trivial {
                    Vec::new()
                } else {
                    points()
                        .map(|(_, s)| [s.mean - s.sd, s.mean + s.sd])
                        .collect()
                },
            }
        });
        let panel = Panel {
            size,
            title: titles[k].to_owned(),
            axes: ["images after the context".to_owned(), units[k].to_owned()],
            series: series.collect(),
            equal: false,
            from_zero: k == 0,
        };
        whole.place(&panel.draw(), [k as f32 * size[0], 0.0]);
    }
    style::below(&mut whole, &style::named(&labels));
    whole
}
