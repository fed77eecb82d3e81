//! The product of experts: precisions add, means are weighted by precision.
//!
//! With the dynamics prior among the experts the product is a Kalman update with an identity observation, so the
//! shares, pulls and leave-one-out beliefs that are computed from it are exact.

use candle_core::{Result, Tensor};

use super::gaussian::{DiagGaussian, EPSILON};

/// Σ α T and Σ α T μ over some experts, `(…, Z)` each: a Gaussian that more can be multiplied into.
#[derive(Clone, Debug)]
pub struct Evidence {
    precision: Tensor,
    weighted_mean: Tensor,
}

impl Evidence {
    /// What `experts`, each `(…, Z)`, say together; `alphas` has a tensor `(…, 1)` for each: 0 leaves it out, 1 as
    /// trained. None for no experts.
    pub fn of(experts: &[DiagGaussian], alphas: &[Tensor]) -> Result<Option<Self>> {
        let mut sum: Option<Self> = None;
        for (expert, alpha) in experts.iter().zip(alphas) {
            let precision = expert.log_var.neg()?.exp()?.broadcast_mul(alpha)?;
            let weighted_mean = (&precision * &expert.mean)?;
            sum = Some(match sum {
                None => Self {
                    precision,
                    weighted_mean,
                },
                Some(sum) => Self {
                    precision: (sum.precision + precision)?,
                    weighted_mean: (sum.weighted_mean + weighted_mean)?,
                },
            });
        }
        Ok(sum)
    }

    /// Both taken together.
    pub fn and(&self, other: &Self) -> Result<Self> {
        Ok(Self {
            precision: (&self.precision + &other.precision)?,
            weighted_mean: (&self.weighted_mean + &other.weighted_mean)?,
        })
    }

    /// The same of dimension 1 at `index`, that dimension dropped.
    pub fn at(&self, index: usize) -> Result<Self> {
        Ok(Self {
            precision: self.precision.narrow(1, index, 1)?.squeeze(1)?,
            weighted_mean: self.weighted_mean.narrow(1, index, 1)?.squeeze(1)?,
        })
    }

    /// The normalised product: variance 1 / Σ α T, mean Σ α T μ / Σ α T (the paper's product of experts).
    pub fn belief(&self) -> Result<DiagGaussian> {
        let variance = self.precision.recip()?;
        Ok(DiagGaussian {
            mean: (&variance * &self.weighted_mean)?,
            log_var: (variance + EPSILON)?.log()?,
        })
    }
}
