//! What each sensor contributes, and when.

use super::column::{Placed, number, place, text, whole};
use crate::eval::credit::Credit;
use crate::eval::score::{Contest, Subject};
use crate::eval::summary::Summary;
use crate::eval::table::Table;
use crate::modality::Expert;

/// A row of an episode, and which of its model's experts.
type CreditRow<'a> = (Placed<'a>, &'a Subject, &'a Credit, usize, Expert);

pub(super) fn shapley(contest: &Contest, all: &[Placed<'_>]) -> Table {
    let mut rows: Vec<CreditRow<'_>> = Vec::new();
    for &placed in all {
        for (subject, scores) in contest.subjects.iter().zip(&placed.1.subjects) {
            let Some(credit) = &scores.credit else {
                continue;
            };
            let experts = &contest.candidate(subject).config.experts;
            rows.extend(
                experts
                    .iter()
                    .enumerate()
                    .map(|(i, e)| (placed, subject, credit, i, *e)),
            );
        }
    }
    let [index, episode] = place(&rows, |r| r.0);
    Table {
        name: "shapley",
        columns: vec![
            index,
            episode,
            text("model", "its label", &rows, |r| r.1.label.clone()),
            text("expert", "whose Shapley value", &rows, |r| {
                r.4.name().to_owned()
            }),
            number(
                "squared_error",
                "of minus the squared error, sum over pixels, mean over the horizon",
                &rows,
                |r| r.2.squared_error.get(r.3).copied(),
            ),
            number(
                "nll",
                "of minus the position's negative log-likelihood in nats, mean over the horizon",
                &rows,
                |r| r.2.nll.as_ref()?.get(r.3).copied(),
            ),
        ],
    }
}

pub(super) fn contact(summary: &Summary) -> Table {
    let rows = &summary.aligned;
    Table {
        name: "contact",
        columns: vec![
            text("model", "its label", rows, |r| r.subject.clone()),
            text("expert", "whose precision share", rows, |r| {
                r.expert.name().to_owned()
            }),
            whole("offset", "steps after the first contact", rows, |r| {
                r.offset
            }),
            whole("contacts", "averaged", rows, |r| r.contacts as i64),
            number("share", "mean precision share, 0 to 1", rows, |r| {
                Some(r.share.mean)
            }),
            number(
                "share_low",
                "lower end of its 95 % bootstrap interval",
                rows,
                |r| Some(r.share.low),
            ),
            number("share_high", "upper end", rows, |r| Some(r.share.high)),
        ],
    }
}
