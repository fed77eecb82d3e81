//! One episode, scored: filtered with every expert as trained, predicted by the default protocol.

use std::sync::Arc;

use crate::episode::{Episode, Frame, PlanarPose};
use crate::measure::active::LatentStats;
use crate::measure::attribution::permutation_importance;
use crate::measure::calibration::{Error2, nees};
use crate::measure::chi2::quantile;
use crate::measure::failure::Scores;
use crate::measure::frame::squared_error;
use crate::measure::innovation::conflict;
use crate::model::trace::{Alphas, ExpertTrace, GaussianTrace};
use crate::session::known::Known;
use crate::session::predict::Predictor;
use crate::session::settings::Settings;
use crate::session::snapshot::table::EpisodeScore;
use crate::session::worker::{Inferred, infer};

/// Seed of the shuffle of D18, and the most beliefs that are shuffled.
const SHUFFLE: u64 = 0;
const SHUFFLED: usize = 20_000;

/// What the experts say of an episode, and what is true.
#[derive(Debug)]
pub struct Sheet {
    /// What the experts say.
    pub trace: Arc<ExpertTrace>,
    /// T.
    pub steps: usize,
    /// Recorded poses, one a step; empty if not recorded.
    pub poses: Vec<PlanarPose>,
    frames: Vec<Frame>,
    flags: usize,
}

impl Sheet {
    /// Encodes an episode.
    pub fn of(episode: Episode, predictor: &dyn Predictor) -> Result<Self, String> {
        let missing = predictor.missing(&episode);
        if !missing.is_empty() {
            return Err(format!("lacks {}", missing.join(", ")));
        }
        let steps = episode.steps();
        if steps < predictor.info().frame_stack + 2 {
            return Err(format!("has {steps} frames"));
        }
        let trace = predictor.encode(&episode).map_err(|e| e.to_string())?;
        Ok(Self::with(Arc::new(trace), episode))
    }

    /// An episode that was encoded before.
    pub fn with(trace: Arc<ExpertTrace>, episode: Episode) -> Self {
        Self {
            trace,
            steps: episode.steps(),
            poses: episode.object.unwrap_or_default(),
            frames: episode.frames,
            flags: episode.flags.len(),
        }
    }

    /// What is kept of it.
    pub fn without_frames(&self) -> Self {
        Self {
            trace: Arc::clone(&self.trace),
            steps: self.steps,
            poses: self.poses.clone(),
            frames: Vec::new(),
            flags: self.flags,
        }
    }

    /// The recorded position of a step in metres.
    pub fn truth_m(&self, step: usize) -> Option<[f32; 2]> {
        self.poses.get(step).map(|pose| [pose.x, pose.y])
    }

    /// Filters it.
    pub fn infer(&self, alphas: Alphas, predictor: &dyn Predictor) -> Result<Inferred, String> {
        infer(Arc::clone(&self.trace), alphas, self.steps, predictor).map_err(|e| e.to_string())
    }

    /// Filters it with every expert as trained.
    pub fn infer_as_trained(&self, predictor: &dyn Predictor) -> Result<Inferred, String> {
        let info = predictor.info();
        let beliefs = self.steps - info.frame_stack;
        self.infer(Alphas::trained(beliefs, info.experts.len() + 1), predictor)
    }
}

fn distance_m(error: &Error2) -> f32 {
    error.error_m[0].hypot(error.error_m[1])
}

