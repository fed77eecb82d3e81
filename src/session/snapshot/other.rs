//! The second model beside the first, on the same episode and step, with the same switches.

use std::sync::Arc;

use serde::Serialize;

use super::{Badge, FrameRow, PositionView, SignedFrame, StepPsnr, StripCell};

/// Model B under A's cursor.
#[derive(Clone, Debug, Serialize)]
pub struct OtherView {
    /// Its index among `Snapshot::models`.
    pub model: usize,
    /// Its images at the cursor.
    pub frames: FrameRow,
    /// A's image minus B's: of the predictions where both have one, else of the beliefs.
    pub difference: Option<Arc<SignedFrame>>,
    /// Its images of every step that has been decoded.
    pub strip: Arc<Vec<StripCell>>,
    /// Its positions; none without a probe.
    pub position: Option<PositionView>,
    /// PSNR of its frames.
    pub psnr_db: Arc<Vec<StepPsnr>>,
    /// Whether it was trained on the switches, as far as it has their experts.
    pub badge: Badge,
    /// Why it cannot be shown.
    pub fault: Option<String>,
}
