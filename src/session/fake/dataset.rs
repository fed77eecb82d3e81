//! Episodes of a moving square.

use crate::episode::{
    Episode, EpisodeMeta, EpisodeSource, Frame, Layout, PlanarPose, SourceError, Split,
};

/// Side of the square, in parts of the frame.
const SQUARE: f32 = 0.22;
/// Grey value of the table.
const TABLE: f32 = 24.0;
/// Grey value of the square.
const BRIGHT: f32 = 232.0;
/// The table's width in metres.
pub(super) const TABLE_M: f32 = 0.4;
/// Seconds between two frames.
const STEP_SECS: f64 = 4.0 / 15.0;

/// A dataset in memory.
#[derive(Clone, Debug)]
pub struct FakeSource {
    metas: Vec<EpisodeMeta>,
    steps: usize,
}

impl FakeSource {
    /// So many episodes of 16 steps.
    pub fn new(episodes: usize) -> Self {
        Self::with_steps(episodes, 16)
    }

    /// So many episodes, the first of `steps` steps and each a step shorter than the one before, down to 2.
    pub fn with_steps(episodes: usize, steps: usize) -> Self {
        let meta = |i| EpisodeMeta {
            id: format!("square_{i:02}"),
            split: Some(Split::Test),
            source: Some("made up".to_owned()),
            ..EpisodeMeta::default()
        };
        Self {
            metas: (0..episodes).map(meta).collect(),
            steps,
        }
    }
}

impl EpisodeSource for FakeSource {
    fn name(&self) -> &'static str {
        "squares"
    }

    fn data_hash(&self) -> &'static str {
        "squares-1"
    }

    fn metas(&self) -> &[EpisodeMeta] {
        &self.metas
    }

    fn load(&self, index: usize, layout: Layout) -> Result<Episode, SourceError> {
        let Some(meta) = self.metas.get(index) else {
            return Err(SourceError(format!("squares has no episode {index}")));
        };
        Ok(episode(
            meta.clone(),
            index,
            self.steps.saturating_sub(index).max(2),
            layout,
        ))
    }
}

fn episode(meta: EpisodeMeta, index: usize, steps: usize, layout: Layout) -> Episode {
    let angle = 0.4 + index as f32;
    let controls: Vec<[f32; 2]> = (0..steps - 1)
        .map(|t| {
            let speed = if t % 5 == 4 { 0.0 } else { 0.03 };
            let turn = angle + 0.08 * t as f32;
            [speed * turn.cos(), speed * turn.sin()]
        })
        .collect();
    let mut centre = [0.5 - 0.2 * angle.cos(), 0.5 - 0.2 * angle.sin()];
    let mut centres = vec![centre];
    for control in &controls {
        centre = [centre[0] + control[0], centre[1] + control[1]];
        centres.push(centre);
    }
    // Six channels of W samples: the first two carry the centre, each sense with its own offset.
    let windows = |offset: [f32; 2]| -> Vec<f32> {
        let sample = |c: &[f32; 2]| [c[0] + offset[0], c[1] + offset[1], 0.1, 0.0, 0.0, 0.0];
        centres
            .iter()
            .flat_map(|c| sample(c).repeat(layout.window))
            .collect()
    };
    Episode {
        meta,
        layout,
        steps_nanos: (0..steps)
            .map(|t| (t as f64 * STEP_SECS * 1e9) as i64)
            .collect(),
        frames: centres
            .iter()
            .map(|&c| square_at(c, layout.frame_size))
            .collect(),
        haptic: Some(windows([0.05, -0.02])),
        proprio: Some(windows([-0.03, 0.04])),
        controls: Some(controls),
        object: Some(centres.iter().map(|c| pose(*c)).collect()),
        tip: Some(
            centres
                .iter()
                .map(|c| [(c[0] - 0.15) * TABLE_M, c[1] * TABLE_M])
                .collect(),
        ),
        flags: Vec::new(),
    }
}

fn pose(centre: [f32; 2]) -> PlanarPose {
    PlanarPose {
        x: centre[0] * TABLE_M,
        y: centre[1] * TABLE_M,
        yaw: 0.0,
    }
}

/// A frame with the square at a centre in parts of the frame; edge pixels are as bright as they are covered.
pub(super) fn square_at(centre: [f32; 2], size: usize) -> Frame {
    let covered = |pixel: usize, centre: f32| {
        let (low, high) = (
            (centre - SQUARE / 2.0) * size as f32,
            (centre + SQUARE / 2.0) * size as f32,
        );
        (high.min(pixel as f32 + 1.0) - low.max(pixel as f32)).clamp(0.0, 1.0)
    };
    let pixels = (0..size * size)
        .map(|i| {
            let part = covered(i % size, centre[0]) * covered(i / size, centre[1]);
            (TABLE + part * (BRIGHT - TABLE)) as u8
        })
        .collect();
    Frame {
        width: size,
        height: size,
        pixels,
    }
}

/// The centre of brightness of a frame, in parts of it: the inverse of [`square_at`].
pub(super) fn centre_of(frame: &Frame) -> [f32; 2] {
    let mut sums = [0.0_f32; 3];
    for (i, &pixel) in frame.pixels.iter().enumerate() {
        let weight = f32::from(pixel) - TABLE;
        sums[0] += weight * ((i % frame.width) as f32 + 0.5);
        sums[1] += weight * ((i / frame.width) as f32 + 0.5);
        sums[2] += weight;
    }
    let total = sums[2].max(1.0);
    [
        sums[0] / total / frame.width as f32,
        sums[1] / total / frame.height as f32,
    ]
}
