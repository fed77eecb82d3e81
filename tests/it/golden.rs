//! The authors' PyTorch numbers: `tests/data/reference_vhp.json` was computed by their published networks in float64,
//! with weights and inputs given by an integer formula and every sampled z replaced by its mean. Tolerances are those of
//! its own notes: 2e-5 for Gaussians and decoded values, 1e-5 relative for errors, 1e-3 relative for gradient norms.

use std::collections::HashMap;
use std::sync::OnceLock;

use candle_core::{DType, Device, Tensor};
use poescope::episode::{HAPTIC_CHANNELS, PROPRIO_CHANNELS};
use poescope::model::config::{Config, Preset};
use poescope::model::encoder::Encoder;
use poescope::model::filter::{self, Filtered, Inputs};
use poescope::model::gaussian::DiagGaussian;
use poescope::model::kernel::adam::{self, Moments};
use poescope::model::network::Network;
use poescope::model::{Model, Weights, elbo};
use serde_json::Value;

const BATCH: usize = 2;
const RECORDED: usize = 16;
const STEPS: usize = 15;
const LATENT: usize = 16;

fn reference() -> &'static Value {
    static REFERENCE: OnceLock<Value> = OnceLock::new();
    REFERENCE.get_or_init(|| {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/reference_vhp.json");
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
    })
}

/// All numbers below `value`, in order.
fn flat(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(flat).collect(),
        other => vec![other.as_f64().unwrap()],
    }
}

fn splitmix64(x: u64) -> u64 {
    let mut x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// The formula's number in [-1, 1) for element `i` of tensor `t`.
fn h(t: u64, i: usize) -> f64 {
    let bits = splitmix64((t << 32).wrapping_add(i as u64)) >> 40;
    (bits as f64 - 8_388_608.0) / 8_388_608.0
}

fn gain(network: &str, name: &str) -> f64 {
    match (network, name) {
        ("img_dec", "layers.6.weight_g") => 0.75,
        ("context_dec", "layers.6.weight_g") => 0.5,
        ("img_dec", _) => 2.0,
        ("context_dec", _) => 1.0,
        ("dyn", "linear.weight_g") => 4.0,
        ("dyn", "fc_logvar.weight_g") => 3.0,
        _ => 1.5,
    }
}

fn number(network: &str, name: &str, t: u64, i: usize) -> f64 {
    let h = h(t, i);
    match name {
        "A" => 0.15 * h + if i / 16 % 16 == i % 16 { 0.8 } else { 0.0 },
        "B" => 0.5 * h,
        "rnn.weight_ih_l0" => 2.0 * h / 18_f64.sqrt(),
        "rnn.weight_hh_l0" => 2.0 * h / 256_f64.sqrt(),
        _ if name.contains("bias") => 0.25 * h,
        _ if name.ends_with("weight_g") => gain(network, name) * (1.0 + 0.25 * h),
        _ => h,
    }
}

/// The model with the formula's weights.
fn model() -> Model {
    let config = Config::preset("vhp", Preset::Released).unwrap();
    let model = Model::new(config, 0, &Device::Cpu).unwrap();
    let order: HashMap<(String, String), u64> = reference()["tensors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|t| {
            let text = |key: &str| t[key].as_str().unwrap().to_owned();
            ((text("net"), text("name")), t["t"].as_u64().unwrap())
        })
        .collect();
    for network in model.networks() {
        network
            .fill(|slot| {
                let t = order[&(network.name.clone(), slot.name.clone())];
                let count: usize = slot.shape.iter().product();
                Ok((0..count)
                    .map(|i| number(&network.name, &slot.name, t, i) as f32)
                    .collect())
            })
            .unwrap();
    }
    model
}

/// Recorded pixel of trajectory b at time t.
fn pixel(b: usize, t: usize, y: usize, x: usize) -> f32 {
    let (cx, cy) = (
        18.0 + 2.0 * t as f64 + 6.0 * b as f64,
        44.0 - t as f64 - 9.0 * b as f64,
    );
    let squared = (x as f64 - cx).powi(2) + (y as f64 - cy).powi(2);
    (0.1 + 0.8 * 36.0 / (36.0 + squared) + 0.1 * ((3 * x + 5 * y + t) % 8) as f64 / 8.0) as f32
}

