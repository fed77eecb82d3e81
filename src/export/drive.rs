//! Takes a session through episodes, models and steps, and hands what it shows to a sink.

use std::ops::RangeInclusive;
use std::sync::Arc;
use std::time::Duration;

use super::{DataOrigin, ExportError, ModelOrigin, ProbeOrigin, Provenance, Run, Sink};
use crate::episode::{EpisodeSource, Split};
use crate::session::command::Command;
use crate::session::predict::Predictor;
use crate::session::snapshot::Snapshot;
use crate::session::state::State;
use crate::session::{Session, model_key};

/// Time between two looks for an end while a model computes.
const PATIENCE: Duration = Duration::from_millis(50);

/// What is exported.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Indices of the episodes, in order.
    pub episodes: Vec<usize>,
    /// The split they are of, where they were asked for so.
    pub split: Option<Split>,
    /// First and last step, from 0; none for all. An episode that ends before counts as far as it goes.
    pub steps: Option<RangeInclusive<usize>>,
    /// Switches, context, horizon, damage, controls and sampling, for every episode and model.
    pub state: Option<State>,
}

/// Who looks on.
pub trait Onlooker {
    /// Whether to stop.
    fn stops(&self) -> bool;
    /// An episode begins.
    fn begins(&mut self, episode: &str);
    /// An episode is done, written or not.
    fn done(&mut self);
    /// Something to tell the user that does not end the export.
    fn note(&mut self, text: &str);
}

/// What the session was made of.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The episodes.
    pub episodes: &'a dyn EpisodeSource,
    /// The models; the first one says in what sizes an episode is read.
    pub models: &'a [Arc<dyn Predictor>],
}

/// Exports what `plan` says. The sink is yet to be finished then. What is returned is why no model made anything of any
/// episode, where that is so.
///
/// # Errors
/// If the sink refuses, if the onlooker stops it, or if no episode could be read.
pub fn drive(
    session: &mut Session,
    source: Source<'_>,
    plan: &Plan,
    sink: &mut dyn Sink,
    onlooker: &mut dyn Onlooker,
) -> Result<Option<String>, ExportError> {
    let mut why = "no episode was asked for".to_owned();
    let layout = source.models.first().map(|model| model.layout());
    let layout = layout.unwrap_or_default();
    let mut provenance: Option<Arc<Provenance>> = None;
    let mut written = 0;
    let mut believed = false;
    for &index in &plan.episodes {
        let meta = source.episodes.metas().get(index);
        onlooker.begins(meta.map_or("", |meta| &meta.id));
        if onlooker.stops() {
            return Err(ExportError::Stopped);
        }
        let episode = match source.episodes.load(index, layout) {
            Ok(episode) => Arc::new(episode),
            Err(error) => {
                why = error.to_string();
                onlooker.note(&format!("left out: {why}"));
                onlooker.done();
                continue;
            }
        };
        let last = episode.steps().saturating_sub(1);
        let steps = match &plan.steps {
            Some(steps) => *steps.start()..=last.min(*steps.end()),
            None => 0..=last,
        };
        if steps.is_empty() {
            why = format!("{} has {} steps", episode.meta.id, episode.steps());
            onlooker.note(&format!("left out: {why}"));
            onlooker.done();
            continue;
        }
        let mut models = Vec::with_capacity(source.models.len());
        for model in 0..source.models.len() {
            let target = (index, model);
            models.push(shown(session, target, steps.clone(), plan, onlooker)?);
        }
        // Not its fusion: a model without a product has a belief all the same.
        let mut all = models.iter().flatten();
        believed |= all.any(|snapshot| snapshot.belief.is_some());
        let mut messages = models.iter().flatten().filter_map(|it| it.message.as_ref());
        if let Some(told) = messages.find(|message| message.error) {
            why.clone_from(&told.text);
        }
        let first = models.first().and_then(|snapshots| snapshots.first());
        let state = first.map(|snapshot| State::parse(&snapshot.state).0);
        let provenance = provenance.get_or_insert_with(|| {
            Arc::new(provenance_of(
                source,
                &state.unwrap_or_default(),
                plan.split,
            ))
        });
        sink.take(&Run {
            episode,
            models,
            provenance: Arc::clone(provenance),
        })?;
        written += 1;
        onlooker.done();
    }
    if written == 0 {
        return Err(ExportError::Nothing(why));
    }
    Ok((!believed).then_some(why))
}

