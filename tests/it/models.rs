//! Every named model, under every preset, trains, looks and comes back from disk.
#![expect(clippy::unwrap_used, reason = "a failed test should stop")]

use std::collections::BTreeMap;

use candle_core::{DType, Device};
use poescope::data::align;
use poescope::episode::Episode;
use poescope::modality::Modality;
use poescope::model::config::{Config, Preset};
use poescope::model::inspect::Inspector;
use poescope::model::kernel::adam;
use poescope::model::observation::{observe, observe_expert};
use poescope::model::trace::Alphas;
use poescope::model::{Model, checkpoint};
use poescope::sim::{Params, simulate};
use poescope::train::batch::{Batch, Draws};
use poescope::train::schedule::{Phase, Stage};
use poescope::train::totals::Totals;
use poescope::train::{statistics, step};

const STEPS: usize = 6;

fn small(name: &str, preset: Preset) -> Config {
    let mut config = Config::preset(name, preset).unwrap();
    config.window = 10;
    config.hidden = 16;
    config.mixtures = 3;
    config.haptic.names = ["fx", "fy", "tz"].map(str::to_owned).to_vec();
    config
}

fn episodes(config: &Config) -> Vec<Episode> {
    let params = Params {
        steps: STEPS,
        window: 10,
        rate_hz: 180.0,
        planar: true,
        ..Params::default()
    };
    (0..3)
        .map(|index| align(&simulate(&params, 5, index), config.layout()).unwrap())
        .collect()
}

/// A model of `config` and a batch for its first update.
fn first_batch(config: &mut Config) -> (Model, Batch) {
    let episodes = episodes(config);
    let mut totals = Totals::default();
    for episode in &episodes {
        totals.add(episode);
    }
    statistics::complete(config, &totals);
    let model = Model::new(config.clone(), 1, &Device::Cpu).unwrap();
    let draws = Draws {
        seed: 1,
        update: 0,
        segment: None,
    };
    let each: Vec<&Episode> = episodes.iter().collect();
    let batch = Batch::new(config, &each, Some(draws)).unwrap();
    (model, batch)
}

fn phase(config: &Config) -> Phase {
    Phase::of(&config.training, 0, 1, 0.0)
}

fn theta(model: &Model) -> BTreeMap<String, Vec<f32>> {
    let each = model.networks();
    each.map(|n| (n.name.clone(), n.theta().to_vec1().unwrap()))
        .collect()
}

fn update(model: &Model, batch: &Batch, phase: &Phase) {
    let gradients = step::gradients(model, batch, phase).unwrap();
    assert_eq!(gradients.not_finite(), None);
    gradients.apply(model, &mut BTreeMap::new(), phase).unwrap();
}

#[test]
fn every_model_and_preset_trains_every_network() {
    for name in Config::NAMES {
        for preset in Preset::ALL {
            let mut config = small(name, preset);
            let (model, batch) = first_batch(&mut config);
            let before = theta(&model);
            update(&model, &batch, &phase(&config));
            for (network, after) in theta(&model) {
                assert_ne!(before[&network], after, "{name} {preset:?} {network}");
            }
        }
    }
}

#[test]
fn every_model_looks_at_an_episode_and_comes_back_from_disk() {
    for name in Config::NAMES {
        for frame_stack in [0, 1] {
            let mut config = small(name, Preset::Fast);
            config.frame_stack = frame_stack;
            let (model, _) = first_batch(&mut config);
            let folder = tempfile::tempdir().unwrap();
            checkpoint::save(&model, folder.path(), DType::F32, None).unwrap();
            let (read, _) = checkpoint::load(folder.path()).unwrap();
            assert_eq!(read.config, model.config);
            let look = |model: &Model| {
                let inspector = Inspector::new(model).unwrap();
                let episode = &episodes(&config)[0];
                let seen = observe(&config, episode).unwrap();
                assert_eq!(seen.beliefs, STEPS - frame_stack);
                let experts = inspector.encode(&seen).unwrap();
                assert_eq!(experts.experts.len(), config.experts.len());
                let on = Alphas::trained(seen.beliefs, config.switches());
                let beliefs = inspector.filter(&experts, &on).unwrap();
                let known = &experts.controls[1..4];
                let rolled = inspector.rollout(&beliefs, 1, known).unwrap();
                inspector.decode_pixels(&rolled.gaussians.mean).unwrap()
            };
            let pixels = look(&model);
            assert_eq!(pixels.len(), 3 * 64 * 64);
            assert_eq!(pixels, look(&read), "{name}");
        }
    }
}

#[test]
fn an_expert_says_the_same_alone_and_a_damaged_input_changes_its_own_word_only() {
    for name in Config::NAMES {
        let mut config = small(name, Preset::Fast);
        let (model, _) = first_batch(&mut config);
        let inspector = Inspector::new(&model).unwrap();
        let episode = &episodes(&config)[0];
        let all = inspector.encode(&observe(&config, episode).unwrap());
        let all = all.unwrap().experts;
        let alone = |episode: &Episode, index: usize| {
            let seen = observe_expert(&config, episode, index).unwrap();
            inspector.encode_expert(&seen, index).unwrap()
        };
        let mut damaged = episode.clone();
        damaged.haptic.as_mut().unwrap().fill(0.0);
        for (index, expert) in config.experts.iter().enumerate() {
            assert_eq!(alone(episode, index), all[index], "{name} {index}");
            let touched = expert.modalities().contains(&Modality::Haptic);
            let changed = alone(&damaged, index) != all[index];
            assert_eq!(changed, touched, "{name} {index}");
        }
        let none = observe_expert(&config, episode, all.len()).unwrap();
        assert!(inspector.encode_expert(&none, all.len()).is_err());
        let everything = observe(&config, episode).unwrap();
        if everything.streams.len() > 2 {
            assert!(inspector.encode_expert(&everything, 0).is_err());
        }
    }
}

