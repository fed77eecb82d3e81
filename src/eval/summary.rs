//! Everything that is said about a contest, as plain numbers.

use candle_core::Result;
use serde::Serialize;

use super::claims::{comparisons, once, sides, unasked};
use super::comparison::{Comparison, Means, Side, TRIVIAL};
use super::contact::{self, Aligned};
use super::protocol::Protocol;
use super::regression::{self, PoseErrors};
use super::score::{Candidate, Contest, EpisodeScores, FrameScores};
use super::spread::Spread;
use crate::measure::bootstrap::{self, Interval};
use crate::modality::Expert;

/// A row of the paper's Tables 1 and 2, and its curves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// The row.
    pub subject: String,
    /// What tells its recipe from the others'; empty where all have the same, and for the trivial predictors.
    pub recipe: String,
    /// Its place among [`Summary::models`]; none for the trivial predictors.
    pub model: Option<usize>,
    /// Root of the mean squared error per frame, a sum over pixels, over all frames.
    pub rmse: f64,
    /// Of each episode's mean over the horizon.
    pub ssim: Spread,
    /// The same, in dB.
    pub psnr_db: Spread,
    /// Over episodes, at each horizon from 1: squared error, structural similarity, PSNR.
    pub horizons: Vec<[Spread; 3]>,
    /// PSNR in dB over that of the last seen frame held, and of the mean frame, at each horizon, paired over episodes;
    /// empty for these themselves.
    pub ahead: Vec<[Interval; 2]>,
}

/// Mean Shapley values over episodes (D24).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Credited {
    /// The row.
    pub subject: String,
    /// Whose.
    pub expert: Expert,
    /// Of minus the squared error, with its deviation over episodes.
    pub squared_error: Spread,
    /// Of minus the position's negative log-likelihood, in nats.
    pub nll: Option<Spread>,
}

/// A group of several seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Seeds {
    /// The group, and its setting.
    pub label: String,
    /// How many seeds.
    pub seeds: usize,
    /// Mean PSNR in dB over seeds, with its deviation over them.
    pub psnr_db: Spread,
}

/// A model that was scored.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scored {
    /// Its label.
    pub label: String,
    /// Names what its files hold.
    pub hash: String,
    /// The seed of its training; none where its report does not say.
    pub seed: Option<u64>,
}

/// What was scored.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scope {
    /// The dataset's name.
    pub data: String,
    /// Names what it holds.
    pub data_hash: String,
    /// The split.
    pub split: String,
    /// Why each episode of it that could not be scored was left out.
    pub left_out: Vec<String>,
    /// What pose regressors were fitted anew on; none for those that training left.
    pub refit: Option<Refit>,
}

/// A dataset that pose regressors were fitted anew on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refit {
    /// Its name.
    pub data: String,
    /// Names what it holds.
    pub data_hash: String,
}

/// What the tables and figures are drawn from.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// On what.
    pub scope: Scope,
    /// How it was scored.
    pub protocol: Protocol,
    /// On how many episodes.
    pub episodes: usize,
    /// The models.
    pub models: Vec<Scored>,
    /// One a row, the trivial predictors last.
    pub quality: Vec<Quality>,
    /// Groups of more than one seed.
    pub seeds: Vec<Seeds>,
    /// Models of a single training.
    pub once: Vec<String>,
    /// Who is better.
    pub comparisons: Vec<Comparison>,
    /// Claims of the paper that were not asked: `[better, worse]` are there, but of no common recipe.
    pub unasked: Vec<[&'static str; 2]>,
    /// Pose regression.
    pub regression: Vec<PoseErrors>,
    /// Shapley values.
    pub credit: Vec<Credited>,
    /// The force that counts as contact, in newtons.
    pub contact_newtons: f32,
    /// Shares around contact.
    pub aligned: Vec<Aligned>,
}