/// What a model shows of an episode at each of the steps.
fn shown(
    session: &mut Session,
    (episode, model): (usize, usize),
    steps: RangeInclusive<usize>,
    plan: &Plan,
    onlooker: &mut dyn Onlooker,
) -> Result<Vec<Snapshot>, ExportError> {
    session.apply(Command::SelectEpisode(episode));
    session.apply(Command::SelectModel(model));
    if let Some(state) = &plan.state {
        let state = settings_of(state, session, episode);
        session.apply(Command::Restore(state.to_string()));
    }
    wait(session, || onlooker.stops())?;
    let told = session.snapshot().message.filter(|message| message.error);
    session.apply(Command::SeekClamped(*steps.start()));
    if let Some(told) = &told {
        let name = |snapshot: &Snapshot| Some(snapshot.shown_model()?.name.clone());
        let name = name(&session.snapshot()).unwrap_or_default();
        let meta = session.snapshot().episode.map(|episode| episode.id.clone());
        let id = meta.unwrap_or_default();
        onlooker.note(&format!("{id}, {name}: {}", told.text));
    }
    let at = |step| {
        session.apply(Command::SeekClamped(step));
        wait(session, || onlooker.stops())?;
        Ok(session.snapshot())
    };
    let mut snapshots: Vec<Snapshot> = steps.map(at).collect::<Result<_, ExportError>>()?;
    // A seek has nothing to complain of; what the state was refused for must not be lost by it.
    if let Some(first) = snapshots.first_mut() {
        first.message = first.message.take().or(told);
    }
    Ok(snapshots)
}

/// A state without what the export itself decides: where it is, and what only a face shows.
fn settings_of(state: &State, session: &Session, episode: usize) -> State {
    let own = session.episode_key(episode);
    let is_own = state.episode.is_none() || state.episode.as_deref() == own;
    State {
        episode: None,
        step: None,
        model: None,
        compare: None,
        speed: None,
        looping: None,
        marks: state.marks.iter().copied().filter(|_| is_own).collect(),
        selection: None,
        unknown: Vec::new(),
        ..state.clone()
    }
}

/// Waits until all that was asked for is computed.
///
/// # Errors
/// If it is to stop before.
pub fn wait(session: &mut Session, stops: impl Fn() -> bool) -> Result<(), ExportError> {
    loop {
        if stops() {
            return Err(ExportError::Stopped);
        }
        if session.wait_idle(PATIENCE) {
            return Ok(());
        }
    }
}

