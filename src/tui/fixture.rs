//! A made-up but plausible moment of a session: a plate that is pushed for 16 steps, seen by four experts.

pub mod bench;

use std::sync::Arc;

use crate::episode::{Frame, PlanarPose, Split};
use crate::modality::{Expert, ExpertSet};
use crate::session::command::{Looping, Scope};
use crate::session::settings::Sampling;
use crate::session::snapshot::other::OtherView;
use crate::session::snapshot::{
    Badge, EpisodeView, ErrorOf, Estimate, Event, EventKind, ExpertView, FrameRow, LatentView,
    ModelInfo, PositionView, SignedFrame, Snapshot, StepPsnr, StripCell,
};

const DIMS: usize = 16;
const START: usize = 3;

fn predicted(step: usize) -> Option<usize> {
    (step > START && step <= START + 11).then_some(step)
}

fn drift(step: usize) -> f32 {
    (step - START) as f32
}

/// A number in [0, 1) that looks random, the same everywhere.
fn noise(seed: usize) -> f32 {
    let hash = (seed as u32).wrapping_mul(2_654_435_761) ^ 0x9E37_79B9;
    (hash.wrapping_mul(2_246_822_519) >> 16) as f32 / 65_536.0
}

/// A grey table with a bright plate on it.
fn plate(x: f32, y: f32, soft: f32) -> Frame {
    let pixels = (0..64 * 64)
        .map(|i| {
            let (column, row) = ((i % 64) as f32, (i / 64) as f32);
            let outside = ((column - x).abs().max((row - y).abs()) - 10.0).max(0.0);
            let light = (1.0 - outside / soft).max(0.0);
            (70.0 + row * 0.6 + 120.0 * light) as u8
        })
        .collect();
    Frame {
        width: 64,
        height: 64,
        pixels,
    }
}

fn truth(step: usize) -> PlanarPose {
    let t = step as f32 / 15.0;
    PlanarPose {
        x: 0.02 + 0.09 * t * t,
        y: 0.01 + 0.05 * t,
        yaw: 0.4 * t,
    }
}

fn estimate(step: usize, drift: f32) -> Estimate {
    let pose = truth(step);
    let spread = 0.000_02 + drift * 0.000_01;
    Estimate {
        x: pose.x + 0.004 * noise(step) + drift * 0.002,
        y: pose.y - 0.005 * noise(step + 99) - drift * 0.001,
        covariance: [spread, spread * 0.3, spread * 0.7],
    }
}

fn frames(step: usize) -> (Frame, Frame, Frame) {
    let (x, y) = (16.0 + 2.0 * step as f32, 44.0 - 1.2 * step as f32);
    (
        plate(x, y, 1.0),
        plate(x + 0.7, y, 4.0),
        plate(x + 0.3 * step as f32, y, 6.0),
    )
}

fn expert(expert: Expert, weight: f32, steps: usize) -> ExpertView {
    let seed = expert.letter() as usize * 37;
    let share: Vec<f32> = (0..DIMS)
        .map(|d| {
            let of = |letter: Expert| 0.2 + noise(letter.letter() as usize * 37 + d);
            let sum: f32 = EXPERTS
                .iter()
                .map(|&(other, weight)| weight * of(other))
                .sum();
            weight * of(expert) / sum
        })
        .collect();
    let share_mean = share.iter().sum::<f32>() / DIMS as f32;
    let over_time = (0..steps).map(|t| if t == 0 { f32::NAN } else { share_mean });
    ExpertView {
        expert,
        alpha: 1.0,
        latent: Some(latent(seed, |noise| 0.2 + 0.6 * noise)),
        share_position: Some(share[0]),
        share_mean,
        share,
        share_over_time: Arc::new(over_time.collect()),
    }
}

fn latent(seed: usize, sigma: impl Fn(f32) -> f32) -> LatentView {
    let sigma: Vec<f32> = (0..DIMS).map(|d| sigma(noise(seed + d + 50))).collect();
    LatentView {
        mean: (0..DIMS).map(|d| 2.0 * noise(seed + d) - 1.0).collect(),
        log_var: sigma.iter().map(|sigma| 2.0 * sigma.ln()).collect(),
        sigma,
    }
}

const EXPERTS: [(Expert, f32); 4] = [
    (Expert::Vision, 5.0),
    (Expert::Haptic, 1.0),
    (Expert::Proprio, 2.0),
    (Expert::Prior, 2.0),
];

fn position(cursor: usize, steps: usize) -> PositionView {
    PositionView {
        truth: Arc::new((0..steps).map(truth).collect()),
        tip: Arc::new(
            (0..steps)
                .map(|t| [truth(t).x - 0.055, truth(t).y - 0.01])
                .collect(),
        ),
        belief: Arc::new(
            (0..steps)
                .map(|t| (t > 0).then(|| estimate(t, 0.0)))
                .collect(),
        ),
        prediction: Arc::new(
            (0..steps)
                .map(|t| predicted(t).map(|t| estimate(t, drift(t))))
                .collect(),
        ),
        recorded_controls: Arc::default(),
        belief_error_m: Some(0.004),
        prediction_error_m: predicted(cursor).map(|_| 0.012),
    }
}

/// The same a little to the upper left.
fn beside(position: PositionView) -> PositionView {
    let moved = |estimate: &Option<Estimate>| {
        estimate.map(|estimate| Estimate {
            x: estimate.x - 0.006,
            y: estimate.y + 0.009,
            ..estimate
        })
    };
    PositionView {
        belief: Arc::new(position.belief.iter().map(moved).collect()),
        prediction: Arc::new(position.prediction.iter().map(moved).collect()),
        ..position
    }
}

