//! The order of the work: what is under the cursor first, what only some views show later, all other frames last.

mod extras;

use std::sync::Arc;

use super::answer::{Answer, Other, Pictures, Request};
use super::memo::{BeliefKey, RolloutKey};
use super::opened::Opened;
use super::readings::{self, ReadingsKey};
use super::{Stop, Worker};
use crate::episode::{Episode, Layout};
use crate::modality::Modality;
use crate::session::predict::Predictor;
use crate::session::snapshot::{StepPsnr, StripCell};

/// Frames decoded between two looks for a newer request.
const DECODED_AT_ONCE: usize = 4;

/// A model on an episode, filtered and rolled out.
struct Look {
    predictor: Arc<dyn Predictor>,
    key: BeliefKey,
    rollout: RolloutKey,
}

impl Worker {
    /// Does all that a request asks for, publishing as it goes.
    pub(super) fn compute(&mut self, request: &Request, answer: &mut Answer) -> Result<(), Stop> {
        let target = request.target;
        let predictor = self.predictors.get(target.model).map(Arc::clone);
        let layout = predictor
            .as_ref()
            .map_or_else(Layout::default, |p| p.layout());
        let episode = self
            .memo
            .episode(self.source.as_ref(), target.episode, layout)?;
        let opened = self.memo.opened(target, &episode, predictor.as_deref());
        answer.pictures.strip = Arc::new(strip(&opened));
        answer.opened = Some(Arc::clone(&opened));
        let Some(predictor) = predictor else {
            return Ok(());
        };
        answer.input = self.input(request, &episode);
        // After a switch or a newer model the face keeps what it shows until there are new beliefs; an episode that is
        // yet to be encoded shows its recording first.
        if self.shown.get() != Some(target) && !self.memo.is_encoded(target) {
            self.publish(answer);
        }
        self.check()?;
        let look = self.look(request, target.model, predictor, &episode, &opened)?;
        self.picture(&look, &[request.cursor], &opened, &mut answer.pictures)?;
        answer.inferred = self.memo.inferred(&look.key);
        self.publish(answer);
        self.check()?;
        self.read(request, &look, &opened, answer)?;
        let mut other = self.other(request, answer);
        if let Some((look, opened)) = &other
            && !self.picture_other(look, &[request.cursor], opened, answer)?
        {
            other = None;
        }
        self.publish(answer);
        self.check()?;
        self.lattice(request, &look, &opened, answer)?;
        self.spread(request, &look, &opened, answer)?;
        loop {
            let mut left = self.undecoded(&look, request.cursor);
            left.truncate(DECODED_AT_ONCE);
            let mut left_of_other = other
                .as_ref()
                .map(|(look, _)| self.undecoded(look, request.cursor))
                .unwrap_or_default();
            left_of_other.truncate(DECODED_AT_ONCE);
            if left.is_empty() && left_of_other.is_empty() {
                return self.respond(request, &look, &episode, &opened, answer);
            }
            self.publish(answer);
            self.check()?;
            if left.is_empty() {
                if let Some((look, opened)) = &other
                    && !self.picture_other(look, &left_of_other, opened, answer)?
                {
                    other = None;
                }
            } else {
                self.picture(&look, &left, &opened, &mut answer.pictures)?;
            }
        }
    }

    /// The frames that the model sees, where vision is damaged.
    fn input(
        &mut self,
        request: &Request,
        episode: &Arc<Episode>,
    ) -> Arc<Vec<Arc<crate::episode::Frame>>> {
        let Some(&corruption) = request.settings.corruptions.get(&Modality::Vision) else {
            return Arc::default();
        };
        let damage = [(Modality::Vision, corruption)];
        let seen = self.memo.damaged(request.target.episode, episode, &damage);
        Arc::new(seen.frames.iter().cloned().map(Arc::new).collect())
    }

    /// Encodes, filters and rolls out.
    fn look(
        &mut self,
        request: &Request,
        model: usize,
        predictor: Arc<dyn Predictor>,
        episode: &Arc<Episode>,
        opened: &Opened,
    ) -> Result<Look, Stop> {
        let info = predictor.info();
        let steps = opened.steps();
        if !opened.view.missing.is_empty() {
            return Err(Stop::Fault(format!(
                "{} needs {}, which this recording lacks; `poescope info` lists its topics",
                info.name,
                opened.view.missing.join(", ")
            )));
        }
        if steps <= info.frame_stack {
            let needed = info.frame_stack + 1;
            return Err(Stop::Fault(format!(
                "{} needs {needed} frames, this episode has {steps}",
                info.name
            )));
        }
        let sight = request.sight(model);
        let trace = self.memo.trace(&sight, episode, predictor.as_ref())?;
        self.check()?;
        let settings = &request.settings;
        if info.silent_step(&settings.switches).is_some() {
            // The model under the cursor never is; one beside it may be, by switches that suit the other.
            let what = format!("the switches leave {} without an active expert", info.name);
            return Err(Stop::Fault(what));
        }
        let alphas = info.alphas(&settings.switches, steps - info.frame_stack);
        let key = self
            .memo
            .believe(&sight, &trace, alphas, steps, predictor.as_ref())?;
        let rollout = RolloutKey {
            rollout: settings.rollout(steps, info.frame_stack),
            controls: settings.controls.filter(|edit| !edit.is_identity()),
            sample: settings.sampling.shown.then_some(settings.sampling.seed),
        };
        self.memo
            .roll_out(&key, rollout, steps, predictor.as_ref())?;
        if rollout.controls.is_some() {
            self.memo
                .roll_out(&key, recorded(rollout), steps, predictor.as_ref())?;
        }
        Ok(Look {
            predictor,
            key,
            rollout,
        })
    }

