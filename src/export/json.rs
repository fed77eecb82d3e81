//! JSON Lines: an object a step and model, with every number at full precision. What is not known, or not finite, is
//! null; each line has the same keys, so that tools find one schema.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::output::Output;
use super::step::Step;
use super::{ExportError, ModelOrigin, ProbeOrigin, Run, Sink};
use crate::episode::Split;
use crate::measure::divergence::KlParts;
use crate::measure::innovation::{Conflict, Nis};
use crate::modality::Expert;
use crate::session::snapshot::{Estimate, LatentView};

/// The file, growing.
pub struct Lines(Output);

impl Lines {
    /// Begins the file.
    ///
    /// # Errors
    /// If it cannot be begun.
    pub fn create(out: &Path, force: bool) -> Result<Self, ExportError> {
        Output::create(out, force).map(Self)
    }
}

impl Sink for Lines {
    fn take(&mut self, run: &Run) -> Result<(), ExportError> {
        let failed = self.0.failed();
        for step in Step::of(run) {
            serde_json::to_writer(&mut self.0, &line(&step))
                .map_err(std::io::Error::from)
                .and_then(|()| self.0.write_all(b"\n"))
                .map_err(&failed)?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        self.0.commit()
    }
}

/// One line.
#[derive(Serialize)]
struct Line<'a> {
    episode: &'a str,
    split: Option<&'static str>,
    model: &'a str,
    /// From 1.
    step: usize,
    stamp_ns: Option<i64>,
    secs: Option<f64>,
    context: usize,
    horizon: usize,
    trained: Option<bool>,
    /// The sensor experts.
    experts: Vec<ExpertLine<'a>>,
    prior: Option<ExpertLine<'a>>,
    posterior: Gaussian<'a>,
    /// Dimensions that count for NIS, conflict and disagreement.
    active: Option<&'a [bool]>,
    surprise: Option<KlParts>,
    conflict: Option<Conflict>,
    disagreements: Vec<DisagreementLine>,
    position: Position,
    frames: Frames,
    probe: Option<&'a ProbeOrigin>,
    provenance: Origin<'a>,
}

/// One expert; `mean` and `log_var` are as the model states them, before α.
#[derive(Serialize)]
struct ExpertLine<'a> {
    name: &'static str,
    alpha: f32,
    mean: Option<&'a [f32]>,
    log_var: Option<&'a [f32]>,
    share: Option<&'a [f32]>,
    share_mean: Option<f32>,
    share_position: Option<f32>,
    nis: Option<Nis>,
    information_nats: Option<f32>,
    mahalanobis: Option<f32>,
    pull_m: Option<[f32; 2]>,
    overruled_nats: Option<KlParts>,
    claim_nats: Option<KlParts>,
    without: Option<Estimate>,
}

#[derive(Default, Serialize)]
struct Gaussian<'a> {
    mean: Option<&'a [f32]>,
    log_var: Option<&'a [f32]>,
}

#[derive(Serialize)]
struct DisagreementLine {
    a: &'static str,
    b: &'static str,
    distance: f32,
    dof: usize,
}

/// Metres; covariances as xx, xy, yy in square metres.
#[derive(Serialize)]
struct Position {
    truth: Option<[f32; 2]>,
    truth_yaw_rad: Option<f32>,
    tip: Option<[f32; 2]>,
    belief: Option<Estimate>,
    belief_error_m: Option<f32>,
    prediction: Option<Estimate>,
    prediction_error_m: Option<f32>,
    nees: Option<f32>,
    nees_without_rp: Option<f32>,
}

#[derive(Serialize)]
struct Frames {
    psnr_belief_db: Option<f32>,
    psnr_prediction_db: Option<f32>,
    squared_error_belief: Option<f32>,
    squared_error_prediction: Option<f32>,
}

#[derive(Serialize)]
struct Origin<'a> {
    poescope: &'a str,
    data: &'a str,
    data_hash: &'a str,
    model_hash: &'a str,
    model_source: &'a str,
    model_config: &'a str,
    seed: u64,
    state: &'a str,
}

