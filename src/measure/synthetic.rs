//! A linear-Gaussian world in which the truth about every belief is known; what the consistency measures are tested on.
//!
//! `z' = A z + w`, `w ~ N(0, Q)`, sensors `μᵢ = z + vᵢ`, `vᵢ ~ N(0, R)` and equally correlated, all matrices diagonal;
//! a position is `W z + r`. The filter multiplies the experts as the model does, with a head that states a fixed
//! variance. Truth starts in N(0, S), S the steady-state predictive variance of one sensor, and the first prior says so.

use nalgebra::{Matrix2, SymmetricEigen};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::calibration::Error2;
use super::gaussian::{Factor, Gaussian, product};

/// Z.
const LATENT: usize = 4;
type Diagonal = [f64; 4];

/// What the experts are and what the head says.
#[derive(Clone, Copy)]
pub struct World {
    /// A.
    pub transition: Diagonal,
    /// Q.
    pub noise: Diagonal,
    /// R, of every expert.
    pub sensor: Diagonal,
    /// Number of sensor experts.
    pub experts: usize,
    /// Correlation of their errors; 1 makes them copies.
    pub rho: f64,
    /// α of every sensor expert.
    pub alpha: f32,
    /// What the prior states after a transition; none: the prior is off.
    pub head: Option<Diagonal>,
    /// Standard deviation of r along both axes, in metres.
    pub residual_m: f64,
}

/// One step of all episodes.
pub struct Outcome {
    /// Of the fused belief, with `W Σ* Wᵀ` as covariance.
    pub fused: Vec<Error2>,
    /// Of each expert alone, one list an expert.
    pub alone: Vec<Vec<[f32; 2]>>,
}

/// W, `(2, Z)`, in metres.
const WEIGHTS: [Diagonal; 2] = [[0.03, -0.01, 0.02, 0.01], [0.01, 0.02, -0.02, 0.03]];

impl World {
    /// One sensor, four different dimensions, a head that states `diag(A P Aᵀ + Q)`.
    pub fn honest() -> Self {
        Self {
            transition: [0.95, 0.9, 0.8, 0.98],
            noise: [0.05, 0.1, 0.3, 0.02],
            sensor: [1.0, 0.5, 0.8, 0.3],
            experts: 1,
            rho: 0.0,
            alpha: 1.0,
            head: None,
            residual_m: 0.0,
        }
        .with_honest_head()
    }

    /// The same in four equal dimensions, so that one ratio of precisions holds for all.
    pub fn even() -> Self {
        Self {
            transition: [0.95; LATENT],
            noise: [0.05; LATENT],
            sensor: [1.0; LATENT],
            ..Self::honest()
        }
        .with_honest_head()
    }

    fn with_honest_head(self) -> Self {
        Self {
            head: Some(self.predictive()),
            ..self
        }
    }

    /// S of one sensor: the fixed point of `S = A P A + Q`, `P = (1/S + 1/R)⁻¹`.
    pub fn predictive(&self) -> Diagonal {
        std::array::from_fn(|d| {
            let mut s = self.noise[d];
            for _ in 0..10_000 {
                s = self.transition[d].powi(2) / (1.0 / s + 1.0 / self.sensor[d]) + self.noise[d];
            }
            s
        })
    }

