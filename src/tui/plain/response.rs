//! How the fusion answers to each damage of rising severity.

use super::Report;
use crate::session::snapshot::Snapshot;

/// Tells it, where something is damaged and a view has asked for it.
pub(super) fn tell(report: &mut Report, snapshot: &Snapshot) {
    for response in snapshot.responses.iter() {
        let (modality, damage) = (response.modality.name(), response.damage.name());
        let name = format!("response {modality} {damage}");
        let label = |what: &str| format!("{name} {what}");
        let hundredfold = |values: &[f32]| -> Vec<f32> {
            let values = values.iter();
            values.map(|value| value * 100.0).collect()
        };
        report.fact(&name, &response.sentence);
        report.numbers(&label("severity"), &response.severity);
        let (cm, percent) = (hundredfold(&response.rmse_m), hundredfold(&response.share));
        report.numbers(&label("position error in cm"), &cm);
        report.numbers(&label("NEES"), &response.nees);
        report.numbers(&label("share in percent"), &percent);
    }
}

#[cfg(test)]
mod tests {
    use crate::tui::{fixture, plain};

    #[test]
    fn a_damage_is_answered_in_words_and_numbers() {
        let mut snapshot = fixture::snapshot(8, 16);
        assert!(!plain(&snapshot).contains("response"));
        snapshot.responses = fixture::bench::responses();
        let text = plain(&snapshot);
        for line in [
            "response haptic noise: haptic doubts itself: under noise its share falls from 14 % to 9 %",
            "response haptic noise severity: 0.000 0.100 0.200 0.300 0.400 0.500 0.600 0.700 0.800 0.900 1.000",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
        let begins = |start: &str| text.lines().any(|line| line.starts_with(start));
        assert!(begins("response haptic noise NEES: 2.000 "), "{text}");
        let start = "response haptic noise share in percent: 14.000 ";
        assert!(begins(start), "{text}");
    }
}
