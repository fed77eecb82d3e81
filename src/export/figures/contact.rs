//! Precision shares around contact (D25).

use super::style;
use crate::eval::contact::Aligned;
use crate::eval::summary::Summary;
use crate::export::plot::{Panel, Plot, Series, Style};
use crate::modality::Expert;

/// Precision shares around contact, a panel a model; none without a contact.
pub fn contact(summary: &Summary) -> Option<Plot> {
    let mut subjects: Vec<&str> = summary.aligned.iter().map(|a| a.subject.as_str()).collect();
    subjects.dedup();
    let size = [320.0, 280.0];
    let columns = subjects.len().clamp(1, 3);
    let mut whole = Plot {
        size: [
            columns as f32 * size[0],
            subjects.len().div_ceil(columns) as f32 * size[1],
        ],
        title: "Precision shares around the first contact, with 95 % bootstrap bands".to_owned(),
        marks: Vec::new(),
    };
    let mut named: Vec<(String, Style)> = Vec::new();
    for (i, subject) in subjects.iter().enumerate() {
        let mut series = Vec::new();
        for expert in Expert::ALL {
            let own = |a: &&Aligned| a.subject == *subject && a.expert == expert;
            let rows: Vec<_> = summary.aligned.iter().filter(own).collect();
            if rows.is_empty() {
                continue;
            }
            let style = style::expert(expert);
            if !named.iter().any(|(label, _)| label == expert.name()) {
                named.push((expert.name().to_owned(), style.clone()));
            }
            series.push(Series {
                style,
                points: rows
                    .iter()
                    .map(|a| [a.offset as f64, a.share.mean])
                    .collect(),
                band: rows.iter().map(|a| [a.share.low, a.share.high]).collect(),
            });
        }
        let panel = Panel {
            size,
            title: (*subject).to_owned(),
            axes: [
                "images after contact".to_owned(),
                "share of precision".to_owned(),
            ],
            series,
            from_zero: true,
            ..Panel::default()
        };
        let at = [
            (i % columns) as f32 * size[0],
            (i / columns) as f32 * size[1],
        ];
        whole.place(&panel.draw(), at);
    }
    style::below(&mut whole, &named);
    (!subjects.is_empty()).then_some(whole)
}