/// Sums up the scores of a contest. Some rows may be missing parts; none where there is no episode.
pub fn summarise(
    contest: &Contest,
    all: &[EpisodeScores],
    scope: &Scope,
) -> Result<Option<Summary>> {
    if all.is_empty() {
        return Ok(None);
    }
    let mut quality = Vec::new();
    for (place, subject) in contest.subjects.iter().enumerate() {
        let scores: Vec<&FrameScores> = all
            .iter()
            .filter_map(|episode| episode.subjects.get(place))
            .map(|scores| &scores.frames)
            .collect();
        quality.extend(rate(&subject.label, &scores).map(|quality| Quality {
            recipe: contest.candidate(subject).recipe.clone(),
            model: Some(subject.candidate),
            ahead: ahead(place, all),
            ..quality
        }));
    }
    let [held, mean] = TRIVIAL;
    let of =
        |scores: fn(&EpisodeScores) -> &FrameScores| all.iter().map(scores).collect::<Vec<_>>();
    quality.extend(rate(held, &of(|e| &e.held)));
    quality.extend(rate(mean, &of(|e| &e.mean_frame)));
    let sides = sides(contest, all);
    let (contact_newtons, aligned) = contact::aligned(contest, all);
    Ok(Some(Summary {
        scope: scope.clone(),
        protocol: contest.protocol,
        episodes: all.len(),
        models: contest.candidates.iter().map(scored).collect(),
        quality,
        seeds: sides.iter().filter_map(over_seeds).collect(),
        once: once(&sides),
        comparisons: comparisons(&sides),
        unasked: unasked(&sides),
        regression: regression::errors(contest, all)?,
        credit: credited(contest, all),
        contact_newtons,
        aligned,
    }))
}

fn scored(candidate: &Candidate) -> Scored {
    Scored {
        label: candidate.label.clone(),
        hash: candidate.hash.clone(),
        seed: candidate.seed,
    }
}

/// How far the seeds of a side lie apart; none for a single one.
fn over_seeds(side: &Side) -> Option<Seeds> {
    let mean =
        |seed: &Vec<Means>| seed.iter().map(|m| m.psnr_db).sum::<f64>() / seed.len().max(1) as f64;
    let means: Vec<f64> = side.seeds.iter().map(mean).collect();
    (means.len() > 1).then_some(Seeds {
        label: side.label(),
        seeds: means.len(),
        psnr_db: Spread::of(&means)?,
    })
}

fn rate(subject: &str, scores: &[&FrameScores]) -> Option<Quality> {
    let horizon = scores.first()?.psnr_db.len();
    let over = |of: fn(&FrameScores) -> &Vec<f64>, h: usize| {
        let values: Vec<f64> = scores
            .iter()
            .filter_map(|s| of(s).get(h).copied())
            .collect();
        Spread::of(&values)
    };
    let whole = |of: fn(&FrameScores) -> &Vec<f64>| {
        let means: Vec<f64> = scores
            .iter()
            .map(|s| of(s).iter().sum::<f64>() / horizon.max(1) as f64)
            .collect();
        Spread::of(&means)
    };
    Some(Quality {
        subject: subject.to_owned(),
        recipe: String::new(),
        model: None,
        rmse: whole(|s| &s.squared_error)?.mean.sqrt(),
        ssim: whole(|s| &s.ssim)?,
        psnr_db: whole(|s| &s.psnr_db)?,
        horizons: (0..horizon)
            .map(|h| {
                Some([
                    over(|s| &s.squared_error, h)?,
                    over(|s| &s.ssim, h)?,
                    over(|s| &s.psnr_db, h)?,
                ])
            })
            .collect::<Option<_>>()?,
        ahead: Vec::new(),
    })
}

/// How far a row is ahead of the trivial predictors at each horizon.
fn ahead(place: usize, all: &[EpisodeScores]) -> Vec<[Interval; 2]> {
    let horizon = all.first().map_or(0, |e| e.held.psnr_db.len());
    let over = |h: usize, trivial: fn(&EpisodeScores) -> &FrameScores| {
        let one = |e: &EpisodeScores| {
            let own = e.subjects.get(place)?.frames.psnr_db.get(h)?;
            Some(own - trivial(e).psnr_db.get(h)?)
        };
        let differences: Vec<f64> = all.iter().filter_map(one).collect();
        bootstrap::mean_95(&differences, 0)
    };
    (0..horizon)
        .map_while(|h| Some([over(h, |e| &e.held)?, over(h, |e| &e.mean_frame)?]))
        .collect()
}