/// What the two experts see, `(30, …)`, and the controls between beliefs, `(2, 14, 2)`.
fn observations() -> (Vec<Tensor>, Tensor) {
    assert_eq!((HAPTIC_CHANNELS.len(), PROPRIO_CHANNELS.len()), (6, 6));
    let (mut images, mut windows, mut controls) = (Vec::new(), Vec::new(), Vec::new());
    for b in 0..BATCH {
        for i in 0..STEPS {
            for y in 0..64 {
                for x in 0..64 {
                    images.extend([pixel(b, i + 1, y, x), pixel(b, i, y, x)]);
                }
            }
            let t = i + 1;
            for f in 0..32 {
                for d in 0..6 {
                    windows.push((0.5 * h(1000, ((b * RECORDED + t) * 32 + f) * 6 + d)) as f32);
                }
                for d in 0..6 {
                    let noise = 0.1 * h(1001, ((b * RECORDED + t) * 32 + f) * 6 + d);
                    let trend = (f as f64 / 31.0 - 0.5) + 0.05 * t as f64;
                    windows.push((trend * (1.0 - 0.25 * d as f64) + noise) as f32);
                }
            }
        }
        for i in 1..STEPS {
            controls.extend((0..2).map(|d| (0.5 * h(1002, (b * RECORDED + i + 1) * 2 + d)) as f32));
        }
    }
    let n = BATCH * STEPS;
    let experts = vec![
        Tensor::from_vec(images, (n, 64 * 64 * 2), &Device::Cpu).unwrap(),
        Tensor::from_vec(windows, (n, 32 * 12), &Device::Cpu).unwrap(),
    ];
    (
        experts,
        Tensor::from_vec(controls, (BATCH, STEPS - 1, 2), &Device::Cpu).unwrap(),
    )
}

fn encode(model: &Model, weights: &Weights, seen: &[Tensor], train: bool) -> Vec<DiagGaussian> {
    let encode = |((encoder, weights), seen): ((&Encoder, &Vec<Tensor>), &Tensor)| {
        let said = encoder.encode(std::slice::from_ref(seen), weights, train);
        said.unwrap().reshape((BATCH, STEPS, LATENT)).unwrap()
    };
    let encoders = model.encoders.iter().zip(&weights.encoders);
    encoders.zip(seen).map(encode).collect()
}

/// α with expert `off` off within `steps`.
fn alphas(off: &[usize], steps: std::ops::Range<usize>) -> Tensor {
    let mut values = vec![1.0_f32; BATCH * STEPS * 3];
    for b in 0..BATCH {
        for t in steps.clone() {
            for &expert in off {
                values[(b * STEPS + t) * 3 + expert] = 0.0;
            }
        }
    }
    Tensor::from_vec(values, (BATCH, STEPS, 3), &Device::Cpu).unwrap()
}

fn run(
    model: &Model,
    weights: &Weights,
    experts: &[DiagGaussian],
    alphas: &Tensor,
    controls: &Tensor,
) -> Filtered {
    let inputs = Inputs {
        experts,
        alphas,
        controls,
        noise: None,
    };
    filter::filter(&model.dynamics, &weights.dynamics, inputs, true).unwrap()
}

#[track_caller]
fn close(what: &str, ours: &Tensor, theirs: &Value, absolute: f64, relative: f64) {
    let ours = ours
        .to_dtype(DType::F64)
        .unwrap()
        .flatten_all()
        .unwrap()
        .to_vec1::<f64>()
        .unwrap();
    close_numbers(what, &ours, &flat(theirs), absolute, relative);
}

#[track_caller]
fn close_numbers(what: &str, ours: &[f64], theirs: &[f64], absolute: f64, relative: f64) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    for (i, (a, b)) in ours.iter().zip(theirs).enumerate() {
        let bound = absolute + relative * b.abs();
        assert!((a - b).abs() <= bound, "{what}[{i}]: ours {a}, theirs {b}");
    }
}

#[test]
fn the_formula_gives_the_references_inputs() {
    let sum: f64 = (0..BATCH * RECORDED * 64 * 64)
        .map(|i| f64::from(pixel(i / 65536, i / 4096 % 16, i / 64 % 64, i % 64)))
        .sum();
    assert!((sum - reference()["inputs"]["img"]["sum"].as_f64().unwrap()).abs() < 1e-2);
}

#[test]
fn encoders_agree() {
    let model = model();
    let weights = model.weights().unwrap().detach();
    let (seen, _) = observations();
    let experts = encode(&model, &weights, &seen, false);
    let theirs = &reference()["encoders"];
    for (expert, name) in experts.iter().zip(["img", "context"]) {
        close(name, &expert.mean, &theirs[format!("{name}_mu")], 2e-5, 0.0);
        close(
            name,
            &expert.log_var,
            &theirs[format!("{name}_logvar")],
            2e-5,
            0.0,
        );
    }
}

