//! The scores of one episode: what every table is made of.

use candle_core::Result;
use serde::{Deserialize, Serialize};

use super::contact::shares;
use super::credit::{self, Credit};
use super::prediction::{encode, grey, roll, squared_error};
use super::protocol::Protocol;
use super::setting::Setting;
use crate::episode::{Episode, Frame};
use crate::measure::frame::psnr_db_from_mse;
use crate::measure::ssim::ssim;
use crate::model::config::Config;
use crate::model::inspect::Inspector;
use crate::model::probe::{Probe, Regressors};
use crate::model::trace::ExpertTrace;

/// What the tables know of a trained model; its weights have no part in them.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// How it is called: the model's name, with recipe and seed where that is not enough.
    pub label: String,
    /// What tells its recipe from the others'; empty where all have the same.
    pub recipe: String,
    /// Names what its files hold.
    pub hash: String,
    /// The seed of its training; none where its report does not say.
    pub seed: Option<u64>,
    /// Its experts and sizes.
    pub config: Config,
    /// The force that counts as contact in its training set, in newtons; none where its report does not say.
    pub contact_newtons: Option<f32>,
    /// Its pose regressors.
    pub regressors: Option<Regressors>,
}

impl Candidate {
    /// The model's name.
    pub fn model(&self) -> &str {
        &self.config.name
    }

    /// Its model and recipe: candidates of one group differ in their seeds alone.
    pub fn group(&self) -> String {
        group(self.model(), &self.recipe)
    }
}

/// A model's name and what tells its recipe from the others'.
pub fn group(model: &str, recipe: &str) -> String {
    format!("{model} {recipe}").trim_end().to_owned()
}

/// A candidate under a setting: a row of the tables.
#[derive(Clone, Debug)]
pub struct Subject {
    /// The candidate's label, and the setting's name.
    pub label: String,
    /// Which candidate.
    pub candidate: usize,
    /// Under what.
    pub setting: Setting,
}

/// What is compared, and how.
#[derive(Clone, Debug)]
pub struct Contest {
    /// The models.
    pub candidates: Vec<Candidate>,
    /// The rows.
    pub subjects: Vec<Subject>,
    /// How much is seen and predicted.
    pub protocol: Protocol,
}

impl Contest {
    /// The candidate of a row.
    pub fn candidate(&self, subject: &Subject) -> &Candidate {
        &self.candidates[subject.candidate]
    }

    /// What a candidate stands in the tables under, in the order of its rows.
    pub fn settings(&self, candidate: usize) -> Vec<Setting> {
        let own = self.subjects.iter().filter(|s| s.candidate == candidate);
        own.map(|subject| subject.setting.clone()).collect()
    }
}

/// A trained model that can be scored.
pub struct Scorer {
    /// The model.
    pub inspector: Inspector,
    /// Its position probe.
    pub probe: Option<Probe>,
    /// Mean training frame in [0, 1], row major: the predictor that always says it.
    pub mean_frame: Vec<f32>,
}

/// Scores of predicted images, one a horizon.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameScores {
    /// Sum over pixels of squared differences of values in [0, 1].
    pub squared_error: Vec<f64>,
    /// Structural similarity, data range 1.
    pub ssim: Vec<f64>,
    /// Peak signal-to-noise ratio in dB, data range 1.
    pub psnr_db: Vec<f64>,
}

impl FrameScores {
    /// Of predictions in [0, 1], one after another, against as many frames.
    fn of<'a>(predicted: impl Iterator<Item = &'a [f32]>, truth: &[(Vec<f32>, usize)]) -> Self {
        let mut scores = Self::default();
        for (predicted, (truth, width)) in predicted.zip(truth) {
            let error = squared_error(predicted, truth);
            scores.squared_error.push(error);
            scores
                .ssim
                .push(ssim(predicted, truth, *width).unwrap_or(f64::NAN));
            let mse = error / truth.len() as f64;
            scores.psnr_db.push(psnr_db_from_mse(mse));
        }
        scores
    }
}

/// What a row makes of an episode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SubjectScores {
    /// Of the predicted images.
    pub frames: FrameScores,
    /// Means of the beliefs that saw everything, `(beliefs, Z)`.
    pub filtered: Vec<f32>,
    /// Means of the predicted beliefs, `(h, Z)`.
    pub predicted: Vec<f32>,
    /// What each sensor deserves of the result (D24), where the model stands every set of sensors and nothing is
    /// switched or damaged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub credit: Option<Credit>,
    /// Precision share of each expert, the prior last, at each belief (D1); none without a product.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shares: Option<Vec<Vec<f32>>>,
}

/// Everything about an episode: of one model a line of its score file, of several what the tables are made of.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeScores {
    /// Its name.
    pub episode: String,
    /// x, y in metres and yaw in radians at each image; none if not recorded.
    pub poses: Option<Vec<[f32; 3]>>,
    /// Root-mean-square force in newtons over each image's window; empty if not recorded.
    pub force_newtons: Vec<f32>,
    /// Of the last seen frame, held.
    pub held: FrameScores,
    /// Of the mean training frame.
    pub mean_frame: FrameScores,
    /// One a row.
    pub subjects: Vec<SubjectScores>,
}

