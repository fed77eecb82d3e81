//! The named numbers that tables, channels and lines of JSON are made of.

use super::Step;
use crate::modality::Expert;

/// A number with its name. The name ends in the unit, where it has one.
pub struct Reading<F> {
    /// Name in tables and topics.
    pub name: &'static str,
    /// What it is.
    pub says: &'static str,
    /// Its value; none where it is not known.
    pub of: F,
}

/// Of a step.
pub type OfStep = fn(&Step<'_>) -> Option<f32>;
/// Of the expert of this place at a step.
pub type OfExpert = fn(&Step<'_>, usize) -> Option<f32>;

const fn reading<F>(name: &'static str, says: &'static str, of: F) -> Reading<F> {
    Reading { name, says, of }
}

/// The numbers of a step.
pub const READINGS: &[Reading<OfStep>] = &[
    reading(
        "trained",
        "1 where the model was trained on the switches, 0 where not; none without a product",
        |step| Some(f32::from(u8::from(step.trained()?))),
    ),
    reading(
        "psnr_belief_db",
        "PSNR of the decoded belief, dB, data range 1",
        |step| step.at.psnr_db.get(step.at.cursor)?.belief,
    ),
    reading(
        "psnr_prediction_db",
        "PSNR of the decoded prediction, dB",
        |step| step.at.psnr_db.get(step.at.cursor)?.prediction,
    ),
    reading(
        "squared_error_belief",
        "sum over pixels of the squared error of the decoded belief, grey values from 0 to 1",
        |step| step.squared_error(step.cell()?.belief.as_deref()),
    ),
    reading(
        "squared_error_prediction",
        "the same of the decoded prediction",
        |step| step.squared_error(step.cell()?.prediction.as_deref()),
    ),
    reading(
        "force_n",
        "root mean square force over the step's window, N",
        |step| {
            let episode = step.at.episode.as_ref()?;
            episode.force_newtons.get(step.at.cursor).copied()
        },
    ),
    reading("truth_x_m", "recorded position of the object, m", |step| {
        Some(step.truth()?[0])
    }),
    reading("truth_y_m", "recorded position of the object, m", |step| {
        Some(step.truth()?[1])
    }),
    reading(
        "truth_yaw_rad",
        "recorded angle of the object, rad",
        |step| Some(step.truth()?[2]),
    ),
    reading(
        "tip_x_m",
        "recorded position of the end effector, m",
        |step| Some(step.tip()?[0]),
    ),
    reading(
        "tip_y_m",
        "recorded position of the end effector, m",
        |step| Some(step.tip()?[1]),
    ),
    reading("belief_x_m", "position read from the belief, m", |step| {
        Some(step.belief()?.x)
    }),
    reading("belief_y_m", "position read from the belief, m", |step| {
        Some(step.belief()?.y)
    }),
    reading(
        "belief_xx_m2",
        "covariance of that position, the probe's R_p included, m²",
        |step| Some(step.belief()?.covariance[0]),
    ),
    reading("belief_xy_m2", "covariance of that position, m²", |step| {
        Some(step.belief()?.covariance[1])
    }),
    reading("belief_yy_m2", "covariance of that position, m²", |step| {
        Some(step.belief()?.covariance[2])
    }),
    reading(
        "belief_error_m",
        "its distance from the recorded one, m",
        |step| step.position()?.belief_error_m,
    ),
    reading(
        "prediction_x_m",
        "position read from the prediction, m",
        |step| Some(step.prediction()?.x),
    ),
    reading(
        "prediction_y_m",
        "position read from the prediction, m",
        |step| Some(step.prediction()?.y),
    ),
    reading(
        "prediction_xx_m2",
        "covariance of that position by the head's one-step spread, R_p included, m²",
        |step| Some(step.prediction()?.covariance[0]),
    ),
    reading(
        "prediction_xy_m2",
        "covariance of that position, m²",
        |step| Some(step.prediction()?.covariance[1]),
    ),
    reading(
        "prediction_yy_m2",
        "covariance of that position, m²",
        |step| Some(step.prediction()?.covariance[2]),
    ),
    reading(
        "prediction_error_m",
        "its distance from the recorded one, m",
        |step| step.position()?.prediction_error_m,
    ),
    reading(
        "prior_x_m",
        "position read from the prior alone, m",
        |step| Some(step.at.fusion.as_ref()?.prior_m?[0]),
    ),
    reading(
        "prior_y_m",
        "position read from the prior alone, m",
        |step| Some(step.at.fusion.as_ref()?.prior_m?[1]),
    ),
    reading(
        "nees",
        "NEES of the belief's position, R_p included (D11); χ² of 2",
        |step| step.in_series(|series| &series.nees),
    ),
    reading("nees_without_rp", "the same without R_p", |step| {
        step.in_series(|series| &series.nees_bare)
    }),
    reading("surprise_nats", "KL(belief ‖ prior), nats (D2)", |step| {
        step.in_series(|series| &series.surprise)
    }),
    reading(
        "conflict",
        "conflict energy of the experts that are on (D10); χ² of `conflict_dof`",
        |step| step.in_series(|series| &series.conflict),
    ),
    reading("conflict_dof", "its degrees of freedom", |step| {
        Some(step.at.fusion.as_ref()?.conflict?.dof as f32)
    }),
    reading(
        "nis_dof",
        "degrees of freedom of every NIS: the active dimensions (D19)",
        |step| {
            let mut experts = step.at.fusion.as_ref()?.experts.iter();
            Some(experts.find_map(|expert| expert.nis)?.dof as f32)
        },
    ),
];

/// The numbers of one expert at a step.
pub const OF_EXPERT: &[Reading<OfExpert>] = &[
    reading(
        "alpha",
        "α: 0 off, 1 as trained; 0 for a prior that the model does not multiply",
        |step, i| Some(step.alpha(i)),
    ),
    reading(
        "share_mean",
        "share of the belief's precision, mean over the latent (D1)",
        |step, i| Some(step.expert(i)?.share_mean).filter(|_| step.at.belief.is_some()),
    ),
    reading(
        "share_position",
        "the same weighted by what moves the position (D1)",
        |step, i| step.expert(i)?.share_position,
    ),
    reading(
        "information_nats",
        "entropy that it removes when it comes last, nats (D5)",
        |step, i| step.reading(i)?.information_nats,
    ),
    reading(
        "mahalanobis",
        "how far the belief without it is from the belief, in σ of the former (D6)",
        |step, i| step.reading(i)?.mahalanobis,
    ),
    reading(
        "overruled_mean_nats",
        "part of KL(belief ‖ expert) that is of the means: how far it was overruled, nats (D3)",
        |step, i| Some(step.reading(i)?.fused?.mean),
    ),
    reading(
        "overruled_spread_nats",
        "the part of the spreads: how much vaguer it is than the belief, nats (D3)",
        |step, i| Some(step.reading(i)?.fused?.spread),
    ),
    reading(
        "without_x_m",
        "the belief's position without it, m (D6)",
        |step, i| Some(step.reading(i)?.without?.x),
    ),
    reading(
        "without_y_m",
        "the belief's position without it, m (D6)",
        |step, i| Some(step.reading(i)?.without?.y),
    ),
];

/// Those of a sensor expert besides.
pub const OF_SENSOR: &[Reading<OfExpert>] = &[
    reading(
        "nis_head",
        "NIS against the prior's own spread (D8)",
        |step, i| Some(step.reading(i)?.nis?.head),
    ),
    reading(
        "nis_propagated",
        "NIS against A P Aᵀ + Q (D8); χ² of `nis_dof`",
        |step, i| step.reading(i)?.nis?.propagated,
    ),
    reading(
        "pull_x_m",
        "what it pulls the position by, m (D7)",
        |step, i| Some(step.reading(i)?.pull_m?[0]),
    ),
    reading(
        "pull_y_m",
        "what it pulls the position by, m (D7)",
        |step, i| Some(step.reading(i)?.pull_m?[1]),
    ),
    reading(
        "claim_mean_nats",
        "part of KL(expert ‖ prior) that is of the means, nats (D4)",
        |step, i| Some(step.reading(i)?.claim?.mean),
    ),
    reading(
        "claim_spread_nats",
        "the part of the spreads, nats (D4)",
        |step, i| Some(step.reading(i)?.claim?.spread),
    ),
];

/// Those that an expert has.
pub fn readings_of(expert: Expert) -> impl Iterator<Item = &'static Reading<OfExpert>> {
    let sensor = if expert == Expert::Prior {
        &[]
    } else {
        OF_SENSOR
    };
    OF_EXPERT.iter().chain(sensor)
}

/// A number of [`READINGS`] by its name.
pub fn named(step: &Step<'_>, name: &str) -> Option<f32> {
    let reading = READINGS.iter().find(|reading| reading.name == name)?;
    (reading.of)(step).filter(|value| value.is_finite())
}
