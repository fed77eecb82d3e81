//! Every number as rows: one a frame and model, one a regressor, one a comparison, and so on.

use super::comparison::TRIVIAL;
use super::score::{Contest, EpisodeScores, FrameScores};
use super::summary::{Quality, Summary};
use super::table::{Cells, Column, Table};
use crate::measure::bootstrap::Interval;

/// Collects a column from rows.
fn text<T>(
    name: &'static str,
    about: &'static str,
    rows: &[T],
    of: impl Fn(&T) -> String,
) -> Column {
    let cells = Cells::Text(rows.iter().map(of).collect());
    Column { name, about, cells }
}

fn whole<T>(name: &'static str, about: &'static str, rows: &[T], of: impl Fn(&T) -> i64) -> Column {
    let cells = Cells::Whole(rows.iter().map(of).collect());
    Column { name, about, cells }
}

fn number<T>(
    name: &'static str,
    about: &'static str,
    rows: &[T],
    of: impl Fn(&T) -> Option<f64>,
) -> Column {
    let finite = |row| of(row).filter(|number| number.is_finite());
    let cells = Cells::Number(rows.iter().map(finite).collect());
    Column { name, about, cells }
}

/// A row of an episode, its model's name, and the horizon's scores.
type FrameRow<'a> = (&'a EpisodeScores, &'a str, &'a FrameScores, usize);
/// A row of the table of horizons.
type HorizonRow<'a> = (&'a Quality, usize);

/// All tables.
pub fn tables(contest: &Contest, all: &[EpisodeScores], summary: &Summary) -> Vec<Table> {
    vec![
        frames(contest, all),
        quality(summary),
        comparisons(summary),
        regression(summary),
        credit(contest, all),
        contact(summary),
    ]
}

fn frames(contest: &Contest, all: &[EpisodeScores]) -> Table {
    let mut rows = Vec::new();
    for episode in all {
        let subjects = contest.subjects.iter().zip(&episode.subjects);
        let ours = subjects.map(|(subject, scores)| (subject.label.as_str(), &scores.frames));
        let trivial = [
            (TRIVIAL[0], &episode.held),
            (TRIVIAL[1], &episode.mean_frame),
        ];
        for (model, scores) in ours.chain(trivial) {
            rows.extend((0..scores.psnr_db.len()).map(|h| (episode, model, scores, h)));
        }
    }
    let at = |of: fn(&FrameScores) -> &Vec<f64>| move |r: &FrameRow<'_>| of(r.2).get(r.3).copied();
    Table {
        name: "frames",
        columns: vec![
            text("episode", "its name", &rows, |r| r.0.episode.clone()),
            text(
                "model",
                "its label, or the trivial predictor's",
                &rows,
                |r| r.1.to_owned(),
            ),
            whole("horizon", "images after the context, from 1", &rows, |r| {
                r.3 as i64 + 1
            }),
            number(
                "squared_error",
                "sum over pixels of squared differences, grey values 0 to 1",
                &rows,
                at(|s| &s.squared_error),
            ),
            number(
                "ssim",
                "structural similarity, 7 x 7 uniform window, data range 1",
                &rows,
                at(|s| &s.ssim),
            ),
            number(
                "psnr_db",
                "peak signal-to-noise ratio in dB, data range 1",
                &rows,
                at(|s| &s.psnr_db),
            ),
        ],
    }
}

fn quality(summary: &Summary) -> Table {
    let rows: Vec<_> = summary
        .quality
        .iter()
        .flat_map(|q| (0..q.horizons.len()).map(move |h| (q, h)))
        .collect();
    let mean = |k: usize| move |r: &HorizonRow<'_>| Some(r.0.horizons[r.1][k].mean);
    let sd = |k: usize| move |r: &HorizonRow<'_>| Some(r.0.horizons[r.1][k].sd);
    let ahead = |k: usize, of: fn(&Interval) -> f64| {
        move |r: &HorizonRow<'_>| r.0.ahead.get(r.1).map(|both| of(&both[k]))
    };
    Table {
        name: "horizons",
        columns: vec![
            text(
                "model",
                "its label, or the trivial predictor's",
                &rows,
                |r| r.0.subject.clone(),
            ),
            whole("horizon", "images after the context, from 1", &rows, |r| {
                r.1 as i64 + 1
            }),
            number(
                "squared_error_mean",
                "over episodes, sum over pixels",
                &rows,
                mean(0),
            ),
            number(
                "squared_error_sd",
                "standard deviation over episodes",
                &rows,
                sd(0),
            ),
            number("ssim_mean", "over episodes", &rows, mean(1)),
            number("ssim_sd", "standard deviation over episodes", &rows, sd(1)),
            number("psnr_db_mean", "over episodes, in dB", &rows, mean(2)),
            number(
                "psnr_db_sd",
                "standard deviation over episodes, in dB",
                &rows,
                sd(2),
            ),
            number(
                "over_held_db",
                "PSNR over that of the last frame held",
                &rows,
                ahead(0, |i| i.mean),
            ),
            number(
                "over_held_db_low",
                "lower end of its 95 % bootstrap interval",
                &rows,
                ahead(0, |i| i.low),
            ),
            number(
                "over_held_db_high",
                "upper end",
                &rows,
                ahead(0, |i| i.high),
            ),
            number(
                "over_mean_frame_db",
                "PSNR over that of the mean training frame",
                &rows,
                ahead(1, |i| i.mean),
            ),
            number(
                "over_mean_frame_db_low",
                "lower end of its interval",
                &rows,
                ahead(1, |i| i.low),
            ),
            number(
                "over_mean_frame_db_high",
                "upper end",
                &rows,
                ahead(1, |i| i.high),
            ),
        ],
    }
}

