//! Where the object is, read from beliefs: the paper's ellipse figure and Table 3.
//!
//! Two numbers, never mixed: regressors that were fitted on the training split, and regressors fitted on the very
//! episodes that are scored, as the released notebook does it.

use std::sync::Arc;

use candle_core::Result;
use rayon::prelude::*;
use serde::Serialize;

use super::prediction::{believe, roll};
use super::protocol::Protocol;
use super::score::{Contest, EpisodeScores, Subject};
use super::spread::Spread;
use crate::episode::{Episode, PlanarPose};
use crate::measure::spread::sample_covariance;
use crate::model::Model;
use crate::model::inspect::Inspector;
use crate::model::probe::{Pairs, Readers, Regressors};
use crate::model::trace::GaussianTrace;

/// What is read: x, y in metres, sine and cosine of yaw.
pub const OUTPUTS: usize = 4;

/// The beliefs that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Beliefs {
    /// They saw every sensor up to their own image.
    Filtered,
    /// They saw the context only.
    Predicted,
}

impl Beliefs {
    /// `filtered` or `predicted`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Filtered => "filtered",
            Self::Predicted => "predicted",
        }
    }
}

/// How they are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Regressor {
    /// Least squares.
    Linear,
    /// One hidden layer of 50.
    Network,
}

impl Regressor {
    /// `least squares` or `network`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "least squares",
            Self::Network => "network",
        }
    }
}

/// What the regressor was fitted on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FittedOn {
    /// The model's training split: the episodes scored are new to it.
    Train,
    /// The scored episodes themselves, as the released notebook has it.
    Scored,
}

impl FittedOn {
    /// `train` or `scored split`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Scored => "scored split",
        }
    }
}

/// Errors of one regressor, in centimetres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PoseErrors {
    /// The row.
    pub subject: String,
    /// Read from which beliefs.
    pub beliefs: Beliefs,
    /// By what.
    pub regressor: Regressor,
    /// Fitted on what.
    pub fitted_on: FittedOn,
    /// Beliefs that were read.
    pub count: usize,
    /// Root of the mean squared distance.
    pub rmse_cm: f64,
    /// Absolute errors along x and y; their deviation is over beliefs.
    pub absolute_cm: [Spread; 2],
    /// Covariance of the absolute errors as xx, xy, yy, in cm².
    pub covariance_cm2: [f32; 3],
    /// Absolute error of yaw in degrees.
    pub yaw_deg: Option<Spread>,
}

/// Filtered and predicted latents of episodes with the poses they should give.
#[derive(Clone, Debug, Default)]
pub struct Latents {
    /// Beliefs that saw everything.
    pub filtered: Pairs,
    /// Predicted ones.
    pub predicted: Pairs,
}

impl Latents {
    fn new(latent: usize) -> Self {
        let pairs = Pairs {
            inputs: latent,
            outputs: OUTPUTS,
            ..Pairs::default()
        };
        Self {
            filtered: pairs.clone(),
            predicted: pairs,
        }
    }

    /// Takes an episode's latents; `poses` has one an image, the first belief is of image `stack`, the first prediction
    /// of image `context`.
    fn push(
        &mut self,
        filtered: &[f32],
        predicted: &[f32],
        poses: &[[f32; 3]],
        [stack, context]: [usize; 2],
    ) {
        for (pairs, latents, first) in [
            (&mut self.filtered, filtered, stack),
            (&mut self.predicted, predicted, context),
        ] {
            let latents = latents.chunks_exact(pairs.inputs.max(1));
            for (latent, [x, y, yaw]) in latents.zip(poses.iter().skip(first)) {
                pairs.x.extend_from_slice(latent);
                pairs.y.extend([*x, *y, yaw.sin(), yaw.cos()]);
            }
        }
    }

    /// Fits every regressor; none with fewer beliefs than latents.
    pub fn fit(&self) -> Result<Option<Regressors>> {
        let fitted = Readers::fit(&self.filtered)?.zip(Readers::fit(&self.predicted)?);
        Ok(fitted.map(|(filtered, predicted)| Regressors {
            filtered,
            predicted,
        }))
    }
}

