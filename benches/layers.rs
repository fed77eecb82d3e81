//! A step layer by layer, each beside the pure matrix products of the same shapes.

use std::collections::BTreeMap;

use candle_core::{CustomOp1 as _, Tensor};
use poescope::model::filter::{self, Inputs};
use poescope::model::gaussian::DiagGaussian;
use poescope::model::kernel::adam;
use poescope::model::kernel::chain::Chain;
use poescope::model::kernel::layer::{Kind, Layer};
use poescope::model::kernel::matmul::{Mat, Write, matmul};
use poescope::model::{Model, elbo};
use poescope::train::batch::Batch;

use super::common::{median_secs, numbers};

/// Two tasks share the samples, as in training.
const TASKS: usize = 2;
/// Runs that a median is taken over.
const RUNS: usize = 9;

/// Seconds of one line of the table.
#[derive(Clone, Copy, Default)]
struct Times {
    gflop: [f64; 2],
    ours: [f64; 2],
    floor: [f64; 2],
}

fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Runs `f` once on each task, each with room of its own.
fn tasks<T: Send>(rooms: &mut [T], f: impl Fn(&mut T) + Sync) {
    rayon::scope(|scope| {
        for room in rooms {
            scope.spawn(|_| f(room));
        }
    });
}

struct Room {
    x: Vec<f32>,
    y: Vec<f32>,
    dy: Vec<f32>,
    dx: Vec<f32>,
    dw: Vec<f32>,
    scratch: Vec<f32>,
}

/// One layer over `samples` a task, `at_once` in work together.
fn layer(layer: &Layer, samples: usize, at_once: usize, input_gradient: bool) -> Times {
    let (k, n) = layer.matrix();
    let layer = Layer {
        offset: 0,
        ..*layer
    };
    let weights = numbers(layer.parameters(), 1);
    let mut rooms: Vec<Room> = (0..TASKS)
        .map(|_| Room {
            x: numbers(samples * layer.inputs(), 2),
            y: vec![0.0; samples * layer.outputs()],
            dy: vec![0.0; at_once * layer.outputs()],
            dx: vec![0.0; at_once * layer.inputs()],
            dw: vec![0.0; layer.parameters()],
            scratch: vec![0.0; at_once * layer.scratch()],
        })
        .collect();
    // Refilled each time: what a backward pass leaves of it would shrink to denormal numbers, which are slow.
    let dy = numbers(at_once * layer.outputs(), 3);
    let starts = || (0..samples).step_by(at_once);
    let forward = median_secs(1, RUNS, || {
        tasks(&mut rooms, |room| {
            for start in starts() {
                let x = &room.x[start * layer.inputs()..][..at_once * layer.inputs()];
                let y = &mut room.y[start * layer.outputs()..][..at_once * layer.outputs()];
                layer.forward(at_once, x, &weights, y, &mut room.scratch);
            }
        });
    });
    let backward = median_secs(1, RUNS, || {
        tasks(&mut rooms, |room| {
            for start in starts() {
                let x = &room.x[start * layer.inputs()..][..at_once * layer.inputs()];
                let y = &room.y[start * layer.outputs()..][..at_once * layer.outputs()];
                let dx = input_gradient.then_some(&mut room.dx[..]);
                let dw = (&mut room.dw[..], Write::Add);
                room.dy.copy_from_slice(&dy);
                layer.backward(
                    at_once,
                    (x, y),
                    &weights,
                    &mut room.dy,
                    dw,
                    dx,
                    &mut room.scratch,
                );
            }
        });
    });
    let rows = at_once * layer.rows();
    let product = |back: bool| {
        let mut rooms: Vec<_> = (0..TASKS)
            .map(|_| {
                (
                    numbers(rows * k, 1),
                    numbers(rows * n, 2),
                    vec![0.0; rows * k.max(n)],
                    vec![0.0; k * n],
                )
            })
            .collect();
        median_secs(1, RUNS, || {
            tasks(&mut rooms, |(x, y, out, dw)| {
                for _ in starts() {
                    if back {
                        matmul(
                            (k, n, rows),
                            Mat::transposed(x, k),
                            Mat::rows(y, n),
                            dw,
                            Write::Add,
                        );
                        if input_gradient {
                            let across = Mat::transposed(&weights, n);
                            matmul((rows, k, n), Mat::rows(y, n), across, out, Write::Replace);
                        }
                    } else {
                        matmul(
                            (rows, n, k),
                            Mat::rows(x, k),
                            Mat::rows(&weights, n),
                            out,
                            Write::Replace,
                        );
                    }
                }
            });
        })
    };
    let gflop = 2e-9 * (TASKS * samples * layer.rows() * k * n) as f64;
    Times {
        gflop: [gflop, gflop * if input_gradient { 2.0 } else { 1.0 }],
        ours: [forward, backward],
        floor: [product(false), product(true)],
    }
}

fn name(layer: &Layer) -> String {
    match layer.kind {
        Kind::Dense { inputs, outputs } => format!("dense {inputs} to {outputs}"),
        Kind::Convolution { windows, outputs } => {
            format!("convolution {} to {outputs}", windows.channels)
        }
        Kind::Transposed { inputs, windows } => {
            format!("transposed {inputs} to {}", windows.channels)
        }
    }
}

