//! The prior alone: what each transition does to a latent, and where known controls lead from a belief (D20).

use std::borrow::Borrow;

use candle_core::{Result, bail};

use super::Inspector;
use crate::model::Model;
use crate::model::kernel::read;
use crate::model::kernel::recurrence::{self, alone};
use crate::model::trace::{BeliefTrace, GaussianTrace, Rolled};

impl<M: Borrow<Model>> Inspector<M> {
    /// A of the transition that led to each belief, its gates frozen: `(beliefs, Z, Z)` row major. Nothing led to the
    /// first one; it has the identity.
    pub fn transitions(&self, beliefs: &BeliefTrace) -> Result<Vec<f32>> {
        let sizes = self.model().dynamics.sizes();
        let (latent, count) = (sizes.latent, beliefs.posterior.len());
        if beliefs.hidden.len() != count * sizes.hidden {
            bail!("{count} beliefs have states of another model");
        }
        let Some(led) = beliefs.hidden.get(sizes.hidden..) else {
            return Ok(Vec::new());
        };
        let mut all: Vec<f32> = (0..latent * latent)
            .map(|i| f32::from(i % (latent + 1) == 0))
            .collect();
        all.extend(read(&self.weights.dynamics, |w| {
            recurrence::transitions(sizes, w, led)
        })?);
        Ok(all)
    }

    /// The prior alone on the mean path from belief `from`, one step a control: whatever the switches, every α is 1.
    pub fn rollout(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
    ) -> Result<Rolled> {
        let sizes = self.model().dynamics.sizes();
        let start = self.start(beliefs, from, controls)?;
        let (mean, log_var, transitions) =
            read(&self.weights.dynamics, |w| alone::path(sizes, w, &start))?;
        Ok(Rolled {
            gaussians: GaussianTrace {
                latent: sizes.latent,
                mean,
                log_var,
            },
            transitions,
        })
    }

    /// Ancestral samples of the same: `z ~ q` at belief `from`, then `z' ~ N(A z + B u, Q)` for each control, A and Q
    /// as that sample's own path has them. `noise`, from N(0, I), is `(S, h + 1, Z)`, its first row for the draw from
    /// q. The latents after each control, `(S, h, Z)`; with no noise but zeros each has the bits of [`Self::rollout`].
    pub fn sample(
        &self,
        beliefs: &BeliefTrace,
        from: usize,
        controls: &[[f32; 2]],
        noise: &[f32],
    ) -> Result<Vec<f32>> {
        let sizes = self.model().dynamics.sizes();
        let mut start = self.start(beliefs, from, controls)?;
        start.noise = Some(noise);
        read(&self.weights.dynamics, |w| alone::samples(sizes, w, &start))
    }

    /// Belief `from` and what is done then.
    fn start<'a>(
        &self,
        beliefs: &'a BeliefTrace,
        from: usize,
        controls: &'a [[f32; 2]],
    ) -> Result<alone::Start<'a>> {
        let width = self.model().config.hidden;
        let count = beliefs.posterior.len();
        let hidden = beliefs.hidden.get(from * width..(from + 1) * width);
        let (Some(hidden), true) = (hidden, from < count) else {
            bail!("there is no belief {from} of {count} to go on from");
        };
        let (mean, log_var) = beliefs.posterior.row(from);
        Ok(alone::Start {
            hidden,
            mean,
            log_var,
            controls: controls.as_flattened(),
            noise: None,
        })
    }
}

#[cfg(test)]
mod tests;
