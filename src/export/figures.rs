//! The paper's figures, drawn from a summary.

use super::plot::{Anchor, INK, Mark, Panel, Plot, Rgb, Series, Style};
use crate::eval::comparison::TRIVIAL;
use crate::eval::regression::{Beliefs, FittedOn, Regressor};
use crate::eval::summary::Summary;
use crate::measure::ellipse::{Ellipse, ONE_SIGMA_MASS};
use crate::modality::Expert;

/// Corners of an outline.
const CORNERS: usize = 72;

/// A model has the colour of what it adds to vision; seeds and settings of it differ by their dashes.
fn style(label: &str, others: &[&str]) -> Style {
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
                label: q.subject.clone(),
                style: style(&q.subject, &labels),
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
    let named: Vec<(String, Style)> = labels
        .iter()
        .map(|l| ((*l).to_owned(), style(l, &labels)))
        .collect();
    below(&mut whole, &named);
    whole
}

/// Adds a legend under a figure.
fn below(plot: &mut Plot, named: &[(String, Style)]) {
    let legend = super::plot::legend(named, plot.size[0]);
    plot.place(&legend, [0.0, plot.size[1]]);
    plot.size[1] += legend.size[1];
}

/// Mean absolute errors along x and y of predicted positions, with an ellipse of one standard deviation; none where no
/// pose was recorded.
pub fn ellipses(summary: &Summary) -> Option<Plot> {
    let of = |fitted_on: FittedOn| {
        let rows = summary.regression.iter().filter(move |r| {
            r.beliefs == Beliefs::Predicted
                && r.regressor == Regressor::Linear
                && r.fitted_on == fitted_on
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
            let style = style(&r.subject, &labels);
            let ellipse = Ellipse::of_covariance(r.covariance_cm2);
            let outline = ellipse.outline(centre.map(|c| c as f32), 1.0, CORNERS);
            let mut outline: Vec<[f64; 2]> = outline.iter().map(|p| p.map(f64::from)).collect();
            outline.extend(outline.first().copied());
            let arm = 0.03;
            let cross = [[-arm, 0.0], [arm, 0.0], [0.0, 0.0], [0.0, -arm], [0.0, arm]];
            let cross = cross.map(|[x, y]| [centre[0] + x, centre[1] + y]).to_vec();
            let line = |points| Series {
                label: r.subject.clone(),
                style: style.clone(),
                points,
                band: Vec::new(),
            };
            [line(outline), line(cross)]
        })
        .collect();
    if series.is_empty() {
        return None;
    }
    let panel = Panel {
        size: [460.0, 420.0],
        title: format!(
            "Absolute position errors, predicted; regression fitted on {}",
            fitted_on.name()
        ),
        axes: ["|x error|, cm".to_owned(), "|y error|, cm".to_owned()],
        series,
        equal: true,
        from_zero: false,
    };
    let mut plot = panel.draw();
    let named: Vec<(String, Style)> = labels
        .iter()
        .map(|l| ((*l).to_owned(), style(l, &labels)))
        .collect();
    below(&mut plot, &named);
    let mass = format!(
        "Ellipses are one standard deviation: {:.1} % of a Gaussian's mass. Crosses are means.",
        100.0 * ONE_SIGMA_MASS
    );
    plot.text([10.0, plot.size[1] + 12.0], mass, Anchor::Start);
    plot.size[1] += 22.0;
    Some(plot)
}

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
            let own =
                |a: &&crate::eval::contact::Aligned| a.subject == *subject && a.expert == expert;
            let rows: Vec<_> = summary.aligned.iter().filter(own).collect();
            let Some(first) = rows.first() else { continue };
            let style = expert_style(expert);
            if !named.iter().any(|(label, _)| label == expert.name()) {
                named.push((expert.name().to_owned(), style.clone()));
            }
            series.push(Series {
                label: first.expert.name().to_owned(),
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
            equal: false,
            from_zero: true,
        };
        let at = [
            (i % columns) as f32 * size[0],
            (i / columns) as f32 * size[1],
        ];
        whole.place(&panel.draw(), at);
    }
    below(&mut whole, &named);
    (!subjects.is_empty()).then_some(whole)
}

/// PSNR on validation episodes against updates, mean over the horizon; none where no run left a curve.
pub fn training(curves: Vec<(String, Vec<[f64; 2]>)>) -> Option<Plot> {
    let labels: Vec<String> = curves.iter().map(|(label, _)| label.clone()).collect();
    let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
    let series: Vec<Series> = curves
        .into_iter()
        .filter(|(_, points)| points.len() > 1)
        .map(|(label, points)| Series {
            style: style(&label, &labels),
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
    below(&mut plot, &named);
    (!named.is_empty()).then_some(plot)
}

fn expert_style(expert: Expert) -> Style {
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

/// A row of frames.
pub struct Frames {
    /// Before it.
    pub label: String,
    /// Grey values, each of `columns * columns` pixels.
    pub frames: Vec<Vec<u8>>,
}

/// Rows of frames of one episode.
pub struct Strip {
    /// Above it.
    pub title: String,
    /// Its rows; the images they are of are the same.
    pub rows: Vec<Frames>,
    /// Number of the first image, from 1.
    pub first: usize,
}

/// Strips one under the other, `side` pixels of a frame along.
pub fn strips(title: &str, strips: &[Strip], side: usize) -> Plot {
    const CELL: f32 = 64.0;
    const GAP: f32 = 2.0;
    const LABEL: f32 = 96.0;
    let longest = strips
        .iter()
        .flat_map(|s| &s.rows)
        .map(|r| r.frames.len())
        .max();
    // No more frames in a row than a page is wide.
    let every = longest.unwrap_or(1).div_ceil(14).max(1);
    let columns = longest.unwrap_or(1).div_ceil(every);
    let mut plot = Plot {
        size: [LABEL + columns as f32 * (CELL + GAP) + 10.0, 10.0],
        title: title.to_owned(),
        marks: Vec::new(),
    };
    for strip in strips {
        let top = plot.size[1];
        plot.text([10.0, top + 14.0], strip.title.clone(), Anchor::Start);
        for column in 0..columns {
            let x = LABEL + column as f32 * (CELL + GAP) + CELL / 2.0;
            let number = (strip.first + column * every).to_string();
            plot.text([x, top + 34.0], number, Anchor::Middle);
        }
        let mut y = top + 40.0;
        for row in &strip.rows {
            plot.text(
                [LABEL - 8.0, y + CELL / 2.0 + 4.0],
                row.label.clone(),
                Anchor::End,
            );
            for (column, pixels) in row.frames.iter().step_by(every).enumerate() {
                plot.marks.push(Mark::Image {
                    at: [LABEL + column as f32 * (CELL + GAP), y],
                    size: [CELL; 2],
                    columns: side,
                    pixels: pixels.clone(),
                });
            }
            y += CELL + GAP;
        }
        plot.size[1] = y + 10.0;
    }
    plot
}