fn credited(contest: &Contest, all: &[EpisodeScores]) -> Vec<Credited> {
    let mut rows = Vec::new();
    for (place, subject) in contest.subjects.iter().enumerate() {
        let credits: Vec<_> = all
            .iter()
            .filter_map(|episode| episode.subjects.get(place)?.credit.as_ref())
            .collect();
        let experts = &contest.candidate(subject).config.experts;
        for (i, &expert) in experts.iter().enumerate() {
            let errors: Vec<f64> = credits
                .iter()
                .filter_map(|c| c.squared_error.get(i).copied())
                .collect();
            let nlls: Vec<f64> = credits
                .iter()
                .filter_map(|c| c.nll.as_ref()?.get(i).copied())
                .collect();
            rows.extend(Spread::of(&errors).map(|squared_error| Credited {
                subject: subject.label.clone(),
                expert,
                squared_error,
                nll: Spread::of(&nlls),
            }));
        }
    }
    rows
}

/// The episodes in which `first` does worst against `second`, and equally many the other way round: indices into
/// `all`, the worst first. Rows by their place among the subjects.
pub fn extremes(
    all: &[EpisodeScores],
    [first, second]: [usize; 2],
    count: usize,
) -> [Vec<usize>; 2] {
    let error = |episode: &EpisodeScores, place: usize| {
        let scores = episode.subjects.get(place)?;
        Some(scores.frames.squared_error.iter().sum::<f64>())
    };
    let mut ranked: Vec<(usize, f64)> = all
        .iter()
        .enumerate()
        .filter_map(|(i, e)| Some((i, error(e, first)? - error(e, second)?)))
        .collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    let count = count.min(ranked.len() / 2);
    let index = |&(i, _): &(usize, f64)| i;
    [
        ranked.iter().take(count).map(index).collect(),
        ranked.iter().rev().take(count).map(index).collect(),
    ]
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;
    use crate::eval::score::SubjectScores;

    fn scores(errors: [f64; 2]) -> FrameScores {
        FrameScores {
            squared_error: errors.to_vec(),
            ssim: vec![0.9, 0.8],
            psnr_db: vec![20.0, 30.0 - errors[1]],
        }
    }

    #[test]
    fn a_row_is_averaged_as_it_says() {
        let (a, b) = (scores([4.0, 2.0]), scores([12.0, 6.0]));
        let row = rate("x", &[&a, &b]).unwrap();
        assert!(
            (row.rmse - 6.0_f64.sqrt()).abs() < 1e-12,
            "root of the mean over frames"
        );
        assert!((row.psnr_db.mean - 23.0).abs() < 1e-12);
        // Means of the episodes are 24 and 22.
        assert!((row.psnr_db.sd - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((row.horizons[0][0].mean - 8.0).abs() < 1e-12);
        assert!((row.horizons[1][2].mean - 26.0).abs() < 1e-12);
        assert_eq!(rate("x", &[]), None);
    }

    #[test]
    fn the_worst_of_either_side_are_found_equally_many() {
        let episode = |a: f64, b: f64| EpisodeScores {
            subjects: [a, b]
                .map(|e| SubjectScores {
                    frames: scores([e, e]),
                    ..SubjectScores::default()
                })
                .to_vec(),
            ..EpisodeScores::default()
        };
        let all = [
            episode(1.0, 2.0),
            episode(9.0, 1.0),
            episode(3.0, 2.0),
            episode(1.0, 8.0),
            episode(2.0, 2.0),
        ];
        assert_eq!(extremes(&all, [0, 1], 2), [vec![1, 2], vec![3, 0]]);
        assert_eq!(
            extremes(&all[..1], [0, 1], 2),
            [Vec::<usize>::new(), Vec::new()]
        );
    }
}