/// Filtered and predicted beliefs of an episode, and x, y and yaw at each of its images.
type Read = (GaussianTrace, GaussianTrace, Vec<[f32; 3]>);

/// The latents of training episodes as a regressor sees them, rolled out as `protocol` says as far as an episode goes;
/// episodes that are none and those without a recorded pose are left out.
pub fn latents<E>(
    inspector: &Inspector<&Model>,
    episodes: impl IndexedParallelIterator<Item = std::result::Result<Option<Arc<Episode>>, E>>,
    protocol: Protocol,
) -> std::result::Result<Latents, E>
where
    E: From<candle_core::Error> + Send,
{
    let config = &inspector.model().config;
    let one = |episode: &Episode, poses: &[PlanarPose]| -> Result<Option<Read>> {
        let protocol = protocol.within(episode.steps());
        if protocol.horizon == 0 || protocol.context <= config.frame_stack {
            return Ok(None);
        }
        let (experts, beliefs) = believe(inspector, episode)?;
        let rolled = roll(inspector, &experts, &beliefs, protocol)?;
        let poses = poses.iter().map(|p| [p.x, p.y, p.yaw]).collect();
        Ok(Some((beliefs.posterior, rolled.gaussians, poses)))
    };
    let each: Vec<Option<Read>> = episodes
        .map(|episode| match episode? {
            Some(episode) => match &episode.object {
                Some(poses) => Ok(one(&episode, poses)?),
                None => Ok(None),
            },
            None => Ok(None),
        })
        .collect::<std::result::Result<_, E>>()?;
    let mut all = Latents::new(config.latent);
    let firsts = [config.frame_stack, protocol.context];
    for (filtered, predicted, poses) in each.into_iter().flatten() {
        all.push(&filtered.mean, &predicted.mean, &poses, firsts);
    }
    Ok(all)
}

/// Reads every row's beliefs in every way there is. Empty where no pose was recorded.
pub fn errors(contest: &Contest, all: &[EpisodeScores]) -> Result<Vec<PoseErrors>> {
    let rows: Vec<Vec<PoseErrors>> = contest
        .subjects
        .par_iter()
        .enumerate()
        .map(|(place, subject)| of_row(contest, subject, place, all))
        .collect::<Result<_>>()?;
    Ok(rows.into_iter().flatten().collect())
}

fn of_row(
    contest: &Contest,
    subject: &Subject,
    place: usize,
    all: &[EpisodeScores],
) -> Result<Vec<PoseErrors>> {
    let candidate = contest.candidate(subject);
    let config = &candidate.config;
    let mut latents = Latents::new(config.latent);
    for episode in all {
        if let (Some(poses), Some(scores)) = (&episode.poses, episode.subjects.get(place)) {
            let firsts = [config.frame_stack, contest.protocol.context];
            latents.push(&scores.filtered, &scores.predicted, poses, firsts);
        }
    }
    let own = latents.fit()?;
    let fits = [
        (FittedOn::Train, candidate.regressors.as_ref()),
        (FittedOn::Scored, own.as_ref()),
    ];
    let mut rows = Vec::new();
    for (fitted_on, regressors) in fits {
        let Some(regressors) = regressors else {
            continue;
        };
        for (beliefs, readers, pairs) in [
            (Beliefs::Filtered, &regressors.filtered, &latents.filtered),
            (
                Beliefs::Predicted,
                &regressors.predicted,
                &latents.predicted,
            ),
        ] {
            for regressor in [Regressor::Linear, Regressor::Network] {
                let source = Source {
                    subject: &subject.label,
                    beliefs,
                    regressor,
                    fitted_on,
                };
                rows.extend(read(source, pairs, readers));
            }
        }
    }
    Ok(rows)
}

/// What is read by what.
#[derive(Clone, Copy)]
struct Source<'a> {
    subject: &'a str,
    beliefs: Beliefs,
    regressor: Regressor,
    fitted_on: FittedOn,
}

