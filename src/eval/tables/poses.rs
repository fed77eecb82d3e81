//! Where the object is read to be.

use super::column::{number, text, whole};
use crate::eval::regression::FittedOn;
use crate::eval::summary::Summary;
use crate::eval::table::Table;

pub(super) fn regression(summary: &Summary) -> Table {
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
            text(
                "refit_on",
                "hash of what `train` was fitted anew on; empty for what training left",
                rows,
                |r| match (r.fitted_on, &summary.scope.refit) {
                    (FittedOn::Train, Some(refit)) => refit.data_hash.clone(),
                    _ => String::new(),
                },
            ),
            whole("count", "beliefs", rows, |r| r.count as i64),
            number("rmse_cm", "root of the mean squared distance", rows, |r| {
                Some(r.rmse_cm)
            }),
            number("x_mean_cm", "mean absolute error along x", rows, |r| {
                Some(r.absolute_cm[0].mean)
            }),
            number(
                "x_sd_cm",
                "its standard deviation over beliefs",
                rows,
                |r| Some(r.absolute_cm[0].sd),
            ),
            number("y_mean_cm", "mean absolute error along y", rows, |r| {
                Some(r.absolute_cm[1].mean)
            }),
            number(
                "y_sd_cm",
                "its standard deviation over beliefs",
                rows,
                |r| Some(r.absolute_cm[1].sd),
            ),
            number(
                "xy_covariance_cm2",
                "of the absolute errors along x and y",
                rows,
                |r| Some(f64::from(r.covariance_cm2[1])),
            ),
            number("yaw_mean_deg", "mean absolute error of yaw", rows, |r| {
                r.yaw_deg.map(|s| s.mean)
            }),
            number(
                "yaw_sd_deg",
                "its standard deviation over beliefs",
                rows,
                |r| r.yaw_deg.map(|s| s.sd),
            ),
        ],
    }
}
