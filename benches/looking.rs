//! What a person waits for: an episode's first beliefs, a switch, a frame, every set of experts at once.

mod common;

use poescope::model::inspect::Inspector;
use poescope::model::observation::Observations;
use poescope::model::trace::{Alphas, ExpertTrace};

/// Runs that a median is taken over.
const RUNS: usize = 101;

/// What a model's experts see over `beliefs`, without an episode.
fn observations(inspector: &Inspector, beliefs: usize) -> Observations {
    let controls = common::numbers(2 * (beliefs - 1), 9);
    Observations {
        beliefs,
        streams: inspector
            .model()
            .encoders
            .iter()
            .enumerate()
            .map(|(i, encoder)| common::numbers(beliefs * encoder.inputs(0), i as u64))
            .collect(),
        controls: controls.as_chunks().0.to_vec(),
    }
}

/// Every non-empty set of experts, the prior among them, as switches that stay.
fn lattice(experts: &ExpertTrace, beliefs: usize) -> Vec<Alphas> {
    let switches = experts.experts.len() + 1;
    let setting = |set: u32| {
        let row: Vec<f32> = (0..switches).map(|i| (set >> i & 1) as f32).collect();
        Alphas {
            experts: switches,
            values: row.repeat(beliefs),
        }
    };
    (1..1 << switches).map(setting).collect()
}

fn timed(id: &str, what: &str, mut f: impl FnMut()) {
    common::report(id, common::median_secs(20, RUNS, &mut f), RUNS, what);
}

fn main() {
    let vhp = Inspector::new(common::model("vhp")).expect("a model");
    let seen = observations(&vhp, 15);
    let experts = vhp.encode(&seen).expect("experts");
    let all = Alphas::trained(15, 3);
    let mut without_vision = all.clone();
    without_vision
        .values
        .iter_mut()
        .step_by(3)
        .for_each(|alpha| *alpha = 0.0);
    let beliefs = vhp.filter(&experts, &all).expect("beliefs");
    let latents = &beliefs.posterior.mean;

    timed(
        "filter_episode",
        "vhp, 15 steps: both encoders and the filter",
        || {
            let experts = vhp.encode(&seen).expect("experts");
            vhp.filter(&experts, &all).expect("beliefs");
        },
    );
    timed(
        "switch",
        "vhp, 15 steps: the filter alone, vision off",
        || {
            vhp.filter(&experts, &without_vision).expect("beliefs");
        },
    );
    let frame = Observations {
        beliefs: 1,
        streams: vec![seen.streams[0][..vhp.model().encoders[0].inputs(0)].to_vec()],
        controls: Vec::new(),
    };
    let vision = Inspector::new(common::model("v")).expect("a model");
    timed("encode_frame", "one frame to a Gaussian", || {
        vision.encode(&frame).expect("a Gaussian");
    });
    timed("decode_1", "one latent to a frame", || {
        vhp.decode(0, &latents[..16]).expect("a frame");
    });
    timed("decode_15", "15 latents to frames", || {
        vhp.decode(0, latents).expect("frames");
    });

    let apart = Inspector::new(common::model("v-h-p")).expect("a model");
    let experts = apart.encode(&observations(&apart, 48)).expect("experts");
    let sets = lattice(&experts, 48);
    timed(
        "lattice_48",
        "v-h-p, 48 steps: beliefs of all 15 sets of experts",
        || {
            apart.filter_all(&experts, &sets).expect("beliefs");
        },
    );

    let beliefs = apart.filter(&experts, &sets[14]).expect("beliefs");
    timed("transitions_48", "v-h-p, 48 beliefs: A of each", || {
        apart.transitions(&beliefs).expect("matrices");
    });
    let known = &experts.controls[3..14];
    timed("rollout_11", "v-h-p, 11 steps: the mean path and A", || {
        apart.rollout(&beliefs, 3, known).expect("a rollout");
    });
    let noise = common::numbers(32 * 12 * 16, 5);
    timed("samples_32x11", "v-h-p, 11 steps: 32 samples", || {
        apart.sample(&beliefs, 3, known, &noise).expect("samples");
    });
    let windows = Observations {
        beliefs: 48,
        streams: vec![common::numbers(48 * apart.model().encoders[1].inputs(0), 1)],
        controls: Vec::new(),
    };
    timed("encode_one_48", "v-h-p, 48 beliefs: haptic alone", || {
        apart.encode_expert(&windows, 1).expect("Gaussians");
    });
}