    /// Filters `episodes` for `steps`; one outcome a step.
    pub fn run(&self, episodes: usize, steps: usize, seed: u64) -> Vec<Outcome> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = move || -> f64 { rng.sample(StandardNormal) };
        let start = self.predictive();
        let mut outcomes: Vec<Outcome> = (0..steps)
            .map(|_| Outcome {
                fused: Vec::with_capacity(episodes),
                alone: vec![Vec::with_capacity(episodes); self.experts],
            })
            .collect();
        for _ in 0..episodes {
            let mut z: Diagonal = std::array::from_fn(|d| start[d].sqrt() * normal());
            let (mut prior, mut stated) = ([0.0_f32; LATENT], start);
            for outcome in &mut outcomes {
                let shared: Diagonal = std::array::from_fn(|_| normal());
                let seen: Vec<[f32; LATENT]> = (0..self.experts)
                    .map(|_| {
                        std::array::from_fn(|d| {
                            let v =
                                self.rho.sqrt() * shared[d] + (1.0 - self.rho).sqrt() * normal();
                            (z[d] + self.sensor[d].sqrt() * v) as f32
                        })
                    })
                    .collect();
                let (mean, variance) = self.fuse(&seen, &prior, stated);
                let r = [0, 1].map(|_| (self.residual_m * normal()) as f32);
                let error = |mean: &[f32]| {
                    let [x, y] = along(&std::array::from_fn(|d| z[d] - f64::from(mean[d])));
                    [x + r[0], y + r[1]]
                };
                outcome.fused.push(Error2 {
                    error_m: error(&mean),
                    covariance: plane(variance),
                });
                for (list, seen) in outcome.alone.iter_mut().zip(&seen) {
                    list.push(error(seen));
                }
                for d in 0..LATENT {
                    z[d] = self.transition[d] * z[d] + self.noise[d].sqrt() * normal();
                    prior[d] = self.transition[d] as f32 * mean[d];
                }
                stated = self.head.unwrap_or(stated);
            }
        }
        outcomes
    }

    /// The last step of a run.
    pub fn last(&self, episodes: usize, steps: usize, seed: u64) -> Outcome {
        self.run(episodes, steps, seed).pop().expect("a step")
    }

    /// Errors `horizon` steps after the last filtered belief of an honest filter: first with the propagated
    /// `P' = A P A + Q`, then with what the head alone states. Estimates cancel: `e' = A e + w`, `e ~ N(0, P)`.
    pub fn rollout(&self, episodes: usize, horizon: usize, seed: u64) -> [Vec<Error2>; 2] {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = move || -> f64 { rng.sample(StandardNormal) };
        let head = self.predictive();
        let belief: Diagonal =
            std::array::from_fn(|d| 1.0 / (1.0 / head[d] + 1.0 / self.sensor[d]));
        let mut carried = belief;
        for _ in 0..horizon {
            carried =
                std::array::from_fn(|d| self.transition[d].powi(2) * carried[d] + self.noise[d]);
        }
        let errors: Vec<[f32; 2]> = (0..episodes)
            .map(|_| {
                let mut e: Diagonal = std::array::from_fn(|d| belief[d].sqrt() * normal());
                for _ in 0..horizon {
                    e = std::array::from_fn(|d| {
                        self.transition[d] * e[d] + self.noise[d].sqrt() * normal()
                    });
                }
                along(&e)
            })
            .collect();
        [carried, head].map(|variance| {
            let covariance = plane(variance);
            errors
                .iter()
                .map(|&error_m| Error2 {
                    error_m,
                    covariance,
                })
                .collect()
        })
    }

    /// The product of all that is on: mean and variance.
    fn fuse(
        &self,
        seen: &[[f32; LATENT]],
        prior: &[f32],
        stated: Diagonal,
    ) -> (Vec<f32>, Diagonal) {
        let log = |variance: Diagonal| variance.map(|v| v.ln() as f32);
        let (sensor, stated) = (log(self.sensor), log(stated));
        let factor = |mean, log_var, alpha| Factor {
            gaussian: Gaussian { mean, log_var },
            alpha,
        };
        let mut factors: Vec<Factor> = seen
            .iter()
            .map(|mean| factor(mean.as_slice(), sensor.as_slice(), self.alpha))
            .collect();
        factors.push(factor(
            prior,
            &stated,
            f32::from(u8::from(self.head.is_some())),
        ));
        let fused = product(&factors).expect("an expert is on");
        let variance = std::array::from_fn(|d| f64::from(fused.log_var[d]).exp());
        (fused.mean, variance)
    }
}

/// `W e`.
fn along(e: &Diagonal) -> [f32; 2] {
    WEIGHTS.map(|w| w.iter().zip(e).map(|(w, e)| w * e).sum::<f64>() as f32)
}

/// `W Σ Wᵀ` as xx, xy, yy.
fn plane(variance: Diagonal) -> [f32; 3] {
    [(0, 0), (0, 1), (1, 1)].map(|(a, b)| {
        let parts = (0..LATENT).map(|d| WEIGHTS[a][d] * WEIGHTS[b][d] * variance[d]);
        parts.sum::<f64>() as f32
    })
}

/// R_p (D11): the positive semidefinite part of the errors' second moment less the mean of what is claimed.
pub fn unexplained(errors: &[Error2]) -> [f32; 3] {
    let mut sum = Matrix2::<f64>::zeros();
    for error in errors {
        let [x, y] = error.error_m.map(f64::from);
        let [xx, xy, yy] = error.covariance.map(f64::from);
        sum += Matrix2::new(x * x - xx, x * y - xy, x * y - xy, y * y - yy);
    }
    let eigen = SymmetricEigen::new(sum / errors.len() as f64);
    let values = Matrix2::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
    let r = eigen.eigenvectors * values * eigen.eigenvectors.transpose();
    [r[(0, 0)] as f32, r[(0, 1)] as f32, r[(1, 1)] as f32]
}