#[test]
fn filters_agree_with_all_experts_and_with_some_switched_off() {
    let model = model();
    let weights = model.weights().unwrap().detach();
    let (seen, controls) = observations();
    let experts = encode(&model, &weights, &seen, false);
    let cases: [(&str, &[usize], std::ops::Range<usize>); 6] = [
        ("both", &[], 0..0),
        ("image_only", &[1], 0..STEPS),
        ("context_only", &[0], 0..STEPS),
        ("prior_only", &[0, 1], 0..STEPS),
        ("image_off_5_to_9", &[0], 5..10),
        ("context_off_5_to_9", &[1], 5..10),
    ];
    for (name, off, steps) in cases {
        let theirs = &reference()["cases"][name];
        let ours = run(&model, &weights, &experts, &alphas(off, steps), &controls);
        close(
            name,
            &ours.posterior.mean,
            &theirs["posterior_mu"],
            2e-5,
            0.0,
        );
        close(
            name,
            &ours.posterior.log_var,
            &theirs["posterior_logvar"],
            2e-5,
            0.0,
        );
        close(name, &ours.prior.mean, &theirs["prior_mu"], 2e-5, 0.0);
        close(
            name,
            &ours.prior.log_var,
            &theirs["prior_logvar"],
            2e-5,
            0.0,
        );
        let after = ours
            .hidden
            .narrow(1, 1, STEPS - 1)
            .unwrap()
            .contiguous()
            .unwrap();
        close(
            name,
            &after.narrow(2, 0, 4).unwrap(),
            &theirs["h_first4"],
            2e-5,
            0.0,
        );
        let norm = after.sqr().unwrap().sum(2).unwrap().sqrt().unwrap();
        close(name, &norm, &theirs["h_norm"], 2e-5, 1e-5);
        let flat_hidden = after.flatten(0, 1).unwrap();
        let matrices = model
            .dynamics
            .matrices(&flat_hidden, &weights.dynamics)
            .unwrap();
        let part = |from: usize, len: usize| {
            let part = matrices.narrow(2, from, len).unwrap().contiguous().unwrap();
            part.flatten_from(1).unwrap().narrow(1, 0, 8).unwrap()
        };
        close(name, &part(0, LATENT), &theirs["A_first8"], 2e-5, 0.0);
        close(name, &part(LATENT, 2), &theirs["B_first8"], 2e-5, 0.0);
        let kl = elbo::kl(&ours, 0.5).unwrap().sum(0).unwrap();
        close(name, &kl, &theirs["kl_per_step_batch_sum"], 1e-4, 1e-5);
        let latents = ours.z.flatten(0, 1).unwrap();
        for (index, key) in [(0, "image_sse"), (1, "context_sse")] {
            let decoder = &model.decoders[index];
            let unit = vec![1.0; BATCH * STEPS];
            let (_, errors) = decoder
                .squared_error(
                    &latents,
                    &weights.decoders[index],
                    &seen[index],
                    unit,
                    false,
                )
                .unwrap();
            let errors: Vec<f64> = errors
                .lock()
                .unwrap()
                .iter()
                .map(|&e| f64::from(e))
                .collect();
            close_numbers(key, &errors, &flat(&theirs[key]), 0.0, 1e-5);
        }
        decoded_agree(&model, &weights, &ours.z, &theirs["decoded"], 0);
    }
}

/// Sampled pixels and context values; in the reference flat in (channels, height, width) and (channels, samples).
fn decoded_agree(model: &Model, weights: &Weights, z: &Tensor, theirs: &Value, first_step: usize) {
    let indices = |key: &str| {
        flat(&reference()[key])
            .into_iter()
            .map(|i| i as usize)
            .collect::<Vec<_>>()
    };
    for entry in theirs.as_array().unwrap() {
        let place = |key: &str| entry[key].as_u64().unwrap() as usize;
        let latent = z
            .get(place("trajectory"))
            .unwrap()
            .get(place("step") - first_step)
            .unwrap()
            .unsqueeze(0)
            .unwrap();
        for (index, key, at, theirs) in [
            (0, "image", "pixel_indices", &entry["image"]["values"]),
            (1, "context", "context_indices", &entry["context_values"]),
        ] {
            if theirs.is_null() {
                continue;
            }
            let (places, channels) = [(64 * 64, 2), (32, 12)][index];
            let decoded = model.decoders[index]
                .decode(&latent, &weights.decoders[index])
                .unwrap();
            let decoded = decoded.flatten_all().unwrap().to_vec1::<f32>().unwrap();
            let ours: Vec<f64> = indices(at)
                .into_iter()
                .map(|i| f64::from(decoded[i % places * channels + i / places]))
                .collect();
            close_numbers(key, &ours, &flat(theirs), 2e-5, 0.0);
        }
    }
}

