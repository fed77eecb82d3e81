//! The kernels against candle's own operations.

use std::sync::Arc;

use candle_core::backprop::GradStore;
use candle_core::{Device, Var};

use super::*;
use crate::model::config::Config;
use crate::model::dynamics::Dynamics;
use crate::model::filter::{self as model_filter, Filtered, Inputs};
use crate::model::gaussian::DiagGaussian;
use crate::model::kernel::apply::Apply;
use crate::model::kernel::cell::Cell;
use crate::model::kernel::squared_error::SquaredError;
use crate::model::network::Parameters;
use crate::model::trace::count_prior;

fn numbers(n: usize, seed: f32) -> Vec<f32> {
    (0..n)
        .map(|i| ((i as f32 + seed) * 12.9898).sin() * 0.5)
        .collect()
}

/// A chain of every kind of layer, small enough for finite differences.
fn small() -> Chain {
    let first = Windows {
        height: 8,
        width: 8,
        channels: 2,
        kernel_height: 4,
        kernel_width: 4,
        stride: 2,
        padding: 0,
    };
    let row = Windows {
        height: 1,
        width: 9,
        channels: 3,
        kernel_height: 1,
        kernel_width: 3,
        stride: 1,
        padding: 1,
    };
    let whole = Windows {
        height: 3,
        width: 3,
        channels: 4,
        kernel_height: 3,
        kernel_width: 3,
        stride: 2,
        padding: 0,
    };
    let up = Windows {
        height: 7,
        width: 7,
        channels: 2,
        kernel_height: 3,
        kernel_width: 3,
        stride: 2,
        padding: 0,
    };
    Chain::new([
        (
            Kind::Convolution {
                windows: first,
                outputs: 3,
            },
            Activation::Elu,
            false,
        ),
        (
            Kind::Convolution {
                windows: row,
                outputs: 5,
            },
            Activation::Elu,
            false,
        ),
        (
            Kind::Dense {
                inputs: 45,
                outputs: 6,
            },
            Activation::Linear,
            true,
        ),
        (
            Kind::Transposed {
                inputs: 6,
                windows: whole,
            },
            Activation::Elu,
            false,
        ),
        (
            Kind::Transposed {
                inputs: 4,
                windows: up,
            },
            Activation::Sigmoid,
            false,
        ),
    ])
}

fn inputs(samples: usize) -> (Arc<Chain>, Tensor, Var) {
    let chain = small();
    let x = Tensor::from_vec(
        numbers(samples * chain.inputs(), 1.0),
        (samples, chain.inputs()),
        &Device::Cpu,
    );
    let w = Var::from_vec(
        numbers(chain.parameters(), 2.0),
        chain.parameters(),
        &Device::Cpu,
    );
    (
        Arc::new(chain),
        x.expect("a tensor"),
        w.expect("a variable"),
    )
}

#[track_caller]
fn close(a: &Tensor, b: &Tensor, bound: f32) {
    let worst = (a - b)
        .and_then(|d| d.abs()?.flatten_all()?.max(0)?.to_scalar::<f32>())
        .expect("same shapes");
    assert!(worst < bound, "apart by {worst}");
}

#[test]
fn kernels_and_candle_agree_forward_and_backward() -> Result<()> {
    let (fast, x, w) = inputs(11);
    let x = Var::from_tensor(&x)?;
    let ours = x.apply_op2(w.as_tensor(), Apply::new(Arc::clone(&fast), true, true))?;
    let theirs = chain(&fast, x.as_tensor(), w.as_tensor())?;
    close(&ours, &theirs, 1e-5);
    let (g, h) = (
        ours.sqr()?.sum_all()?.backward()?,
        theirs.sqr()?.sum_all()?.backward()?,
    );
    for var in [w.as_tensor(), x.as_tensor()] {
        close(
            g.get(var).expect("a gradient"),
            h.get(var).expect("a gradient"),
            1e-3,
        );
    }
    Ok(())
}

#[test]
fn the_cell_agrees_forward_and_backward() -> Result<()> {
    let sizes = Sizes {
        latent: 3,
        inputs: 5,
        hidden: 7,
        mixtures: 4,
    };
    let var = |rows: usize, columns: usize, seed: f32| {
        Var::from_vec(numbers(rows * columns, seed), (rows, columns), &Device::Cpu)
    };
    let (h, x) = (var(6, 7, 1.0)?, var(6, 5, 2.0)?);
    let w = Var::from_vec(
        numbers(sizes.parameters(), 3.0),
        sizes.parameters(),
        &Device::Cpu,
    )?;
    let ours = h.apply_op3(x.as_tensor(), w.as_tensor(), Cell::new(sizes))?;
    let theirs = cell(sizes, h.as_tensor(), x.as_tensor(), w.as_tensor())?;
    close(&ours, &theirs, 1e-6);
    let (g, k) = (
        ours.sqr()?.sum_all()?.backward()?,
        theirs.sqr()?.sum_all()?.backward()?,
    );
    for var in [&h, &x, &w] {
        close(
            g.get(var).expect("a gradient"),
            k.get(var).expect("a gradient"),
            1e-4,
        );
    }
    Ok(())
}

