//! Looks at every episode of the dataset in the background: scores for the table and the queue of failures, what is
//! known of the latent, and consistency over a split.
//!
//! A thread of its own, so that a key never waits for it, and so polite that it stands still while the session's worker
//! has something to do. Scores are kept in a [`Cache`] by model and data hash; what they were made of is not.

mod board;
mod cache;
mod score;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

pub use cache::Cache;
use score::Sheet;

use super::known::Known;
use super::predict::Predictor;
use super::settings::Settings;
use super::snapshot::board::BoardView;
use super::snapshot::table::EpisodeScore;
use super::worker::{Mailbox, Shared};
use crate::episode::{EpisodeSource, Split};
use crate::lock::lock;

/// Name of the thread.
pub const THREAD: &str = "poescope-survey";
/// Time between two publications while it works.
const PERIOD: Duration = Duration::from_millis(100);
/// Results after which the scores are kept, should the program end before all are there.
const KEPT_EVERY: usize = 256;
/// What the experts say is kept of so many steps a model, some 100 MB; episodes beyond are encoded again.
const KEPT_STEPS: usize = 1 << 18;
/// How long it sleeps before it looks again whether the worker is done.
const PATIENCE: Duration = Duration::from_micros(500);

/// What is to be looked at.
#[derive(Clone, Debug)]
pub struct SurveyRequest {
    /// Rises with each change.
    pub generation: u64,
    /// With which model.
    pub model: usize,
    /// The model that sees frames alone, for the gain over it.
    pub vision: Option<usize>,
    /// Whose consistency, where that is looked at.
    pub board: Option<BoardRequest>,
}

/// Consistency of which switches over which episodes.
#[derive(Clone, Debug)]
pub struct BoardRequest {
    /// Switches, context and horizon.
    pub settings: Settings,
    /// Episodes of this split; all where the data name none.
    pub split: Option<Split>,
}

/// What has been found out so far.
#[derive(Clone, Debug)]
pub struct SurveyAnswer {
    /// Of which request.
    pub generation: u64,
    /// With which model.
    pub model: usize,
    /// One an episode.
    pub scores: Arc<Vec<Option<Arc<EpisodeScore>>>>,
    /// How many are there.
    pub scored: usize,
    /// Of the latent, once every episode has been looked at.
    pub known: Option<Arc<Known>>,
    /// Consistency, once measured; what there is of it until then.
    pub board: Option<Arc<BoardView>>,
    /// Whether the board is complete.
    pub measured: bool,
    /// Whether nothing more will come.
    pub done: bool,
}

/// What both threads hold.
#[derive(Default)]
pub struct SurveyShared {
    /// To the survey.
    pub requests: Mailbox<SurveyRequest>,
    /// From the survey.
    pub answers: Mailbox<SurveyAnswer>,
    /// Newer models, to be taken in before the next request.
    pub successors: Mutex<BTreeMap<usize, Arc<dyn Predictor>>>,
}

/// Starts the thread; it ends when the mailbox of requests is closed. `worker` is whom it gives way to, and whose face
/// it wakes.
pub fn spawn(
    shared: Arc<SurveyShared>,
    worker: Arc<Shared>,
    source: Arc<dyn EpisodeSource>,
    predictors: Vec<Arc<dyn Predictor>>,
    cache: Option<Arc<dyn Cache>>,
) -> std::io::Result<JoinHandle<()>> {
    thread::Builder::new()
        .name(THREAD.to_owned())
        .spawn(move || {
            let mut surveyor = Surveyor {
                scored: predictors.iter().map(|_| Scored::default()).collect(),
                predictors,
                source,
                cache,
                worker,
                board: None,
                measured: false,
                published: Instant::now(),
                shared: Arc::clone(&shared),
            };
            while let Some(request) = shared.requests.wait() {
                surveyor.serve(&request);
            }
        })
}

/// A newer request is there, or the session ends.
struct Interrupted;

/// Does something that may break down.
fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err("the model broke down".to_owned()))
}

/// What a model has made of the episodes.
#[derive(Default)]
struct Scored {
    scores: Vec<Option<Arc<EpisodeScore>>>,
    sheets: Vec<Option<Arc<Sheet>>>,
    known: Option<Arc<Known>>,
    /// Steps of the episodes that `sheets` has.
    kept_steps: usize,
    begun: bool,
    /// Results that came since it began.
    new: usize,
}

struct Surveyor {
    source: Arc<dyn EpisodeSource>,
    predictors: Vec<Arc<dyn Predictor>>,
    cache: Option<Arc<dyn Cache>>,
    worker: Arc<Shared>,
    shared: Arc<SurveyShared>,
    scored: Vec<Scored>,
    board: Option<Arc<BoardView>>,
    /// Whether the board is complete.
    measured: bool,
    published: Instant,
}

