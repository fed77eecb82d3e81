//! What is predicted from what.

use super::panel::{Panel, Range};
use crate::session::snapshot::Snapshot;

/// Adds the folder.
pub fn add(panel: &mut Panel, snapshot: &Snapshot, spread: bool) {
    panel.folder("rollout", "Prediction", true);
    // Where there is a belief, and something to predict after it.
    let least = snapshot.first_belief() + 1;
    let most = snapshot.steps().saturating_sub(1);
    let range = Range::whole(least.min(snapshot.context), most.max(snapshot.context));
    let hint = "Images seen before the prediction";
    panel.slider(
        "context",
        ("Context c", hint),
        snapshot.context as f64,
        range,
        true,
    );
    let range = Range::whole(1, snapshot.steps().max(snapshot.horizon).max(1));
    let hint = "Images predicted";
    panel.slider(
        "horizon",
        ("Horizon h", hint),
        snapshot.horizon as f64,
        range,
        true,
    );
    panel.button(
        "predict-here",
        "Predict from here",
        "Open loop from the step under the cursor",
    );
    let hint = "Instead of the mean path";
    panel.checkbox(
        "sampled",
        ("Show a sample", hint),
        snapshot.sampling.shown,
        true,
    );
    let hint = "Adds propagated and sampled σ to the chart by horizon; takes its time";
    panel.checkbox("spread", ("Spread of samples", hint), spread, true);
}