/// The images to predict, of an episode of `protocol.images()` images or more.
fn targets(episode: &Episode, protocol: Protocol) -> Result<Vec<(Vec<f32>, usize)>> {
    let Some(frames) = episode.frames.get(protocol.context..protocol.images()) else {
        candle_core::bail!(
            "episode `{}` has {} images, {} are needed",
            episode.meta.id,
            episode.steps(),
            protocol.images()
        );
    };
    let target = |frame: &Frame| (grey(frame), frame.width);
    Ok(frames.iter().map(target).collect())
}

/// Scores a model under each setting on an episode of `protocol.images()` images or more.
pub fn score(
    scorer: &Scorer,
    settings: &[Setting],
    protocol: Protocol,
    episode: &Episode,
) -> Result<EpisodeScores> {
    let truth = targets(episode, protocol)?;
    // What the sensors say does not depend on the switches.
    let said = encode(&scorer.inspector, episode)?;
    let row = |setting| row(scorer, setting, protocol, episode, &said, &truth);
    Ok(EpisodeScores {
        subjects: settings.iter().map(row).collect::<Result<_>>()?,
        ..trivial(&scorer.mean_frame, protocol, episode, &truth)
    })
}

/// What is known of an episode without a model.
fn trivial(
    mean_frame: &[f32],
    protocol: Protocol,
    episode: &Episode,
    truth: &[(Vec<f32>, usize)],
) -> EpisodeScores {
    let held = grey(&episode.frames[protocol.context - 1]);
    let poses = episode.object.as_ref();
    EpisodeScores {
        episode: episode.meta.id.clone(),
        poses: poses.map(|poses| poses.iter().map(|p| [p.x, p.y, p.yaw]).collect()),
        force_newtons: (0..episode.steps())
            .map_while(|t| episode.force_newtons(t))
            .collect(),
        held: FrameScores::of(std::iter::repeat(held.as_slice()), truth),
        mean_frame: FrameScores::of(std::iter::repeat(mean_frame), truth),
        subjects: Vec::new(),
    }
}

/// Scores one row.
fn row(
    scorer: &Scorer,
    setting: &Setting,
    protocol: Protocol,
    episode: &Episode,
    said: &ExpertTrace,
    truth: &[(Vec<f32>, usize)],
) -> Result<SubjectScores> {
    let inspector = &scorer.inspector;
    let config = &inspector.model().config;
    let damaged = setting.damage(episode);
    let damaged = damaged.map(|seen| encode(inspector, &seen)).transpose()?;
    let experts = damaged.as_ref().unwrap_or(said);
    let alphas = setting.alphas(config, experts.controls.len() + 1);
    let beliefs = inspector.filter(experts, &alphas)?;
    let rolled = roll(inspector, experts, &beliefs, protocol)?;
    let pixels = inspector.decode_pixels(&rolled.gaussians.mean)?;
    let size = pixels.len() / protocol.horizon.max(1);
    let frames = FrameScores::of(pixels.chunks_exact(size.max(1)), truth);
    let as_trained = *setting == Setting::default();
    let credit = if as_trained && config.training.masks {
        Some(credit::of(scorer, protocol, experts, episode, truth)?)
    } else {
        None
    };
    let probe = scorer.probe.as_ref();
    Ok(SubjectScores {
        frames,
        shares: shares(config, &alphas, experts, &beliefs, probe),
        filtered: beliefs.posterior.mean,
        predicted: rolled.gaussians.mean,
        credit,
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;

    /// Frames of one grey each, 10 t at image t.
    fn ramp(images: u8) -> Episode {
        let frame = |t: u8| Frame {
            width: 8,
            height: 8,
            pixels: vec![10 * t; 64],
        };
        Episode {
            meta: crate::episode::EpisodeMeta::default(),
            layout: crate::episode::Layout {
                frame_size: 8,
                window: 4,
            },
            steps_nanos: (0..i64::from(images)).collect(),
            frames: (0..images).map(frame).collect(),
            haptic: None,
            proprio: None,
            controls: None,
            object: None,
            tip: None,
            flags: Vec::new(),
        }
    }

    #[test]
    fn trivial_predictors_say_the_last_seen_frame_and_the_mean_one() {
        let protocol = Protocol {
            context: 3,
            horizon: 4,
        };
        let truth = targets(&ramp(8), protocol).unwrap();
        let scores = trivial(&[60.0 / 255.0; 64], protocol, &ramp(8), &truth);
        // Image 3 of 1.. is held, of grey 20; predicted are greys 30 to 60.
        let error = |grey: f64| 64.0 * (grey / 255.0).powi(2);
        for (h, off) in [10.0, 20.0, 30.0, 40.0].into_iter().enumerate() {
            assert!((scores.held.squared_error[h] - error(off)).abs() < 1e-5);
            let psnr = 20.0 * (255.0_f64 / off).log10();
            assert!((scores.held.psnr_db[h] - psnr).abs() < 1e-4);
            assert!((scores.mean_frame.squared_error[h] - error(40.0 - off)).abs() < 1e-5);
        }
        assert_eq!(scores.held.ssim.len(), 4);
        assert!(targets(&ramp(6), protocol).is_err());
    }
}