impl Surveyor {
    fn serve(&mut self, request: &SurveyRequest) {
        self.take_successors();
        let work = AssertUnwindSafe(|| self.survey(request));
        match catch_unwind(work) {
            Ok(Err(Interrupted)) => {}
            // A model that breaks down on some episode is told by the worker when that episode is shown.
            Ok(Ok(())) | Err(_) => self.publish(request, true),
        }
    }

    fn survey(&mut self, request: &SurveyRequest) -> Result<(), Interrupted> {
        self.board = None;
        self.measured = false;
        if let Some(board) = &request.board {
            self.measure(request, board)?;
        }
        self.measured = true;
        self.score_all(request, request.model)?;
        if let Some(vision) = request.vision.filter(|&vision| vision != request.model) {
            self.score_all(request, vision)?;
        }
        Ok(())
    }

    /// Scores what is not scored yet.
    fn score_all(&mut self, request: &SurveyRequest, model: usize) -> Result<(), Interrupted> {
        let Some(predictor) = self.predictors.get(model).map(Arc::clone) else {
            return Ok(());
        };
        self.begin(model, predictor.as_ref());
        let before = self.scored[model].new;
        let end = self.score_rest(request, model, predictor.as_ref());
        if self.scored[model].new > before {
            self.keep(model, predictor.as_ref());
        }
        end
    }

    fn score_rest(
        &mut self,
        request: &SurveyRequest,
        model: usize,
        predictor: &dyn Predictor,
    ) -> Result<(), Interrupted> {
        for episode in 0..self.source.metas().len() {
            if self.scored[model].scores[episode].is_some() {
                continue;
            }
            self.give_way()?;
            let score = guarded(|| {
                let sheet = self.read(model, episode, predictor)?;
                score::score(&sheet, predictor)
            });
            let score = score.unwrap_or_else(|fault| EpisodeScore {
                fault: Some(fault),
                ..EpisodeScore::default()
            });
            let scored = &mut self.scored[model];
            scored.scores[episode] = Some(Arc::new(score));
            scored.new += 1;
            if scored.new.is_multiple_of(KEPT_EVERY) {
                self.keep(model, predictor);
            }
            self.publish_now_and_then(request);
        }
        if self.scored[model].known.is_none() {
            self.know(model, predictor)?;
            self.scored[model].new += 1;
        }
        Ok(())
    }

    /// Keeps what has been scored so far.
    fn keep(&self, model: usize, predictor: &dyn Predictor) {
        let Some(cache) = &self.cache else { return };
        let scored = &self.scored[model];
        cache::store(
            cache.as_ref(),
            &cache::key(predictor.info(), self.source.data_hash()),
            &scored.scores,
            scored.known.as_deref(),
        );
    }

    /// Takes what the cache has of a model, once.
    fn begin(&mut self, model: usize, predictor: &dyn Predictor) {
        let count = self.source.metas().len();
        let scored = &mut self.scored[model];
        if scored.begun {
            return;
        }
        scored.begun = true;
        scored.sheets = vec![None; count];
        scored.scores = vec![None; count];
        let key = cache::key(predictor.info(), self.source.data_hash());
        let kept = self
            .cache
            .as_ref()
            .and_then(|cache| cache::load(cache.as_ref(), &key, count));
        if let Some((scores, known)) = kept {
            scored.scores = scores;
            scored.known = known.map(Arc::new);
        }
    }

    /// What the experts say of an episode, kept.
    fn sheet(
        &mut self,
        model: usize,
        episode: usize,
        predictor: &dyn Predictor,
    ) -> Result<Arc<Sheet>, String> {
        match &self.scored[model].sheets[episode] {
            Some(sheet) => Ok(Arc::clone(sheet)),
            None => self.read(model, episode, predictor).map(Arc::new),
        }
    }

    /// Reads an episode, and encodes it where that was not done before.
    fn read(
        &mut self,
        model: usize,
        episode: usize,
        predictor: &dyn Predictor,
    ) -> Result<Sheet, String> {
        let loaded = self.source.load(episode, predictor.layout());
        let loaded = loaded.map_err(|error| error.to_string())?;
        if let Some(known) = &self.scored[model].sheets[episode] {
            return Ok(Sheet::with(Arc::clone(&known.trace), loaded));
        }
        let sheet = Sheet::of(loaded, predictor)?;
        let scored = &mut self.scored[model];
        if scored.kept_steps + sheet.steps <= KEPT_STEPS {
            scored.kept_steps += sheet.steps;
            scored.sheets[episode] = Some(Arc::new(sheet.without_frames()));
        }
        Ok(sheet)
    }

