//! The physics: a rapier world of one plate, one table and one rod, stepped by the rod's velocity.
//!
//! Four choices make pushing by rapier agree with the quasi-static solution (see the test of the same name):
//! - Coulomb friction at each contact; the default couples neither points nor directions, and a plate pushed beside
//!   its centre does not turn.
//! - No contact recycling, which keeps contacts that are stale by centimetres.
//! - The plate stands on four balls rather than its underside. The solver limits a contact's friction after weighing
//!   it by the mass felt there, which is less across the radius than along it, so the friction of a foot leads off
//!   its sliding direction; by 30° at the corners, by up to 17° at the feet. Groups let the rod see only the plate's
//!   box and the table only the balls.
//! - The rod's end is a ball at half the plate's height (the sides are upright, so the same contact as the rod's)
//!   with the two horizontal axes locked and driven, and the vertical one on a soft spring. A rod rigid in z would
//!   carry part of the plate's weight by friction, as much as the solver's rounding happens to load on it.

use rapier3d::prelude::*;

use super::{Scene, contact};

const TABLE: Group = Group::GROUP_1;
const FEET: Group = Group::GROUP_2;
const SIDES: Group = Group::GROUP_3;
const TIP: Group = Group::GROUP_4;

/// The feet are small beside the plate, so that they roll on nothing and hide below it.
const FOOT_RADIUS_M: f32 = 0.004;
/// Mass of what moves on the rod's vertical spring.
const TIP_MASS_KG: f32 = 0.05;
/// Stiffness of the vertical spring over its mass, in 1/s²: 10 N/m.
const TIP_SPRING: f32 = 200.0;
/// Damping of the vertical spring over its mass, in 1/s: critical.
const TIP_DAMPING: f32 = 28.0;
/// Long enough for the plate to settle on its feet.
const SETTLE_SECS: f64 = 0.1;

/// What the plate does to the rod during one physics step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Touch {
    /// Mean force on the rod, in newtons, world axes.
    pub force_newtons: [f64; 3],
    /// Unit vector from the rod's axis to the contact, x and y; zero without contact.
    pub toward_contact: [f64; 2],
}

/// One plate, one table, one rod.
pub(super) struct World {
    physics: PhysicsWorld,
    plate: RigidBodyHandle,
    sides: ColliderHandle,
    tip: RigidBodyHandle,
    tip_end: ColliderHandle,
    tip_height: f32,
}

impl World {
    /// The scene at rest: the plate at its start, the rod's axis at `tip_m`; each step takes `step_secs`.
    pub fn new(scene: &Scene, tip_m: [f64; 2], step_secs: f64) -> Self {
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::new(0.0, 0.0, -9.81);
        let parameters = &mut physics.integration_parameters;
        parameters.dt = step_secs as f32;
        parameters.friction_model = FrictionModel::Coulomb;
        parameters.contact_recycling = false;
        parameters.max_ccd_substeps = 0;

        let table_friction = scene.table_friction as f32;
        physics.insert(
            RigidBodyBuilder::fixed(),
            ColliderBuilder::cuboid(2.0, 2.0, 0.1)
                .translation(Vector::new(0.0, 0.0, -0.1))
                .friction(table_friction)
                .collision_groups(meets(TABLE, FEET)),
        );
        let (plate, sides) = insert_plate(&mut physics, scene);
        let tip_height = scene.contact_height_m() as f32;
        let (tip, tip_end) = physics.insert(
            RigidBodyBuilder::dynamic()
                .translation(Vector::new(tip_m[0] as f32, tip_m[1] as f32, tip_height))
                .enabled_translations(false, false, true)
                .lock_rotations()
                .gravity_scale(0.0)
                .can_sleep(false),
            ColliderBuilder::ball(scene.tip_radius_m as f32)
                .mass(TIP_MASS_KG)
                .friction(scene.tip_friction as f32)
                .collision_groups(meets(TIP, SIDES)),
        );
        let mut world = Self {
            physics,
            plate,
            sides,
            tip,
            tip_end,
            tip_height,
        };
        for _ in 0..(SETTLE_SECS / step_secs).ceil() as usize {
            world.step([0.0, 0.0]);
        }
        world
    }

    /// Moves the rod for one step with `velocity` (x, y in m/s) and says what the plate did to it.
    pub fn step(&mut self, velocity: [f64; 2]) -> Touch {
        let dt = self.physics.integration_parameters.dt;
        let tip = &mut self.physics.bodies[self.tip];
        let sag = tip.translation().z - self.tip_height;
        let vertical = tip.linvel().z;
        let vertical = vertical - (TIP_SPRING * sag + TIP_DAMPING * vertical) * dt;
        tip.set_linvel(
            Vector::new(velocity[0] as f32, velocity[1] as f32, vertical),
            true,
        );
        self.physics.step();
        contact::touch(&self.physics, self.tip_end, self.sides)
    }

    /// Position of the rod's axis, x and y in metres.
    pub fn tip_m(&self) -> [f64; 2] {
        let position = self.physics.bodies[self.tip].translation();
        [f64::from(position.x), f64::from(position.y)]
    }

    /// Pose of the plate: x, y in metres, yaw in radians within (−π, π].
    pub fn plate_pose(&self) -> [f64; 3] {
        let pose = self.physics.bodies[self.plate].position();
        let forward = pose.rotation * Vector::X;
        [
            f64::from(pose.translation.x),
            f64::from(pose.translation.y),
            f64::from(forward.y).atan2(f64::from(forward.x)),
        ]
    }
}

/// The plate: a box that only the rod meets, on four balls that only the table meets.
fn insert_plate(physics: &mut PhysicsWorld, scene: &Scene) -> (RigidBodyHandle, ColliderHandle) {
    let half_side = (scene.plate_side_m / 2.0) as f32;
    let half_height = (scene.plate_height_m / 2.0) as f32;
    let [x, y] = scene.plate_start_m.map(|m| m as f32);
    let (plate, sides) = physics.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(x, y, half_height))
            .can_sleep(false),
        ColliderBuilder::cuboid(half_side, half_side, half_height)
            .mass(scene.plate_mass_kg as f32)
            .friction(scene.tip_friction as f32)
            .collision_groups(meets(SIDES, TIP)),
    );
    for [foot_x, foot_y] in feet_on_plate(scene) {
        physics.insert_collider(
            ColliderBuilder::ball(FOOT_RADIUS_M)
                .translation(Vector::new(
                    foot_x as f32,
                    foot_y as f32,
                    FOOT_RADIUS_M - half_height,
                ))
                .density(0.0)
                .friction(scene.table_friction as f32)
                .collision_groups(meets(FEET, TABLE)),
            Some(plate),
        );
    }
    (plate, sides)
}

/// Where the feet stand, from the plate's centre and along its axes, in metres: towards its corners.
pub(super) fn feet_on_plate(scene: &Scene) -> [[f64; 2]; 4] {
    let reach = scene.feet_ring_m() * std::f64::consts::FRAC_1_SQRT_2;
    [
        [reach, reach],
        [-reach, reach],
        [-reach, -reach],
        [reach, -reach],
    ]
}

fn meets(own: Group, other: Group) -> InteractionGroups {
    InteractionGroups::new(own, other, InteractionTestMode::And)
}