fn comparisons(summary: &Summary) -> Table {
    let rows = &summary.comparisons;
    Table {
        name: "comparisons",
        columns: vec![
            text("first", "claimed to be better", rows, |c| c.better.clone()),
            text("second", "than this", rows, |c| c.worse.clone()),
            whole("episodes", "pairs", rows, |c| c.episodes as i64),
            number(
                "psnr_db",
                "first less second in dB, mean over episodes",
                rows,
                |c| Some(c.psnr_db.mean),
            ),
            number(
                "psnr_db_low",
                "lower end of its 95 % bootstrap interval",
                rows,
                |c| Some(c.psnr_db.low),
            ),
            number("psnr_db_high", "upper end", rows, |c| Some(c.psnr_db.high)),
            number("ssim", "first less second", rows, |c| Some(c.ssim.mean)),
            number("ssim_low", "lower end of its interval", rows, |c| {
                Some(c.ssim.low)
            }),
            number("ssim_high", "upper end", rows, |c| Some(c.ssim.high)),
            number(
                "squared_error",
                "first less second, sum over pixels",
                rows,
                |c| Some(c.squared_error.mean),
            ),
            number(
                "squared_error_low",
                "lower end of its interval",
                rows,
                |c| Some(c.squared_error.low),
            ),
            number("squared_error_high", "upper end", rows, |c| {
                Some(c.squared_error.high)
            }),
            number(
                "won",
                "part of the episodes in which the first has the higher PSNR",
                rows,
                |c| Some(c.won),
            ),
            text("finding", "by the interval of PSNR", rows, |c| {
                c.finding.name().to_owned()
            }),
        ],
    }
}

fn regression(summary: &Summary) -> Table {
    let rows = &summary.regression;
    Table {
        name: "regression",
        columns: vec![
            text("model", "its label", rows, |r| r.subject.clone()),
            text("beliefs", "filtered or predicted", rows, |r| {
                r.beliefs.name().to_owned()
            }),
            text("regressor", "least squares or network", rows, |r| {
                r.regressor.name().to_owned()
            }),
            text(
                "fitted_on",
                "train, or the scored split itself",
                rows,
                |r| r.fitted_on.name().to_owned(),
            ),
            whole("count", "beliefs", rows, |r| r.count as i64),
            number("rmse_cm", "root of the mean squared distance", rows, |r| {
                Some(r.rmse_cm)
            }),
            number("x_mean_cm", "mean absolute error along x", rows, |r| {
                Some(r.absolute_cm[0].mean)
            }),
            number("x_sd_cm", "its standard deviation", rows, |r| {
                Some(r.absolute_cm[0].sd)
            }),
            number("y_mean_cm", "mean absolute error along y", rows, |r| {
                Some(r.absolute_cm[1].mean)
            }),
            number("y_sd_cm", "its standard deviation", rows, |r| {
                Some(r.absolute_cm[1].sd)
            }),
            number("yaw_mean_deg", "mean absolute error of yaw", rows, |r| {
                r.yaw_deg.map(|s| s.mean)
            }),
            number("yaw_sd_deg", "its standard deviation", rows, |r| {
                r.yaw_deg.map(|s| s.sd)
            }),
        ],
    }
}

fn credit(contest: &Contest, all: &[EpisodeScores]) -> Table {
    let mut rows = Vec::new();
    for episode in all {
        for (subject, scores) in contest.subjects.iter().zip(&episode.subjects) {
            let Some(credit) = &scores.credit else {
                continue;
            };
            let experts = &contest.candidate(subject).inspector.model().config.experts;
            rows.extend(
                experts
                    .iter()
                    .enumerate()
                    .map(|(i, e)| (episode, subject, credit, i, *e)),
            );
        }
    }
    Table {
        name: "shapley",
        columns: vec![
            text("episode", "its name", &rows, |r| r.0.episode.clone()),
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

fn contact(summary: &Summary) -> Table {
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
