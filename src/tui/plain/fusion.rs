//! What the belief at the cursor is made of: the readings of each expert, KL terms with mean and spread apart, pairs and
//! conflict, pulls, dimensions, NEES.

use super::{Report, of, trained};
use crate::measure::chi2::Bounds;
use crate::measure::divergence::KlParts;
use crate::modality::Expert;
use crate::session::snapshot::reading::{ExpertReading, FusionView};
use crate::session::snapshot::{Badge, ExpertView, Snapshot};
use crate::tui::fuse::{empty, mark};

/// Tells what is read, or why there is nothing to read.
pub(super) fn tell(report: &mut Report, snapshot: &Snapshot) {
    match &snapshot.fusion {
        _ if snapshot.badge == Badge::NoProduct => report.fact("fusion", trained(&snapshot.badge)),
        Some(fusion) => readings(report, snapshot, fusion),
        None => report.fact("fusion", format!("none, {}", empty::why(snapshot))),
    }
    if let Some(series) = &snapshot.series {
        let now = |values: &[f32]| values.get(snapshot.cursor).copied();
        report.number("NEES", now(&series.nees), "");
        report.number("NEES without R_p", now(&series.nees_bare), "");
    }
}

fn readings(report: &mut Report, snapshot: &Snapshot, fusion: &FusionView) {
    for (view, reading) in snapshot.experts.iter().zip(&fusion.experts) {
        of_expert(report, view, reading);
    }
    let limits = fusion.experts.iter().find_map(|it| it.nis?.bounds);
    bounds(report, "NIS", limits);
    kl(report, "belief", "prior", fusion.surprise);
    pairs(report, snapshot, fusion);
    match fusion.conflict {
        Some(conflict) => {
            judged(report, "conflict Q", Some(conflict.energy), conflict.bounds);
            bounds(report, "conflict Q", conflict.bounds);
            report.fact("conflict dof", conflict.dof);
            report.number("conflict ln C", Some(conflict.log_normaliser), "nats");
        }
        None => report.fact("conflict Q", "none"),
    }
    report.place("position prior", fusion.prior_m);
    report.place("pull sum", fusion.correction_m);
    dims(report, fusion);
}

fn of_expert(report: &mut Report, view: &ExpertView, reading: &ExpertReading) {
    let name = view.expert.name();
    let label = |what: &str| format!("expert {name} {what}");
    let is_sensor = view.expert != Expert::Prior;
    if is_sensor {
        let nis = reading.nis;
        let limits = nis.and_then(|nis| nis.bounds);
        let propagated = nis.and_then(|nis| nis.propagated);
        judged(report, &label("NIS head"), nis.map(|nis| nis.head), limits);
        judged(report, &label("NIS propagated"), propagated, limits);
    }
    report.number(&label("information"), reading.information_nats, "nats");
    report.number(&label("without"), reading.mahalanobis, "sigma");
    let without = reading.without.map(|at| [at.x, at.y]);
    report.place(&label("without, position"), without);
    if is_sensor {
        report.place(&label("pull"), reading.pull_m);
        kl(report, "belief", name, reading.fused);
        kl(report, name, "prior", reading.claim);
    }
}

/// KL(q ‖ p); the sum alone is never shown.
fn kl(report: &mut Report, q: &str, p: &str, parts: Option<KlParts>) {
    let label = |part: &str| format!("KL({q}, {p}) {part}");
    report.number(&label("mean"), parts.map(|parts| parts.mean), "nats");
    report.number(&label("spread"), parts.map(|parts| parts.spread), "nats");
}

fn pairs(report: &mut Report, snapshot: &Snapshot, fusion: &FusionView) {
    let name = |i: usize| {
        let view = snapshot.experts.get(i);
        view.map_or("none", |view| view.expert.name())
    };
    for pair in &fusion.disagreements {
        let label = format!("pair {} {} d2", name(pair.a), name(pair.b));
        judged(report, &label, Some(pair.distance), pair.bounds);
    }
    let limits = fusion.disagreements.iter().find_map(|pair| pair.bounds);
    bounds(report, "pair d2", limits);
}

