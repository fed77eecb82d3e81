//! Do the experts agree as well as they claim to (D8, D9, D10)?
//!
//! Each quantity compares differences of means with the variances that the experts state, and follows a χ² law if
//! those are right. Only active dimensions (D19) and experts that are on count. An expert with tempering α counts
//! as `N(μ, Σ/α)`; bounds are given only where each α is 0 or 1.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::chi2::{self, Bounds};
use super::gaussian::{self, Factor, Gaussian};
use super::spread;

/// Normalised innovation squared of one sensor: it against the prediction (D8).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Nis {
    /// `νᵀ (R + Σ₀)⁻¹ ν` with `ν = μᵢ − μ₀` and `R = Σᵢ/α`, against the head's own Σ₀. The head says the noise of
    /// one step and not the last posterior's spread, so this reads above the bounds even for a right model.
    pub head: f32,
    /// The same against `A P Aᵀ + Q`, which the bounds are meant for; none where that is not known, does not fit
    /// or is no covariance.
    pub propagated: Option<f32>,
    /// Active dimensions, the law's degrees of freedom.
    pub dof: usize,
    /// 95 % bounds; none where the sensor is tempered.
    pub bounds: Option<Bounds>,
}

/// D8 of one sensor; `propagated` is the full `A P Aᵀ + Q`, `(Z, Z)` row major (see [`predicted_covariance`]), and
/// `active` says which of the Z dimensions count.
///
/// None where the sensor is off, no dimension is active, the sizes do not fit or a number is not finite.
pub fn nis(
    sensor: Factor,
    prior: Gaussian,
    propagated: Option<&[f64]>,
    active: &[bool],
) -> Option<Nis> {
    if !prior.fits(gaussian::latent(&[sensor])?) {
        return None;
    }
    let dims = dimensions(active, prior.mean.len())?;
    let innovation = |d: usize| f64::from(sensor.gaussian.mean[d]) - f64::from(prior.mean[d]);
    let head: f64 = dims
        .iter()
        .map(|&d| innovation(d).powi(2) / (sensor.variance(d) + f64::from(prior.log_var[d]).exp()))
        .sum();
    Some(Nis {
        head: finite(head)?,
        propagated: propagated.and_then(|covariance| {
            let noise: Vec<f64> = dims.iter().map(|&d| sensor.variance(d)).collect();
            let nu: Vec<f64> = dims.iter().map(|&d| innovation(d)).collect();
            mahalanobis(&nu, covariance, &noise, &dims, active.len())
        }),
        dof: dims.len(),
        bounds: bounds(dims.len(), &[sensor]),
    })
}

/// The prediction's covariance `A P Aᵀ + Q` after one transition from a diagonal posterior, `(Z, Z)` row major.
///
/// `transition` is A, `(Z, Z)` row major; the others are logarithms of the diagonals of P and Q, Z each. Empty where
/// the sizes do not fit.
pub fn predicted_covariance(
    transition: &[f32],
    posterior_log_var: &[f32],
    noise_log_var: &[f32],
) -> Vec<f64> {
    spread::propagate(
        transition,
        &spread::diagonal(posterior_log_var),
        noise_log_var,
    )
}

/// Two experts against each other (D9).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Disagreement {
    /// Index of the one.
    pub a: usize,
    /// Index of the other, above `a`.
    pub b: usize,
    /// `d² = (μ_a − μ_b)ᵀ (Σ_a/α_a + Σ_b/α_b)⁻¹ (μ_a − μ_b)`.
    pub distance: f32,
    /// Active dimensions, the law's degrees of freedom.
    pub dof: usize,
    /// 95 % bounds; none where one of them is tempered. A pair with the prior shares the caveat of [`Nis::head`].
    pub bounds: Option<Bounds>,
}

