//! What the benches share: medians, a model, and how a number is printed.

use std::time::Instant;

use candle_core::Device;
use poescope::model::Model;
use poescope::model::config::{Config, Preset};
use serde_json::json;

/// Median seconds of `runs` calls after `warm` that are not counted.
pub fn median_secs(warm: usize, runs: usize, mut f: impl FnMut()) -> f64 {
    (0..warm).for_each(|_| f());
    let mut secs: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            f();
            start.elapsed().as_secs_f64()
        })
        .collect();
    secs.sort_by(f64::total_cmp);
    secs[runs / 2]
}

/// Whether `--json` was asked for: one object a number, for a script to read.
pub fn json_wanted() -> bool {
    std::env::args().any(|argument| argument == "--json")
}

/// Prints a median under the name that scripts know it by.
#[expect(clippy::print_stdout, reason = "a bench speaks to its user")]
pub fn report(id: &str, secs: f64, runs: usize, what: &str) {
    if json_wanted() {
        println!("{}", json!({"id": id, "ms": secs * 1e3, "runs": runs}));
    } else {
        println!("{id:<16} {:>9.3} ms  {what}", secs * 1e3);
    }
}

/// Numbers in [-1, 1] that repeat nothing.
pub fn numbers(n: usize, seed: u64) -> Vec<f32> {
    (0..n as u64)
        .map(|i| {
            let x = (i + (seed << 32) + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            ((x >> 40) as f32) / 8_388_608.0 - 1.0
        })
        .collect()
}

/// A named model as the released script trains it, its weights drawn from a fixed seed.
pub fn model(name: &str) -> Model {
    let config = Config::preset(name, Preset::Released).expect("a model of that name");
    Model::new(config, 1, &Device::Cpu).expect("a model")
}
