//! Models that change while they are looked at: a training run leaves a newer checkpoint now and then.

use std::sync::Arc;

use super::Session;
use super::predict::Predictor;
use super::worker::{Found, Shared};
use crate::lock::lock;

/// Hands newer models to a session, from another thread.
#[derive(Clone)]
pub struct Renewal(Arc<Shared>);

impl Renewal {
    /// Puts a newer one in the place of model `index`, or tells why it cannot be had. The face is woken, and takes it
    /// in when it next looks; of several until then the newest counts.
    pub fn offer(&self, index: usize, found: Found) {
        lock(&self.0.renewed).insert(index, found);
        self.0.wake();
    }
}

impl Session {
    /// For whoever watches the models.
    pub fn renewal(&self) -> Renewal {
        Renewal(Arc::clone(&self.shared))
    }

    /// Takes newer models in; true if there was one. Cursor, episode and switches stay as they are, and so does the
    /// picture until the new model has made its own.
    pub(super) fn take_renewed(&mut self) -> bool {
        let renewed = std::mem::take(&mut *lock(&self.shared.renewed));
        let any = !renewed.is_empty();
        for (index, found) in renewed {
            match found {
                Ok(predictor) => self.succeed(index, predictor),
                Err(why) => self.complain(why),
            }
        }
        any
    }

    fn succeed(&mut self, index: usize, predictor: Arc<dyn Predictor>) {
        let Some(info) = self.models.get_mut(index) else {
            return;
        };
        *info = Arc::new(predictor.info().clone());
        self.position_weights[index] = predictor.position_weights().map(Arc::from);
        self.shared.replace_model(index, Arc::clone(&predictor));
        self.survey_anew(index, &predictor);
        lock(&self.shared.successors).insert(index, predictor);
        if index == self.target.model || Some(index) == self.other() {
            // What was wanted is wanted again.
            self.wanted = None;
            self.repair();
        }
    }
}
