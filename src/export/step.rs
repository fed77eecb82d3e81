//! What is known of one model at one step.

use crate::episode::Frame;
use crate::measure::frame::squared_error;
use crate::modality::Expert;
use crate::session::snapshot::reading::{ExpertReading, SeriesView};
use crate::session::snapshot::{
    Badge, Estimate, ExpertView, LatentView, PositionView, Snapshot, StripCell, estimate_at,
};

use super::{ModelOrigin, Run};

mod readings;

pub use self::readings::{
    OF_EXPERT, OF_SENSOR, OfExpert, OfStep, READINGS, Reading, named, readings_of,
};

/// One model at one step.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    /// The episode.
    pub run: &'a Run,
    /// What is shown of it.
    pub at: &'a Snapshot,
}

impl<'a> Step<'a> {
    /// Every step of a run, model by model.
    pub fn of(run: &'a Run) -> impl Iterator<Item = Self> {
        let all = run.models.iter().flatten();
        all.map(move |at| Self { run, at })
    }

    /// The model.
    pub fn model(&self) -> Option<&'a ModelOrigin> {
        self.run.provenance.models.get(self.at.model)
    }

    /// When the step's image was taken, in nanoseconds since the Unix epoch.
    pub fn stamp_nanos(&self) -> Option<i64> {
        self.run.episode.steps_nanos.get(self.at.cursor).copied()
    }

    /// The same in seconds since the first image.
    pub fn secs(&self) -> Option<f64> {
        let secs = &self.at.episode.as_ref()?.secs;
        secs.get(self.at.cursor).copied()
    }

    /// Whether the model was trained on the switches; none where there is nothing to switch.
    pub fn trained(&self) -> Option<bool> {
        match self.at.badge {
            Badge::Trained => Some(true),
            Badge::Untrained(_) => Some(false),
            Badge::NoProduct => None,
        }
    }

    /// The experts, the prior last.
    pub fn experts(&self) -> impl Iterator<Item = Expert> {
        self.at.experts.iter().map(|expert| expert.expert)
    }

    /// One of them.
    pub fn expert(&self, i: usize) -> Option<&'a ExpertView> {
        self.at.experts.get(i)
    }

    /// α as the product has it.
    pub fn alpha(&self, i: usize) -> f32 {
        self.expert(i).map_or(0.0, |expert| expert.alpha)
    }

    /// What is read of an expert.
    pub fn reading(&self, i: usize) -> Option<&'a ExpertReading> {
        self.at.fusion.as_ref()?.experts.get(i)
    }

    /// The belief.
    pub fn posterior(&self) -> Option<&'a LatentView> {
        self.at.belief.as_ref()
    }

    /// Recorded pose of the object: x, y in metres, yaw in radians.
    pub fn truth(&self) -> Option<[f32; 3]> {
        let poses = self.run.episode.object.as_ref()?;
        poses.get(self.at.cursor).map(|p| [p.x, p.y, p.yaw])
    }

    /// Recorded position of the end effector, in metres.
    pub fn tip(&self) -> Option<[f32; 2]> {
        self.run.episode.tip.as_ref()?.get(self.at.cursor).copied()
    }

    /// Position read from the belief.
    pub fn belief(&self) -> Option<Estimate> {
        estimate_at(&self.position()?.belief, self.at.cursor)
    }

    /// Position read from the prediction.
    pub fn prediction(&self) -> Option<Estimate> {
        estimate_at(&self.position()?.prediction, self.at.cursor)
    }

    /// The frames of the step.
    pub fn cell(&self) -> Option<&'a StripCell> {
        self.at.strip.get(self.at.cursor)
    }

    fn position(&self) -> Option<&'a PositionView> {
        self.at.position.as_ref()
    }

    fn squared_error(&self, frame: Option<&Frame>) -> Option<f32> {
        squared_error(frame?, &self.cell()?.truth).map(|sum| sum as f32)
    }

    fn in_series(&self, of: impl Fn(&'a SeriesView) -> &'a Vec<f32>) -> Option<f32> {
        let values = of(self.at.series.as_deref()?);
        let value = values.get(self.at.cursor).copied();
        value.filter(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a failed test should stop")]

    use std::sync::Arc;
    use std::time::Duration;

    use super::*;
    use crate::episode::{EpisodeSource, Layout};
    use crate::export::drive::{Source, provenance_of};
    use crate::measure::gaussian::{Factor, Gaussian, product};
    use crate::session::Session;
    use crate::session::command::Command;
    use crate::session::fake::{FakePredictor, FakeSource};
    use crate::session::predict::Predictor;
    use crate::session::state::State;

    /// A model at step 6 of a made-up episode.
    fn run(model: FakePredictor) -> Run {
        let source = FakeSource::new(1);
        let models: Vec<Arc<dyn Predictor>> = vec![Arc::new(model)];
        let mut session = Session::new(Arc::new(source.clone()), models.clone());
        assert!(session.wait_idle(Duration::from_mins(1)));
        session.apply(Command::SeekTo(6));
        let from = Source {
            episodes: &source,
            models: &models,
        };
        Run {
            episode: Arc::new(source.load(0, Layout::default()).unwrap()),
            provenance: Arc::new(provenance_of(from, &State::default(), None)),
            models: vec![vec![session.snapshot()]],
        }
    }

    #[test]
    fn alphas_and_gaussians_multiply_to_the_belief_also_where_the_prior_is_left_out() {
        for (model, prior, trained) in [
            (FakePredictor::three(), 1.0, Some(true)),
            (FakePredictor::joint(), 1.0, Some(true)),
            (FakePredictor::vision(), 0.0, None),
        ] {
            let run = run(model);
            let step = Step::of(&run).next().unwrap();
            let count = step.experts().count();
            assert!((step.alpha(count - 1) - prior).abs() < f32::EPSILON);
            assert_eq!(step.trained(), trained);
            let factors: Vec<Factor<'_>> = (0..count)
                .map(|i| {
                    let said = step.expert(i).unwrap().latent.as_ref().unwrap();
                    Factor {
                        gaussian: Gaussian {
                            mean: &said.mean,
                            log_var: &said.log_var,
                        },
                        alpha: step.alpha(i),
                    }
                })
                .collect();
            let (made, belief) = (product(&factors).unwrap(), step.posterior().unwrap());
            for d in 0..belief.mean.len() {
                assert!((made.mean[d] - belief.mean[d]).abs() < 1e-5);
                assert!((made.log_var[d] - belief.log_var[d]).abs() < 1e-5);
            }
            assert_eq!(step.alpha(99).to_bits(), 0, "there is no such expert");
        }
    }

    #[test]
    fn names_are_one_of_a_kind_and_what_is_known_is_finite() {
        let mut names: Vec<&str> = READINGS.iter().map(|reading| reading.name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
        let run = run(FakePredictor::three());
        let step = Step::of(&run).next().unwrap();
        for reading in READINGS {
            let value = (reading.of)(&step);
            assert!(value.is_none_or(f32::is_finite), "{}", reading.name);
            assert!(value.is_some(), "{}", reading.name);
        }
        for (i, expert) in step.experts().enumerate() {
            for reading in readings_of(expert) {
                assert!((reading.of)(&step, i).is_some(), "{}", reading.name);
            }
        }
        assert_eq!(named(&step, "no such reading"), None);
    }
}