fn worse(psnr: &StepPsnr) -> StepPsnr {
    StepPsnr {
        belief: psnr.belief.map(|db| db - 2.0),
        prediction: psnr.prediction.map(|db| db - 3.5),
    }
}

/// Adds a second model whose prediction lags behind.
pub fn compare(snapshot: &mut Snapshot) {
    let step = snapshot.cursor;
    let (now, _, prediction) = frames(step);
    let (_, _, lagging) = frames(step.saturating_sub(2));
    let minus = |a: &Frame, b: &Frame| {
        Arc::new(SignedFrame {
            width: 64,
            height: 64,
            values: std::iter::zip(&a.pixels, &b.pixels)
                .map(|(&a, &b)| i16::from(a) - i16::from(b))
                .collect(),
        })
    };
    let mut model = (*snapshot.models[0]).clone();
    "vhp".clone_into(&mut model.name);
    snapshot.models.push(Arc::new(model));
    snapshot.other = Some(Arc::new(OtherView {
        badge: Badge::Trained,
        model: 1,
        difference: Some(minus(&prediction, &lagging)),
        frames: FrameRow {
            error: Some(minus(&lagging, &now)),
            prediction: Some(Arc::new(lagging)),
            ..snapshot.frames.clone()
        },
        strip: Arc::clone(&snapshot.strip),
        position: snapshot.position.clone().map(beside),
        psnr_db: Arc::new(snapshot.psnr_db.iter().map(worse).collect()),
        fault: None,
    }));
}

fn episode(steps: usize) -> EpisodeView {
    EpisodeView {
        id: "push-00002".to_owned(),
        split: Some(Split::Test),
        source: None,
        secs: (0..steps).map(|t| t as f64 / 3.75).collect(),
        force_newtons: (0..steps)
            .map(|t| if t < 4 { 0.05 } else { 1.0 + 2.0 * noise(t) })
            .collect(),
        push_newtons: (0..steps)
            .map(|t| if t < 4 { [0.0; 2] } else { [1.0, 0.5] })
            .collect(),
        flags: Vec::new(),
        flagged_steps: Vec::new(),
        missing: Vec::new(),
    }
}

/// The session at a step of an episode of so many.
pub fn snapshot(cursor: usize, steps: usize) -> Snapshot {
    let (now, belief, prediction) = frames(cursor);
    let prediction = predicted(cursor).map(|_| prediction);
    let shown = prediction.as_ref().unwrap_or(&belief);
    let error = SignedFrame {
        width: 64,
        height: 64,
        values: std::iter::zip(&shown.pixels, &now.pixels)
            .map(|(&a, &b)| i16::from(a) - i16::from(b))
            .collect(),
    };
    let strip = (0..steps.min(16)).map(|step| {
        let (truth, belief, prediction) = frames(step);
        StripCell {
            step,
            truth: Arc::new(truth),
            belief: (step > 0).then(|| Arc::new(belief)),
            prediction: predicted(step).map(|_| Arc::new(prediction)),
        }
    });
    Snapshot {
        dataset: "sample_data".to_owned(),
        models: vec![Arc::new(ModelInfo {
            name: "v-h-p".to_owned(),
            source: "sample_data/model".to_owned(),
            experts: EXPERTS[..3].iter().map(|&(expert, _)| expert).collect(),
            latent: DIMS,
            frame_stack: 1,
            prior_expert: true,
            trained_sets: vec![ExpertSet::full(3)],
            ..ModelInfo::default()
        })],
        model: 0,
        episode: Some(Arc::new(episode(steps))),
        episode_index: 2,
        episode_count: 24,
        cursor,
        playing: false,
        speed: 1.0,
        looping: Looping::All,
        scope: Scope::Episode,
        context: 4,
        horizon: 11,
        start: START,
        experts: EXPERTS
            .iter()
            .map(|&(kind, weight)| expert(kind, weight, steps))
            .collect(),
        badge: Badge::Trained,
        frames: FrameRow {
            truth: Some(Arc::new(now)),
            belief: (cursor > 0).then(|| Arc::new(belief)),
            error_of: if prediction.is_some() {
                ErrorOf::Prediction
            } else {
                ErrorOf::Belief
            },
            prediction: prediction.map(Arc::new),
            error: (cursor > 0).then(|| Arc::new(error)),
            input: None,
        },
        strip: Arc::new(strip.collect()),
        position: Some(position(cursor, steps)),
        belief: (cursor > 0).then(|| latent(0, |noise| 0.1 + 0.3 * noise)),
        psnr_db: Arc::new(
            (0..steps)
                .map(|t| StepPsnr {
                    belief: (t > 0).then(|| 27.0 + 4.0 * noise(t)),
                    prediction: predicted(t).map(|t| 26.0 - 0.6 * drift(t)),
                })
                .collect(),
        ),
        fusion: bench::fusion(cursor),
        series: Some(bench::series(steps)),
        lattice: Some(bench::lattice(cursor)),
        spread: Some(bench::spread(cursor, steps)),
        responses: Arc::default(),
        board: Some(bench::board()),
        table: bench::table(steps),
        other: None,
        events: Arc::new(vec![
            Event {
                step: 4.min(steps - 1),
                kind: EventKind::Contact,
            },
            Event {
                step: 7.min(steps - 1),
                kind: EventKind::Mark,
            },
        ]),
        corruptions: Vec::new(),
        control_edit: None,
        sampling: Sampling::default(),
        selection: None,
        message: None,
        told: 0,
        busy: false,
        current: true,
        state: "v=1;model=v-h-p;step=9".to_owned(),
    }
}
