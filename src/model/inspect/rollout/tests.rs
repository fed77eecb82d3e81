#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use candle_core::{Device, Tensor};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::*;
use crate::model::config::Config;
use crate::model::trace::{Alphas, ExpertTrace};

const LATENT: usize = 4;
const BELIEFS: usize = 6;

fn numbers(n: usize, seed: f32) -> Vec<f32> {
    let number = |i| ((i as f32 + seed) * 12.9898).sin();
    (0..n).map(number).collect()
}

fn gaussians(seed: f32) -> GaussianTrace {
    GaussianTrace {
        latent: LATENT,
        mean: numbers(BELIEFS * LATENT, seed),
        log_var: numbers(BELIEFS * LATENT, seed + 0.5),
    }
}

fn inspector(mixtures: usize) -> Inspector {
    let mut config = Config::named("v").unwrap();
    (config.latent, config.hidden, config.mixtures) = (LATENT, 16, mixtures);
    Inspector::new(Model::new(config, 3, &Device::Cpu).unwrap()).unwrap()
}

/// One map and a variance that no state moves: linear and Gaussian.
fn linear() -> Inspector {
    let made = inspector(1);
    let network = &made.model.dynamics.network;
    let given = network.tensors().unwrap();
    let numbers = |name: &str, own: Vec<f32>| match name {
        "fc_logvar.weight_g" => vec![0.0; own.len()],
        "fc_logvar.bias" => vec![-3.0, -2.5, -2.0, -3.5],
        "A" => numbers(own.len(), 7.0)
            .iter()
            .enumerate()
            .map(|(i, a)| 0.3 * a + 0.9 * f32::from(i % (LATENT + 1) == 0))
            .collect(),
        _ => own,
    };
    let mut own = given.iter();
    network
        .fill(|slot| {
            let (_, own) = own.next().unwrap();
            Ok(numbers(&slot.name, own.flatten_all()?.to_vec1()?))
        })
        .unwrap();
    Inspector::new(made.model).unwrap()
}

fn controls() -> Vec<[f32; 2]> {
    numbers(2 * (BELIEFS - 1), 4.0).as_chunks().0.to_vec()
}

fn beliefs(inspector: &Inspector) -> BeliefTrace {
    let experts = ExpertTrace {
        experts: vec![gaussians(1.0)],
        controls: controls(),
    };
    let alphas = Alphas::trained(BELIEFS, 2);
    inspector.filter(&experts, &alphas).unwrap()
}

fn noise(samples: usize, steps: usize) -> Vec<f32> {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut draw = || rng.sample(StandardNormal);
    (0..samples * (steps + 1) * LATENT)
        .map(|_| draw())
        .collect()
}

#[test]
fn transitions_are_the_mixed_matrices_of_the_states() {
    let inspector = inspector(15);
    let beliefs = beliefs(&inspector);
    let ours = inspector.transitions(&beliefs).unwrap();
    let states = Tensor::from_slice(&beliefs.hidden, (BELIEFS, 16), &Device::Cpu).unwrap();
    let dynamics = &inspector.weights.dynamics;
    let both = inspector.model.dynamics.matrices(&states, dynamics);
    let theirs = both.unwrap().narrow(2, 0, LATENT).unwrap();
    let theirs: Vec<f32> = theirs.flatten_all().unwrap().to_vec1().unwrap();
    let each = LATENT * LATENT;
    assert_eq!(ours.len(), BELIEFS * each);
    for (ours, theirs) in ours.iter().zip(&theirs).skip(each) {
        assert!((ours - theirs).abs() < 1e-6, "{ours} {theirs}");
    }
    let first = DMatrix::from_row_slice(LATENT, LATENT, &ours[..each]);
    assert_eq!(first, DMatrix::identity(LATENT, LATENT));
}

#[test]
fn a_rollouts_first_step_is_the_filters() {
    let inspector = inspector(15);
    let (beliefs, controls) = (beliefs(&inspector), controls());
    let led = inspector.transitions(&beliefs).unwrap();
    for from in 0..BELIEFS - 1 {
        let rolled = inspector
            .rollout(&beliefs, from, &controls[from..])
            .unwrap();
        assert_eq!(rolled.gaussians.len(), BELIEFS - 1 - from);
        assert_eq!(rolled.gaussians.row(0), beliefs.prior.row(from + 1));
        let each = LATENT * LATENT;
        assert_eq!(rolled.transitions[..each], led[(from + 1) * each..][..each]);
    }
    assert!(
        inspector
            .rollout(&beliefs, 5, &[])
            .unwrap()
            .gaussians
            .is_empty()
    );
}