#[test]
fn rollouts_agree() {
    let model = model();
    let weights = model.weights().unwrap().detach();
    let (seen, controls) = observations();
    let experts = encode(&model, &weights, &seen, false);
    let both = run(&model, &weights, &experts, &alphas(&[], 0..0), &controls);
    let row = |x: &Tensor| {
        x.narrow(1, 8, 1)
            .unwrap()
            .squeeze(1)
            .unwrap()
            .contiguous()
            .unwrap()
    };
    let known = controls.narrow(1, 8, 6).unwrap();
    let rolled = filter::rollout(
        &model.dynamics,
        &weights.dynamics,
        &row(&both.hidden),
        &row(&both.z),
        &known,
    )
    .unwrap();
    close("mu", &rolled.mean, &reference()["rollout"]["mu"], 2e-5, 0.0);
    close(
        "logvar",
        &rolled.log_var,
        &reference()["rollout"]["logvar"],
        2e-5,
        0.0,
    );
    decoded_agree(
        &model,
        &weights,
        &rolled.mean,
        &reference()["rollout"]["decoded"],
        9,
    );
}

/// Image error, context error and KL (with overshooting), each divided by its own number of terms.
fn terms(model: &Model, seen: &[Tensor], controls: &Tensor, n_step: usize) -> [Tensor; 3] {
    let weights = model.weights().unwrap();
    let experts = encode(model, &weights, seen, true);
    let ours = run(model, &weights, &experts, &alphas(&[], 0..0), controls);
    let latents = ours.z.flatten(0, 1).unwrap();
    let error = |index: usize| {
        let part = vec![1.0 / (BATCH * STEPS) as f32; BATCH * STEPS];
        model.decoders[index]
            .squared_error(&latents, &weights.decoders[index], &seen[index], part, true)
            .unwrap()
            .0
    };
    let mut kl = elbo::kl(&ours, 0.5).unwrap().mean_all().unwrap();
    for term in elbo::overshooting(
        &model.dynamics,
        &weights.dynamics,
        &ours,
        controls,
        n_step,
        0.5,
    )
    .unwrap()
    {
        kl = (kl + term.mean_all().unwrap()).unwrap();
    }
    [error(0), error(1), kl]
}

#[test]
fn loss_terms_agree_for_one_two_and_three_steps() {
    let model = model();
    let (seen, controls) = observations();
    for n_step in 1..=3 {
        let theirs = &reference()["elbo"][format!("n_step_{n_step}")];
        let ours = terms(&model, &seen, &controls, n_step);
        for (ours, key) in ours.iter().zip(["image_rec", "context_rec", "kl"]) {
            close(key, ours, &theirs[key], 0.0, 1e-5);
        }
    }
}

#[test]
fn gradients_and_five_adam_updates_agree() {
    let model = model();
    let (seen, controls) = observations();
    let mut moments: HashMap<String, Moments> = HashMap::new();
    for (update, theirs) in reference()["adam_5_steps_n_step_2"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let ours = terms(&model, &seen, &controls, 2);
        for (ours, key) in ours.iter().zip(["image_rec", "context_rec", "kl"]) {
            close(key, ours, &theirs[key], 0.0, 1e-4);
        }
        let [image, context, kl] = ours;
        let gradients = ((image + context).unwrap() + kl)
            .unwrap()
            .backward()
            .unwrap();
        for network in model.networks() {
            let gradient = gradients.get(network.theta()).unwrap();
            if update == 0 {
                gradients_agree(network, &gradient.to_vec1::<f32>().unwrap());
            }
            let moments = moments.entry(network.name.clone()).or_default();
            let norm = adam::norm(gradient).unwrap();
            adam::update(network.theta(), gradient, norm, moments, 3e-4, 0.5).unwrap();
        }
    }
}

fn gradients_agree(network: &Network, gradient: &[f32]) {
    let theirs = &reference()["gradients_n_step_2"][&network.name];
    let norm = |x: &[f32]| x.iter().map(|&g| f64::from(g).powi(2)).sum::<f64>().sqrt();
    close_numbers(
        &network.name,
        &[norm(gradient)],
        &[theirs["total_norm"].as_f64().unwrap()],
        0.0,
        1e-3,
    );
    for slot in network.slots() {
        let ours = Network::view(slot, gradient);
        let theirs = &theirs["tensors"][&slot.name];
        let size = theirs["norm"].as_f64().unwrap();
        close_numbers(&slot.name, &[norm(&ours)], &[size], 1e-6, 1e-3);
        let first: Vec<f64> = ours.iter().take(4).map(|&g| f64::from(g)).collect();
        close_numbers(
            &slot.name,
            &first,
            &flat(&theirs["first4"]),
            1e-4 * size,
            1e-3,
        );
    }
}