#[test]
fn filters_agree_forward_and_backward_and_without_the_prior_expert() -> Result<()> {
    let mut config = Config::named("vhp").expect("a model");
    (config.latent, config.hidden, config.mixtures) = (4, 9, 3);
    let mut draw = |p: &Parameters| numbers(p.norm.trained(), 5.0);
    let dynamics = Dynamics::new(&config, "dyn", &mut draw, &Device::Cpu)?;
    let (batch, steps) = (10, 5);
    let tensor = |shape: &[usize], seed: f32| {
        Tensor::from_vec(numbers(shape.iter().product(), seed), shape, &Device::Cpu)
    };
    let stated = [1.0, 2.0, 3.0, 4.0]
        .map(|seed| Var::from_tensor(&tensor(&[batch, steps, 4], seed)?))
        .into_iter()
        .collect::<Result<Vec<_>>>()?;
    let experts: Vec<DiagGaussian> = stated
        .chunks_exact(2)
        .map(|pair| DiagGaussian {
            mean: pair[0].as_tensor().clone(),
            log_var: pair[1].as_tensor().clone(),
        })
        .collect();
    let mut alphas: Vec<f32> = (0..batch * steps)
        .flat_map(|i| [[1.0, 1.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.5, 0.5]][i % 3])
        .collect();
    let shape = (batch, steps, 3);
    let given = Tensor::from_vec(alphas.clone(), shape, &Device::Cpu)?;
    let (controls, noise) = (
        tensor(&[batch, steps - 1, 2], 6.0)?,
        tensor(&[batch, steps, 4], 7.0)?,
    );
    let inputs = Inputs {
        experts: &experts,
        alphas: &given,
        controls: &controls,
        noise: Some(&noise),
    };
    for prior_expert in [true, false] {
        let weights = dynamics.network.folded()?;
        let ours = model_filter::filter(&dynamics, &weights, inputs, prior_expert)?;
        count_prior(&mut alphas, 3, prior_expert);
        let factors = Tensor::from_vec(alphas.clone(), shape, &Device::Cpu)?;
        let theirs = super::filter(&dynamics, &weights, inputs, &factors)?;
        let all = |f: &Filtered| {
            let parts = [
                &f.prior.mean,
                &f.prior.log_var,
                &f.posterior.mean,
                &f.posterior.log_var,
                &f.z,
                &f.hidden,
            ];
            Tensor::cat(&parts, 2)
        };
        let (ours, theirs) = (all(&ours)?, all(&theirs)?);
        close(&ours, &theirs, 1e-5);
        let (g, h) = (
            ours.sqr()?.mean_all()?.backward()?,
            theirs.sqr()?.mean_all()?.backward()?,
        );
        let theta = dynamics.network.theta();
        for var in stated.iter().chain([theta]) {
            let gradient =
                |store: &GradStore| store.get(var.as_tensor()).expect("a gradient").clone();
            close(&gradient(&g), &gradient(&h), 1e-5);
        }
        if !prior_expert {
            // The second belief of the first sequence has no sensor: it is the prior.
            let (prior, posterior) = (ours.narrow(2, 0, 8)?, ours.narrow(2, 8, 8)?);
            let at = |x: Tensor| x.get(0)?.get(1);
            close(&at(prior)?, &at(posterior)?, 1e-5);
        }
    }
    Ok(())
}

#[test]
fn gradients_agree_with_finite_differences() -> Result<()> {
    let (fast, x, w) = inputs(3);
    let target = Tensor::from_vec(
        numbers(3 * fast.outputs(), 3.0),
        (3, fast.outputs()),
        &Device::Cpu,
    )?;
    let error = |w: &Tensor, train: bool| -> Result<Tensor> {
        let op = SquaredError::new(Arc::clone(&fast), vec![0.5, 1.0, 2.0], train);
        x.apply_op3(w, &target, op)
    };
    let gradients = error(w.as_tensor(), true)?.affine(3.0, 0.0)?.backward()?;
    let gradient = gradients
        .get(w.as_tensor())
        .expect("a gradient")
        .to_vec1::<f32>()?;
    let start = w.to_vec1::<f32>()?;
    for at in (0..start.len()).step_by(start.len() / 40) {
        let moved = |by: f32| -> Result<f64> {
            let mut w = start.clone();
            w[at] += by;
            Ok(3.0
                * f64::from(
                    error(&Tensor::from_vec(w, start.len(), &Device::Cpu)?, false)?
                        .to_scalar::<f32>()?,
                ))
        };
        let difference = (moved(1e-2)? - moved(-1e-2)?) / 2e-2;
        let bound = 2e-2 * (difference.abs() + 1.0);
        assert!(
            (f64::from(gradient[at]) - difference).abs() < bound,
            "{at}: {} and {difference}",
            gradient[at]
        );
    }
    Ok(())
}
