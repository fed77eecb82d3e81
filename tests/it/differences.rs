//! The gradient of the whole loss against central differences, on tiny models: through every network at once, with
//! experts left out, steps overshot and beliefs decoded in part.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use candle_core::{Device, Tensor};
use poescope::data::align;
use poescope::episode::Episode;
use poescope::model::Model;
use poescope::model::config::{Config, Init, Preset};
use poescope::model::kernel::adam;
use poescope::sim::{Params, simulate};
use poescope::train::batch::{Batch, Draws};
use poescope::train::schedule::{Phase, Stage};
use poescope::train::step;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The loss, of a size of 10 to 100, is moved by about this much: far enough to be seen in f32, near enough for a line.
const MOVE: f64 = 0.03;
/// How far a difference may lie from the gradient's claim, in gradient norms: about the norm is what a random
/// direction gives.
const TOLERANCE: f64 = 3e-3;

/// A model of all the paper's parts and the smallest of sizes; 2 episodes of 4 beliefs of it.
fn tiny(name: &str, change: impl FnOnce(&mut Config)) -> (Model, Batch) {
    let mut config = Config::preset(name, Preset::Released).unwrap();
    (config.latent, config.hidden, config.mixtures) = (4, 8, 3);
    config.window = 6;
    config.training.init = Init::Scaled;
    // Terms of a size: a large one would drown what the others add in its rounding.
    let weight = |stream: usize| [0.02, 0.3, 0.2][stream];
    config.training.error_weights = (0..config.streams().len()).map(weight).collect();
    change(&mut config);
    config.validate().unwrap();
    let params = Params {
        steps: 4 + config.frame_stack,
        window: config.window,
        rate_hz: 108.0,
        planar: true,
        ..Params::default()
    };
    let episodes: Vec<Episode> = (0..2)
        .map(|index| align(&simulate(&params, 5, index), config.layout()).unwrap())
        .collect();
    let draws = Draws {
        seed: 4,
        update: 0,
        segment: None,
    };
    let batch = Batch::new(&config, &episodes.iter().collect::<Vec<_>>(), Some(draws)).unwrap();
    (Model::new(config, 1, &Device::Cpu).unwrap(), batch)
}

/// Holds each network's gradient against the loss at either side of its parameters along a random direction.
fn check(model: &Model, batch: &Batch, n_step: usize) {
    let phase = Phase {
        rate: 1e-3,
        n_step,
        kl_weight: 0.7,
        stage: Stage::All,
        segment: None,
    };
    let terms = || step::loss(model, batch, &phase, true).unwrap();
    let gradients = terms().total.backward().unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(n_step as u64);
    for network in model.networks() {
        let theta = network.theta();
        let gradient = gradients.get(theta).unwrap();
        let norm = f64::from(adam::norm(gradient).unwrap());
        let sign = |_| if rng.random() { 1.0_f32 } else { -1.0 };
        let signs: Vec<f32> = (0..theta.elem_count()).map(sign).collect();
        let direction = Tensor::from_vec(signs, theta.shape(), &Device::Cpu).unwrap();
        let claimed = (gradient * &direction).unwrap().sum_all().unwrap();
        let claimed = f64::from(claimed.to_scalar::<f32>().unwrap());
        let start = theta.as_tensor().copy().unwrap();
        let loss_at = |by: f64| {
            let moved = (&start + direction.affine(by, 0.0).unwrap()).unwrap();
            theta.set(&moved).unwrap();
            f64::from(terms().losses.loss)
        };
        let by = (MOVE / norm).min(5e-4);
        let difference = (loss_at(by) - loss_at(-by)) / (2.0 * by);
        theta.set(&start).unwrap();
        let name = &network.name;
        assert!(
            (claimed - difference).abs() < TOLERANCE * norm,
            "{name}, {n_step} steps: the gradient, of norm {norm}, says {claimed}, the loss {difference}"
        );
    }
}

#[test]
fn with_every_expert_the_gradient_is_that_of_the_loss() {
    let (model, batch) = tiny("v-h-p", |config| config.training.masks = false);
    assert!(batch.sensed.iter().all(Option::is_none));
    check(&model, &batch, 1);
}

#[test]
fn with_experts_left_out_the_gradient_is_that_of_the_loss() {
    let (model, batch) = tiny("v-h-p", |config| config.training.masks = true);
    assert!(batch.sensed.iter().any(Option::is_some));
    check(&model, &batch, 3);
}

#[test]
fn where_rollouts_are_decoded_in_part_the_gradient_is_that_of_the_loss() {
    let (model, batch) = tiny("vhp", |config| {
        config.training.rollouts = 1.0;
        config.training.decoded = 2;
    });
    assert!(batch.sensed.iter().all(Option::is_some));
    assert_eq!(batch.decoded.as_ref().map(Vec::len), Some(4));
    check(&model, &batch, 2);
}

#[test]
fn without_prior_expert_the_gradient_is_that_of_the_loss() {
    for name in ["vhp", "vhp-c"] {
        let (model, batch) = tiny(name, |config| config.prior_expert = false);
        check(&model, &batch, 2);
    }
}
