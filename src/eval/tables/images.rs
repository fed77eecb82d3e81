//! How well images are predicted: over everything, by horizon, and frame by frame.

use super::column::{Placed, number, place, text, whole};
use crate::eval::comparison::TRIVIAL;
use crate::eval::score::{Contest, FrameScores};
use crate::eval::summary::{Quality, Scored, Summary};
use crate::eval::table::Table;
use crate::measure::bootstrap::Interval;

/// A row of an episode, its model's name, and the horizon's scores.
type FrameRow<'a> = (Placed<'a>, &'a str, &'a FrameScores, usize);
/// A row of the table of horizons.
type HorizonRow<'a> = (&'a Quality, usize);

pub(super) fn models(summary: &Summary) -> Table {
    let rows = &summary.quality;
    let scope = &summary.scope;
    let protocol = summary.protocol;
    let model = |q: &Quality| -> Option<&Scored> { summary.models.get(q.model?) };
    Table {
        name: "models",
        columns: vec![
            text(
                "model",
                "its label, or the trivial predictor's",
                rows,
                |q| q.subject.clone(),
            ),
            text("data", "what it was scored on", rows, |_| {
                scope.data.clone()
            }),
            text("data_hash", "names what that holds", rows, |_| {
                scope.data_hash.clone()
            }),
            text("split", "of it", rows, |_| scope.split.clone()),
            whole("episodes", "scored", rows, |_| summary.episodes as i64),
            number(
                "rmse",
                "root of the mean over all frames of the squared error, a sum over pixels",
                rows,
                |q| Some(q.rmse),
            ),
            number("ssim_mean", "over episodes", rows, |q| Some(q.ssim.mean)),
            number("ssim_sd", "standard deviation over episodes", rows, |q| {
                Some(q.ssim.sd)
            }),
            number("psnr_db_mean", "over episodes, in dB", rows, |q| {
                Some(q.psnr_db.mean)
            }),
            number(
                "psnr_db_sd",
                "standard deviation over episodes, in dB",
                rows,
                |q| Some(q.psnr_db.sd),
            ),
            text(
                "model_hash",
                "names what its files hold; empty for a trivial predictor",
                rows,
                |q| model(q).map_or_else(String::new, |model| model.hash.clone()),
            ),
            whole(
                "seed",
                "of its training, where its report says",
                rows,
                |q| i64::try_from(model(q)?.seed?).ok(),
            ),
            whole("context", "images seen", rows, |_| protocol.context as i64),
            whole("horizon", "images predicted", rows, |_| {
                protocol.horizon as i64
            }),
        ],
    }
}

pub(super) fn horizons(summary: &Summary) -> Table {
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

pub(super) fn frames(contest: &Contest, all: &[Placed<'_>]) -> Table {
    let mut rows = Vec::new();
    for &placed in all {
        let (_, episode) = placed;
        let subjects = contest.subjects.iter().zip(&episode.subjects);
        let ours = subjects.map(|(subject, scores)| (subject.label.as_str(), &scores.frames));
        let trivial = [
            (TRIVIAL[0], &episode.held),
            (TRIVIAL[1], &episode.mean_frame),
        ];
        for (model, scores) in ours.chain(trivial) {
            rows.extend((0..scores.psnr_db.len()).map(|h| (placed, model, scores, h)));
        }
    }
    let at = |of: fn(&FrameScores) -> &Vec<f64>| move |r: &FrameRow<'_>| of(r.2).get(r.3).copied();
    let [index, episode] = place(&rows, |r| r.0);
    Table {
        name: "frames",
        columns: vec![
            index,
            episode,
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