    /// Decodes some steps, and puts together what there is of all of them.
    fn picture(
        &mut self,
        look: &Look,
        steps: &[usize],
        opened: &Opened,
        pictures: &mut Pictures,
    ) -> Result<(), Stop> {
        let mut cells = strip(opened);
        let mut psnr_db = vec![StepPsnr::default(); opened.steps()];
        if let Some(believed) = self.memo.believed(&look.key) {
            let pictured = &mut believed.pictured;
            pictured.decode(look.predictor.as_ref(), steps, &opened.truth)?;
            for step in pictured.range() {
                cells[step].belief = pictured.frame(step);
                psnr_db[step].belief = pictured.psnr_db(step);
            }
            pictures.belief_positions.clone_from(&pictured.positions);
        }
        if let Some(pictured) = self.memo.rolled_out(&look.key, look.rollout) {
            pictured.decode(look.predictor.as_ref(), steps, &opened.truth)?;
            for step in pictured.range() {
                cells[step].prediction = pictured.frame(step);
                psnr_db[step].prediction = pictured.psnr_db(step);
            }
            pictures.rollout_positions.clone_from(&pictured.positions);
        }
        if look.rollout.controls.is_some()
            && let Some(pictured) = self.memo.rolled_out(&look.key, recorded(look.rollout))
        {
            pictures.recorded_positions.clone_from(&pictured.positions);
        }
        pictures.strip = Arc::new(cells);
        pictures.psnr_db = Arc::new(psnr_db);
        Ok(())
    }

    /// Steps of which a frame is yet to be decoded, the nearest to the cursor first.
    fn undecoded(&mut self, look: &Look, cursor: usize) -> Vec<usize> {
        let mut left = Vec::new();
        if let Some(believed) = self.memo.believed(&look.key) {
            left.extend(believed.pictured.undecoded());
        }
        if let Some(pictured) = self.memo.rolled_out(&look.key, look.rollout) {
            left.extend(pictured.undecoded());
        }
        left.sort_by_key(|step| (step.abs_diff(cursor), *step));
        left.dedup();
        left
    }

    fn read(
        &mut self,
        request: &Request,
        look: &Look,
        opened: &Opened,
        answer: &mut Answer,
    ) -> Result<(), Stop> {
        let Some(inferred) = self.memo.inferred(&look.key) else {
            return Ok(());
        };
        let known = request.known.as_deref();
        let key = ReadingsKey {
            belief: look.key.clone(),
            known: known.map(|known| known.episodes),
        };
        let read = || readings::read(&inferred, opened, known, look.predictor.as_ref());
        let readings = self
            .memo
            .readings
            .get_or_try_insert(key, || read().map(Arc::new))?;
        answer.readings = Some(Arc::clone(readings));
        Ok(())
    }

    /// The second model; what it cannot do is said beside it and stops nothing.
    fn other(&mut self, request: &Request, answer: &mut Answer) -> Option<(Look, Arc<Opened>)> {
        let model = request.other?;
        let predictor = self.predictors.get(model).map(Arc::clone)?;
        let mut look = || {
            let target = request.sight(model).target;
            let layout = predictor.layout();
            let episode = self
                .memo
                .episode(self.source.as_ref(), target.episode, layout)?;
            let opened = self.memo.opened(target, &episode, Some(predictor.as_ref()));
            let look = self.look(request, model, Arc::clone(&predictor), &episode, &opened)?;
            Ok((look, opened))
        };
        match look() {
            Ok(found) => Some(found),
            // The check that comes next ends the work.
            Err(Stop::Interrupted) => None,
            Err(Stop::Fault(fault)) => {
                answer.other = Some(Other {
                    model,
                    pictures: Pictures::default(),
                    fault: Some(fault),
                });
                None
            }
        }
    }

    /// Decodes for the model beside; false where it cannot, which is said beside it and stops nothing.
    fn picture_other(
        &mut self,
        look: &Look,
        steps: &[usize],
        opened: &Opened,
        answer: &mut Answer,
    ) -> Result<bool, Stop> {
        let other = answer.other.take();
        let mut pictures = other.map(|other| other.pictures).unwrap_or_default();
        let fault = match self.picture(look, steps, opened, &mut pictures) {
            Ok(()) => None,
            Err(Stop::Fault(fault)) => Some(fault),
            Err(interrupted) => return Err(interrupted),
        };
        let can = fault.is_none();
        answer.other = Some(Other {
            model: look.key.sight.target.model,
            pictures,
            fault,
        });
        Ok(can)
    }
}

/// The mean path under the recorded controls.
fn recorded(rollout: RolloutKey) -> RolloutKey {
    RolloutKey {
        controls: None,
        ..rollout
    }
}

/// A row with nothing decoded yet.
fn strip(opened: &Opened) -> Vec<StripCell> {
    let truth = opened.truth.iter().map(Arc::clone).enumerate();
    truth
        .map(|(step, truth)| StripCell {
            step,
            truth,
            belief: None,
            prediction: None,
        })
        .collect()
}
