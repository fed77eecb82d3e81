//! How sure the rollout is at the cursor, in three ways, and what its samples look like.

use super::Report;
use crate::measure::spread::axis_sigmas;
use crate::session::snapshot::Snapshot;

/// Tells it, where a view has asked for it.
pub(super) fn tell(report: &mut Report, snapshot: &Snapshot) {
    let Some(spread) = &snapshot.spread else {
        return;
    };
    let now = snapshot.cursor.checked_sub(spread.first_step);
    let at_cursor = |all: &[[f32; 3]]| now.and_then(|now| all.get(now)).copied();
    let of_z = at_cursor(&spread.latent_sigma);
    for (i, (name, covariances)) in [
        ("head", &spread.head),
        ("propagated", &spread.propagated),
        ("samples", &spread.sampled),
    ]
    .into_iter()
    .enumerate()
    {
        let label = format!("rollout {name} sigma");
        let sigma = at_cursor(covariances).map(axis_sigmas);
        report.place(&format!("{label} without R_p"), sigma);
        report.number(&format!("{label} of z"), of_z.map(|of_z| of_z[i]), "");
    }
    report.fact("rollout samples", spread.samples);
    report.fact("rollout seed", spread.seed);
    // While the cursor moves on the images are of a step before.
    let frames = spread.frames.as_ref();
    if let Some(frames) = frames.filter(|frames| frames.step == snapshot.cursor) {
        let edges = "of the edges of the truth";
        report.fact("rollout samples decoded", frames.decoded);
        report.number("rollout mean of samples", frames.blur_of_samples, edges);
        report.number("rollout mean path", frames.blur_of_mean_path, edges);
    }
}

#[cfg(test)]
mod tests {
    use crate::tui::{fixture, plain};

    #[test]
    fn outside_the_horizon_nothing_is_predicted_and_where_nobody_asked_nothing_is_told() {
        let mut snapshot = fixture::snapshot(2, 16);
        let text = plain(&snapshot);
        for line in [
            "rollout head sigma without R_p, x y in cm: none",
            "rollout propagated sigma of z: none",
            "rollout samples: 32",
        ] {
            assert!(text.lines().any(|it| it == line), "{line} in {text}");
        }
        assert!(!text.contains("rollout mean of samples"), "{text}");
        snapshot.spread = None;
        assert!(!plain(&snapshot).contains("rollout"));
    }
}
