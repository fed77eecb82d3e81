//! What is known of one model at one step: the named numbers that tables, channels and lines of JSON are made of.

use crate::episode::Frame;
use crate::measure::frame::squared_error;
use crate::modality::Expert;
use crate::session::snapshot::reading::{ExpertReading, SeriesView};
use crate::session::snapshot::{
    Badge, Estimate, ExpertView, LatentView, PositionView, Snapshot, StripCell,
};

use super::{ModelOrigin, Run};

/// One model at one step.
#[derive(Clone, Copy)]
pub struct Step<'a> {
    /// The episode.
    pub run: &'a Run,
    /// What is shown of it.
    pub at: &'a Snapshot,
}

/// A number with its name. The name ends in the unit, where it has one.
pub struct Reading<F> {
    /// Name in tables and topics.
    pub name: &'static str,
    /// What it is.
    pub says: &'static str,
    /// Its value; none where it is not known.
    pub of: F,
}

/// Of a step.
pub type OfStep = fn(&Step<'_>) -> Option<f32>;
/// Of the expert of this place at a step.
pub type OfExpert = fn(&Step<'_>, usize) -> Option<f32>;

const fn reading<F>(name: &'static str, says: &'static str, of: F) -> Reading<F> {
    Reading { name, says, of }
}

/// The numbers of a step.
pub const READINGS: &[Reading<OfStep>] = &[
    reading(
        "psnr_belief_db",
        "PSNR of the decoded belief, dB, data range 1",
        |step| step.at.psnr_db.get(step.at.cursor)?.belief,
    ),
    reading(
        "psnr_prediction_db",
        "PSNR of the decoded prediction, dB",
        |step| step.at.psnr_db.get(step.at.cursor)?.prediction,
    ),
    reading(
        "squared_error_belief",
        "sum over pixels of the squared error of the decoded belief, grey values from 0 to 1",
        |step| step.squared_error(step.cell()?.belief.as_deref()),
    ),
    reading(
        "squared_error_prediction",
        "the same of the decoded prediction",
        |step| step.squared_error(step.cell()?.prediction.as_deref()),
    ),
    reading(
        "force_n",
        "root mean square force over the step's window, N",
        |step| {
            let episode = step.at.episode.as_ref()?;
            episode.force_newtons.get(step.at.cursor).copied()
        },
    ),
    reading("truth_x_m", "recorded position of the object, m", |step| {
        Some(step.truth()?[0])
    }),
    reading("truth_y_m", "recorded position of the object, m", |step| {
        Some(step.truth()?[1])
    }),
    reading(
        "truth_yaw_rad",
        "recorded angle of the object, rad",
        |step| Some(step.truth()?[2]),
    ),
    reading(
        "tip_x_m",
        "recorded position of the end effector, m",
        |step| Some(step.tip()?[0]),
    ),
    reading(
        "tip_y_m",
        "recorded position of the end effector, m",
        |step| Some(step.tip()?[1]),
    ),
    reading("belief_x_m", "position read from the belief, m", |step| {
        Some(step.belief()?.x)
    }),
    reading("belief_y_m", "position read from the belief, m", |step| {
        Some(step.belief()?.y)
    }),
    reading(
        "belief_xx_m2",
        "covariance of that position, the probe's R_p included, m²",
        |step| Some(step.belief()?.covariance[0]),
    ),
    reading("belief_xy_m2", "covariance of that position, m²", |step| {
        Some(step.belief()?.covariance[1])
    }),
    reading("belief_yy_m2", "covariance of that position, m²", |step| {
        Some(step.belief()?.covariance[2])
    }),
    reading(
        "belief_error_m",
        "its distance from the recorded one, m",
        |step| step.position()?.belief_error_m,
    ),
    reading(
        "prediction_x_m",
        "position read from the prediction, m",
        |step| Some(step.prediction()?.x),
    ),
    reading(
        "prediction_y_m",
        "position read from the prediction, m",
        |step| Some(step.prediction()?.y),
    ),
    reading(
        "prediction_xx_m2",
        "covariance of that position by the head's one-step spread, R_p included, m²",
        |step| Some(step.prediction()?.covariance[0]),
    ),
    reading(
        "prediction_xy_m2",
        "covariance of that position, m²",
        |step| Some(step.prediction()?.covariance[1]),
    ),
    reading(
        "prediction_yy_m2",
        "covariance of that position, m²",
        |step| Some(step.prediction()?.covariance[2]),
    ),
    reading(
        "prediction_error_m",
        "its distance from the recorded one, m",
        |step| step.position()?.prediction_error_m,
    ),
    reading(
        "prior_x_m",
        "position read from the prior alone, m",
        |step| Some(step.at.fusion.as_ref()?.prior_m?[0]),
    ),
    reading(
        "prior_y_m",
        "position read from the prior alone, m",
        |step| Some(step.at.fusion.as_ref()?.prior_m?[1]),
    ),
    reading(
        "nees",
        "NEES of the belief's position, R_p included (D11); χ² of 2",
        |step| step.in_series(|series| &series.nees),
    ),
    reading("nees_without_rp", "the same without R_p", |step| {
        step.in_series(|series| &series.nees_bare)
    }),
    reading("surprise_nats", "KL(belief ‖ prior), nats (D2)", |step| {
        step.in_series(|series| &series.surprise)
    }),
    reading(
        "conflict",
        "conflict energy of the experts that are on (D10); χ² of `conflict_dof`",
        |step| step.in_series(|series| &series.conflict),
    ),
    reading("conflict_dof", "its degrees of freedom", |step| {
        Some(step.at.fusion.as_ref()?.conflict?.dof as f32)
    }),
    reading(
        "nis_dof",
        "degrees of freedom of every NIS: the active dimensions (D19)",
        |step| {
            let mut experts = step.at.fusion.as_ref()?.experts.iter();
            Some(experts.find_map(|expert| expert.nis)?.dof as f32)
        },
    ),
];

/// The numbers of one expert at a step.
pub const OF_EXPERT: &[Reading<OfExpert>] = &[
    reading(
        "alpha",
        "α: 0 off, 1 as trained; 0 for a prior that the model does not multiply",
        |step, i| Some(step.alpha(i)),
    ),
    reading(
        "share_mean",
        "share of the belief's precision, mean over the latent (D1)",
        |step, i| Some(step.expert(i)?.share_mean).filter(|_| step.at.belief.is_some()),
    ),
    reading(
        "share_position",
        "the same weighted by what moves the position (D1)",
        |step, i| step.expert(i)?.share_position,
    ),
    reading(
        "information_nats",
        "entropy that it removes when it comes last, nats (D5)",
        |step, i| step.reading(i)?.information_nats,
    ),
    reading(
        "mahalanobis",
        "distance of the belief without it, in σ of that belief (D6)",
        |step, i| step.reading(i)?.mahalanobis,
    ),
    reading(
        "overruled_nats",
        "KL(belief ‖ expert), nats (D3)",
        |step, i| {
            let kl = step.reading(i)?.fused?;
            Some(kl.mean + kl.spread)
        },
    ),
    reading(
        "without_x_m",
        "the belief's position without it, m (D6)",
        |step, i| Some(step.reading(i)?.without?.x),
    ),
    reading(
        "without_y_m",
        "the belief's position without it, m (D6)",
        |step, i| Some(step.reading(i)?.without?.y),
    ),
];

/// Those of a sensor expert besides.
pub const OF_SENSOR: &[Reading<OfExpert>] = &[
    reading(
        "nis_head",
        "NIS against the prior's own spread (D8)",
        |step, i| Some(step.reading(i)?.nis?.head),
    ),
    reading(
        "nis_propagated",
        "NIS against A P Aᵀ + Q (D8); χ² of `nis_dof`",
        |step, i| step.reading(i)?.nis?.propagated,
    ),
    reading(
        "pull_x_m",
        "what it pulls the position by, m (D7)",
        |step, i| Some(step.reading(i)?.pull_m?[0]),
    ),
    reading(
        "pull_y_m",
        "what it pulls the position by, m (D7)",
        |step, i| Some(step.reading(i)?.pull_m?[1]),
    ),
    reading(
        "claim_nats",
        "KL(expert ‖ prior), nats (D4)",
        |step, i| {
            let kl = step.reading(i)?.claim?;
            Some(kl.mean + kl.spread)
        },
    ),
];

/// Those that an expert has.
pub fn readings_of(expert: Expert) -> impl Iterator<Item = &'static Reading<OfExpert>> {
    let sensor = if expert == Expert::Prior {
        &[]
    } else {
        OF_SENSOR
    };
    OF_EXPERT.iter().chain(sensor)
}

/// A number of [`READINGS`] by its name.
pub fn named(step: &Step<'_>, name: &str) -> Option<f32> {
    let reading = READINGS.iter().find(|reading| reading.name == name)?;
    (reading.of)(step).filter(|value| value.is_finite())
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
        let Some(expert) = self.expert(i) else {
            return 0.0;
        };
        let model = self.at.models.get(self.at.model);
        let is_left_out = model.is_some_and(|model| !model.prior_expert);
        if is_left_out && expert.expert == Expert::Prior {
            return 0.0;
        }
        expert.alpha
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
        *self.position()?.belief.get(self.at.cursor)?
    }

    /// Position read from the prediction.
    pub fn prediction(&self) -> Option<Estimate> {
        *self.position()?.prediction.get(self.at.cursor)?
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