/// D9 of every pair of factors that are on; the prior is one of them, by custom the last. `active` says which of the
/// Z dimensions count.
///
/// Empty with fewer than two on, no active dimension, sizes that do not fit or numbers that are not finite.
pub fn disagreements(factors: &[Factor], active: &[bool]) -> Vec<Disagreement> {
    let Some(dims) = gaussian::latent(factors).and_then(|latent| dimensions(active, latent)) else {
        return Vec::new();
    };
    let on = || factors.iter().enumerate().filter(|(_, f)| f.is_on());
    on().flat_map(|(b, second)| {
        let dims = &dims;
        on().take_while(move |&(a, _)| a < b)
            .filter_map(move |(a, first)| {
                let distance: f64 = dims
                    .iter()
                    .map(|&d| {
                        let apart =
                            f64::from(first.gaussian.mean[d]) - f64::from(second.gaussian.mean[d]);
                        apart * apart / (first.variance(d) + second.variance(d))
                    })
                    .sum();
                Some(Disagreement {
                    a,
                    b,
                    distance: finite(distance)?,
                    dof: dims.len(),
                    bounds: bounds(dims.len(), &[*first, *second]),
                })
            })
    })
    .collect()
}

/// How much agreement a product forces (D10). The belief is sharp also where this is large, so it belongs beside σ*.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Conflict {
    /// `Q = Σᵢ αᵢ (μᵢ − μ*)ᵀ Tᵢ (μᵢ − μ*)`.
    pub energy: f32,
    /// `(M − 1) · D_active` with M experts on, the prior counted only if it is: the law's degrees of freedom.
    pub dof: usize,
    /// `ln C = −½ [Q + Σᵢ ln det 2πΣᵢ/αᵢ − ln det 2πΣ*]` over the active dimensions: the product's normaliser, in
    /// nats.
    pub log_normaliser: f32,
    /// 95 % bounds; none where one of them is tempered. With the prior on it shares the caveat of [`Nis::head`].
    pub bounds: Option<Bounds>,
}

/// D10 of the factors that are on; `active` says which of the Z dimensions count.
///
/// None with fewer than two on (one cannot be in conflict), no active dimension, sizes that do not fit or numbers
/// that are not finite.
pub fn conflict(factors: &[Factor], active: &[bool]) -> Option<Conflict> {
    let full = gaussian::moments(factors)?;
    let dims = dimensions(active, full.mean.len())?;
    let on: Vec<Factor> = factors.iter().copied().filter(Factor::is_on).collect();
    if on.len() < 2 {
        return None;
    }
    let (mut energy, mut log_dets) = (0.0, 0.0);
    for &d in &dims {
        log_dets -= (TAU / full.precision[d]).ln();
        for factor in &on {
            let apart = f64::from(factor.gaussian.mean[d]) - full.mean[d];
            energy += apart * apart * factor.precision(d);
            log_dets += (TAU * factor.variance(d)).ln();
        }
    }
    let dof = (on.len() - 1) * dims.len();
    Some(Conflict {
        energy: finite(energy)?,
        dof,
        log_normaliser: finite(-0.5 * (energy + log_dets))?,
        bounds: bounds(dof, &on),
    })
}

/// The active dimensions; none where there is none or the mask is of another size.
fn dimensions(active: &[bool], latent: usize) -> Option<Vec<usize>> {
    let dims: Vec<usize> = (0..latent)
        .filter(|&d| active.get(d) == Some(&true))
        .collect();
    (active.len() == latent && !dims.is_empty()).then_some(dims)
}

/// Bounds hold only for experts as they were trained.
fn bounds(dof: usize, factors: &[Factor]) -> Option<Bounds> {
    let trained = factors.iter().all(Factor::is_as_trained);
    trained.then(|| chi2::bounds_95(dof as f64))
}

fn finite(value: f64) -> Option<f32> {
    let value = value as f32;
    value.is_finite().then_some(value)
}

/// `νᵀ (S + diag(noise))⁻¹ ν`, with S the rows and columns `dims` of `covariance`, `(latent, latent)` row major.
fn mahalanobis(
    nu: &[f64],
    covariance: &[f64],
    noise: &[f64],
    dims: &[usize],
    latent: usize,
) -> Option<f32> {
    if covariance.len() != latent * latent || covariance.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let sum = DMatrix::from_fn(dims.len(), dims.len(), |i, j| {
        covariance[dims[i] * latent + dims[j]] + if i == j { noise[i] } else { 0.0 }
    });
    let nu = DVector::from_column_slice(nu);
    finite(nu.dot(&sum.cholesky()?.solve(&nu)))
}

#[cfg(test)]
mod tests;