#[expect(clippy::print_stdout, reason = "a bench speaks to its user")]
fn line(name: &str, times: Times) {
    let [forward, backward] = times.ours.map(|secs| secs * 1e3);
    let [f, b] = times.floor.map(|secs| secs * 1e3);
    println!(
        "{name:<32} {:>6.2} {:>6.2}  {forward:>7.2} {backward:>7.2}  {f:>7.2} {b:>7.2}  {:>5.2}",
        times.gflop[0],
        times.gflop[1],
        (forward + backward) / (f + b),
    );
}

#[expect(clippy::print_stdout, reason = "a bench speaks to its user")]
fn part(name: &str, secs: f64) {
    println!("{name:<32} {:>31.2} ms", secs * 1e3);
}

fn chain(title: &str, chain: &Chain, samples: usize, encoder: bool, total: &mut Times) {
    for (i, one) in chain.layers().iter().enumerate() {
        let times = layer(
            one,
            samples,
            chain.at_once(i, samples),
            !(encoder && i == 0),
        );
        line(&format!("{title} {}", name(one)), times);
        *total = Times {
            gflop: add(total.gflop, times.gflop),
            ours: add(total.ours, times.ours),
            floor: add(total.floor, times.floor),
        };
    }
}

/// Filter with its KL terms, forward and backward.
fn recurrence(model: &Model, batch: &Batch) -> f64 {
    let weights = model.dynamics.network.folded().expect("weights");
    let latent = model.config.latent;
    let stated = |seed| {
        let shape = (batch.episodes, batch.beliefs, latent);
        let values = numbers(batch.episodes * batch.beliefs * latent, seed);
        let tensor = Tensor::from_vec(values, shape, &candle_core::Device::Cpu);
        candle_core::Var::from_tensor(&tensor.expect("a tensor")).expect("a variable")
    };
    let vars: Vec<_> = (0..2 * model.encoders.len() as u64).map(stated).collect();
    let experts: Vec<_> = vars
        .chunks_exact(2)
        .map(|pair| DiagGaussian {
            mean: pair[0].as_tensor().clone(),
            log_var: pair[1].as_tensor().clone(),
        })
        .collect();
    let inputs = Inputs {
        experts: &experts,
        alphas: &batch.alphas,
        controls: &batch.controls,
        noise: Some(&batch.noise),
    };
    let dynamics = &model.dynamics;
    median_secs(1, RUNS, || {
        let filtered = filter::filter(dynamics, &weights, inputs, true).expect("beliefs");
        let mut kl = elbo::kl(&filtered, 0.5)
            .expect("a KL")
            .mean_all()
            .expect("a mean");
        let more = elbo::overshooting(dynamics, &weights, &filtered, &batch.controls, 2, 0.5);
        for term in more.expect("terms") {
            kl = (kl + term.mean_all().expect("a mean")).expect("a sum");
        }
        kl.backward().expect("gradients");
    })
}

/// Prints the table for a step of `step` seconds.
#[expect(clippy::print_stdout, reason = "a bench speaks to its user")]
pub fn table(model: &Model, batch: &Batch, step: f64) {
    println!(
        "\n{:<32} {:>13}  {:>15}  {:>15}  ratio",
        "", "GFLOP fwd bwd", "ms fwd bwd", "products alone"
    );
    let samples = batch.episodes * batch.beliefs / TASKS;
    let mut total = Times::default();
    for (encoder, expert) in model.encoders.iter().zip(&model.config.experts) {
        let title = format!("{} encoder:", expert.name());
        for one in encoder.chains() {
            chain(&title, one, samples, true, &mut total);
        }
    }
    for (decoder, expert) in model.decoders.iter().zip(&model.config.experts) {
        let title = format!("{} decoder:", expert.name());
        chain(&title, decoder.chain(), samples, false, &mut total);
    }
    line("all layers", total);
    let filter = recurrence(model, batch);
    part("filter, KL terms, and back", filter);
    let (mut norm, mut update) = (0.0, 0.0);
    let mut moments = BTreeMap::<_, adam::Moments>::new();
    for network in model.networks() {
        let folded = network.folded().expect("weights");
        let theta = network.theta().as_tensor();
        norm += median_secs(1, RUNS, || {
            network.folded().expect("weights");
            network
                .norm()
                .bwd(theta, &folded, &folded)
                .expect("a gradient");
        });
        let moments = moments.entry(network.name.clone()).or_default();
        // At rate 0 nothing moves.
        let gradient = theta.affine(0.5, 0.0).expect("a gradient");
        update += median_secs(1, RUNS, || {
            let norm = adam::norm(&gradient).expect("a norm");
            adam::update(theta, &gradient, norm, moments, 0.0, 0.5).expect("an update");
        });
    }
    part("weight norm and back", norm);
    part("clip and Adam", update);
    let sum = total.ours.iter().sum::<f64>() + filter + norm + update;
    part("sum of the above", sum);
    part("a step", step);
    let floor: f64 = total.floor.iter().sum();
    println!(
        "a step is {:.2} of the products alone ({:.1} ms)",
        step / floor,
        floor * 1e3
    );
}
