//! Who is better, and how far seeds lie apart.

use super::column::{number, text, whole};
use crate::eval::summary::Summary;
use crate::eval::table::Table;

pub(super) fn comparisons(summary: &Summary) -> Table {
    let rows = &summary.comparisons;
    Table {
        name: "comparisons",
        columns: vec![
            text("first", "claimed to be better", rows, |c| c.first.clone()),
            text("second", "than this", rows, |c| c.second.clone()),
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
            whole(
                "seeds_won",
                "pairs of seeds in which the first has the higher mean PSNR",
                rows,
                |c| c.seeds.map(|[won, _]| won as i64),
            ),
            whole("seeds", "pairs of seeds", rows, |c| {
                c.seeds.map(|[_, all]| all as i64)
            }),
            text("finding", "by the interval of PSNR", rows, |c| {
                c.finding.name().to_owned()
            }),
        ],
    }
}

pub(super) fn seeds(summary: &Summary) -> Table {
    let rows = &summary.seeds;
    Table {
        name: "seeds",
        columns: vec![
            text("model", "without its seed", rows, |s| s.label.clone()),
            whole("seeds", "how many", rows, |s| s.seeds as i64),
            number("psnr_db_mean", "over seeds, in dB", rows, |s| {
                Some(s.psnr_db.mean)
            }),
            number(
                "psnr_db_sd",
                "standard deviation over seeds, in dB",
                rows,
                |s| Some(s.psnr_db.sd),
            ),
        ],
    }
}