    /// Statistics of the latent over all episodes.
    fn know(&mut self, model: usize, predictor: &dyn Predictor) -> Result<(), Interrupted> {
        let mut collected = score::Collected::default();
        for episode in 0..self.source.metas().len() {
            self.give_way()?;
            // One that breaks down says so where it is scored.
            let _ = guarded(|| {
                let sheet = self.sheet(model, episode, predictor)?;
                collected.take(&sheet, predictor);
                Ok(())
            });
        }
        self.scored[model].known = Some(Arc::new(collected.known(predictor)));
        Ok(())
    }

    /// Measures consistency over a split.
    fn measure(
        &mut self,
        request: &SurveyRequest,
        wanted: &BoardRequest,
    ) -> Result<(), Interrupted> {
        let Some(predictor) = self.predictors.get(request.model).map(Arc::clone) else {
            return Ok(());
        };
        self.begin(request.model, predictor.as_ref());
        let of_split = |split: Option<Split>| -> Vec<usize> {
            let metas = self.source.metas().iter().enumerate();
            let matching = metas.filter(|(_, meta)| split.is_none() || meta.split == split);
            matching.map(|(i, _)| i).collect()
        };
        let episodes = of_split(wanted.split);
        let val = of_split(Some(Split::Val));
        let mut board = board::Board::new(&wanted.settings, wanted.split, episodes.len());
        for &episode in &episodes {
            self.give_way()?;
            let taken = guarded(|| {
                let sheet = self.sheet(request.model, episode, predictor.as_ref())?;
                board.take(&sheet, predictor.as_ref());
                Ok(())
            });
            if let Err(why) = taken {
                board.leave_out(why);
            }
            self.board = Some(Arc::new(board.progress()));
            self.publish_now_and_then(request);
        }
        let mut view = board.view(predictor.as_ref());
        self.board = Some(Arc::new(view.clone()));
        self.publish(request, false);
        let fit_on = if val.is_empty() { &episodes } else { &val };
        let mut sheets = Vec::new();
        for &episode in fit_on.iter().take(board::FITTED_ON) {
            self.give_way()?;
            sheets.extend(guarded(|| {
                self.sheet(request.model, episode, predictor.as_ref())
            }));
        }
        let name = if val.is_empty() {
            wanted.split.map_or("all", Split::name)
        } else {
            Split::Val.name()
        };
        view.alphas_from = format!("{name}, {} episodes", sheets.len());
        for expert in 0..predictor.info().experts.len() {
            let mut stop = false;
            let fitted = board::fit(
                &wanted.settings,
                &sheets,
                expert,
                predictor.as_ref(),
                || {
                    stop |= self.give_way().is_err();
                    stop
                },
            );
            if stop {
                return Err(Interrupted);
            }
            view.alphas.extend(fitted);
            self.board = Some(Arc::new(view.clone()));
            self.publish_now_and_then(request);
        }
        Ok(())
    }

    /// Stands still while the worker works; ends where a newer request is there.
    fn give_way(&self) -> Result<(), Interrupted> {
        loop {
            if self.shared.requests.calls() {
                return Err(Interrupted);
            }
            if !self.worker.is_working() {
                return Ok(());
            }
            thread::sleep(PATIENCE);
        }
    }

    fn take_successors(&mut self) {
        let successors = std::mem::take(&mut *lock(&self.shared.successors));
        for (model, predictor) in successors {
            if let (Some(slot), Some(scored)) =
                (self.predictors.get_mut(model), self.scored.get_mut(model))
            {
                *slot = predictor;
                *scored = Scored::default();
            }
        }
    }

    fn publish_now_and_then(&mut self, request: &SurveyRequest) {
        // The table is made anew each time: the more episodes, the more seldom.
        let episodes = self.source.metas().len() as u64;
        let period = PERIOD.max(Duration::from_micros(100 * episodes));
        if self.published.elapsed() >= period {
            self.publish(request, false);
        }
    }

    fn publish(&mut self, request: &SurveyRequest, done: bool) {
        let Some(scored) = self.scored.get(request.model) else {
            return;
        };
        let vision = request
            .vision
            .and_then(|vision| self.scored.get(vision))
            .map_or(&[][..], |scored| scored.scores.as_slice());
        let scores = score::with_gain(&scored.scores, vision);
        self.shared.answers.put(SurveyAnswer {
            generation: request.generation,
            model: request.model,
            scored: scores.iter().flatten().count(),
            scores: Arc::new(scores),
            known: scored.known.clone(),
            board: self.board.clone(),
            measured: self.measured,
            done,
        });
        self.published = Instant::now();
        self.worker.wake();
    }
}
