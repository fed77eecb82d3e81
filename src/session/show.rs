//! The snapshot: what is known, put where faces look for it.

use std::sync::Arc;

use super::Session;
use super::badge::badge;
use super::settings::{Rollout, Settings};
use super::snapshot::other::OtherView;
use super::snapshot::{
    Badge, ErrorOf, Estimate, ExpertView, FrameRow, LatentView, Message, ModelInfo, PositionView,
    SignedFrame, Snapshot, estimate_at,
};
use super::worker::{Answer, Inferred, Opened, Pictures};
use crate::episode::{EpisodeSource, Frame};
use crate::measure::fusion::mean_share;

impl Session {
    /// Context and horizon fitted to the present episode.
    pub(super) fn rollout(&self) -> Rollout {
        let steps = self.steps();
        let frame_stack = self.first_belief();
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
        let first_belief = self.first_belief();
        let badge_of = |model: &Arc<ModelInfo>| {
            let first = model.frame_stack;
            badge(model, &self.settings.switches, first, cursor.max(first))
        };
        let inferred = answer.and_then(|answer| answer.inferred.as_deref());
        let at_cursor = inferred.zip(cursor.checked_sub(first_belief));
        let message = self.line(answer.and_then(|answer| answer.fault.clone()));
        let readings = answer.and_then(|answer| answer.readings.as_deref());
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
            badge: self.model().map_or(Badge::NoProduct, badge_of),
            frames: answer
                .map(|answer| FrameRow {
                    input: input(answer, cursor),
                    ..frame_row(&answer.pictures, cursor)
                })
                .unwrap_or_default(),
            strip: answer
                .map(|answer| Arc::clone(&answer.pictures.strip))
                .unwrap_or_default(),
            position: answer.and_then(|a| position_view(a.opened.as_ref()?, &a.pictures, cursor)),
            belief: at_cursor
                .map(|(inferred, belief)| latent_view(inferred.beliefs.posterior.row(belief))),
            psnr_db: answer
                .map(|answer| Arc::clone(&answer.pictures.psnr_db))
                .unwrap_or_default(),
            fusion: readings.and_then(|readings| readings.fusion.get(cursor)?.clone()),
            series: readings.map(|readings| Arc::clone(&readings.series)),
            lattice: answer.and_then(|answer| answer.lattice.clone()),
            spread: answer.and_then(|answer| answer.spread.clone()),
            responses: answer
                .map(|answer| Arc::clone(&answer.responses))
                .unwrap_or_default(),
            board: self.board.clone().filter(|_| self.wants.board),
            table: Arc::clone(self.table.view()),
            other: answer
                .and_then(|answer| {
                    let model = self.models.get(answer.other.as_ref()?.model)?;
                    other_view(answer, cursor, badge_of(model))
                })
                .map(Arc::new),
            events: self.events(),
            corruptions: self
                .settings
                .corruptions
                .iter()
                .map(|(&modality, &corruption)| (modality, corruption))
                .collect(),
            control_edit: self.settings.controls,
            sampling: self.settings.sampling,
            selection: self.playback.selection.map(|(first, last)| {
                let last = last.unwrap_or(cursor);
                (first.min(last), first.max(last))
            }),
            // What stands on its own account, as a fault does, is told once.
            told: if message == self.message {
                self.told
            } else {
                0
            },
            message,
            busy: self.is_busy(),
            current: self.is_current(),
            state: self.state().to_string(),
            ..empty(self.source.as_ref(), &[])
        }
    }

    /// Whether the newest answer has the images at the cursor, or will never have them.
    fn is_current(&self) -> bool {
        let Some(answer) = self.answered().filter(|a| a.generation == self.generation) else {
            return false;
        };
        let cursor = self.playback.cursor;
        let cell = answer.pictures.strip.get(cursor);
        let first_belief = self.first_belief();
        answer.done || cell.is_some_and(|cell| cell.belief.is_some() || cursor < first_belief)
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
        let alphas = model.counted(&self.settings.switches, step);
        let at_cursor = inferred.zip(self.playback.cursor.checked_sub(model.frame_stack));
        let shares = at_cursor.map(|(inferred, belief)| inferred.shares(belief));
        let position = at_cursor.zip(shares.as_ref());
        let position = position.and_then(|((inferred, belief), shares)| {
            let weights = self.position_weights.get(self.target.model)?.as_deref()?;
            inferred.position_shares(belief, shares, weights)
        });
        let view = |(i, expert)| {
            let share: Vec<f32> = shares
                .as_ref()
                .and_then(|rows| rows.get(i).cloned())
                .unwrap_or_default();
            ExpertView {
                expert,
                alpha: alphas[i],
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
        episode_count: source.metas().len(),
        speed: 1.0,
        ..Snapshot::default()
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
        log_var: log_var.to_vec(),
    }
}

fn frame_row(pictures: &Pictures, cursor: usize) -> FrameRow {
    let Some(cell) = pictures.strip.get(cursor) else {
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
        error: compared.and_then(|frame| difference(frame, &cell.truth)),
        error_of,
        input: None,
    }
}

/// The frame that the model sees, where it is not the recorded one.
fn input(answer: &Answer, cursor: usize) -> Option<Arc<Frame>> {
    let input = answer.input.get(cursor)?;
    let truth = answer.opened.as_ref()?.truth.get(cursor)?;
    (input != truth).then(|| Arc::clone(input))
}

fn difference(shown: &Frame, truth: &Frame) -> Option<Arc<SignedFrame>> {
    SignedFrame::between(shown, truth).map(Arc::new)
}

fn position_view(opened: &Opened, pictures: &Pictures, cursor: usize) -> Option<PositionView> {
    let belief = Arc::clone(pictures.belief_positions.as_ref()?);
    let prediction = pictures.rollout_positions.clone().unwrap_or_default();
    let error_m = |estimates: &[Option<Estimate>]| {
        let (estimate, truth) = (estimate_at(estimates, cursor)?, opened.poses.get(cursor)?);
        Some(estimate.distance_m([truth.x, truth.y]))
    };
    Some(PositionView {
        truth: Arc::clone(&opened.poses),
        tip: Arc::clone(&opened.tip),
        belief_error_m: error_m(&belief),
        prediction_error_m: error_m(&prediction),
        belief,
        prediction,
        recorded_controls: pictures.recorded_positions.clone().unwrap_or_default(),
    })
}

/// The second model beside the first.
fn other_view(answer: &Answer, cursor: usize, badge: Badge) -> Option<OtherView> {
    let other = answer.other.as_ref()?;
    let (own, beside) = (
        answer.pictures.strip.get(cursor)?,
        other.pictures.strip.get(cursor),
    );
    let pair = beside.and_then(|beside| {
        let predictions = own.prediction.as_ref().zip(beside.prediction.as_ref());
        predictions.or_else(|| own.belief.as_ref().zip(beside.belief.as_ref()))
    });
    Some(OtherView {
        model: other.model,
        frames: frame_row(&other.pictures, cursor),
        difference: pair.and_then(|(own, beside)| difference(own, beside)),
        strip: Arc::clone(&other.pictures.strip),
        position: position_view(answer.opened.as_ref()?, &other.pictures, cursor),
        psnr_db: Arc::clone(&other.pictures.psnr_db),
        badge,
        fault: other.fault.clone(),
    })
}
