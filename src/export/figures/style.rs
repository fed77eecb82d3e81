//! What a model and an expert look like in every figure: never by colour alone.

use crate::eval::comparison::TRIVIAL;
use crate::export::plot::{INK, Plot, Rgb, Style, legend};
use crate::modality::Expert;

/// A model has the colour of what it adds to vision; seeds and settings of it differ by their dashes.
pub(super) fn model(label: &str, others: &[&str]) -> Style {
    let rgb = |expert: Expert| {
        let (r, g, b) = expert.rgb();
        [r, g, b]
    };
    let name = |label: &str| {
        label
            .split([' ', ',', '#'])
            .next()
            .unwrap_or_default()
            .to_owned()
    };
    let own = name(label);
    let color = match own.as_str() {
        "v" => rgb(Expert::Vision),
        "vp" => rgb(Expert::Proprio),
        "vh" => rgb(Expert::Haptic),
        "vhp" => rgb(Expert::Joint),
        "vhp-c" => rgb(Expert::Concat),
        "v-h-p" => INK,
        _ if label == TRIVIAL[0] => [150; 3],
        _ if label == TRIVIAL[1] => [110; 3],
        _ => [0x56, 0xB4, 0xE9],
    };
    let before = others.iter().take_while(|other| **other != label);
    let alike = before.filter(|other| name(other) == own).count();
    let dash: &[f32] = match label {
        _ if label == TRIVIAL[0] => &[2.0, 3.0],
        _ if label == TRIVIAL[1] => &[8.0, 3.0, 2.0, 3.0],
        _ => [&[][..], &[6.0, 3.0], &[2.0, 2.0], &[8.0, 2.0, 2.0, 2.0]][alike.min(3)],
    };
    Style {
        color,
        dash: dash.to_vec(),
    }
}

/// An expert has its own colour, and a dash of its own.
pub(super) fn expert(expert: Expert) -> Style {
    let (r, g, b) = expert.rgb();
    let color: Rgb = [r, g, b];
    let dash: &[f32] = match expert {
        Expert::Vision | Expert::Concat => &[],
        Expert::Haptic | Expert::Joint => &[6.0, 3.0],
        Expert::Proprio => &[2.0, 2.0],
        Expert::Prior => &[8.0, 2.0, 2.0, 2.0],
    };
    Style {
        color,
        dash: dash.to_vec(),
    }
}

/// Adds a legend under a figure.
pub(super) fn below(plot: &mut Plot, named: &[(String, Style)]) {
    let legend = legend(named, plot.size[0]);
    plot.place(&legend, [0.0, plot.size[1]]);
    plot.size[1] += legend.size[1];
}

/// Labels with their styles.
pub(super) fn named(labels: &[&str]) -> Vec<(String, Style)> {
    let each = labels.iter();
    each.map(|label| ((*label).to_owned(), model(label, labels)))
        .collect()
}
