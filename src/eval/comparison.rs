//! Which of two is better, on the same episodes, and whether that can be said at all.

use super::score::{FrameScores, group};
use crate::measure::bootstrap::{Interval, mean_95};
use serde::Serialize;

/// The names of the predictors that anybody could write.
pub const TRIVIAL: [&str; 2] = ["last frame held", "mean frame"];

/// One side of a comparison: an average over seeds where there are several.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// The model's name, or the trivial predictor's.
    pub model: String,
    /// Of its training; empty where all have the same.
    pub recipe: String,
    /// Empty as trained.
    pub setting: String,
    /// Scores of each seed, the least seed first: for each an episode's means over the horizon.
    pub seeds: Vec<Vec<Means>>,
}

impl Side {
    /// Nothing switched or damaged.
    pub(super) fn as_trained(&self) -> bool {
        self.setting.is_empty()
    }

    /// No model, but what anybody could write.
    pub(super) fn is_trivial(&self) -> bool {
        TRIVIAL.contains(&self.model.as_str())
    }

    /// How it is called.
    pub fn label(&self) -> String {
        let group = group(&self.model, &self.recipe);
        match self.setting.as_str() {
            "" => group,
            setting => format!("{group} ({setting})"),
        }
    }
}

/// Means over the horizon of an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Means {
    /// Sum over pixels.
    pub squared_error: f64,
    /// Data range 1.
    pub ssim: f64,
    /// In dB.
    pub psnr_db: f64,
}

impl Means {
    /// Of an episode's scores.
    pub fn of(scores: &FrameScores) -> Self {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        Self {
            squared_error: mean(&scores.squared_error),
            ssim: mean(&scores.ssim),
            psnr_db: mean(&scores.psnr_db),
        }
    }
}

/// What can be said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The first is better, and the interval leaves out zero.
    Holds,
    /// It is the other way round, and the interval leaves out zero.
    Reversed,
    /// The interval has zero in it.
    Open,
    /// Of so few episodes an interval says little.
    TooFew,
}

/// Fewer episodes than this tell nothing: with three, one difference in four has the same sign in all by chance.
const FEW: usize = 10;

impl Finding {
    /// In a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Reversed => "the other way round",
            Self::Open => "cannot be told",
            Self::TooFew => "too few episodes",
        }
    }
}

/// The first side less the second, paired over episodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Claimed to be better.
    pub first: String,
    /// Than which.
    pub second: String,
    /// Episodes.
    pub episodes: usize,
    /// Difference of PSNR in dB, with its 95 % bootstrap interval.
    pub psnr_db: Interval,
    /// Of structural similarity.
    pub ssim: Interval,
    /// Of squared error, a sum over pixels: negative where the first is better.
    pub squared_error: Interval,
    /// Part of the episodes in which the first has the higher PSNR.
    pub won: f64,
    /// Seeds in which it has the higher mean PSNR, of how many pairs of seeds; none for a single one.
    pub seeds: Option<[usize; 2]>,
    /// By PSNR.
    pub finding: Finding,
}

impl Comparison {
    /// In words.
    pub fn sentence(&self) -> String {
        let Self { first, second, .. } = self;
        let Interval { mean, low, high } = self.psnr_db;
        let of = format!("{} episodes", self.episodes);
        let seeds = self.seeds.map_or_else(String::new, |[won, all]| {
            format!("; the first is ahead in {won} of {all} seeds")
        });
        match self.finding {
            Finding::Holds => format!(
                "`{first}` predicts better than `{second}`, by {mean:.2} dB [{low:.2}, {high:.2}] on {of}: holds{seeds}"
            ),
            Finding::Reversed => format!(
                "`{first}` predicts worse than `{second}`, by {:.2} dB [{:.2}, {:.2}] on {of}: does not hold, it is the other way round{seeds}",
                -mean, -high, -low
            ),
            Finding::Open => format!(
                "`{first}` and `{second}` cannot be told apart, {mean:+.2} dB [{low:+.2}, {high:+.2}] on {of}{seeds}"
            ),
            Finding::TooFew => format!(
                "`{first}` less `{second}` is {mean:+.2} dB on {of}: too few to tell, {FEW} or more are wanted{seeds}"
            ),
        }
    }
}

