//! Diagonal Gaussians over the latent, as tensors.

use candle_core::{D, Result, Shape, Tensor};

/// Variances get this much when a KL divides by them, and products when their logarithm is taken, as released.
pub const EPSILON: f64 = 1e-8;

/// A diagonal Gaussian: two tensors of one shape, `(…, Z)`.
#[derive(Clone, Debug)]
pub struct DiagGaussian {
    /// Means.
    pub mean: Tensor,
    /// Logarithms of the variances.
    pub log_var: Tensor,
}

impl DiagGaussian {
    /// The mean, or with noise from N(0, I) a sample: `mean + exp(log_var / 2) ε`.
    pub fn draw(&self, noise: Option<&Tensor>) -> Result<Tensor> {
        match noise {
            Some(noise) => &self.mean + (self.log_var.affine(0.5, 0.0)?.exp()? * noise)?,
            None => Ok(self.mean.clone()),
        }
    }

    /// KL(self ‖ prior) in nats, summed over latents: `(…)`.
    pub fn kl(&self, prior: &Self) -> Result<Tensor> {
        self.kl_per_latent(prior)?.sum(D::Minus1)
    }

    /// What each latent adds to KL(self ‖ prior), in nats: `(…, Z)`.
    pub fn kl_per_latent(&self, prior: &Self) -> Result<Tensor> {
        let (own, other) = (self.variance()?, prior.variance()?);
        let distance = (&prior.mean - &self.mean)?.sqr()?;
        let terms = ((((&own + distance)? / &other)? + other.log()?)? - own.log()?)?;
        (terms - 1.0)?.affine(0.5, 0.0)
    }

    fn variance(&self) -> Result<Tensor> {
        self.log_var.exp()? + EPSILON
    }

    /// The same numbers without a gradient.
    #[must_use]
    pub fn detach(&self) -> Self {
        Self {
            mean: self.mean.detach(),
            log_var: self.log_var.detach(),
        }
    }

    /// The same numbers in another shape.
    pub fn reshape<S: Into<Shape> + Clone>(&self, shape: S) -> Result<Self> {
        Ok(Self {
            mean: self.mean.reshape(shape.clone().into())?,
            log_var: self.log_var.reshape(shape.into())?,
        })
    }

    /// Rows `start..start + len` of dimension `dim`.
    pub fn narrow(&self, dim: usize, start: usize, len: usize) -> Result<Self> {
        Ok(Self {
            mean: self.mean.narrow(dim, start, len)?,
            log_var: self.log_var.narrow(dim, start, len)?,
        })
    }
}
