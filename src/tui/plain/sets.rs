//! Every set of experts at once, in numbers.

use super::Report;
use crate::session::snapshot::Snapshot;

/// Square centimetres of a square metre.
const CM2_PER_M2: f32 = 1e4;

/// Tells them, where a view has asked for them.
pub(super) fn tell(report: &mut Report, snapshot: &Snapshot) {
    let Some(lattice) = &snapshot.lattice else {
        return;
    };
    report.fact("sets", lattice.cells.len());
    report.fact("sets at step", lattice.step + 1);
    for cell in &lattice.cells {
        let name = format!("set {}", cell.name);
        let label = |what: &str| format!("{name} {what}");
        let cm = |metres: Option<f32>| metres.map(|metres| metres * 100.0);
        let trained = if cell.trained {
            "trained"
        } else {
            "never trained"
        };
        let present = if cell.current {
            ", the present switches"
        } else {
            ""
        };
        report.fact(&name, format!("{trained}{present}"));
        report.number(&label("PSNR"), cell.psnr_db, "dB");
        report.number(&label("SE"), cell.squared_error, "");
        let (off, rmse) = (cm(cell.position_error_m), cm(cell.episode_rmse_m));
        report.number(&label("position error"), off, "cm");
        report.number(&label("episode RMSE"), rmse, "cm");
        let area = cell.ellipse_m2.map(|area| area * CM2_PER_M2);
        report.number(&label("ellipse of 1 sigma"), area, "square cm");
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::tui::{fixture, plain};

    #[test]
    fn a_set_says_whether_it_was_trained_and_is_the_present_one() {
        let mut snapshot = fixture::snapshot(8, 16);
        let mut lattice = (*fixture::bench::lattice(8)).clone();
        lattice.cells[0].psnr_db = None;
        snapshot.lattice = Some(Arc::new(lattice));
        let text = plain(&snapshot);
        for line in [
            "sets: 15",
            "sets at step: 9",
            "set VHPD: trained, the present switches",
            "set VHPD PSNR: none",
            "set VHP: never trained",
            "set D: trained",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
        snapshot.lattice = None;
        assert!(!plain(&snapshot).contains("\nset"));
    }
}
