//! A run of Gaussians over the steps, with as many of its frames as have been decoded so far.

use std::ops::Range;
use std::sync::Arc;

use crate::episode::Frame;
use crate::measure::frame::psnr_db;
use crate::model::trace::GaussianTrace;
use crate::session::predict::{PredictError, Predictor};
use crate::session::snapshot::Estimate;

/// Gaussian i is at step `first_step + i`.
#[derive(Debug)]
pub struct Pictured {
    /// The step of the first Gaussian.
    pub first_step: usize,
    /// The Gaussians.
    pub trace: Arc<GaussianTrace>,
    /// A position at each step of the episode, none outside the run; no list without a probe.
    pub positions: Option<Arc<Vec<Option<Estimate>>>>,
    /// Frame and PSNR in dB of each Gaussian, once decoded.
    cells: Vec<Option<(Arc<Frame>, Option<f32>)>>,
}

impl Pictured {
    /// Reads the positions; decodes nothing yet.
    pub fn new(
        predictor: &dyn Predictor,
        trace: GaussianTrace,
        first_step: usize,
        steps: usize,
    ) -> Self {
        let mut positions = vec![None; steps];
        for (i, slot) in positions
            .iter_mut()
            .skip(first_step)
            .enumerate()
            .take(trace.len())
        {
            let (mean, log_var) = trace.row(i);
            *slot = predictor.position(mean, log_var);
        }
        Self {
            first_step,
            cells: vec![None; trace.len()],
            trace: Arc::new(trace),
            positions: predictor.position_weights().map(|_| Arc::new(positions)),
        }
    }

    /// The steps it has a Gaussian for.
    pub fn range(&self) -> Range<usize> {
        self.first_step..self.first_step + self.cells.len()
    }

    /// The decoded frame of a step.
    pub fn frame(&self, step: usize) -> Option<Arc<Frame>> {
        self.cell(step).map(|(frame, _)| Arc::clone(frame))
    }

    /// PSNR of the decoded frame of a step, in dB.
    pub fn psnr_db(&self, step: usize) -> Option<f32> {
        self.cell(step)?.1
    }

    /// The steps that are not decoded yet.
    pub fn undecoded(&self) -> impl Iterator<Item = usize> {
        self.range().filter(|&step| self.cell(step).is_none())
    }

    /// Decodes those of the steps that are not decoded yet in one go and compares them with the truth.
    pub fn decode(
        &mut self,
        predictor: &dyn Predictor,
        steps: &[usize],
        truth: &[Arc<Frame>],
    ) -> Result<(), PredictError> {
        let undecoded = self.undecoded().filter(|step| steps.contains(step));
        let indices: Vec<usize> = undecoded.map(|step| step - self.first_step).collect();
        if indices.is_empty() {
            return Ok(());
        }
        let latents: Vec<f32> = indices
            .iter()
            .flat_map(|&i| self.trace.row(i).0.iter().copied())
            .collect();
        let frames = predictor.decode(&latents)?;
        if frames.len() != indices.len() {
            let (got, expected) = (frames.len(), indices.len());
            return Err(PredictError(format!(
                "decoded {got} frames of {expected} latents"
            )));
        }
        for (&i, frame) in indices.iter().zip(frames) {
            let psnr = truth
                .get(self.first_step + i)
                .and_then(|truth| psnr_db(&frame, truth));
            self.cells[i] = Some((Arc::new(frame), psnr));
        }
        Ok(())
    }

    fn cell(&self, step: usize) -> Option<&(Arc<Frame>, Option<f32>)> {
        let index = step.checked_sub(self.first_step)?;
        self.cells.get(index)?.as_ref()
    }
}
