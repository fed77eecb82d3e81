//! Precision shares lined up with the moment of contact (D25): when does touch take over?

use crate::measure::bootstrap::{Interval, mean_95};
use crate::measure::events::{contact_newtons, onsets};
use crate::measure::fusion::{mean_share, position_shares, precision_shares};
use crate::modality::Expert;
use crate::model::config::Config;
use crate::model::probe::Probe;
use crate::model::trace::{Alphas, BeliefTrace, ExpertTrace};
use serde::Serialize;

use super::score::{Contest, EpisodeScores, Subject};

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
    if !config.prior_expert && config.experts.len() < 2 {
        return None;
    }
    let at = |belief: usize| {
        let rows = experts.experts.iter().map(|expert| expert.row(belief).1);
        let log_vars: Vec<&[f32]> = rows.chain([beliefs.prior.row(belief).1]).collect();
        let mut alphas = alphas.row(belief).to_vec();
        if let (false, Some(prior)) = (config.prior_expert, alphas.last_mut()) {
            *prior = 0.0;
        }
        let shares = precision_shares(&alphas, &log_vars);
        let variance: Vec<f32> = beliefs
            .posterior
            .row(belief)
            .1
            .iter()
            .map(|v| v.exp())
            .collect();
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
pub fn aligned(contest: &Contest, all: &[EpisodeScores]) -> (f32, Vec<Aligned>) {
    let peak = |e: &EpisodeScores| e.force_newtons.iter().copied().fold(0.0, f32::max);
    let known = contest.candidates.iter().find_map(|c| c.contact_newtons);
    let threshold = known.unwrap_or_else(|| contact_newtons(all.iter().map(peak).collect()));
    let first: Vec<Option<usize>> = all
        .iter()
        .map(|e| onsets(&e.force_newtons, threshold).first().copied())
        .collect();
    let mut rows = Vec::new();
    for (place, subject) in contest.subjects.iter().enumerate() {
        let config = &contest.candidate(subject).inspector.model().config;
        let experts = config.experts.iter().copied().chain([Expert::Prior]);
        for (i, expert) in experts.enumerate() {
            for offset in -AROUND..=AROUND {
                let values: Vec<f64> = all
                    .iter()
                    .zip(&first)
                    .filter_map(|(episode, onset)| {
                        let step = i64::try_from((*onset)?).ok()? + offset;
                        let belief = step - config.frame_stack as i64;
                        let shares = episode.subjects.get(place)?.shares.as_ref()?;
                        let share = shares.get(usize::try_from(belief).ok()?)?.get(i)?;
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