/// Where what a session of `source` shows comes from; `state` is what its snapshot says.
pub fn provenance_of(source: Source<'_>, state: &State, split: Option<Split>) -> Provenance {
    let models = source.models.iter();
    let infos: Vec<_> = models.map(|m| Arc::new(m.info().clone())).collect();
    let origin = |(i, model): (usize, &Arc<dyn Predictor>)| ModelOrigin {
        name: model_key(&infos, i),
        hash: infos[i].hash.clone(),
        source: infos[i].source.clone(),
        update: infos[i].update,
        config: infos[i].config.clone(),
        probe: ProbeOrigin::of(model.as_ref()),
    };
    Provenance {
        poescope: env!("CARGO_PKG_VERSION").to_owned(),
        data: DataOrigin {
            name: source.episodes.name().to_owned(),
            hash: source.episodes.data_hash().to_owned(),
        },
        models: source.models.iter().enumerate().map(origin).collect(),
        state: State {
            episode: None,
            step: None,
            model: None,
            compare: None,
            ..state.clone()
        }
        .to_string(),
        seed: state.sampling.seed,
        split,
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use super::*;
    use crate::session::fake::{FakePredictor, FakeSource};

    /// Keeps what it is given.
    #[derive(Default)]
    struct Kept(Vec<Run>);

    impl Sink for Kept {
        fn take(&mut self, run: &Run) -> Result<(), ExportError> {
            self.0.push(run.clone());
            Ok(())
        }

        fn finish(self: Box<Self>) -> Result<(), ExportError> {
            Ok(())
        }
    }

    /// Stops before the episode of this number.
    #[derive(Default)]
    struct Watched {
        stop_at: Option<usize>,
        begun: usize,
        notes: Vec<String>,
    }

    impl Onlooker for Watched {
        fn stops(&self) -> bool {
            self.stop_at.is_some_and(|at| self.begun >= at)
        }

        fn begins(&mut self, _: &str) {
            self.begun += 1;
        }

        fn done(&mut self) {}

        fn note(&mut self, text: &str) {
            self.notes.push(text.to_owned());
        }
    }

    fn driven(
        plan: &Plan,
        onlooker: &mut Watched,
    ) -> (Vec<Run>, Result<Option<String>, ExportError>) {
        let source = FakeSource::new(3);
        let models: Vec<Arc<dyn Predictor>> = vec![
            Arc::new(FakePredictor::three()),
            Arc::new(FakePredictor::joint()),
        ];
        let mut session = Session::new(Arc::new(source.clone()), models.clone());
        let source = Source {
            episodes: &source,
            models: &models,
        };
        let mut kept = Kept::default();
        let result = drive(&mut session, source, plan, &mut kept, onlooker);
        (kept.0, result)
    }

    fn state(text: &str) -> State {
        let (state, complaints) = State::parse(text);
        assert_eq!(complaints, [""; 0]);
        state
    }

    #[test]
    fn every_step_of_every_model_is_there_and_whole() {
        let plan = Plan {
            episodes: vec![2, 0],
            state: Some(state(
                "v=1;step=3;model=vhp;alpha=haptic:0@3-,vision:0.5;context=6;seed=9",
            )),
            ..Plan::default()
        };
        let mut onlooker = Watched::default();
        let (runs, result) = driven(&plan, &mut onlooker);
        assert_eq!(result.unwrap(), None, "the models made something of it");
        assert_eq!(onlooker.notes, [""; 0]);
        let ids: Vec<&str> = runs.iter().map(|run| &*run.episode.meta.id).collect();
        assert_eq!(ids, ["square_02", "square_00"]);
        for run in &runs {
            assert_eq!(run.models.len(), 2);
            for (model, snapshots) in run.models.iter().enumerate() {
                let steps: Vec<usize> = snapshots.iter().map(|s| s.cursor).collect();
                assert_eq!(steps, (0..run.episode.steps()).collect::<Vec<_>>());
                for snapshot in snapshots {
                    assert_eq!(snapshot.model, model);
                    assert_eq!(
                        snapshot.episode.as_ref().unwrap().id,
                        run.episode.meta.id,
                        "the episode is the run's"
                    );
                    assert!(!snapshot.busy && snapshot.current);
                    assert_eq!((snapshot.context, snapshot.sampling.seed), (6, 9));
                    assert_eq!(snapshot.frames.belief.is_some(), snapshot.cursor > 0);
                    assert_eq!(snapshot.frames.prediction.is_some(), snapshot.cursor > 5);
                }
            }
            // The haptic expert's switch means nothing to the model that has none.
            let alphas = |model: usize, step: usize| -> Vec<f32> {
                let experts = &run.models[model][step].experts;
                experts.iter().map(|expert| expert.alpha).collect()
            };
            assert_eq!(alphas(0, 1), [0.5, 1.0, 1.0, 1.0]);
            assert_eq!(alphas(0, 2), [0.5, 0.0, 1.0, 1.0]);
            assert_eq!(alphas(1, 2), [0.5, 1.0, 1.0]);
        }
        let provenance = &runs[0].provenance;
        assert_eq!(provenance.data.hash, "squares-1");
        assert_eq!(provenance.models[1].name, "vhp");
        assert_eq!(provenance.seed, 9);
        assert!(
            provenance.state.contains("haptic:0@3-") && !provenance.state.contains("episode="),
            "{}",
            provenance.state
        );
    }

    #[test]
    fn some_steps_only_as_far_as_an_episode_goes() {
        let plan = |steps| Plan {
            episodes: vec![0, 2],
            steps: Some(steps),
            ..Plan::default()
        };
        let mut onlooker = Watched::default();
        let (runs, result) = driven(&plan(12..=14), &mut onlooker);
        result.unwrap();
        let counts: Vec<usize> = runs.iter().map(|run| run.models[0].len()).collect();
        assert_eq!(counts, [3, 2]);
        let (runs, result) = driven(&plan(15..=15), &mut onlooker);
        result.unwrap();
        assert_eq!(runs.len(), 1);
        assert_eq!(onlooker.notes, ["left out: square_02 has 14 steps"]);
        let (_, result) = driven(&plan(99..=99), &mut onlooker);
        assert!(matches!(result, Err(ExportError::Nothing(_))));
    }

    #[test]
    fn what_cannot_be_had_is_told_and_an_end_can_be_asked_for() {
        let plan = Plan {
            episodes: vec![7, 1],
            state: Some(state("v=1;alpha=vision:0,joint:0,prior:0")),
            ..Plan::default()
        };
        let mut onlooker = Watched::default();
        let (runs, result) = driven(&plan, &mut onlooker);
        result.unwrap();
        assert_eq!(runs.len(), 1);
        let [unread, refused] = &onlooker.notes[..] else {
            panic!("{:?}", onlooker.notes);
        };
        assert!(unread.contains("no episode 7"), "{unread}");
        assert!(refused.contains("square_01, vhp: alpha"), "{refused}");

        let plan = Plan {
            episodes: vec![0, 1, 2],
            ..Plan::default()
        };
        let mut onlooker = Watched {
            stop_at: Some(2),
            ..Watched::default()
        };
        let (runs, result) = driven(&plan, &mut onlooker);
        assert!(matches!(result, Err(ExportError::Stopped)));
        assert_eq!(runs.len(), 1);
    }
}
