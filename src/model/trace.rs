//! What the model says of one episode, as plain numbers: the currency between the model, the session and the measures.

use serde::{Deserialize, Serialize};

use crate::measure::gaussian::{Factor, Gaussian};
use crate::measure::spread::{diagonal, propagate};

/// A run of diagonal Gaussians over the latent, one a belief; row major `(beliefs, Z)`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GaussianTrace {
    /// Z, the latent's dimensions.
    pub latent: usize,
    /// Means.
    pub mean: Vec<f32>,
    /// Logarithms of the variances.
    pub log_var: Vec<f32>,
}

impl GaussianTrace {
    /// Number of beliefs.
    pub fn len(&self) -> usize {
        self.mean.len() / self.latent.max(1)
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.mean.is_empty()
    }

    /// Mean and log-variance of belief `i`.
    pub fn row(&self, i: usize) -> (&[f32], &[f32]) {
        let range = i * self.latent..(i + 1) * self.latent;
        (&self.mean[range.clone()], &self.log_var[range])
    }

    /// Belief `i`.
    pub fn gaussian(&self, i: usize) -> Gaussian<'_> {
        let (mean, log_var) = self.row(i);
        Gaussian { mean, log_var }
    }
}

/// What each sensor expert of a model says of an episode; it does not depend on the switches.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpertTrace {
    /// One trace a sensor expert, in the model's order.
    pub experts: Vec<GaussianTrace>,
    /// The controls between beliefs, `(beliefs - 1, U)`: row i acts from belief i to i + 1.
    pub controls: Vec<[f32; 2]>,
}

/// The filter's answer for one setting of the switches.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefTrace {
    /// `p(z_t | z_{t-1}, u_{t-1})` before each belief's observations; the first is N(0, 20 I).
    pub prior: GaussianTrace,
    /// The product of the active experts.
    pub posterior: GaussianTrace,
    /// Hidden state of the recurrent network after each belief's transition, `(beliefs, hidden)`; row i has seen
    /// belief i - 1.
    pub hidden: Vec<f32>,
}

impl BeliefTrace {
    /// What is multiplied at belief `i`: the sensor experts and the prior last, each with the α it counts with.
    pub fn factors<'a>(
        &'a self,
        experts: &'a ExpertTrace,
        alphas: &Alphas,
        prior_expert: bool,
        i: usize,
    ) -> Vec<Factor<'a>> {
        let mut alphas = alphas.row(i).to_vec();
        let switches = alphas.len();
        count_prior(&mut alphas, switches, prior_expert);
        let all = experts.experts.iter().chain([&self.prior]).zip(alphas);
        all.map(|(gaussians, alpha)| Factor {
            gaussian: gaussians.gaussian(i),
            alpha,
        })
        .collect()
    }
}

/// Sets the α that the prior counts with, the last in each row of `switches`. Where `prior_expert` is off the prior is
/// stated but not multiplied in, unless no sensor is: it is all there is to believe.
pub fn count_prior(alphas: &mut [f32], switches: usize, prior_expert: bool) {
    if prior_expert {
        return;
    }
    for row in alphas.chunks_exact_mut(switches) {
        let (sensors, prior) = row.split_at_mut(switches - 1);
        prior[0] = f32::from(sensors.iter().all(|&alpha| alpha == 0.0));
    }
}

/// The prior alone, from a belief on: one row a control.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rolled {
    /// What is believed after each control. The variances are the head's one-step ones, Q of D20: nothing accumulates.
    pub gaussians: GaussianTrace,
    /// A of each step, `(h, Z, Z)` row major, its gates as on the mean path (D20).
    pub transitions: Vec<f32>,
}

impl Rolled {
    /// The covariance after each control, `A P Aᵀ + Q` from a belief's log-variances on, `(Z, Z)` row major (D20).
    pub fn covariances(&self, start_log_var: &[f32]) -> impl Iterator<Item = Vec<f64>> {
        let latent = start_log_var.len();
        debug_assert_eq!(
            self.transitions.len(),
            self.gaussians.len() * latent * latent
        );
        let mut covariance = diagonal(start_log_var);
        let transitions = self.transitions.chunks_exact((latent * latent).max(1));
        let steps = transitions.zip(0..self.gaussians.len());
        steps.map(move |(transition, step)| {
            covariance = propagate(transition, &covariance, self.gaussians.row(step).1);
            covariance.clone()
        })
    }
}

/// α of every expert at every belief, `(beliefs, M)` with the prior last: 0 off, 1 as trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alphas {
    /// M, the sensor experts and the prior.
    pub experts: usize,
    /// Row major.
    pub values: Vec<f32>,
}

impl Alphas {
    /// Every expert as trained.
    pub fn trained(beliefs: usize, experts: usize) -> Self {
        Self {
            experts,
            values: vec![1.0; beliefs * experts],
        }
    }

    /// α of each expert at belief `i`.
    pub fn row(&self, i: usize) -> &[f32] {
        &self.values[i * self.experts..(i + 1) * self.experts]
    }
}
