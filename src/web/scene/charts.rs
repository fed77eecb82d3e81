//! Charts over the episode, over the latent and over the horizon.

mod errors;
mod horizon;
mod latents;
mod shares;

use std::collections::BTreeMap;

use super::panel::Panel;
use crate::modality::Expert;
use crate::session::snapshot::Snapshot;
use crate::web::protocol::uplot::{
    Axis, Band, Column, Cursor, Legend, Points, Scale, Series, UplotProps,
};

/// The belief's colour: seen on light and on dark.
const BELIEF: &str = "#7a7a7a";
/// The prediction's.
const PREDICTION: &str = "#56b4e9";
/// Longer episodes have no mark at the cursor: it would have every point sent again at each step.
const MARKED: usize = 512;

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot) {
    panel.folder("charts", "Charts", true);
    panel.chart("chart-shares", shares::chart(snapshot));
    panel.chart("chart-latents", latents::chart(snapshot));
    panel.chart("chart-position", errors::position(snapshot));
    panel.chart("chart-horizon", horizon::chart(snapshot));
    panel.chart("chart-psnr", errors::psnr(snapshot));
}

/// A chart that is being put together. Which series it has depends on the model, not on what there is at a step:
/// viser's client makes a chart anew for other series, from the old data, and tells it the new ones before it has drawn;
/// where the first of those is a gap, uPlot then fails for want of an axis' range. It would lose the user's zoom, too.
struct Chart {
    columns: Vec<Vec<f64>>,
    series: Vec<Series>,
    bands: Vec<Band>,
}

impl Chart {
    /// Over these values of x; over 1 where there are none, since viser's client counts with the ends of x.
    fn over(label: &str, x: impl IntoIterator<Item = f64>) -> Self {
        let mut x: Vec<f64> = x.into_iter().collect();
        if x.is_empty() {
            x.push(1.0);
        }
        let series = Series {
            label: Some(label.to_owned()),
            ..Series::default()
        };
        Self {
            columns: vec![x],
            series: vec![series],
            bands: Vec::new(),
        }
    }

    /// Over the steps of the episode, from 1.
    fn over_steps(steps: usize) -> Self {
        Self::over("step", (1..=steps).map(|step| step as f64))
    }

    /// Adds a column, filled up or cut to the length of x; its number.
    fn add(&mut self, series: Series, values: impl IntoIterator<Item = f64>) -> usize {
        let length = self.columns[0].len();
        let values = values.into_iter().chain(std::iter::repeat(f64::NAN));
        self.columns.push(values.take(length).collect());
        self.series.push(series);
        self.columns.len() - 1
    }

    /// Fills between two columns.
    fn band(&mut self, upper: usize, lower: usize, color: &str) {
        self.bands.push(Band {
            series: [upper, lower],
            fill: color.to_owned(),
            dir: -1,
        });
    }

    /// Marks the cursor by a point at a height, if there is one.
    fn mark(&mut self, cursor: usize, height: f64) {
        let length = self.columns[0].len();
        if length <= MARKED {
            let points = Points {
                show: true,
                size: 9.0,
                fill: BELIEF.to_owned(),
            };
            let series = Series {
                points: Some(points),
                ..line("now", BELIEF, &[])
            };
            let at = (0..length).map(|step| if step == cursor { height } else { f64::NAN });
            self.add(series, at);
        }
    }

    /// The chart; unseen without a value besides x.
    fn done(self, title: &str, y: &str, range: Option<[Option<f64>; 2]>) -> UplotProps {
        let any = self
            .columns
            .iter()
            .skip(1)
            .flatten()
            .any(|value| value.is_finite());
        let x = Scale {
            time: Some(false),
            range: None,
        };
        let y_scale = Scale { time: None, range };
        let scales = [("x".to_owned(), x), ("y".to_owned(), y_scale)];
        let axis = |label: Option<String>, side, size| Axis {
            label,
            side: Some(side),
            size: Some(size),
        };
        let x_label = self.series.first().and_then(|series| series.label.clone());
        UplotProps {
            data: self.columns.into_iter().map(Column::of).collect(),
            title: Some(title.to_owned()),
            series: self.series,
            bands: (!self.bands.is_empty()).then_some(self.bands),
            scales: Some(BTreeMap::from(scales)),
            axes: Some(vec![axis(x_label, 2, 44), axis(Some(y.to_owned()), 3, 48)]),
            legend: Some(Legend { show: true }),
            cursor: Some(Cursor {
                show: true,
                drag: None,
            }),
            aspect: 1.6,
            height: Some(210),
            visible: any,
            ..UplotProps::default()
        }
    }
}

/// A line; no dashes for a whole one.
fn line(label: &str, color: &str, dash: &[u32]) -> Series {
    Series {
        label: Some(label.to_owned()),
        stroke: Some(color.to_owned()),
        width: Some(1.5),
        dash: (!dash.is_empty()).then(|| dash.to_vec()),
        ..Series::default()
    }
}

/// A colour for an area.
fn wash((r, g, b): (u8, u8, u8), alpha: f32) -> String {
    format!("rgba({r},{g},{b},{alpha})")
}

/// An expert's colour.
fn ink(expert: Expert) -> String {
    let (r, g, b) = expert.rgb();
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Dashes that tell experts apart without colour.
fn dashes(place: usize) -> &'static [u32] {
    const KINDS: [&[u32]; 5] = [&[], &[8, 3], &[2, 3], &[8, 3, 2, 3], &[4, 4]];
    KINDS[place % KINDS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_of_nothing_has_an_x_all_the_same() {
        let mut chart = Chart::over("latent dimension", []);
        chart.add(line("belief μ", BELIEF, &[]), []);
        assert!(chart.columns.iter().all(|column| column.len() == 1));
        assert!(!chart.done("belief", "mean", None).visible);
    }
}