#[test]
fn with_one_map_a_transition_is_the_derivative_of_the_mean_path() {
    let inspector = linear();
    let (mut beliefs, controls) = (beliefs(&inspector), controls());
    let after = |beliefs: &BeliefTrace| inspector.rollout(beliefs, 2, &controls[2..4]).unwrap();
    let rolled = after(&beliefs);
    let [first, second] = [0, 1].map(|step| {
        let each = LATENT * LATENT;
        DMatrix::from_row_slice(LATENT, LATENT, &rolled.transitions[step * each..][..each])
    });
    for d in 0..LATENT {
        let was = std::mem::replace(&mut beliefs.posterior.mean[2 * LATENT + d], 0.0);
        let before = after(&beliefs).gaussians;
        beliefs.posterior.mean[2 * LATENT + d] = 1.0;
        let moved = after(&beliefs).gaussians;
        beliefs.posterior.mean[2 * LATENT + d] = was;
        for (step, a) in [first.clone(), &second * &first].iter().enumerate() {
            for r in 0..LATENT {
                let slope = moved.row(step).0[r] - before.row(step).0[r];
                assert!((slope - a[(r, d)]).abs() < 1e-5, "{slope} {a}");
            }
        }
    }
}

#[test]
fn without_noise_a_sample_is_the_mean_path_and_others_leave_no_trace_in_one() {
    let inspector = inspector(15);
    let (beliefs, controls) = (beliefs(&inspector), controls());
    let known = &controls[1..];
    let each = (known.len() + 1) * LATENT;
    let sample = |noise: &[f32]| inspector.sample(&beliefs, 1, known, noise).unwrap();
    let rolled = inspector.rollout(&beliefs, 1, known).unwrap();
    assert_eq!(
        sample(&vec![0.0; 9 * each]),
        rolled.gaussians.mean.repeat(9)
    );
    let noise = noise(17, known.len());
    let together = sample(&noise);
    for (i, alone) in together.chunks_exact(known.len() * LATENT).enumerate() {
        assert_eq!(alone, sample(&noise[i * each..(i + 1) * each]));
    }
    assert_ne!(together[..each - LATENT], rolled.gaussians.mean[..]);
    assert!(sample(&[]).is_empty());
}

#[test]
fn with_one_map_the_spread_of_samples_is_the_propagated_one() {
    const SAMPLES: usize = 20_000;
    let inspector = linear();
    let (beliefs, controls) = (beliefs(&inspector), controls());
    let known = &controls[1..];
    let rolled = inspector.rollout(&beliefs, 1, known).unwrap();
    let draws = noise(SAMPLES, known.len());
    let sampled = inspector.sample(&beliefs, 1, known, &draws).unwrap();
    let diagonal = |log_var: &[f32]| {
        let variances = log_var.iter().map(|v| f64::from(v.exp()));
        DMatrix::from_diagonal(&nalgebra::DVector::from_iterator(LATENT, variances))
    };
    let mut propagated = diagonal(beliefs.posterior.row(1).1);
    for step in 0..known.len() {
        let a = &rolled.transitions[step * LATENT * LATENT..][..LATENT * LATENT];
        let a = DMatrix::from_row_slice(LATENT, LATENT, a).map(f64::from);
        let (mean, log_var) = rolled.gaussians.row(step);
        let head = diagonal(log_var);
        propagated = &a * propagated * a.transpose() + &head;
        let mut spread = DMatrix::<f64>::zeros(LATENT, LATENT);
        for path in sampled.chunks_exact(known.len() * LATENT) {
            let z = &path[step * LATENT..][..LATENT];
            let off = z.iter().zip(mean).map(|(z, m)| f64::from(z - m));
            let off = nalgebra::DVector::from_iterator(LATENT, off);
            spread += &off * off.transpose();
        }
        spread /= SAMPLES as f64;
        let apart = (&spread - &propagated).norm() / propagated.norm();
        assert!(apart < 0.03, "step {step}: {apart}");
        // The head's own variance does not carry what was there before.
        assert!(head.trace() < 0.7 * propagated.trace());
    }
}

#[test]
fn what_cannot_be_gone_on_from_is_told() {
    let inspector = inspector(2);
    let beliefs = beliefs(&inspector);
    let known = controls();
    let told = |error: candle_core::Error| error.to_string();
    let past = told(inspector.rollout(&beliefs, BELIEFS, &known).unwrap_err());
    assert!(past.contains("no belief 6 of 6"), "{past}");
    assert!(inspector.sample(&beliefs, 0, &known, &[0.0; 5]).is_err());
    let mut torn = beliefs;
    torn.hidden.pop();
    assert!(inspector.transitions(&torn).is_err());
    assert!(inspector.rollout(&torn, 5, &known).is_err());
}
