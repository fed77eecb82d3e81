//! How runs went.

use super::style;
use crate::export::plot::{Panel, Plot, Series, Style};

/// PSNR on validation episodes against updates, mean over the horizon; none where no run left a curve.
pub fn training(curves: Vec<(String, Vec<[f64; 2]>)>) -> Option<Plot> {
    let labels: Vec<String> = curves.iter().map(|(label, _)| label.clone()).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    let series: Vec<Series> = curves
        .into_iter()
        .filter(|(_, points)| points.len() > 1)
        .map(|(label, points)| Series {
            style: style::model(&label, &labels),
            label,
            points,
            band: Vec::new(),
        })
        .collect();
    let named: Vec<(String, Style)> = series
        .iter()
        .map(|s| (s.label.clone(), s.style.clone()))
        .collect();
    let panel = Panel {
        size: [560.0, 320.0],
        title: "Open-loop prediction of validation episodes while training".to_owned(),
        axes: ["updates".to_owned(), "PSNR, dB".to_owned()],
        series,
        equal: false,
        from_zero: false,
    };
    let mut plot = panel.draw();
    style::below(&mut plot, &named);
    (!named.is_empty()).then_some(plot)
}
