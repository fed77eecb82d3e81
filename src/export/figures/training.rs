//! How runs went.

use super::style;
use crate::export::plot::{Panel, Plot, Series};

/// PSNR on validation episodes against updates, mean over the horizon; none where no run left a curve.
pub fn training(curves: Vec<(String, Vec<[f64; 2]>)>) -> Option<Plot> {
    let curves: Vec<(String, Vec<[f64; 2]>)> = curves
        .into_iter()
        .filter(|(_, points)| points.len() > 1)
        .collect();
    let labels: Vec<&str> = curves.iter().map(|(label, _)| label.as_str()).collect();
    let named = style::named(&labels);
    let series = named
        .iter()
        .zip(&curves)
        .map(|((_, style), (_, points))| Series {
            style: style.clone(),
            points: points.clone(),
            band: Vec::new(),
        })
        .collect();
    let panel = Panel {
        size: [560.0, 320.0],
        title: "Open-loop prediction of validation episodes while training".to_owned(),
        axes: ["updates".to_owned(), "PSNR, dB".to_owned()],
        series,
        ..Panel::default()
    };
    let mut plot = panel.draw();
    style::below(&mut plot, &named);
    (!named.is_empty()).then_some(plot)
}
