//! The laws of fusion, over drawn Gaussians: of the product of experts, of the filter built on it, and of the KL.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::sync::OnceLock;

use candle_core::{Device, Tensor};
use poescope::model::Model;
use poescope::model::config::Config;
use poescope::model::experts::Evidence;
use poescope::model::filter::{Filtered, Inputs, filter};
use poescope::model::gaussian::DiagGaussian;
use proptest::collection::vec;
use proptest::prelude::*;

/// Z.
const LATENT: usize = 3;
/// T, where time goes by.
const STEPS: usize = 4;

/// Means and log-variances of one Gaussian over the latent.
type Numbers = [(f32, f32); LATENT];

fn numbers() -> impl Strategy<Value = Numbers> {
    std::array::from_fn::<_, LATENT, _>(|_| (-4.0_f32..4.0, -4.0_f32..3.0))
}

/// Experts with their α.
fn experts() -> impl Strategy<Value = Vec<(Numbers, f32)>> {
    vec((numbers(), 0.1_f32..2.0), 1..5)
}

/// `rows` of numbers as a Gaussian `(1, rows, Z)`.
fn gaussian(rows: &[Numbers]) -> DiagGaussian {
    let tensor = |of: fn(&(f32, f32)) -> f32| {
        let numbers: Vec<f32> = rows.iter().flatten().map(of).collect();
        Tensor::from_vec(numbers, (1, rows.len(), LATENT), &Device::Cpu).unwrap()
    };
    DiagGaussian {
        mean: tensor(|each| each.0),
        log_var: tensor(|each| each.1),
    }
}

fn alpha(value: f32) -> Tensor {
    Tensor::full(value, (1, 1, 1), &Device::Cpu).unwrap()
}

fn evidence(experts: &[(Numbers, f32)]) -> Evidence {
    let gaussians: Vec<_> = experts.iter().map(|(each, _)| gaussian(&[*each])).collect();
    let alphas: Vec<_> = experts.iter().map(|(_, value)| alpha(*value)).collect();
    Evidence::of(&gaussians, &alphas).unwrap().unwrap()
}

fn flat(x: &Tensor) -> Vec<f32> {
    x.flatten_all().unwrap().to_vec1().unwrap()
}

/// Mean and log-variance of each latent of the product.
fn product(experts: &[(Numbers, f32)]) -> Vec<(f32, f32)> {
    both(&evidence(experts).belief().unwrap())
}

fn both(belief: &DiagGaussian) -> Vec<(f32, f32)> {
    let numbers = flat(&belief.mean).into_iter();
    numbers.zip(flat(&belief.log_var)).collect()
}

fn near(a: &[(f32, f32)], b: &[(f32, f32)]) -> bool {
    let close = |a: f32, b: f32| (a - b).abs() < 2e-5;
    let each = a.iter().zip(b);
    a.len() == b.len() && each.fold(true, |ok, (a, b)| ok && close(a.0, b.0) && close(a.1, b.1))
}

fn bits(x: &Tensor) -> Vec<u32> {
    flat(x).into_iter().map(f32::to_bits).collect()
}

/// Beliefs of a small model's dynamics under `experts`, `STEPS` rows each, whose α are `on`; the prior's is 1.
fn filtered(experts: &[Vec<Numbers>], on: &[f32], controls: &[f32]) -> Filtered {
    static MODEL: OnceLock<Model> = OnceLock::new();
    let model = MODEL.get_or_init(|| {
        let mut config = Config::named("v").unwrap();
        (config.latent, config.hidden, config.mixtures) = (LATENT, 8, 3);
        Model::new(config, 3, &Device::Cpu).unwrap()
    });
    let experts: Vec<_> = experts.iter().map(|rows| gaussian(rows)).collect();
    let row = [on, &[1.0]].concat();
    let alphas = Tensor::from_vec(row.repeat(STEPS), (1, STEPS, row.len()), &Device::Cpu).unwrap();
    let inputs = Inputs {
        experts: &experts,
        alphas: &alphas,
        controls: &Tensor::from_slice(controls, (1, STEPS - 1, 2), &Device::Cpu).unwrap(),
        noise: None,
    };
    let weights = model.dynamics.network.folded().unwrap().detach();
    filter(&model.dynamics, &weights, inputs, true).unwrap()
}

