//! What only some views show: every set of experts, the spread of the rollout, the response to damage.

use std::sync::Arc;

use super::Look;
use crate::episode::Episode;
use crate::session::worker::answer::{Answer, Request};
use crate::session::worker::lattice::Lattice;
use crate::session::worker::memo::RolloutKey;
use crate::session::worker::opened::Opened;
use crate::session::worker::response::{ResponseKey, respond};
use crate::session::worker::spread::{Spread, SpreadKey};
use crate::session::worker::{Stop, Worker};

impl Worker {
    /// Every set of experts at the cursor.
    pub(super) fn lattice(
        &mut self,
        request: &Request,
        look: &Look,
        opened: &Opened,
        answer: &mut Answer,
    ) -> Result<(), Stop> {
        let predictor = look.predictor.as_ref();
        if !request.wants.lattice || !predictor.info().has_product() {
            return Ok(());
        }
        let sight = &look.key.sight;
        let Some(inferred) = self.memo.inferred(&look.key) else {
            return Ok(());
        };
        if self.memo.lattices.get(sight).is_none() {
            let Some(lattice) = Lattice::of(&inferred.trace, opened, predictor)? else {
                return Ok(());
            };
            let keep = || Ok::<_, Stop>(lattice);
            self.memo.lattices.get_or_try_insert(sight.clone(), keep)?;
            self.check()?;
        }
        let Some(lattice) = self.memo.lattices.get(sight) else {
            return Ok(());
        };
        let step = request.cursor.max(predictor.info().frame_stack);
        let current = &inferred.alphas;
        answer.lattice = lattice.at(step, current, opened, predictor)?.map(Arc::new);
        Ok(())
    }

    /// The rollout's spread in three ways, with its samples at the cursor.
    pub(super) fn spread(
        &mut self,
        request: &Request,
        look: &Look,
        opened: &Opened,
        answer: &mut Answer,
    ) -> Result<(), Stop> {
        let predictor = look.predictor.as_ref();
        if !request.wants.spread || look.rollout.rollout.horizon == 0 {
            return Ok(());
        }
        let Some(inferred) = self.memo.inferred(&look.key) else {
            return Ok(());
        };
        let mean = RolloutKey {
            sample: None,
            ..look.rollout
        };
        let key = SpreadKey {
            belief: look.key.clone(),
            rollout: mean,
            samples: request.settings.sampling.count,
            seed: request.settings.sampling.seed,
        };
        self.check()?;
        // Its picture under the cursor is what the samples' pictures are compared with.
        self.memo
            .roll_out(&look.key, mean, opened.steps(), predictor)?;
        let mean_path = match self.memo.rolled_out(&look.key, mean) {
            Some(pictured) => {
                pictured.decode(predictor, &[request.cursor], &opened.truth)?;
                pictured.frame(request.cursor)
            }
            None => None,
        };
        let make = || Spread::of(&key, &inferred, predictor);
        let spread = self.memo.spreads.get_or_try_insert(key.clone(), make)?;
        let view = spread.at(request.cursor, opened, mean_path.as_deref(), predictor)?;
        answer.spread = Some(Arc::new(view));
        Ok(())
    }

    /// Lets each damage rise from none to all of it; the last thing that is done, for it encodes many times.
    pub(super) fn respond(
        &mut self,
        request: &Request,
        look: &Look,
        episode: &Arc<Episode>,
        opened: &Opened,
        answer: &mut Answer,
    ) -> Result<(), Stop> {
        if !request.wants.response {
            return Ok(());
        }
        let Some(inferred) = self.memo.inferred(&look.key) else {
            return Ok(());
        };
        let mut responses = Vec::new();
        for &damage in &look.key.sight.damage {
            // The damage rises through every severity, whatever the present one is.
            let mut belief = look.key.clone();
            for (modality, corruption) in &mut belief.sight.damage {
                if *modality == damage.0 {
                    corruption.severity = 0.0;
                }
            }
            let key = ResponseKey {
                belief,
                modality: damage.0,
            };
            if let Some(view) = self.memo.responses.get(&key) {
                responses.push(view.clone());
                continue;
            }
            self.publish(answer);
            let others = look.key.sight.damage.iter().copied();
            let others: Vec<_> = others
                .filter(|(modality, _)| *modality != damage.0)
                .collect();
            let episode = self.memo.damaged(request.target.episode, episode, &others);
            let episode = episode.as_ref();
            let predictor = look.predictor.as_ref();
            let check = || self.check();
            if let Some(view) = respond(damage, episode, &inferred, opened, predictor, check)? {
                let keep = || Ok::<_, Stop>(view.clone());
                self.memo.responses.get_or_try_insert(key, keep)?;
                responses.push(view);
            }
        }
        answer.responses = Arc::new(responses);
        Ok(())
    }
}
