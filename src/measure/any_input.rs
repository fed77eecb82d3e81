//! No input makes a diagnostic stop: whatever the sizes and the numbers, it answers or says that it cannot.

use proptest::prelude::*;

use super::{
    active::LatentStats,
    attribution::{attribution, permutation_importance},
    chi2,
    divergence::kl_parts,
    events::onsets,
    failure::{Order, Scores, queue},
    gaussian::{Factor, Gaussian, product},
    innovation::{conflict, disagreements, nis, predicted_covariance},
    leave_one_out::without,
    pull::pulls,
    samples::{blur_index, mean_frame, spread_frame},
    spread::{plane, sample_covariance},
};
use crate::episode::Frame;

/// Often an ordinary number, else any: infinite, subnormal, not a number.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![4 => -3.0_f32..3.0, 1 => any::<f32>()]
}

/// Often two numbers, else any few.
fn numbers() -> impl Strategy<Value = Vec<f32>> {
    prop_oneof![
        3 => prop::collection::vec(number(), 2),
        1 => prop::collection::vec(number(), 0..6),
    ]
}

fn frame() -> impl Strategy<Value = Frame> {
    (
        0_usize..3,
        0_usize..3,
        prop::collection::vec(any::<u8>(), 0..5),
    )
        .prop_map(|(width, height, pixels)| Frame {
            width,
            height,
            pixels,
        })
}

proptest! {
    #[test]
    fn experts_of_any_size_and_value(
        experts in prop::collection::vec((numbers(), numbers(), number()), 0..4),
        weights in prop::collection::vec(number(), 0..6),
        active in prop::collection::vec(any::<bool>(), 0..4),
        transition in prop::collection::vec(number(), 4),
    ) {
        let factors: Vec<Factor> = experts
            .iter()
            .map(|(mean, log_var, alpha)| Factor {
                gaussian: Gaussian { mean, log_var },
                alpha: *alpha,
            })
            .collect();
        let belief = product(&factors);
        for i in 0..=factors.len() {
            let left = without(&factors, i, Some(&weights));
            prop_assert!(left.is_none() || belief.is_some());
        }
        let _ = (conflict(&factors, &active), disagreements(&factors, &active));
        if let Some((prior, sensors)) = factors.split_last() {
            let _ = pulls(sensors, *prior, &weights);
            for sensor in sensors {
                let (q, p) = (sensor.gaussian, prior.gaussian);
                let covariance = predicted_covariance(&transition, q.log_var, p.log_var);
                let _ = (kl_parts(q, p), plane(&weights, &covariance));
                let _ = nis(*sensor, p, Some(&covariance), &active);
            }
        }
    }

    #[test]
    fn data_of_any_size_and_value(
        rows in prop::collection::vec((numbers(), [number(), number()]), 0..5),
        weights in prop::collection::vec(number(), 0..6),
        force in numbers(),
        threshold in number(),
        frames in prop::collection::vec(frame(), 0..4),
        dof in any::<f32>(),
    ) {
        let mut stats = LatentStats::default();
        for (mean, _) in &rows {
            let _ = stats.push(mean);
            let _ = attribution(&weights, mean, &force, &stats);
        }
        let _ = permutation_importance(&weights, [threshold, 0.0], &rows, 1);
        let points: Vec<[f32; 2]> = rows.iter().map(|row| row.1).collect();
        let _ = (sample_covariance(&points), onsets(&force, threshold));
        let frames: Vec<&Frame> = frames.iter().collect();
        let _ = (mean_frame(&frames), spread_frame(&frames));
        if let [first, second, ..] = frames[..] {
            let _ = blur_index(first, second);
        }
        let few = f64::from(dof).clamp(-1.0, 1e4);
        let _ = (chi2::bounds_95(few), chi2::cdf(few, f64::from(threshold)));
        let steps: Vec<Scores> = force
            .iter()
            .map(|&score| Scores { error: Some(score), gain: Some(score), ..Scores::default() })
            .collect();
        for order in Order::ALL {
            let queue = queue([(0, steps.as_slice()), (1, &[][..])], order);
            prop_assert!(queue.iter().all(|&(episode, step)| episode == 0 && step < steps.len()));
        }
    }
}
