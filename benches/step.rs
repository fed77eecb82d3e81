//! A training step as the training runs it: 32 episodes of 15 beliefs of `vhp`, forward, backward, clip and Adam; then
//! the same layer by layer. `--json` prints the step's time alone.

mod common;
mod layers;

use std::collections::BTreeMap;

use candle_core::{DType, Device, Tensor};
use poescope::model::Model;
use poescope::model::config::Config;
use poescope::model::encoder::Encoder;
use poescope::model::kernel::memory::keep_pages;
use poescope::train::batch::Batch;
use poescope::train::schedule::Phase;
use poescope::train::step;

fn main() {
    keep_pages();
    let model = common::model("vhp");
    let batch = batch(&model, 32, 15);
    let phase = Phase::of(&model.config.training, 0, 1, 0.0);
    let mut moments = BTreeMap::new();
    let runs = 15;
    let secs = common::median_secs(3, runs, || {
        let gradients = step::gradients(&model, &batch, &phase).expect("gradients");
        let applied = gradients.apply(&model, &mut moments, &phase);
        applied.expect("an update");
    });
    let what = "vhp, 32 episodes of 15 beliefs: forward, backward, clip, Adam";
    common::report("step", secs, runs, what);
    if !common::json_wanted() {
        layers::table(&model, &batch, secs);
    }
}

/// A batch that no dataset is needed for: frames in [0, 1], windows and controls in [-1, 1], every expert on.
fn batch(model: &Model, episodes: usize, beliefs: usize) -> Batch {
    let config = &model.config;
    let tensor = |shape: &[usize], seed: u64| {
        Tensor::from_vec(
            common::numbers(shape.iter().product(), seed),
            shape,
            &Device::Cpu,
        )
        .expect("a tensor")
    };
    let rows = episodes * beliefs;
    let seen = |(i, encoder): (usize, &Encoder)| {
        let x = tensor(&[rows, encoder.inputs(0)], i as u64);
        if i == 0 {
            x.affine(0.5, 0.5).expect("a tensor")
        } else {
            x
        }
    };
    let shape = (episodes, beliefs, config.switches());
    Batch {
        episodes,
        beliefs,
        seen: model.encoders.iter().enumerate().map(seen).collect(),
        controls: tensor(&[episodes, beliefs - 1, Config::CONTROL], 10),
        alphas: Tensor::ones(shape, DType::F32, &Device::Cpu).expect("a tensor"),
        sensed: vec![None; model.encoders.len()],
        decoded: None,
        noise: tensor(&[episodes, beliefs, config.latent], 11),
    }
}
