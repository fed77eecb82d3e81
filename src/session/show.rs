//! The snapshot: what is known, put where faces look for it.

use std::sync::Arc;

use super::Session;
use super::badge::badge;
use super::settings::{Rollout, Sampling, Settings};
use super::snapshot::{
    Badge, ErrorOf, Estimate, ExpertView, FrameRow, LatentView, Message, ModelInfo, PositionView,
    SignedFrame, Snapshot,
};
use super::worker::{Answer, Inferred};
use crate::episode::{EpisodeSource, Frame};
use crate::measure::frame::signed_difference;
use crate::measure::fusion::{mean_share, position_shares, precision_shares};

impl Session {
    /// Context and horizon fitted to the present episode.
    pub(super) fn rollout(&self) -> Rollout {
        let steps = self.opened().map_or(0, |opened| opened.steps());
        let frame_stack = self.model().map_or(0, |model| model.frame_stack);
        self.settings.rollout(steps, frame_stack)
    }

    /// Puts the snapshot together.
    pub(super) fn show(&self) -> Snapshot {
        let (answer, opened) = (self.answered(), self.opened());
        let cursor = self.playback.cursor;
        let rollout = match opened {
            Some(_) => self.rollout(),
            None => wished_rollout(&self.settings),
        };
        let first_belief = self.model().map_or(0, |model| model.frame_stack);
        let badge_step = cursor.max(first_belief);
        let inferred = answer.and_then(|answer| answer.inferred.as_deref());
        let at_cursor = inferred.zip(cursor.checked_sub(first_belief));
        let fault = answer.and_then(|answer| answer.fault.clone());
        Snapshot {
            models: self.models.clone(),
            model: self.target.model,
            episode: opened.map(|opened| Arc::clone(&opened.view)),
            episode_index: self.target.episode,
            cursor,
            playing: self.playback.playing,
            speed: self.playback.speed(),
            looping: self.playback.looping,
            scope: self.settings.scope,
            context: rollout.start + 1,
            horizon: rollout.horizon,
            start: rollout.start,
            experts: self.expert_views(inferred),
            badge: self.model().map_or(Badge::NoProduct, |m| {
                badge(m, &self.settings.switches, first_belief, badge_step)
            }),
            frames: answer
                .map(|answer| frame_row(answer, cursor))
                .unwrap_or_default(),
            strip: answer
                .map(|answer| Arc::clone(&answer.strip))
                .unwrap_or_default(),
            position: answer.and_then(|answer| position_view(answer, cursor)),
            belief: at_cursor
                .map(|(inferred, belief)| latent_view(inferred.beliefs.posterior.row(belief))),
            psnr_db: answer
                .map(|answer| Arc::clone(&answer.psnr_db))
                .unwrap_or_default(),
            message: self.line(fault),
            busy: self.is_busy(),
            state: self.state().to_string(),
            ..empty(self.source.as_ref(), &[])
        }
    }

    /// A refusal first, for it answers the last key; then what went wrong; then what went well.
    fn line(&self, fault: Option<String>) -> Option<Message> {
        let fault = fault.map(|text| Message { error: true, text });
        let (refusal, other) = match self.message.clone() {
            Some(message) if message.error => (Some(message), None),
            other => (None, other),
        };
        refusal.or(fault).or(other)
    }

    fn expert_views(&self, inferred: Option<&Inferred>) -> Vec<ExpertView> {
        let Some(model) = self.model() else {
            return Vec::new();
        };
        let step = self.playback.cursor.max(model.frame_stack);
        let at_cursor = inferred.zip(self.playback.cursor.checked_sub(model.frame_stack));
        let shares = at_cursor.map(|(inferred, belief)| {
            let alphas = inferred.factor_alphas(belief, model.prior_expert);
            precision_shares(&alphas, &inferred.log_vars(belief))
        });
        let position = at_cursor
            .zip(shares.as_ref())
            .and_then(|((inferred, belief), shares)| {
                let weights = self.position_weights.get(self.target.model)?.as_deref()?;
                let log_var = inferred.beliefs.posterior.row(belief).1;
                let variance: Vec<f32> = log_var.iter().map(|v| v.exp()).collect();
                position_shares(shares, weights, &variance)
            });
        let view = |(i, expert)| {
            let share: Vec<f32> = shares
                .as_ref()
                .and_then(|rows| rows.get(i).cloned())
                .unwrap_or_default();
            ExpertView {
                expert,
                alpha: model.alpha(&self.settings.switches, expert, step),
                latent: at_cursor.map(|(inferred, belief)| {
                    let sensors = inferred.trace.experts.get(i);
                    let gaussians = sensors.unwrap_or(&inferred.beliefs.prior);
                    latent_view(gaussians.row(belief))
                }),
                share_mean: mean_share(&share),
                share,
                share_position: position
                    .as_ref()
                    .and_then(|position| position.get(i))
                    .copied(),
                share_over_time: inferred
                    .and_then(|inferred| inferred.share_over_time.get(i))
                    .map(Arc::clone)
                    .unwrap_or_default(),
            }
        };
        model
            .all_experts()
            .into_iter()
            .enumerate()
            .map(view)
            .collect()
    }
}

