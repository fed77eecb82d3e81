//! The vocabulary of data: what was recorded, and the same laid out on steps. Plain data; no files, no tensors.
//!
//! A [`Recording`] holds the streams of one episode as they were sensed, each on its own clock. An [`Episode`] is
//! the same push on the clock of its images: T steps, and for each step a window of W high-rate samples.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A grey image, row major, 8 bits a pixel.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `height * width` grey values, 0 black to 255 white.
    pub pixels: Vec<u8>,
}

/// A stream of `N` numbers a sample, in the order it was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Track<const N: usize> {
    /// When each sample was measured, in nanoseconds since the Unix epoch.
    pub stamps_nanos: Vec<i64>,
    /// The samples; as many as stamps.
    pub values: Vec<[f64; N]>,
}

impl<const N: usize> Default for Track<N> {
    fn default() -> Self {
        Self {
            stamps_nanos: Vec::new(),
            values: Vec::new(),
        }
    }
}

impl<const N: usize> Track<N> {
    /// Appends one sample.
    pub fn push(&mut self, stamp_nanos: i64, value: [f64; N]) {
        self.stamps_nanos.push(stamp_nanos);
        self.values.push(value);
    }

    /// Whether nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.stamps_nanos.is_empty()
    }
}

/// Which part of an experiment an episode belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// Fitted on.
    Train,
    /// Chooses checkpoints and calibrations.
    Val,
    /// Touched by evaluation only.
    Test,
}

impl Split {
    /// `train`, `val` or `test`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
            Self::Test => "test",
        }
    }

    /// The split of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Train, Self::Val, Self::Test]
            .into_iter()
            .find(|split| split.name() == name)
    }
}

/// What a file says of an episode without its messages being read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeMeta {
    /// Its name, unique in a file.
    pub id: String,
    /// First log time that belongs to it, in nanoseconds since the Unix epoch.
    pub start_nanos: i64,
    /// Last log time that belongs to it (inclusive).
    pub end_nanos: i64,
    /// Its part in the experiment, where the file names one.
    pub split: Option<Split>,
    /// What was pushed, where known.
    pub object: Option<String>,
    /// On what, where known.
    pub surface: Option<String>,
    /// What made the recording, where known.
    pub source: Option<String>,
    /// The simulator's seed, where there was one.
    pub seed: Option<u64>,
}

/// One episode as it was sensed: every stream on its own clock. A role that was not recorded is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// What the file says of it.
    pub meta: EpisodeMeta,
    /// Stamps of the frames, in nanoseconds since the Unix epoch; as many as frames.
    pub frame_stamps_nanos: Vec<i64>,
    /// Camera frames at their recorded size.
    pub frames: Vec<Frame>,
    /// Force x, y, z in newtons and torque x, y, z in newton metres at the end effector.
    pub wrench: Track<6>,
    /// End-effector position in metres.
    pub ee_position: Track<3>,
    /// End-effector linear velocity in metres per second.
    pub ee_velocity: Track<3>,
    /// The planar command held from its stamp on: x, y in m/s (or m, for position commands).
    pub control: Track<2>,
    /// Ground truth of the pushed object: x, y in metres, yaw in radians.
    pub object: Track<3>,
    /// What was odd about the streams.
    pub flags: Vec<Flag>,
}

/// Something odd that was seen in a recording: it excludes an episode from training and from `eval`, never from viewing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Flag {
    /// The topic it was seen on.
    pub topic: String,
    /// When, in nanoseconds since the Unix epoch.
    pub stamp_nanos: i64,
    /// What: "gap of 1.2 s", "stamps run backwards".
    pub what: String,
    /// Whether samples are missing after the stamp.
    pub gap: bool,
}

/// Sides and height of the object as it is drawn, in metres: those of the plate that both samples push, for a recording
/// does not say them.
pub const PLATE_M: [f32; 3] = [0.14, 0.14, 0.03];
/// Height of the tip as it is drawn, in metres.
pub const TIP_HEIGHT_M: f32 = 0.09;

/// The pose of the pushed object on the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanarPose {
    /// Metres.
    pub x: f32,
    /// Metres.
    pub y: f32,
    /// Radians.
    pub yaw: f32,
}

/// The sizes an episode is laid out in; a model asks for its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Layout {
    /// Side of the square frames, in pixels.
    pub frame_size: usize,
    /// W, the samples of a step's window.
    pub window: usize,
}

impl Default for Layout {
    /// The paper's synthetic set: 64 × 64 pixels, 32 samples.
    fn default() -> Self {
        Self {
            frame_size: 64,
            window: 32,
        }
    }
}

/// Names of the six haptic channels of an [`Episode`], in order.
pub const HAPTIC_CHANNELS: [&str; 6] = ["fx", "fy", "fz", "tx", "ty", "tz"];
/// Names of the six proprio channels of an [`Episode`], in order.
pub const PROPRIO_CHANNELS: [&str; 6] = ["px", "py", "pz", "vx", "vy", "vz"];

