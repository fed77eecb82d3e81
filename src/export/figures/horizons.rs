//! The paper's curves over the prediction horizon.

use super::style;
use crate::eval::comparison::TRIVIAL;
use crate::eval::summary::{Quality, Summary};
use crate::export::plot::{Panel, Plot, Series};

const SIZE: [f32; 2] = [360.0, 300.0];
const MEASURES: [[&str; 2]; 3] = [
    ["Squared error", "sum over pixels"],
    ["SSIM", "structural similarity"],
    ["PSNR", "dB"],
];

/// Squared error, similarity and PSNR over the horizon, each with a band of one standard deviation over episodes: a row
/// of panels for each recipe, over the same axes.
pub fn horizons(summary: &Summary) -> Plot {
    let mut recipes: Vec<&str> = Vec::new();
    for quality in summary.quality.iter().filter(|q| !is_trivial(q)) {
        if !recipes.contains(&&*quality.recipe) {
            recipes.push(&quality.recipe);
        }
    }
    let all: Vec<&Quality> = summary.quality.iter().collect();
    let ends = [0, 1, 2].map(|k| panel(&all, k, "").range(1));
    let mut whole = Plot {
        size: [3.0 * SIZE[0], 0.0],
        title:
            "Prediction quality over the horizon; bands are one standard deviation over episodes"
                .to_owned(),
        marks: Vec::new(),
    };
    for recipe in recipes {
        let of = |q: &&&Quality| q.recipe == recipe || is_trivial(q);
        let own: Vec<&Quality> = all.iter().filter(of).copied().collect();
        let labels: Vec<&str> = own.iter().map(|q| q.subject.as_str()).collect();
        let top = whole.size[1];
        for (k, ends) in ends.into_iter().enumerate() {
            let panel = Panel {
                ends: Some(ends),
                ..panel(&own, k, recipe)
            };
            whole.place(&panel.draw(), [k as f32 * SIZE[0], top]);
        }
        whole.size[1] += SIZE[1];
        style::below(&mut whole, &style::named(&labels));
    }
    whole
}

fn is_trivial(quality: &Quality) -> bool {
    TRIVIAL.contains(&quality.subject.as_str())
}

/// One measure of some rows.
fn panel(rows: &[&Quality], k: usize, recipe: &str) -> Panel {
    let labels: Vec<&str> = rows.iter().map(|q| q.subject.as_str()).collect();
    let series = rows.iter().map(|q| {
        let points = || q.horizons.iter().map(|h| h[k]).enumerate();
        let band = || points().map(|(_, s)| [s.mean - s.sd, s.mean + s.sd]);
        Series {
            style: style::model(&q.subject, &labels),
            points: points().map(|(h, s)| [h as f64 + 1.0, s.mean]).collect(),
            band: if is_trivial(q) {
                Vec::new()
            } else {
                band().collect()
            },
        }
    });
    let [title, unit] = MEASURES[k];
    Panel {
        size: SIZE,
        title: match recipe {
            "" => title.to_owned(),
            recipe => format!("{title}, {recipe}"),
        },
        axes: ["images after the context".to_owned(), unit.to_owned()],
        series: series.collect(),
        from_zero: k == 0,
        ..Panel::default()
    }
}
