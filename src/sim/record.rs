//! One episode from a seed: the policy drives the rod, the world moves, the instruments are read, pictures taken.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::{
    Params, Scene,
    pusher::{self, Arm},
    render::Studio,
    sensor::{WrenchSensor, read_position, read_velocity},
    world::World,
};
use crate::episode::{EpisodeMeta, Recording};

/// The first episode starts on 1 January 2024, 00:00 UTC.
const EPOCH_SECS: i64 = 1_704_067_200;
/// Episodes start on whole seconds, at least this far apart from the end of the one before.
const PAUSE_SECS: i64 = 1;

/// Simulates episode `index` of `seed`; the same arguments give the same bits, on any thread.
///
/// The recording starts one full window before its first image, with the command held in that window; one command
/// follows at each image but the last. An image shares its stamp with every `window`-th sample, so alignment takes
/// samples unchanged. Force and torque are what the plate does to the rod, in the axes of the world.
///
/// # Panics
/// On parameters that [`Params::check`] refuses.
pub fn simulate(params: &Params, seed: u64, index: u64) -> Recording {
    let scene = Scene::default();
    let studio = Studio::new(&scene, params.frame_size);
    record(params, &scene, &studio, seed, index)
}

fn record(params: &Params, scene: &Scene, studio: &Studio, seed: u64, index: u64) -> Recording {
    // Two streams an episode: how much the instruments draw leaves the motion as it is.
    let mut policy_rng = stream(seed, 2 * index);
    let mut noise_rng = stream(seed, 2 * index + 1);
    let physics_secs = params.physics_secs();
    let mut world = World::new(scene, pusher::start_m(scene, &mut policy_rng), physics_secs);
    let mut arm = Arm::new(scene, physics_secs);
    let mut wrench = WrenchSensor::new(scene, physics_secs);
    let mut velocity = [0.0; 2];
    let mut command = [0.0; 2];

    let samples = params.steps * params.window;
    let mut recording = Recording {
        meta: meta(params, seed, index),
        ..Recording::default()
    };
    let start_nanos = recording.meta.start_nanos;
    for sample in 0..=samples {
        let stamp = start_nanos + params.sample_nanos(sample);
        let [tip_x, tip_y] = world.tip_m();
        let tip_m = [tip_x, tip_y, scene.contact_height_m()];
        recording
            .wrench
            .push(stamp, wrench.read(params, &mut noise_rng));
        recording
            .ee_position
            .push(stamp, read_position(params, tip_m, &mut noise_rng));
        let [vx, vy] = velocity;
        recording
            .ee_velocity
            .push(stamp, read_velocity(params, [vx, vy, 0.0], &mut noise_rng));
        let plate_pose = world.plate_pose();
        recording.object.push(stamp, plate_pose);
        if sample > 0 && sample % params.window == 0 {
            recording.frame_stamps_nanos.push(stamp);
            recording
                .frames
                .push(studio.picture(plate_pose, [tip_x, tip_y]));
        }
        if sample == samples {
            break;
        }
        if sample % params.window == 0 {
            command = pusher::command(&mut policy_rng);
            recording.control.push(stamp, command);
        }
        for _ in 0..params.substeps() {
            velocity = arm.follow(command, world.tip_m());
            wrench.feel(&world.step(velocity));
        }
    }
    recording
}

fn stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(stream);
    rng
}

fn meta(params: &Params, seed: u64, index: u64) -> EpisodeMeta {
    let duration_secs = params.steps as f64 * params.step_secs();
    let spacing_secs = duration_secs.ceil() as i64 + PAUSE_SECS;
    let start_nanos = (EPOCH_SECS + index as i64 * spacing_secs) * 1_000_000_000;
    EpisodeMeta {
        id: format!("ep{index:05}"),
        start_nanos,
        end_nanos: start_nanos + params.sample_nanos(params.steps * params.window),
        split: None,
        object: Some("square plate".into()),
        surface: None,
        source: Some("poescope simulate".into()),
        seed: Some(seed),
    }
}

#[cfg(test)]
mod tests {
    use rayon::prelude::*;

    use super::*;
    use crate::sim::{Motion, Motions};

    /// The channels, rates and lengths of the MIT pushing set.
    fn mit_params() -> Params {
        Params {
            steps: 48,
            window: 10,
            rate_hz: 180.0,
            planar: true,
            ..Params::default()
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bits_on_any_thread() {
        let params = Params::default();
        let alone: Vec<_> = (0..4).map(|index| simulate(&params, 7, index)).collect();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(3)
            .build()
            .expect("three threads start");
        let together: Vec<_> = pool.install(|| {
            let indices = (0..4_u64).into_par_iter();
            indices.map(|index| simulate(&params, 7, index)).collect()
        });
        assert!(alone == together);
        assert!(alone[0].wrench != alone[1].wrench);
        assert!(simulate(&params, 8, 0).wrench != alone[0].wrench);
    }

    #[test]
    fn streams_have_their_counts_and_share_their_stamps() {
        for params in [Params::default(), mit_params()] {
            let recording = simulate(&params, 1, 3);
            let samples = params.steps * params.window + 1;
            let stamps = &recording.wrench.stamps_nanos;
            assert_eq!(stamps.len(), samples);
            assert_eq!(recording.wrench.values.len(), samples);
            assert_eq!(&recording.ee_position.stamps_nanos, stamps);
            assert_eq!(&recording.ee_velocity.stamps_nanos, stamps);
            assert_eq!(&recording.object.stamps_nanos, stamps);
            assert!(stamps.windows(2).all(|pair| pair[0] < pair[1]));

            let every_window: Vec<_> = stamps.iter().copied().step_by(params.window).collect();
            assert_eq!(recording.frame_stamps_nanos, every_window[1..]);
            assert_eq!(recording.control.stamps_nanos, every_window[..params.steps]);
            assert_eq!(recording.frames.len(), params.steps);
            assert_eq!(recording.meta.start_nanos, stamps[0]);
            assert_eq!(recording.meta.end_nanos, stamps[samples - 1]);
            let next = simulate(&params, 1, 4);
            assert!(recording.meta.end_nanos < next.meta.start_nanos);
        }
    }

    #[test]
    #[expect(
        clippy::float_cmp,
        reason = "a channel is the same reading or exactly 0"
    )]
    fn a_planar_setup_senses_its_own_channels_of_the_same_push() {
        let planar = Params {
            planar: true,
            ..Params::default()
        };
        let (full, flat) = (simulate(&Params::default(), 2, 0), simulate(&planar, 2, 0));
        assert_eq!(full.object, flat.object);
        for (full, flat) in full.wrench.values.iter().zip(&flat.wrench.values) {
            assert_eq!(*flat, [full[0], full[1], 0.0, 0.0, 0.0, full[5]]);
        }
        for (full, flat) in full.ee_position.values.iter().zip(&flat.ee_position.values) {
            assert_eq!(*flat, [full[0], full[1], 0.0]);
        }
    }

    #[test]
    fn most_episodes_move_the_plate() {
        for params in [Params::default(), mit_params()] {
            let mut motions = Motions::default();
            motions.extend((0..40).filter_map(|index| Motion::of(&simulate(&params, 0, index))));
            assert!(motions.share(Motion::is_marked) >= 0.8, "{motions}");
        }
    }
}