/// Scores an episode whose frames are there.
pub fn score(sheet: &Sheet, predictor: &dyn Predictor) -> Result<EpisodeScore, String> {
    let info = predictor.info();
    let inferred = sheet.infer_as_trained(predictor)?;
    let rollout = Settings::default().rollout(sheet.steps, info.frame_stack);
    let predicted = if rollout.horizon == 0 {
        GaussianTrace::default()
    } else {
        let controls = inferred.controls(rollout, None);
        let controls = controls.map_err(|e| e.to_string())?;
        predictor
            .rollout(&inferred.beliefs, inferred.start(rollout), &controls)
            .map_err(|e| e.to_string())?
            .gaussians
    };
    // Each step's picture is of the prediction where there is one, else of the belief.
    let first = rollout.start + 1;
    let at = |step: usize| -> Option<(&[f32], &[f32])> {
        match step.checked_sub(first) {
            Some(ahead) if ahead < predicted.len() => Some(predicted.row(ahead)),
            _ => {
                let posterior = inferred.posterior(inferred.belief_at(step)?);
                Some((posterior.mean, posterior.log_var))
            }
        }
    };
    let shown: Vec<usize> = (0..sheet.steps)
        .filter(|&step| at(step).is_some())
        .collect();
    let latents: Vec<f32> = shown
        .iter()
        .filter_map(|&step| at(step))
        .flat_map(|(mean, _)| mean.iter().copied())
        .collect();
    let frames = predictor.decode(&latents).map_err(|e| e.to_string())?;
    let outside = quantile(2.0, 0.95);
    let active = vec![true; info.latent];
    let mut by_step = vec![Scores::default(); sheet.steps];
    for (&step, frame) in shown.iter().zip(&frames) {
        let scores = &mut by_step[step];
        let squared = sheet.frames.get(step).and_then(|t| squared_error(frame, t));
        scores.error = squared.map(|error| error as f32);
        let position = at(step).and_then(|(mean, log_var)| predictor.position(mean, log_var));
        let off = position
            .zip(sheet.truth_m(step))
            .map(|(at, truth)| at.error(truth));
        scores.distance_m = off.as_ref().map(distance_m);
        let Some(belief) = inferred.belief_at(step) else {
            continue;
        };
        let posterior = inferred.posterior(belief);
        let position = predictor.position(posterior.mean, posterior.log_var);
        let off = position
            .zip(sheet.truth_m(step))
            .map(|(at, truth)| at.error(truth));
        let epsilon = off.as_ref().and_then(nees);
        scores.nees = epsilon.map(|epsilon| epsilon as f32);
        scores.escape = epsilon.filter(|&epsilon| epsilon > outside).map(|_| step);
        scores.conflict = conflict(&inferred.factors(belief), &active).map(|c| c.energy);
    }
    let horizon = first..first + predicted.len();
    let summed = if horizon.is_empty() {
        &by_step[..]
    } else {
        &by_step[horizon]
    };
    let scores = Scores {
        error: mean(summed.iter().filter_map(|s| s.error)),
        distance_m: mean(summed.iter().filter_map(|s| s.distance_m)),
        nees: mean(by_step.iter().filter_map(|s| s.nees)),
        conflict: mean(by_step.iter().filter_map(|s| s.conflict)),
        gain: None,
        escape: by_step.iter().find_map(|s| s.escape),
    };
    Ok(EpisodeScore {
        steps: sheet.steps,
        scores,
        by_step,
        flags: sheet.flags,
        fault: None,
    })
}

fn mean(values: impl Iterator<Item = f32>) -> Option<f32> {
    let (mut sum, mut count) = (0.0_f64, 0_u32);
    for value in values.filter(|value| value.is_finite()) {
        sum += f64::from(value);
        count += 1;
    }
    (count > 0).then(|| (sum / f64::from(count)) as f32)
}

/// The scores with the gain over the model that sees frames alone: its mean squared error less this one's (D23).
pub fn with_gain(
    scores: &[Option<Arc<EpisodeScore>>],
    vision: &[Option<Arc<EpisodeScore>>],
) -> Vec<Option<Arc<EpisodeScore>>> {
    let gain = |own: &Scores, vision: &Scores| Some(vision.error? - own.error?);
    scores
        .iter()
        .enumerate()
        .map(|(i, score)| {
            let score = score.as_ref()?;
            let Some(Some(vision)) = vision.get(i) else {
                return Some(Arc::clone(score));
            };
            let mut score = EpisodeScore::clone(score);
            score.scores.gain = gain(&score.scores, &vision.scores);
            for (own, vision) in score.by_step.iter_mut().zip(&vision.by_step) {
                own.gain = gain(own, vision);
            }
            Some(Arc::new(score))
        })
        .collect()
}

/// Beliefs of all episodes, for what is known of the latent.
#[derive(Default)]
pub struct Collected {
    stats: LatentStats,
    /// Every `stride`-th belief with its position.
    beliefs: Vec<(Vec<f32>, [f32; 2])>,
    stride: usize,
    seen: usize,
    episodes: usize,
}

impl Collected {
    /// Adds an episode.
    pub fn take(&mut self, sheet: &Sheet, predictor: &dyn Predictor) {
        let Ok(inferred) = sheet.infer_as_trained(predictor) else {
            return;
        };
        self.episodes += 1;
        for step in 0..sheet.steps {
            let Some(belief) = inferred.belief_at(step) else {
                continue;
            };
            let mean = inferred.posterior(belief).mean;
            self.stats.push(mean);
            if let Some(truth) = sheet.truth_m(step) {
                self.keep(mean, truth);
            }
        }
    }

    /// Keeps a belief; where there are too many, every other one goes, and only every other one comes from then on.
    fn keep(&mut self, mean: &[f32], truth_m: [f32; 2]) {
        self.stride = self.stride.max(1);
        if self.seen.is_multiple_of(self.stride) {
            self.beliefs.push((mean.to_vec(), truth_m));
        }
        self.seen += 1;
        if self.beliefs.len() > SHUFFLED {
            let mut at = 0;
            self.beliefs.retain(|_| {
                at += 1;
                at % 2 == 1
            });
            self.stride *= 2;
        }
    }

    /// What they say.
    pub fn known(self, predictor: &dyn Predictor) -> Known {
        let probe = predictor.position_weights().zip(predictor.position_bias());
        let importance_m = probe
            .map(|(weights, bias)| permutation_importance(weights, bias, &self.beliefs, SHUFFLE));
        Known {
            stats: self.stats,
            importance_m: importance_m.unwrap_or_default(),
            episodes: self.episodes,
        }
    }
}