/// KL(a ‖ b) of one latent, in nats.
fn kl_of(a: (f32, f32), b: (f32, f32)) -> f64 {
    let [(m, l), (n, k)] = [a, b].map(|(m, l)| (f64::from(m), f64::from(l)));
    0.5 * ((l - k).exp() + (m - n).powi(2) / k.exp() + k - l - 1.0)
}

fn kl(a: &Numbers, b: &Numbers) -> f32 {
    flat(&gaussian(&[*a]).kl(&gaussian(&[*b])).unwrap())[0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_order_of_experts_is_irrelevant(
        (experts, shuffled) in experts().prop_flat_map(|e| (Just(e.clone()), Just(e).prop_shuffle())),
    ) {
        prop_assert!(near(&product(&experts), &product(&shuffled)));
    }

    #[test]
    fn precisions_add_and_weigh_the_means(experts in experts()) {
        for (latent, (mean, log_var)) in product(&experts).into_iter().enumerate() {
            let (mut total, mut weighted) = (0.0, 0.0);
            for (numbers, alpha) in &experts {
                let (mean, log_var) = numbers[latent];
                let precision = f64::from(*alpha) * (-f64::from(log_var)).exp();
                total += precision;
                weighted += precision * f64::from(mean);
            }
            prop_assert!((-f64::from(log_var) - total.ln()).abs() < 1e-5);
            prop_assert!((f64::from(mean) - weighted / total).abs() < 1e-5);
        }
    }

    #[test]
    fn what_is_taken_together_in_parts_is_the_product_of_all(a in experts(), b in experts()) {
        let parts = evidence(&a).and(&evidence(&b)).unwrap().belief().unwrap();
        prop_assert!(near(&both(&parts), &product(&[a, b].concat())));
    }

    #[test]
    fn one_expert_as_trained_is_itself(expert in numbers()) {
        prop_assert!(near(&product(&[(expert, 1.0)]), &expert));
    }

    #[test]
    fn tempering_interpolates(rest in experts(), expert in numbers(), alpha in 0.05_f32..0.95) {
        let with = |alpha| product(&[&rest[..], &[(expert, alpha)]].concat());
        let (off, part, on) = (with(0.0), with(alpha), with(1.0));
        for ((off, part), on) in off.iter().zip(&part).zip(&on) {
            let precision = |belief: &(f32, f32)| (-f64::from(belief.1)).exp();
            let line = precision(off) + f64::from(alpha) * (precision(on) - precision(off));
            prop_assert!((precision(part) / line - 1.0).abs() < 1e-5);
            let (low, high) = (off.0.min(on.0), off.0.max(on.0));
            prop_assert!((low - 1e-5..=high + 1e-5).contains(&part.0));
        }
    }

    #[test]
    fn an_expert_with_alpha_0_is_not_there(
        kept in vec(numbers(), STEPS),
        gone in vec(numbers(), STEPS),
        controls in vec(-1.0_f32..1.0, 2 * (STEPS - 1)),
    ) {
        let without = filtered(std::slice::from_ref(&kept), &[1.0], &controls);
        let off = filtered(&[kept, gone], &[1.0, 0.0], &controls);
        prop_assert_eq!(bits(&off.posterior.mean), bits(&without.posterior.mean));
        prop_assert_eq!(bits(&off.posterior.log_var), bits(&without.posterior.log_var));
    }

    #[test]
    fn no_modality_leaves_the_prior(
        experts in vec(vec(numbers(), STEPS), 1..4),
        controls in vec(-1.0_f32..1.0, 2 * (STEPS - 1)),
    ) {
        let on = filtered(&experts, &vec![1.0; experts.len()], &controls);
        prop_assert!(!near(&both(&on.posterior), &both(&on.prior)));
        let off = filtered(&experts, &vec![0.0; experts.len()], &controls);
        prop_assert!(near(&both(&off.posterior), &both(&off.prior)));
    }

    #[test]
    fn the_kl_is_that_of_the_formula_and_never_negative(a in numbers(), b in numbers()) {
        let expected: f64 = a.into_iter().zip(b).map(|(a, b)| kl_of(a, b)).sum();
        let ours = kl(&a, &b);
        prop_assert!((f64::from(ours) - expected).abs() < 1e-5 * (1.0 + expected));
        prop_assert!(ours > -1e-6);
        prop_assert!(kl(&a, &a).abs() < 1e-6);
        let each = flat(&gaussian(&[a]).kl_per_latent(&gaussian(&[b])).unwrap());
        prop_assert!((each.iter().sum::<f32>() - ours).abs() <= 1e-5 * (1.0 + ours));
    }
}