/// Errors of one regressor on some pairs; none without a pair.
fn read(source: Source<'_>, pairs: &Pairs, readers: &Readers) -> Option<PoseErrors> {
    let mut absolute = [Vec::new(), Vec::new()];
    let mut yaw = Vec::new();
    let mut squares = 0.0;
    for (latent, truth) in pairs.iter() {
        let says = match source.regressor {
            Regressor::Linear => readers.linear.read(latent),
            Regressor::Network => readers.network.read(latent),
        };
        let error = |k: usize| 100.0 * f64::from(says[k] - truth[k]);
        let (x, y) = (error(0), error(1));
        squares += x * x + y * y;
        absolute[0].push(x.abs());
        absolute[1].push(y.abs());
        if let (&[_, _, sin, cos], &[_, _, true_sin, true_cos]) = (&says[..], truth) {
            // The angle between the two directions, so that a full turn is none.
            let across = true_sin * cos - true_cos * sin;
            let along = true_cos * cos + true_sin * sin;
            yaw.push(f64::from(across.atan2(along).abs().to_degrees()));
        }
    }
    let [x, y] = [Spread::of(&absolute[0])?, Spread::of(&absolute[1])?];
    let points: Vec<[f32; 2]> = absolute[0]
        .iter()
        .zip(&absolute[1])
        .map(|(&x, &y)| [x as f32, y as f32])
        .collect();
    Some(PoseErrors {
        subject: source.subject.to_owned(),
        beliefs: source.beliefs,
        regressor: source.regressor,
        fitted_on: source.fitted_on,
        count: pairs.len(),
        rmse_cm: (squares / pairs.len() as f64).sqrt(),
        absolute_cm: [x, y],
        covariance_cm2: sample_covariance(&points).unwrap_or_default(),
        yaw_deg: Spread::of(&yaw),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_a_known_offset() -> Result<()> {
        // Latents that are the pose itself, read by a map that is off by 3 cm, 4 cm and 10 degrees.
        let mut latents = Latents::new(4);
        let poses: Vec<[f32; 3]> = (0..60)
            .map(|i| {
                [
                    (i as f32 * 0.7).sin(),
                    (i as f32 * 1.3).cos(),
                    i as f32 * 0.4,
                ]
            })
            .collect();
        let own: Vec<f32> = poses
            .iter()
            .flat_map(|[x, y, a]| [*x, *y, a.sin(), a.cos()])
            .collect();
        latents.push(&own, &own[16..], &poses, [0, 4]);
        assert_eq!((latents.filtered.len(), latents.predicted.len()), (60, 56));
        let fitted = latents.fit()?.expect("enough");
        let source = Source {
            subject: "x",
            beliefs: Beliefs::Filtered,
            regressor: Regressor::Linear,
            fitted_on: FittedOn::Scored,
        };
        let exact = read(source, &latents.filtered, &fitted.filtered).expect("rows");
        assert!(exact.rmse_cm < 1e-2, "{exact:?}");
        let mut off = fitted.filtered.clone();
        off.linear.bias[0] += 0.03;
        off.linear.bias[1] -= 0.04;
        let turn = 10.0_f32.to_radians();
        for row in off.linear.weight.chunks_exact_mut(4).skip(2) {
            let [sin, cos] = [row[2], row[3]];
            row[2] = sin * turn.cos() - cos * turn.sin();
            row[3] = cos * turn.cos() + sin * turn.sin();
        }
        let found = read(source, &latents.filtered, &off).expect("rows");
        assert!((found.rmse_cm - 5.0).abs() < 1e-2, "{found:?}");
        assert!((found.absolute_cm[0].mean - 3.0).abs() < 1e-2 && found.absolute_cm[0].sd < 1e-2);
        let yaw = found.yaw_deg.expect("yaw");
        assert!((yaw.mean - 10.0).abs() < 0.2, "{yaw:?}");
        // A network that always says the same place is wrong by the distance from it.
        let mut still = fitted.filtered;
        still.network.second.weight.fill(0.0);
        still.network.second.bias = vec![0.0, 0.0, 0.0, 1.0];
        let source = Source {
            regressor: Regressor::Network,
            ..source
        };
        let found = read(source, &latents.filtered, &still).expect("rows");
        let squares: f32 = poses.iter().map(|[x, y, _]| x * x + y * y).sum();
        let expected = 100.0 * f64::from(squares / 60.0).sqrt();
        assert!((found.rmse_cm - expected).abs() < 1e-2, "{found:?}");
        Ok(())
    }
}