/// A snapshot of nothing yet.
pub(super) fn empty(source: &dyn EpisodeSource, models: &[Arc<ModelInfo>]) -> Snapshot {
    Snapshot {
        dataset: source.name().to_owned(),
        models: models.to_vec(),
        model: 0,
        episode: None,
        episode_index: 0,
        episode_count: source.metas().len(),
        cursor: 0,
        playing: false,
        speed: 1.0,
        looping: super::command::Looping::default(),
        scope: super::command::Scope::default(),
        context: 0,
        horizon: 0,
        start: 0,
        experts: Vec::new(),
        badge: Badge::NoProduct,
        frames: FrameRow::default(),
        strip: Arc::default(),
        position: None,
        belief: None,
        psnr_db: Arc::default(),
        fusion: None,
        series: None,
        lattice: None,
        spread: None,
        board: None,
        table: Arc::default(),
        other: None,
        events: Arc::default(),
        corruptions: Vec::new(),
        control_edit: None,
        sampling: Sampling::default(),
        selection: None,
        message: None,
        busy: false,
        state: String::new(),
    }
}

/// Before the episode's length is known.
fn wished_rollout(settings: &Settings) -> Rollout {
    Rollout {
        start: settings.context.saturating_sub(1),
        horizon: settings.horizon,
    }
}

fn latent_view((mean, log_var): (&[f32], &[f32])) -> LatentView {
    LatentView {
        mean: mean.to_vec(),
        sigma: log_var.iter().map(|v| (0.5 * v).exp()).collect(),
    }
}

fn frame_row(answer: &Answer, cursor: usize) -> FrameRow {
    let Some(cell) = answer.strip.get(cursor) else {
        return FrameRow::default();
    };
    let (compared, error_of) = match &cell.prediction {
        Some(prediction) => (Some(prediction), ErrorOf::Prediction),
        None => (cell.belief.as_ref(), ErrorOf::Belief),
    };
    FrameRow {
        truth: Some(Arc::clone(&cell.truth)),
        belief: cell.belief.clone(),
        prediction: cell.prediction.clone(),
        error: compared.and_then(|frame| signed_frame(frame, &cell.truth)),
        error_of,
        input: None,
    }
}

fn signed_frame(frame: &Frame, truth: &Frame) -> Option<Arc<SignedFrame>> {
    let values = signed_difference(frame, truth)?;
    Some(Arc::new(SignedFrame {
        width: frame.width,
        height: frame.height,
        values,
    }))
}

fn position_view(answer: &Answer, cursor: usize) -> Option<PositionView> {
    let opened = answer.opened.as_ref()?;
    let belief = Arc::clone(answer.belief_positions.as_ref()?);
    let prediction = answer.rollout_positions.clone().unwrap_or_default();
    let error_m = |estimates: &[Option<Estimate>]| {
        let (estimate, truth) = ((*estimates.get(cursor)?)?, opened.poses.get(cursor)?);
        Some((estimate.x - truth.x).hypot(estimate.y - truth.y))
    };
    Some(PositionView {
        truth: Arc::clone(&opened.poses),
        tip: Arc::clone(&opened.tip),
        belief_error_m: error_m(&belief),
        prediction_error_m: error_m(&prediction),
        belief,
        prediction,
        recorded_controls: Arc::default(),
    })
}
