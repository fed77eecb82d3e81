//! How the made-up model's square moves: where the control says, give or take a little. A is the identity, and like
//! a trained model's the head states the variance of one step: it does not carry what the last belief had (D20).

use crate::model::trace::{GaussianTrace, Rolled};

/// Z.
pub const LATENT: usize = 4;
/// Q, the variance of one step in every dimension.
pub const STEP_VARIANCE: f32 = 0.004;

/// Moves a latent by a control.
pub fn push(z: &mut [f32], control: Option<&[f32; 2]>) {
    for (z, u) in z.iter_mut().zip(control.copied().unwrap_or_default()) {
        *z += u;
    }
}

/// So many times A.
pub fn identities(count: usize) -> Vec<f32> {
    let numbers = 0..LATENT * LATENT;
    let one: Vec<f32> = numbers.map(|i| f32::from(i % (LATENT + 1) == 0)).collect();
    one.repeat(count)
}

/// Means and the one-step variance after each control.
pub fn rollout(mean: &[f32], controls: &[[f32; 2]]) -> Rolled {
    let mut z = mean.to_vec();
    let mut gaussians = GaussianTrace {
        latent: LATENT,
        ..GaussianTrace::default()
    };
    for control in controls {
        push(&mut z, Some(control));
        gaussians.mean.extend(&z);
        gaussians.log_var.extend([STEP_VARIANCE.ln(); LATENT]);
    }
    Rolled {
        gaussians,
        transitions: identities(controls.len()),
    }
}

/// A path for each `(h + 1, Z)` of the noise: `(S, h, Z)`.
pub fn samples(mean: &[f32], log_var: &[f32], controls: &[[f32; 2]], noise: &[f32]) -> Vec<f32> {
    let mut paths = Vec::new();
    for noise in noise.chunks_exact((controls.len() + 1) * LATENT) {
        let (first, steps) = noise.split_at(LATENT);
        let drawn = mean.iter().zip(log_var).zip(first);
        let mut z: Vec<f32> = drawn
            .map(|((mean, log_var), noise)| mean + (log_var * 0.5).exp() * noise)
            .collect();
        for (control, noise) in controls.iter().zip(steps.chunks_exact(LATENT)) {
            push(&mut z, Some(control));
            for (z, noise) in z.iter_mut().zip(noise) {
                *z += STEP_VARIANCE.sqrt() * noise;
            }
            paths.extend(&z);
        }
    }
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_spread_as_the_propagated_variance_and_without_noise_not_at_all() {
        let (mean, log_var) = ([0.4, 0.5, 0.3, -0.2], [-7.0_f32, -6.0, -5.0, -4.0]);
        let controls = [[0.03, 0.01], [-0.02, 0.02], [0.0, 0.01]];
        let rolled = rollout(&mean, &controls);
        let still = samples(&mean, &log_var, &controls, &[0.0; 2 * 4 * LATENT]);
        assert_eq!(still, rolled.gaussians.mean.repeat(2));
        // Plus and minus one in one place at a time: the sum of squares is the variance there.
        let mut noise = vec![0.0; 16 * 4 * LATENT];
        for (i, path) in noise.chunks_exact_mut(4 * LATENT).enumerate() {
            path[i] = 1.0;
        }
        let paths = samples(&mean, &log_var, &controls, &noise);
        for (step, d) in (0..3).flat_map(|step| (0..LATENT).map(move |d| (step, d))) {
            let at = step * LATENT + d;
            let off = |path: &[f32]| (path[at] - rolled.gaussians.mean[at]).powi(2);
            let spread: f32 = paths.chunks_exact(3 * LATENT).map(off).sum();
            let propagated = log_var[d].exp() + (step + 1) as f32 * STEP_VARIANCE;
            assert!((spread / propagated - 1.0).abs() < 1e-4);
        }
    }
}
