//! Whether what is claimed is held over a split: the sentences first, then the numbers they come from.

use super::{Report, of};
use crate::measure::calibration::{Calibration, CoveragePoint, HorizonNees};
use crate::session::snapshot::Snapshot;
use crate::session::snapshot::board::BoardView;

/// Tells it, where a view has asked for it.
pub(super) fn tell(report: &mut Report, snapshot: &Snapshot) {
    let Some(board) = &snapshot.board else {
        return;
    };
    report.fact("consistency split", &board.split);
    report.fact("consistency episodes", of(board.episodes, board.total));
    if let Some(why) = &board.why_not {
        report.fact("consistency", format!("none, {why}"));
        return;
    }
    if board.stale {
        report.fact("consistency numbers", "still of before the last change");
    }
    if !snapshot.corruptions.is_empty() {
        report.fact("consistency episodes damaged", "none");
    }
    for sentence in &board.sentences {
        report.fact("consistency", sentence);
    }
    if board.sentences.is_empty() {
        report.fact("consistency", "none");
    }
    calibration(report, "consistency filtered", board.filtered.as_ref());
    let bare = board.filtered_bare_nees.map(|nees| nees as f32);
    report.number("consistency filtered NEES without R_p", bare, "");
    calibration(report, "consistency predicted", board.predicted.as_ref());
    nees(report, board);
    dependence(report, board);
}

fn calibration(report: &mut Report, name: &str, calibration: Option<&Calibration>) {
    let Some(calibration) = calibration else {
        report.fact(name, "none");
        return;
    };
    let label = |what: &str| format!("{name} {what}");
    report.fact(&label("verdict"), calibration.verdict);
    let held = calibration.at_claim().map(|point| percent(point.held));
    report.number(&label("holds of 95 percent"), held, "percent");
    report.number(&label("off by"), Some(calibration.area as f32), "");
    let trace = Some(calibration.sharpness_cm2 as f32);
    report.number(&label("tr P"), trace, "square cm");
    report.number(&label("NLL"), Some(calibration.nll as f32), "nats");
    let crps_cm = calibration.crps_cm.map(|cm| cm as f32);
    report.numbers(&label("CRPS, x y in cm"), &crps_cm);
    let pit: Vec<f32> = calibration.pit.iter().map(|&share| share as f32).collect();
    report.numbers(&label("PIT"), &pit);
    let curve = |value: fn(&CoveragePoint) -> f64| -> Vec<f32> {
        let points = calibration.coverage.iter();
        points.map(|point| percent(value(point))).collect()
    };
    let (claimed, held) = (curve(|point| point.claimed), curve(|point| point.held));
    report.numbers(&label("coverage, percent claimed"), &claimed);
    report.numbers(&label("coverage, percent held"), &held);
}

fn percent(part: f64) -> f32 {
    (100.0 * part) as f32
}

fn nees(report: &mut Report, board: &BoardView) {
    for (name, nees) in [
        ("head", &board.by_head),
        ("propagated", &board.by_propagation),
        ("filtered", &board.by_filter),
    ] {
        let label = format!("consistency NEES {name} by horizon from 0");
        report.numbers(&label, &by_horizon(nees));
    }
    let fullest = board.by_head.iter().max_by_key(|at| at.episodes);
    let band = fullest.map(|at| [at.low as f32, at.high as f32]);
    report.numbers(
        "consistency NEES of 95 percent if honest",
        band.as_ref().map_or(&[][..], |band| band),
    );
}

/// Means at every horizon up to the last, no number where there is none.
fn by_horizon(nees: &[HorizonNees]) -> Vec<f32> {
    let horizons = nees.iter().map(|at| at.horizon + 1).max().unwrap_or(0);
    let mut means = vec![f32::NAN; horizons];
    for at in nees {
        means[at.horizon] = at.mean as f32;
    }
    means
}

fn dependence(report: &mut Report, board: &BoardView) {
    let name = |i: usize| {
        let expert = board.experts.get(i);
        expert.map_or("none", |expert| expert.name())
    };
    for pair in board.dependence.iter().flat_map(|it| &it.pairs) {
        let (a, b) = (name(pair.a), name(pair.b));
        let label = format!("consistency rho of errors {a} {b}");
        report.number(&label, Some(pair.rho as f32), "");
    }
    for (expert, fitted) in &board.alphas {
        let label = format!("consistency fit alpha {}", expert.name());
        report.number(&label, Some(fitted.alpha as f32), "");
    }
    if !board.alphas.is_empty() {
        report.fact("consistency alpha fitted on", &board.alphas_from);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tui::{fixture, plain};

    fn told(change: impl FnOnce(&mut BoardView)) -> String {
        let mut snapshot = fixture::snapshot(8, 16);
        let mut board = (*fixture::bench::board()).clone();
        change(&mut board);
        snapshot.board = Some(Arc::new(board));
        plain(&snapshot)
    }

    #[test]
    fn the_verdict_is_said_with_its_numbers() {
        let text = told(|board| board.stale = true);
        for line in [
            "consistency episodes: 32 of 32",
            "consistency numbers: still of before the last change",
            "consistency: filtered: claims 95 %, holds 81 % [65, 91] of 32: overconfident",
            "consistency filtered verdict: overconfident",
            "consistency filtered NEES without R_p: 9.700",
            "consistency rho of errors haptic proprio: 0.770",
            "consistency fit alpha haptic: 0.330",
            "consistency alpha fitted on: test, 32 episodes",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
    }

    #[test]
    fn what_cannot_be_measured_is_said_and_what_is_not_yet_is_none() {
        let why = "v has no position probe; train writes one";
        let text = told(|board| board.why_not = Some(why.to_owned()));
        let line = format!("\nconsistency: none, {why}\n");
        assert!(text.contains(&line) && !text.contains("PIT"), "{text}");
        let text = told(|board| {
            *board = BoardView {
                split: "test".to_owned(),
                episodes: 3,
                total: 32,
                ..BoardView::default()
            };
        });
        for line in [
            "consistency episodes: 3 of 32",
            "consistency: none",
            "consistency filtered: none",
            "consistency NEES head by horizon from 0: none",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
    }

    #[test]
    fn a_horizon_without_a_mean_keeps_its_place() {
        let text = told(|board| board.by_head.retain(|at| at.horizon % 2 == 1));
        let line = "\nconsistency NEES head by horizon from 0: none 3.000 none 4.800 ";
        assert!(text.contains(line), "{text}");
    }
}