/// Compares two sides over the same episodes. None without an episode.
pub fn compare(first: &Side, second: &Side) -> Option<Comparison> {
    let average = |side: &Side, episode: usize| -> Option<Means> {
        let seeds: Vec<&Means> = side
            .seeds
            .iter()
            .map(|s| s.get(episode))
            .collect::<Option<_>>()?;
        let mean = |of: fn(&Means) -> f64| {
            seeds.iter().map(|m| of(m)).sum::<f64>() / seeds.len().max(1) as f64
        };
        Some(Means {
            squared_error: mean(|m| m.squared_error),
            ssim: mean(|m| m.ssim),
            psnr_db: mean(|m| m.psnr_db),
        })
    };
    let episodes = first.seeds.first()?.len();
    let pairs: Vec<(Means, Means)> = (0..episodes)
        .map(|e| average(first, e).zip(average(second, e)))
        .collect::<Option<_>>()?;
    let difference =
        |of: fn(&Means) -> f64| -> Vec<f64> { pairs.iter().map(|(a, b)| of(a) - of(b)).collect() };
    let psnr = difference(|m| m.psnr_db);
    let psnr_db = mean_95(&psnr, 0)?;
    let finding = match psnr_db {
        _ if episodes < FEW => Finding::TooFew,
        Interval { low, .. } if low > 0.0 => Finding::Holds,
        Interval { high, .. } if high < 0.0 => Finding::Reversed,
        _ => Finding::Open,
    };
    Some(Comparison {
        first: first.label(),
        second: second.label(),
        episodes,
        psnr_db,
        ssim: mean_95(&difference(|m| m.ssim), 0)?,
        squared_error: mean_95(&difference(|m| m.squared_error), 0)?,
        won: psnr.iter().filter(|&&d| d > 0.0).count() as f64 / episodes as f64,
        seeds: agreement(first, second),
        finding,
    })
}

/// In how many pairs of seeds the first side has the higher mean PSNR; a side of one seed stands against each of the
/// other's.
fn agreement(first: &Side, second: &Side) -> Option<[usize; 2]> {
    let mean = |seed: &Vec<Means>| seed.iter().map(|m| m.psnr_db).sum::<f64>();
    let count = first.seeds.len().max(second.seeds.len());
    let even = |side: &Side| [1, count].contains(&side.seeds.len());
    if count < 2 || !even(first) || !even(second) {
        return None;
    }
    let at = |side: &Side, i: usize| side.seeds.get(i % side.seeds.len()).map(mean);
    let won = (0..count).filter(|&i| at(first, i) > at(second, i)).count();
    Some([won, count])
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
pub(super) mod tests {
    use super::*;

    type Psnr = fn(usize) -> f64;

    /// `model/recipe`, or `model/recipe/setting`.
    pub fn side(name: &str, seeds: &[Psnr]) -> Side {
        let seed = |psnr: &Psnr| {
            let of = |i| Means {
                psnr_db: psnr(i),
                ..Means::default()
            };
            (0..40).map(of).collect()
        };
        let mut parts = name.split('/').map(str::to_owned);
        let mut part = || parts.next().unwrap_or_default();
        Side {
            model: part(),
            recipe: part(),
            setting: part(),
            seeds: seeds.iter().map(seed).collect(),
        }
    }

    #[test]
    fn a_finding_is_what_the_interval_says() {
        // Episodes differ by far more than the models: only pairs can tell.
        let base: Psnr = |i| 20.0 + 5.0 * (i as f64).sin();
        let better: Psnr = |i| 20.5 + 5.0 * (i as f64).sin() + 0.1 * (i as f64 * 0.3).cos();
        let noisy: Psnr = |i| 20.0 + 5.0 * (i as f64).sin() + if i % 2 == 0 { 1.0 } else { -1.0 };
        let (a, b, c) = (
            side("a", &[better]),
            side("b", &[base]),
            side("c", &[noisy]),
        );
        let found = compare(&a, &b).unwrap();
        assert_eq!((found.finding, found.seeds), (Finding::Holds, None));
        assert!((found.psnr_db.mean - 0.5).abs() < 0.05 && (found.won - 1.0).abs() < 1e-12);
        assert!(found.sentence().ends_with("holds"), "{}", found.sentence());
        let reversed = compare(&b, &a).unwrap();
        assert_eq!(reversed.finding, Finding::Reversed);
        let said = reversed.sentence();
        assert!(
            said.starts_with("`b` predicts worse than `a`, by 0.5") && !said.contains('-'),
            "{said}"
        );
        let open = compare(&c, &b).unwrap();
        assert_eq!(open.finding, Finding::Open);
        assert!(open.sentence().contains("cannot be told apart"));
        // Nine episodes of one sign are not enough to say so.
        let mut few = [a, b];
        for side in &mut few {
            side.seeds[0].truncate(9);
        }
        let few = compare(&few[0], &few[1]).unwrap();
        assert!(few.psnr_db.low > 0.0 && few.finding == Finding::TooFew);
        assert!(few.sentence().contains("on 9 episodes: too few"));
    }

    #[test]
    fn seeds_are_averaged_and_counted() {
        let (low, high): (Psnr, Psnr) = (|_| 19.0, |_| 21.0);
        let one: Psnr = |_| 20.0;
        let found = compare(&side("a", &[low, high, high]), &side("b", &[one])).unwrap();
        assert_eq!(found.seeds, Some([2, 3]));
        assert!((found.psnr_db.mean - 1.0 / 3.0).abs() < 1e-9);
        assert_eq!(
            compare(&side("a", &[low, high]), &side("b", &[one; 3]))
                .unwrap()
                .seeds,
            None
        );
        assert_eq!(compare(&side("a", &[]), &side("b", &[one])), None);
    }
}
