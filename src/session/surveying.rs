//! Between a session and its survey: when it starts, what it is asked, what becomes of its answers.

use std::sync::Arc;
use std::thread::JoinHandle;

use super::Session;
use super::predict::Predictor;
use super::snapshot::board::BoardView;
use super::survey::{self, BoardRequest, Cache, SurveyAnswer, SurveyRequest, SurveyShared};
use crate::lock::lock;

/// A survey that has been started.
pub(super) struct Survey {
    shared: Arc<SurveyShared>,
    thread: Option<JoinHandle<()>>,
    wanted: Option<Wanted>,
    generation: u64,
    /// Whether the board is complete.
    measured: bool,
    /// Episodes scored so far.
    scored: usize,
    done: bool,
}

/// What the last request asks for.
#[derive(PartialEq)]
struct Wanted {
    model: usize,
    vision: Option<usize>,
    board: Option<super::Wanted>,
}

impl Session {
    /// Keeps the scores of a survey there, and looks there first; to be said before one begins.
    pub fn keep_scores_in(&mut self, cache: Arc<dyn Cache>) {
        self.cache = Some(cache);
    }

    /// Looks at every episode in the background from now on, where there is something to look at. A command that needs
    /// the scores starts it as well.
    pub fn survey(&mut self) {
        if self.survey.is_some() || self.models.is_empty() || self.source.metas().is_empty() {
            return;
        }
        let shared = Arc::new(SurveyShared::default());
        let started = survey::spawn(
            Arc::clone(&shared),
            Arc::clone(&self.shared),
            Arc::clone(&self.source),
            self.shared.models(),
            self.cache.clone(),
        );
        match started {
            Ok(thread) => {
                self.survey = Some(Survey {
                    shared,
                    thread: Some(thread),
                    wanted: None,
                    generation: 0,
                    measured: false,
                    scored: 0,
                    done: false,
                });
                self.table.ask();
                self.ask_survey();
                self.refresh();
            }
            Err(error) => self.complain(format!("cannot start a thread to score on: {error}")),
        }
    }

    /// Asks for what is wanted now and is not yet asked for.
    pub(super) fn ask_survey(&mut self) {
        if self.wants.board && self.survey.is_none() {
            // It asks for itself.
            self.survey();
            return;
        }
        let split = self
            .source
            .metas()
            .get(self.target.episode)
            .and_then(|meta| meta.split);
        let wanted = Wanted {
            model: self.target.model,
            vision: self
                .models
                .iter()
                .position(|model| model.experts == [crate::modality::Expert::Vision]),
            board: self.wants.board.then(|| {
                let mut wanted = self.wanted();
                // Whatever episode of the split is looked at, the board is the same.
                wanted.target.episode = split.map_or(usize::MAX, |split| split as usize);
                wanted.other = None;
                wanted.without_what_only_pictures_show()
            }),
        };
        let Some(survey) = &mut self.survey else {
            return;
        };
        if survey.wanted.as_ref() == Some(&wanted) {
            return;
        }
        survey.generation += 1;
        survey.done = false;
        survey.measured = false;
        survey.shared.requests.put(SurveyRequest {
            generation: survey.generation,
            model: wanted.model,
            vision: wanted.vision,
            board: wanted.board.as_ref().map(|_| BoardRequest {
                settings: self.settings.clone(),
                split,
            }),
        });
        let other_model = survey
            .wanted
            .as_ref()
            .is_some_and(|before| before.model != wanted.model);
        survey.wanted = Some(wanted);
        if other_model {
            self.table.take(&[]);
            self.board = None;
        }
    }

    /// Takes in what the survey has found; true if there was anything of use.
    pub(super) fn collect_survey(&mut self) -> bool {
        let answer = self.survey.as_ref().and_then(|s| s.shared.answers.take());
        answer.is_some_and(|answer| self.take_survey(answer))
    }

    fn take_survey(&mut self, answer: SurveyAnswer) -> bool {
        let Some(survey) = &mut self.survey else {
            return false;
        };
        if answer.generation != survey.generation {
            return false;
        }
        survey.done = answer.done;
        survey.measured = answer.measured;
        survey.scored = answer.scored;
        self.table.take(&answer.scores);
        if let Some(known) = answer.known {
            self.known.insert(answer.model, known);
        }
        // What was measured stays while another is computed.
        match (answer.board, &self.board) {
            (Some(board), Some(before)) if !is_measured(&board) && is_measured(before) => {
                self.board = Some(Arc::new(BoardView {
                    episodes: board.episodes,
                    total: board.total,
                    stale: true,
                    ..BoardView::clone(before)
                }));
            }
            (Some(board), _) => self.board = Some(board),
            (None, _) => {}
        }
        if answer.done
            && let Some(by) = self.awaiting_failure.take()
        {
            self.go_to_failure(by);
        }
        true
    }

    /// Whether something that was asked for waits for the survey.
    pub(super) fn awaits_survey(&self) -> bool {
        let Some(survey) = &self.survey else {
            return false;
        };
        let scores = self.awaiting_failure.is_some() && !survey.done;
        scores || (self.wants.board && !survey.measured && !survey.done)
    }

    /// Episodes that the survey has scored so far: whoever waits for it sees that it goes on.
    pub fn surveyed(&self) -> usize {
        self.survey.as_ref().map_or(0, |survey| survey.scored)
    }

    /// Whether the survey has something to do.
    pub(super) fn survey_runs(&self) -> bool {
        self.survey.as_ref().is_some_and(|survey| !survey.done)
    }

    /// Waits for the survey's next answer and takes it in; false if there is none in time.
    pub(super) fn wait_for_survey(&mut self, deadline: std::time::Instant) -> bool {
        let Some(survey) = &self.survey else {
            return false;
        };
        let Some(answer) = survey.shared.answers.wait_until(deadline) else {
            return false;
        };
        let cursor = self.playback.cursor;
        if self.take_survey(answer) {
            self.settle(cursor);
        }
        true
    }

    /// Nothing that a model's survey has found holds for the one that takes its place.
    pub(super) fn survey_anew(&mut self, model: usize, predictor: &Arc<dyn Predictor>) {
        self.known.remove(&model);
        if model == self.target.model {
            self.board = None;
            self.table.take(&[]);
        }
        let Some(survey) = &mut self.survey else {
            return;
        };
        lock(&survey.shared.successors).insert(model, Arc::clone(predictor));
        let asked = survey.wanted.as_ref();
        if asked.is_none_or(|wanted| wanted.model == model || wanted.vision == Some(model)) {
            // Answers on their way are the former model's.
            survey.generation += 1;
            survey.wanted = None;
        }
    }

    /// Ends it.
    pub(super) fn end_survey(&mut self) {
        if let Some(survey) = &mut self.survey {
            survey.shared.requests.close();
            if let Some(thread) = survey.thread.take() {
                // It catches panics; one that got past it has nothing left to tell.
                let _ = thread.join();
            }
        }
    }
}

fn is_measured(board: &BoardView) -> bool {
    board.filtered.is_some() || board.why_not.is_some()
}
