//! Every non-empty set of experts of an episode, filtered as one batch.

use std::sync::Arc;

use super::inferred::{Inferred, infer_all};
use super::lru::Lru;
use super::opened::Opened;
use crate::episode::Frame;
use crate::measure::ellipse::Ellipse;
use crate::measure::frame::{psnr_db, squared_error};
use crate::modality::{Expert, ExpertSet};
use crate::model::trace::{Alphas, ExpertTrace};
use crate::session::predict::{PredictError, Predictor};
use crate::session::snapshot::ModelInfo;
use crate::session::snapshot::lattice::{LatticeCell, LatticeView};

/// Steps whose frames are kept: 15 of each for three experts and the prior.
const FRAMES: usize = 64;

/// The sets of an episode, with the frames of the steps that were looked at.
#[derive(Debug)]
pub struct Lattice {
    sets: Vec<Set>,
    frames: Lru<usize, Vec<Arc<Frame>>>,
}

#[derive(Debug)]
struct Set {
    /// In the order of the model's experts, the prior last.
    active: Vec<bool>,
    inferred: Inferred,
    /// Root mean squared distance of the position from the truth, in metres.
    rmse_m: Option<f32>,
}

/// The sets of a model's factors: the largest first, and of one size those with the first experts first.
pub fn sets(model: &ModelInfo) -> Vec<Vec<bool>> {
    let factors = model.factors().len();
    let all = model.experts.len() + 1;
    let mut sets: Vec<Vec<bool>> = (1..1_u32 << factors)
        .map(|bits| {
            (0..all)
                .map(|i| i < factors && bits >> i & 1 == 1)
                .collect()
        })
        .collect();
    let size = |set: &Vec<bool>| set.iter().filter(|&&on| on).count();
    sets.sort_by(|a, b| size(b).cmp(&size(a)).then_with(|| b.cmp(a)));
    sets
}

impl Lattice {
    /// Filters all sets; none for a model without a product.
    pub fn of(
        trace: &Arc<ExpertTrace>,
        opened: &Opened,
        predictor: &dyn Predictor,
    ) -> Result<Option<Self>, PredictError> {
        let info = predictor.info();
        if !info.has_product() {
            return Ok(None);
        }
        let beliefs = opened.steps() - info.frame_stack;
        let sets = sets(info);
        let settings: Vec<Alphas> = sets
            .iter()
            .map(|active| {
                let on = active.iter().map(|&on| f32::from(u8::from(on)));
                // A prior that is no factor is as trained: it states what is predicted, and is not multiplied.
                let mut alphas: Vec<f32> = on.collect();
                if let (false, Some(prior)) = (info.prior_expert, alphas.last_mut()) {
                    *prior = 1.0;
                }
                Alphas {
                    experts: alphas.len(),
                    values: alphas.repeat(beliefs),
                }
            })
            .collect();
        let inferred = infer_all(trace, settings, opened.steps(), predictor)?;
        let sets = sets
            .into_iter()
            .zip(inferred)
            .map(|(active, inferred)| Set {
                rmse_m: rmse_m(&inferred, opened, predictor),
                active,
                inferred,
            });
        Ok(Some(Self {
            sets: sets.collect(),
            frames: Lru::new(FRAMES),
        }))
    }

    /// What every set believes at a step; `current` are the present switches, which are a set's where they are its own
    /// at every step: a belief depends on those before it.
    pub fn at(
        &mut self,
        step: usize,
        current: &Alphas,
        opened: &Opened,
        predictor: &dyn Predictor,
    ) -> Result<Option<LatticeView>, PredictError> {
        let Some(belief) = self
            .sets
            .first()
            .and_then(|set| set.inferred.belief_at(step))
        else {
            return Ok(None);
        };
        let frames = &*self.frames.get_or_try_insert(step, || {
            let means = self.sets.iter();
            let latents: Vec<f32> = means
                .flat_map(|set| set.inferred.posterior(belief).mean.iter().copied())
                .collect();
            let frames = predictor.decode(&latents)?;
            Ok::<_, PredictError>(frames.into_iter().map(Arc::new).collect())
        })?;
        let experts = predictor.info().all_experts();
        let cell = |(i, set): (usize, &Set)| {
            let posterior = set.inferred.posterior(belief);
            let position = predictor.position(posterior.mean, posterior.log_var);
            let frame = frames.get(i).map(Arc::clone);
            let compared = frame.as_deref().zip(opened.truth.get(step));
            let truth = opened.poses.get(step);
            let ellipse = position.map(|at| Ellipse::of_covariance(at.covariance));
            LatticeCell {
                name: name(&experts, &set.active),
                trained: is_trained(predictor.info(), &set.active),
                current: set.inferred.alphas == *current,
                squared_error: compared
                    .and_then(|(frame, truth)| squared_error(frame, truth))
                    .map(|error| error as f32),
                psnr_db: compared.and_then(|(frame, truth)| psnr_db(frame, truth)),
                frame,
                position_error_m: position
                    .zip(truth)
                    .map(|(at, truth)| at.distance_m([truth.x, truth.y])),
                position,
                episode_rmse_m: set.rmse_m,
                ellipse_m2: ellipse.map(|e| std::f32::consts::PI * e.major * e.minor),
                active: set.active.clone(),
            }
        };
        Ok(Some(LatticeView {
            step,
            cells: self.sets.iter().enumerate().map(cell).collect(),
        }))
    }
}

fn rmse_m(inferred: &Inferred, opened: &Opened, predictor: &dyn Predictor) -> Option<f32> {
    let squares: Vec<f32> = (0..opened.steps())
        .filter_map(|step| {
            let posterior = inferred.posterior(inferred.belief_at(step)?);
            let at = predictor.position(posterior.mean, posterior.log_var)?;
            let truth = opened.poses.get(step)?;
            Some((at.x - truth.x).powi(2) + (at.y - truth.y).powi(2))
        })
        .collect();
    let mean = squares.iter().sum::<f32>() / squares.len().max(1) as f32;
    (!squares.is_empty()).then(|| mean.sqrt())
}

fn name(experts: &[Expert], active: &[bool]) -> String {
    let members = experts.iter().zip(active).filter(|(_, on)| **on);
    members.map(|(expert, _)| expert.letter()).collect()
}

/// Training multiplies the prior in wherever the model has it among its factors.
fn is_trained(model: &ModelInfo, active: &[bool]) -> bool {
    let sensors = model.experts.len();
    let bits = (0..sensors)
        .filter(|&i| active[i])
        .fold(0_u8, |bits, i| bits | 1 << i);
    let has_prior = active[sensors] || !model.prior_expert;
    has_prior && model.trained_sets.contains(&ExpertSet(bits))
}
