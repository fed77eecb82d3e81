//! A training step as the training runs it.

mod common;

use std::collections::BTreeMap;

use poescope::train::step;

fn main() {
    poescope::model::kernel::memory::keep_pages();
    let model = common::model("vhp");
    let batch = common::batch(&model, 32, 15);
    let mut moments = BTreeMap::new();
    let secs = common::median_secs(3, 15, || {
        step::update(&model, &batch, &mut moments, 3e-4).expect("an update");
    });
    common::report(
        "step",
        secs,
        15,
        "32 episodes of 15 beliefs, vhp: forward, backward, clip, Adam",
    );
}