#[test]
fn without_prior_expert_the_belief_is_what_the_sensors_say() {
    let mut config = small("vhp", Preset::Fast);
    config.prior_expert = false;
    let (model, _) = first_batch(&mut config);
    let inspector = Inspector::new(&model).unwrap();
    let seen = observe(&config, &episodes(&config)[0]).unwrap();
    let experts = inspector.encode(&seen).unwrap();
    let (switches, z) = (config.switches(), config.latent);
    let mut alphas = Alphas::trained(seen.beliefs, switches);
    // Vision alone, and from belief 3 on nothing.
    for (belief, row) in alphas.values.chunks_exact_mut(switches).enumerate() {
        row[0] = f32::from(belief < 3);
        row[1] = 0.0;
    }
    let beliefs = inspector.filter(&experts, &alphas).unwrap();
    let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
    let (mean, vision) = (&beliefs.posterior.mean, &experts.experts[0].mean);
    assert!(near(&mean[..3 * z], &vision[..3 * z]));
    assert!(near(&mean[3 * z..], &beliefs.prior.mean[3 * z..]));
    assert!(!near(&mean[3 * z..], &vision[3 * z..]));
}

#[test]
fn the_warm_up_trains_first_no_dynamics_then_their_bases() {
    let mut config = small("vhp", Preset::Released);
    let (model, batch) = first_batch(&mut config);
    let staged = |stage| Phase {
        stage,
        ..phase(&config)
    };
    let at_first = theta(&model);
    update(&model, &batch, &staged(Stage::Autoencoder));
    let second = theta(&model);
    assert_eq!(second["dyn"], at_first["dyn"]);
    assert_ne!(second["img_enc"], at_first["img_enc"]);
    update(&model, &batch, &staged(Stage::Bases));
    let third = theta(&model);
    let mask = model
        .dynamics
        .bases_mask()
        .unwrap()
        .to_vec1::<f32>()
        .unwrap();
    let numbers = third["dyn"].iter().zip(&second["dyn"]).zip(&mask);
    let moved = |bases: bool| {
        numbers
            .clone()
            .filter(|((a, b), mask)| (**mask > 0.5) == bases && a.to_bits() != b.to_bits())
            .count()
    };
    assert_eq!(moved(false), 0);
    assert!(moved(true) > 0);
}

#[test]
fn what_is_decoded_in_parts_adds_up_to_the_whole() {
    let mut config = small("vhp", Preset::Released);
    let (model, mut batch) = first_batch(&mut config);
    let mut losses = |rows: Option<Vec<u32>>| {
        batch.decoded = rows;
        step::loss(&model, &batch, &phase(&config), true)
            .unwrap()
            .losses
    };
    let whole = losses(None);
    let n = 3 * (STEPS as u32 - 1);
    let even = losses(Some((0..n).step_by(2).collect()));
    let odd = losses(Some((1..n).step_by(2).collect()));
    let (evens, odds) = (n.div_ceil(2) as f32, (n / 2) as f32);
    let mean = |of: fn(&step::Losses) -> f32| (of(&even) * evens + of(&odd) * odds) / n as f32;
    for of in [|l: &step::Losses| l.vision, |l: &step::Losses| l.windows] {
        assert!((mean(of) / of(&whole) - 1.0).abs() < 1e-5);
    }
    assert!((even.kl - whole.kl).abs() < 1e-6);
}

#[test]
fn an_expert_that_is_off_need_not_be_encoded() {
    let mut config = small("v-h-p", Preset::Fast);
    config.training.decoded = 0;
    let (model, mut batch) = first_batch(&mut config);
    assert!(
        batch.sensed.iter().any(Option::is_some),
        "masks drew nothing"
    );
    let some = step::loss(&model, &batch, &phase(&config), true).unwrap();
    batch.sensed.fill(None);
    let all = step::loss(&model, &batch, &phase(&config), true).unwrap();
    assert!((some.losses.loss / all.losses.loss - 1.0).abs() < 1e-5);
    let norms = |terms: &step::Terms| {
        let gradients = terms.total.backward().unwrap();
        let norm = |name: &str| {
            let network = model.networks().find(|n| n.name == name).unwrap();
            adam::norm(gradients.get(network.theta()).unwrap()).unwrap()
        };
        ["img_enc", "haptic_enc", "proprio_enc", "dyn"].map(norm)
    };
    for (some, all) in norms(&some).into_iter().zip(norms(&all)) {
        assert!((some / all - 1.0).abs() < 1e-4, "{some} {all}");
    }
}

#[test]
fn the_baseline_has_the_products_budget_within_a_tenth() {
    for preset in Preset::ALL {
        let parameters = |name: &str| {
            let config = Config::preset(name, preset).unwrap();
            Model::new(config, 1, &Device::Cpu).unwrap().parameters() as f64
        };
        let ratio = parameters("vhp-c") / parameters("vhp");
        assert!((0.9..=1.1).contains(&ratio), "{}: {ratio}", preset.name());
    }
}
