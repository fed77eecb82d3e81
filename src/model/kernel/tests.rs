//! Backward passes against finite differences, and the choice of the code path.

use std::ffi::OsStr;

use candle_core::{Device, Result, Tensor, Var};
use pulp::Arch;

use super::cell::{Cell, Sizes};
use super::choose;
use super::recurrence::{Kept, Recurrence};
use super::weight_norm::{Stretch, WeightNorm};

fn numbers(n: usize, seed: f32) -> Vec<f32> {
    (0..n)
        .map(|i| ((i as f32 + seed) * 12.9898).sin())
        .collect()
}

/// Holds the gradient of `f` at `var` against central differences at every `stride`-th number.
fn check(var: &Var, f: impl Fn(&Tensor) -> Result<Tensor>, stride: usize) -> Result<()> {
    let gradients = f(var.as_tensor())?.backward()?;
    let gradient = gradients
        .get(var.as_tensor())
        .expect("a gradient")
        .flatten_all()?
        .to_vec1::<f32>()?;
    let start = var.flatten_all()?.to_vec1::<f32>()?;
    for at in (0..start.len()).step_by(stride) {
        let moved = |by: f32| -> Result<f64> {
            let mut numbers = start.clone();
            numbers[at] += by;
            Ok(f64::from(
                f(&Tensor::from_vec(numbers, var.shape(), &Device::Cpu)?)?.to_scalar::<f32>()?,
            ))
        };
        let difference = (moved(5e-3)? - moved(-5e-3)?) / 1e-2;
        let bound = 1e-2 * (difference.abs() + 0.2);
        assert!(
            (f64::from(gradient[at]) - difference).abs() < bound,
            "{at}: {} and {difference}",
            gradient[at]
        );
    }
    Ok(())
}

/// A smooth scalar that weighs every number differently.
fn scalar(x: &Tensor) -> Result<Tensor> {
    let weights = Tensor::from_vec(numbers(x.elem_count(), 7.0), x.shape(), &Device::Cpu)?;
    (x * weights)?.sum_all()
}

#[test]
fn weight_norm_has_the_gradient_of_its_formula() -> Result<()> {
    let norm = WeightNorm {
        stretches: vec![
            Stretch::Normed {
                outer: 4,
                norms: 3,
                inner: 1,
            },
            Stretch::Plain(5),
            Stretch::Normed {
                outer: 2,
                norms: 3,
                inner: 4,
            },
        ],
    };
    let theta = Var::from_vec(numbers(norm.trained(), 0.5), norm.trained(), &Device::Cpu)?;
    check(&theta, |theta| scalar(&theta.apply_op1(norm.clone())?), 1)
}

#[test]
fn an_update_of_g_or_of_v_changes_the_weights() -> Result<()> {
    let norm = WeightNorm {
        stretches: vec![Stretch::Normed {
            outer: 2,
            norms: 2,
            inner: 1,
        }],
    };
    let fold = |theta: [f32; 6]| {
        Tensor::from_slice(&theta, 6, &Device::Cpu)?
            .apply_op1(norm.clone())?
            .to_vec1::<f32>()
    };
    let base = fold([2.0, 1.0, 3.0, 1.0, 4.0, 0.0])?;
    assert_eq!(base, [1.2, 1.0, 1.6, 0.0]);
    assert_eq!(fold([4.0, 1.0, 3.0, 1.0, 4.0, 0.0])?, [2.4, 1.0, 3.2, 0.0]);
    assert_eq!(fold([2.0, 1.0, 4.0, 1.0, 3.0, 0.0])?, [1.6, 1.0, 1.2, 0.0]);
    Ok(())
}

#[test]
fn the_cell_has_the_gradient_of_its_formula() -> Result<()> {
    let sizes = Sizes {
        latent: 3,
        inputs: 5,
        hidden: 7,
        mixtures: 4,
    };
    let batch = 3;
    let tensor = |rows: usize, seed: f32| {
        Var::from_vec(numbers(batch * rows, seed), (batch, rows), &Device::Cpu)
    };
    let (h, x) = (tensor(sizes.hidden, 1.0)?, tensor(sizes.inputs, 2.0)?);
    let w = Var::from_vec(
        numbers(sizes.parameters(), 3.0),
        sizes.parameters(),
        &Device::Cpu,
    )?;
    let run = |h: &Tensor, x: &Tensor, w: &Tensor| scalar(&h.apply_op3(x, w, Cell::new(sizes))?);
    check(&h, |h| run(h, &x, &w), 1)?;
    check(&x, |x| run(&h, x, &w), 1)?;
    check(&w, |w| run(&h, &x, w), 5)
}

#[test]
fn the_recurrence_has_the_gradient_of_its_formula() -> Result<()> {
    let sizes = Sizes {
        latent: 2,
        inputs: 3,
        hidden: 5,
        mixtures: 3,
    };
    // More sequences than one task takes, experts off, on and in between, and a step that only the prior speaks at.
    let (batch, steps, experts) = (9, 4, 2);
    let alphas: Vec<f32> = (0..batch * steps)
        .flat_map(|i| match i % 5 {
            0 => [1.0, 0.0, 1.0],
            1 => [0.0, 0.0, 1.0],
            2 => [0.5, 1.0, 0.0],
            _ => [1.0, 1.0, 1.0],
        })
        .collect();
    let stated = Var::from_vec(
        numbers(2 * experts * batch * steps * sizes.latent, 1.0),
        (2 * experts, batch, steps, sizes.latent),
        &Device::Cpu,
    )?;
    let w = Var::from_vec(
        numbers(sizes.parameters(), 2.0),
        sizes.parameters(),
        &Device::Cpu,
    )?;
    for noise in [None, Some(numbers(batch * steps * sizes.latent, 4.0))] {
        let run = |stated: &Tensor, w: &Tensor| {
            let op = Recurrence {
                sizes,
                alphas: alphas.clone(),
                controls: numbers(batch * (steps - 1), 3.0),
                noise: noise.clone(),
                first_log_var: 1.0,
                kept: Kept::default(),
            };
            scalar(&stated.apply_op2(w, op)?)?.affine(0.1, 0.0)
        };
        check(&stated, |stated| run(stated, &w), 3)?;
        check(&w, |w| run(&stated, w), 5)?;
    }
    Ok(())
}

#[test]
fn the_portable_path_is_taken_when_asked_for_and_only_then() {
    let is_scalar = |value: &str| matches!(choose(Some(OsStr::new(value))), Arch::Scalar);
    assert!(is_scalar("1") && is_scalar("yes") && is_scalar(""));
    let best = std::mem::discriminant(&Arch::new());
    for value in [None, Some(OsStr::new("0"))] {
        assert_eq!(std::mem::discriminant(&choose(value)), best);
    }
}
