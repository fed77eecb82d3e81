//! Precision shares lined up with the moment of contact (D25): when does touch take over?

use crate::measure::bootstrap::{Interval, mean_95};
use crate::measure::events::{contact_newtons, onsets};
use crate::measure::fusion::{mean_share, position_shares, precision_shares};
use crate::modality::Expert;
use crate::model::config::Config;
use crate::model::probe::Probe;
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace};
use serde::Serialize;

use super::score::{Candidate, Contest, EpisodeScores, Subject};

/// Steps before and after contact that are shown.
const AROUND: i64 = 6;
/// Fewer contacts than this at an offset are not averaged.
const FEW: usize = 10;

/// Precision share of each expert, the prior last, at each belief: weighted by what moves the position estimate where
/// there is a probe, else the mean over dimensions. None where nothing is multiplied.
pub(super) fn shares(
    config: &Config,
    alphas: &Alphas,
    experts: &ExpertTrace,
    beliefs: &BeliefTrace,
    probe: Option<&Probe>,
) -> Option<Vec<Vec<f32>>> {
    if !config.has_product() {
        return None;
    }
    let at = |belief: usize| {
        let factors = beliefs.factors(experts, alphas, config.prior_expert, belief);
        let shares = precision_shares(&factors);
        let (_, log_var) = beliefs.posterior.row(belief);
        let variance: Vec<f32> = log_var.iter().map(|v| v.exp()).collect();
        probe
            .and_then(|probe| position_shares(&shares, &probe.weights, &variance))
            .unwrap_or_else(|| shares.iter().map(|share| mean_share(share)).collect())
    };
    Some((0..beliefs.posterior.len()).map(at).collect())
}

/// Mean share of an expert so many steps after contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Aligned {
    /// The row.
    pub subject: String,
    /// Whose share.
    pub expert: Expert,
    /// Steps after the first contact; negative before it.
    pub offset: i64,
    /// Contacts that were averaged.
    pub contacts: usize,
    /// Their mean with its 95 % bootstrap interval.
    pub share: Interval,
}

/// Shares around the first contact of every episode, and the force that counts as one, in newtons: as the first model's
/// training set has it, else as these episodes do.
///
/// The first belief of an episode is left out: its prior is the fixed N(0, 20 I), not the dynamics, and would pass for a
/// prior that knows nothing before contact. So is an episode that starts in contact.
pub fn aligned(contest: &Contest, all: &[EpisodeScores]) -> (f32, Vec<Aligned>) {
    let peak = |e: &EpisodeScores| e.force_newtons.iter().copied().reduce(f32::max);
    let of = |c: &Candidate| c.contact_newtons.filter(|&newtons| newtons > 0.0);
    let known = contest.candidates.iter().find_map(of);
    let threshold = known.unwrap_or_else(|| contact_newtons(all.iter().filter_map(peak).collect()));
    let first: Vec<Option<usize>> = all
        .iter()
        .map(|e| {
            let known = e.force_newtons.iter().find(|force| force.is_finite());
            let onset = onsets(&e.force_newtons, threshold).first().copied();
            onset.filter(|_| known.is_some_and(|&force| force <= threshold))
        })
        .collect();
    let mut rows = Vec::new();
    for (place, subject) in contest.subjects.iter().enumerate() {
        let config = &contest.candidate(subject).config;
        let experts = config.experts.iter().copied().chain([Expert::Prior]);
        for (i, expert) in experts.enumerate() {
            for offset in -AROUND..=AROUND {
                let values: Vec<f64> = all
                    .iter()
                    .zip(&first)
                    .filter_map(|(episode, onset)| {
                        let step = i64::try_from((*onset)?).ok()? + offset;
                        let belief = usize::try_from(step - config.frame_stack as i64).ok()?;
                        let shares = episode.subjects.get(place)?.shares.as_ref()?;
                        let share = shares.get(belief).filter(|_| belief > 0)?.get(i)?;
                        Some(f64::from(*share)).filter(|share| share.is_finite())
                    })
                    .collect();
                rows.extend(averaged(subject, expert, offset, &values));
            }
        }
    }
    (threshold, rows)
}

fn averaged(subject: &Subject, expert: Expert, offset: i64, values: &[f64]) -> Option<Aligned> {
    let share = mean_95(values, 0).filter(|_| values.len() >= FEW)?;
    Some(Aligned {
        subject: subject.label.clone(),
        expert,
        offset,
        contacts: values.len(),
        share,
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;
    use crate::eval::protocol::Protocol;
    use crate::eval::score::SubjectScores;
    use crate::eval::setting::Setting;

    /// An episode of ten steps that is touched at `onset`, where vision has the share `touched`, and 0.2 elsewhere, but for
    /// 1 at the first belief.
    fn touched_at(onset: usize, touched: f32) -> EpisodeScores {
        let mut force_newtons = vec![0.0; onset];
        force_newtons.resize(10, 5.0);
        // With one frame stacked, belief 0 is of step 1.
        let share = |step: usize| match step {
            1 => 1.0,
            _ if step == onset => touched,
            _ => 0.2,
        };
        let shares = (1..10).map(|step| vec![share(step), 1.0 - share(step)]);
        EpisodeScores {
            force_newtons,
            subjects: vec![SubjectScores {
                shares: Some(shares.collect()),
                ..SubjectScores::default()
            }],
            ..EpisodeScores::default()
        }
    }

    #[test]
    fn shares_line_up_with_the_moment_of_contact() {
        let config = Config::named("v").unwrap();
        let contest = Contest {
            candidates: vec![Candidate {
                label: "v".to_owned(),
                recipe: String::new(),
                hash: String::new(),
                seed: None,
                config,
                contact_newtons: Some(1.0),
                regressors: None,
            }],
            subjects: vec![Subject {
                label: "v".to_owned(),
                candidate: 0,
                setting: Setting::default(),
            }],
            protocol: Protocol::SYNTHETIC,
        };
        let mut all: Vec<EpisodeScores> = (0..24)
            .map(|i| touched_at(3 + i % 3, if i % 2 == 0 { 0.5 } else { 0.7 }))
            .collect();
        // What is touched from the start on, let go and touched again has had its first contact before.
        let mut again = touched_at(5, 0.0);
        again.force_newtons[0] = 5.0;
        all.push(again);
        let (threshold, rows) = aligned(&contest, &all);
        assert!((threshold - 1.0).abs() < 1e-6);
        let vision = |offset: i64| {
            let own = |r: &&Aligned| r.expert == Expert::Vision && r.offset == offset;
            rows.iter().find(own)
        };
        let (before, at, after) = (vision(-1).unwrap(), vision(0).unwrap(), vision(1).unwrap());
        assert!((at.share.mean - 0.6).abs() < 1e-6 && at.contacts == 24);
        assert!(at.share.low > 0.5 && at.share.low < 0.6 && at.share.high > 0.6);
        for other in [before, after] {
            assert!((other.share.mean - 0.2).abs() < 1e-6, "{other:?}");
        }
        // Two steps before contact eight episodes have their first belief or none, six after it all but eight have ended.
        assert_eq!(vision(-2).map(|r| r.contacts), Some(16));
        assert!((vision(-2).unwrap().share.mean - 0.2).abs() < 1e-6);
        assert_eq!(vision(6), None);
        assert!(aligned(&contest, &all[..9]).1.is_empty());
    }
}