fn line<'a>(step: &Step<'a>) -> Line<'a> {
    let (at, run) = (step.at, step.run);
    let model: Option<&ModelOrigin> = step.model();
    let fusion = at.fusion.as_deref();
    let posterior = step.posterior().map(gaussian).unwrap_or_default();
    let count = at.experts.len();
    let is_prior = |i: &usize| step.expert(*i).is_some_and(|e| e.expert == Expert::Prior);
    let name = |i: usize| step.expert(i).map_or("", |expert| expert.expert.name());
    let truth = step.truth();
    let meta = &run.episode.meta;
    let read = |name| super::step::named(step, name);
    Line {
        episode: &meta.id,
        split: meta.split.map(Split::name),
        model: model.map_or("", |model| &model.name),
        step: at.cursor + 1,
        stamp_ns: step.stamp_nanos(),
        secs: step.secs(),
        context: at.context,
        horizon: at.horizon,
        trained: step.trained(),
        experts: (0..count)
            .filter(|i| !is_prior(i))
            .map(|i| expert(step, i))
            .collect(),
        prior: (0..count).find(is_prior).map(|i| expert(step, i)),
        posterior,
        active: fusion.map(|fusion| fusion.active.as_slice()),
        surprise: fusion.and_then(|fusion| fusion.surprise),
        conflict: fusion.and_then(|fusion| fusion.conflict),
        disagreements: fusion.map_or_else(Vec::new, |fusion| {
            let pairs = fusion.disagreements.iter();
            pairs
                .map(|pair| DisagreementLine {
                    a: name(pair.a),
                    b: name(pair.b),
                    distance: pair.distance,
                    dof: pair.dof,
                })
                .collect()
        }),
        position: Position {
            truth: truth.map(|[x, y, _]| [x, y]),
            truth_yaw_rad: truth.map(|[.., yaw]| yaw),
            tip: step.tip(),
            belief: step.belief(),
            belief_error_m: read("belief_error_m"),
            prediction: step.prediction(),
            prediction_error_m: read("prediction_error_m"),
            nees: read("nees"),
            nees_without_rp: read("nees_without_rp"),
        },
        frames: Frames {
            psnr_belief_db: read("psnr_belief_db"),
            psnr_prediction_db: read("psnr_prediction_db"),
            squared_error_belief: read("squared_error_belief"),
            squared_error_prediction: read("squared_error_prediction"),
        },
        probe: model.and_then(|model| model.probe.as_ref()),
        provenance: Origin {
            poescope: &run.provenance.poescope,
            data: &run.provenance.data.name,
            data_hash: &run.provenance.data.hash,
            model_hash: model.map_or("", |model| &model.hash),
            model_source: model.map_or("", |model| &model.source),
            model_config: model.map_or("", |model| &model.config),
            seed: run.provenance.seed,
            state: &at.state,
        },
    }
}

fn expert<'a>(step: &Step<'a>, i: usize) -> ExpertLine<'a> {
    let (view, reading) = (step.expert(i), step.reading(i));
    let said = view.and_then(|view| view.latent.as_ref());
    let gaussian = said.map(gaussian).unwrap_or_default();
    let share = view.map(|view| view.share.as_slice());
    let share = share.filter(|share| !share.is_empty());
    ExpertLine {
        name: view.map_or("", |view| view.expert.name()),
        alpha: step.alpha(i),
        mean: gaussian.mean,
        log_var: gaussian.log_var,
        share,
        share_mean: share.and(view).map(|view| view.share_mean),
        share_position: view.and_then(|view| view.share_position),
        nis: reading.and_then(|reading| reading.nis),
        information_nats: reading.and_then(|reading| reading.information_nats),
        mahalanobis: reading.and_then(|reading| reading.mahalanobis),
        pull_m: reading.and_then(|reading| reading.pull_m),
        overruled_nats: reading.and_then(|reading| reading.fused),
        claim_nats: reading.and_then(|reading| reading.claim),
        without: reading.and_then(|reading| reading.without),
    }
}

fn gaussian(view: &LatentView) -> Gaussian<'_> {
    Gaussian {
        mean: Some(&view.mean),
        log_var: Some(&view.log_var),
    }
}