/// Numbers count dimensions from 0, as on the screen.
fn dims(report: &mut Report, fusion: &FusionView) {
    let active = fusion.active.iter().filter(|&&active| active).count();
    report.fact("dims active", of(active, fusion.active.len()));
    let dims = fusion.active.iter().enumerate();
    let still = dims.filter_map(|(d, &active)| (!active).then_some(d));
    report.list("dims that do not move", still);
    if !fusion.active_from.is_empty() {
        report.fact("dims active over", &fusion.active_from);
    }
    if let Some(attribution) = &fusion.attribution {
        for (axis, metres) in ["x", "y"].into_iter().zip(&attribution.contribution_m) {
            let cm: Vec<f32> = metres.iter().map(|metres| metres * 100.0).collect();
            report.numbers(&format!("dims {axis} in cm"), &cm);
        }
        for (axis, parts) in ["x", "y"].into_iter().zip(&attribution.variance_part) {
            report.numbers(&format!("dims sigma squared {axis}"), parts);
        }
    }
    let importance = fusion.importance_m.iter();
    let cm: Vec<f32> = importance.map(|&metres| (metres * 100.0) as f32).collect();
    report.numbers("dims perm in cm", &cm);
}

/// A reading, and where it lies against the bounds.
fn judged(report: &mut Report, label: &str, value: Option<f32>, limits: Option<Bounds>) {
    report.number(label, value, "");
    report.fact(&format!("{label} verdict"), verdict(value, limits));
}

/// What the marks ▲ and ▼ say; there is no verdict where an α is neither 0 nor 1.
fn verdict(value: Option<f32>, limits: Option<Bounds>) -> &'static str {
    match value.filter(|value| value.is_finite()) {
        Some(value) if limits.is_some() => match mark(value, limits) {
            '▲' => "above",
            '▼' => "below",
            _ => "within",
        },
        _ => "none",
    }
}

fn bounds(report: &mut Report, label: &str, limits: Option<Bounds>) {
    let ends = limits.map(|limits| [limits.low, limits.high]);
    report.numbers(
        &format!("{label} bounds of 95 percent"),
        ends.as_ref().map_or(&[][..], |ends| ends),
    );
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tui::{fixture, plain};

    #[test]
    fn a_reading_is_above_below_or_within_its_bounds_and_a_tempered_one_has_none() {
        let mut snapshot = fixture::snapshot(8, 16);
        let mut fusion = (**snapshot.fusion.as_ref().expect("a belief")).clone();
        let heads = [(40.0, true), (1.0, true), (10.0, false)];
        for (reading, (head, bounded)) in fusion.experts.iter_mut().zip(heads) {
            let nis = reading.nis.as_mut().expect("a sensor");
            nis.head = head;
            nis.bounds = nis.bounds.filter(|_| bounded);
        }
        snapshot.fusion = Some(Arc::new(fusion));
        let text = plain(&snapshot);
        for line in [
            "expert vision NIS head: 40.000",
            "expert vision NIS head verdict: above",
            "expert haptic NIS head verdict: below",
            "expert proprio NIS head: 10.000",
            "expert proprio NIS head verdict: none",
            "NIS bounds of 95 percent: 6.900 28.800",
            "pair vision haptic d2 verdict: within",
            "conflict Q: 61.000",
            "conflict Q verdict: within",
            "conflict Q bounds of 95 percent: 26.000 61.800",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
        assert!(!text.contains("expert prior NIS"), "{text}");
    }

    #[test]
    fn an_expert_that_is_off_has_no_reading() {
        let mut snapshot = fixture::snapshot(8, 16);
        let mut fusion = (**snapshot.fusion.as_ref().expect("a belief")).clone();
        fusion.experts[1] = ExpertReading::default();
        fusion.conflict = None;
        fusion.disagreements.clear();
        snapshot.fusion = Some(Arc::new(fusion));
        let text = plain(&snapshot);
        for line in [
            "expert haptic NIS head: none",
            "expert haptic NIS head verdict: none",
            "expert haptic pull, x y in cm: none",
            "KL(belief, haptic) mean: none",
            "pair d2 bounds of 95 percent: none",
            "conflict Q: none",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
    }

    #[test]
    fn where_there_is_nothing_to_read_it_is_said_why() {
        let text = plain(&fixture::snapshot(0, 16));
        let line = "\nfusion: none, no belief before step 2\nNEES: none\n";
        assert!(text.contains(line), "{text}");
        let mut snapshot = fixture::snapshot(8, 16);
        snapshot.badge = Badge::NoProduct;
        let text = plain(&snapshot);
        let line = "\nfusion: none, the model has no product\n";
        assert!(text.contains(line) && !text.contains("\nKL("), "{text}");
    }
}