/// One push on the clock of its images: step t is the t-th frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// What the file says of it.
    pub meta: EpisodeMeta,
    /// The sizes it was laid out in.
    pub layout: Layout,
    /// `τ_t`, the stamp of each frame in nanoseconds since the Unix epoch; T of them.
    pub steps_nanos: Vec<i64>,
    /// T grey frames, each `frame_size` square.
    pub frames: Vec<Frame>,
    /// `(T, W, 6)`, channels as [`HAPTIC_CHANNELS`], in N and N·m; none if not recorded.
    pub haptic: Option<Vec<f32>>,
    /// `(T, W, 6)`, channels as [`PROPRIO_CHANNELS`], in m and m/s; none if not recorded.
    pub proprio: Option<Vec<f32>>,
    /// `T - 1` controls: `controls[t]` acts from step t to t + 1; none if not recorded.
    pub controls: Option<Vec<[f32; 2]>>,
    /// Ground truth of the object at each step; none if not recorded.
    pub object: Option<Vec<PlanarPose>>,
    /// End-effector position x, y in metres at each step; none if not recorded.
    pub tip: Option<Vec<[f32; 2]>>,
    /// What was odd about the recording.
    pub flags: Vec<Flag>,
}

impl Episode {
    /// T.
    pub fn steps(&self) -> usize {
        self.steps_nanos.len()
    }

    /// Time of step `t` since the first frame, in seconds.
    pub fn secs_at(&self, t: usize) -> f64 {
        self.steps_nanos[t].saturating_sub(self.steps_nanos[0]) as f64 * 1e-9
    }

    /// The step that each flag concerns: the one at or before its stamp, or, of a gap, the one whose window lacks what
    /// is missing.
    pub fn flagged_steps(&self) -> impl Iterator<Item = usize> {
        let last = self.steps().saturating_sub(1);
        self.flags.iter().map(move |flag| {
            let is_reached = |&step: &i64| step <= flag.stamp_nanos;
            let reached = self.steps_nanos.partition_point(is_reached);
            if flag.gap {
                reached.min(last)
            } else {
                reached.saturating_sub(1)
            }
        })
    }

    /// What was odd about the recording, each with its topic and its time since the first frame.
    pub fn oddities(&self) -> impl Iterator<Item = String> {
        let first = self.steps_nanos.first().copied().unwrap_or_default();
        self.flags.iter().map(move |flag| {
            let secs = flag.stamp_nanos.saturating_sub(first) as f64 * 1e-9;
            format!("{} at {secs:.2} s: {}", flag.topic, flag.what)
        })
    }

    /// Median time between two images, in seconds; none with fewer than two.
    pub fn step_secs(&self) -> Option<f64> {
        let mut gaps: Vec<i64> = self
            .steps_nanos
            .windows(2)
            .map(|pair| pair[1].saturating_sub(pair[0]))
            .collect();
        gaps.sort_unstable();
        gaps.get(gaps.len() / 2).map(|&gap| gap as f64 * 1e-9)
    }

    /// Root-mean-square force over the window of step `t`, in newtons; the face's measure of contact.
    pub fn force_newtons(&self, t: usize) -> Option<f32> {
        let sum: f32 = self
            .felt(t)?
            .chunks_exact(6)
            .map(|s| s[..3].iter().map(|f| f * f).sum::<f32>())
            .sum();
        Some((sum / self.layout.window as f32).sqrt())
    }

    /// Mean force of the pusher on the object over the window of step `t`: x and y in newtons, along the axes of the
    /// table. A wrench says what the object does to the pusher, so this is the mean of fx and fy turned round.
    pub fn push_newtons(&self, t: usize) -> Option<[f32; 2]> {
        let samples = self.felt(t)?;
        let mean = |channel: usize| {
            let sum: f32 = samples.chunks_exact(6).map(|s| s[channel]).sum();
            sum / self.layout.window as f32
        };
        Some([-mean(0), -mean(1)])
    }

    /// `(W, 6)`: the haptic window of step `t`.
    fn felt(&self, t: usize) -> Option<&[f32]> {
        let window = self.layout.window;
        let haptic = self.haptic.as_ref()?;
        haptic.get(t * window * 6..(t + 1) * window * 6)
    }
}

/// Why an episode could not be had: a sentence that names the file and what to do.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct SourceError(pub String);

/// Where a session gets its episodes from; it opens no files itself.
pub trait EpisodeSource: Send + Sync {
    /// A short name for the status line: the file's or the folder's.
    fn name(&self) -> &str;
    /// A hash of the data's identity, for provenance and caches.
    fn data_hash(&self) -> &str;
    /// What is known of each episode before it is read.
    fn metas(&self) -> &[EpisodeMeta];
    /// Reads episode `index` and lays it out.
    fn load(&self, index: usize, layout: Layout) -> Result<Episode, SourceError>;
}
