//! The exact quasi-static solution of pushing a plate that stands on a few points, to hold rapier against.
//!
//! Slow pushing has no inertia: of all motions that the contact allows, the plate makes the one that the table
//! resists least (Peshkin and Sanderson, "Minimization of energy in quasi-static manipulation", 1989). With the
//! weight shared evenly by the feet, Coulomb friction loses `D = μ m g / n · Σ |v_foot|`, a convex function of the
//! plate's twist. A rod that sticks prescribes the velocity of the contact point, which leaves the yaw rate free. If
//! the force this takes lies outside the rod's friction cone, the rod slides: then the force's direction `d` is the
//! cone's edge, and the twist minimises `D` at given `d · v_contact`.

use super::{Scene, world::World, world::feet_on_plate};

type Vec2 = [f64; 2];

/// A plate that is pushed, or is about to be, at its face at −x.
struct Push {
    feet: [Vec2; 4],
    newtons_per_foot: f64,
    half_side: f64,
    tip_radius: f64,
    tip_friction: f64,
    /// x, y, yaw.
    pose: [f64; 3],
    tip: Vec2,
}

impl Push {
    /// The rod stands before the plate, `offset` metres beside its middle.
    fn new(scene: &Scene, offset: f64) -> Self {
        let [x, y] = scene.plate_start_m;
        Self {
            feet: feet_on_plate(scene),
            newtons_per_foot: scene.table_friction * scene.plate_mass_kg * 9.81 / 4.0,
            half_side: scene.plate_side_m / 2.0,
            tip_radius: scene.tip_radius_m,
            tip_friction: scene.tip_friction,
            pose: [x, y, 0.0],
            tip: start(scene, offset),
        }
    }

    /// Moves the rod by `velocity` for `dt` seconds; returns its force on the plate in newtons.
    fn step(&mut self, velocity: Vec2, dt: f64) -> Vec2 {
        self.tip = advance(self.tip, velocity, dt);
        if self.gap() > 0.0 {
            return [0.0; 2];
        }
        let (sin, cos) = self.pose[2].sin_cos();
        let (normal, tangent) = ([cos, sin], [-sin, cos]);
        let contact = [0, 1].map(|i| self.tip[i] + self.tip_radius * normal[i]);
        let arms = self.feet.map(|[u, v]| {
            let foot = [
                self.pose[0] + cos * u - sin * v,
                self.pose[1] + sin * u + cos * v,
            ];
            [foot[0] - contact[0], foot[1] - contact[1]]
        });
        let foot_velocity =
            |[ax, ay]: Vec2, w: Vec2, rate: f64| [w[0] - rate * ay, w[1] + rate * ax];
        let loss = |w: Vec2, rate: f64| -> f64 {
            let speeds = arms.map(|arm| norm(foot_velocity(arm, w, rate)));
            self.newtons_per_foot * speeds.iter().sum::<f64>()
        };
        let best_rate = |w: Vec2| {
            let fastest = 4.0 * norm(w) / norm(self.feet[0]);
            minimum(-fastest, fastest, |rate| loss(w, rate))
        };

        let (mut w, mut rate) = (velocity, best_rate(velocity));
        let mut force = [0.0; 2];
        for arm in arms {
            let v = foot_velocity(arm, w, rate);
            for axis in 0..2 {
                force[axis] += self.newtons_per_foot * v[axis] / norm(v);
            }
        }
        let sideways = dot(force, tangent);
        if sideways.abs() > self.tip_friction * dot(force, normal) {
            let slope = self.tip_friction.copysign(sideways);
            let d = [0, 1].map(|i| normal[i] + slope * tangent[i]);
            let square = dot(d, d);
            let along = |slip: f64| [d[0] / square - slip * d[1], d[1] / square + slip * d[0]];
            let slip = minimum(-3.0, 3.0, |slip| {
                let w = along(slip);
                loss(w, best_rate(w))
            });
            let unit = along(slip);
            force = d.map(|component| component * loss(unit, best_rate(unit)));
            let scale = dot(velocity, normal) / dot(unit, normal);
            w = unit.map(|component| component * scale);
            rate = best_rate(w);
        }

        let arm = [self.pose[0] - contact[0], self.pose[1] - contact[1]];
        let centre_velocity = foot_velocity(arm, w, rate);
        let [x, y] = advance([self.pose[0], self.pose[1]], centre_velocity, dt);
        self.pose = [x, y, self.pose[2] + rate * dt];
        // Takes out the drift of the integration.
        let [x, y] = advance([x, y], normal, -self.gap());
        self.pose = [x, y, self.pose[2]];
        force
    }

    /// From the rod's surface to the plate's face, in metres.
    fn gap(&self) -> f64 {
        let (sin, cos) = self.pose[2].sin_cos();
        let depth = cos * (self.pose[0] - self.tip[0]) + sin * (self.pose[1] - self.tip[1]);
        depth - self.half_side - self.tip_radius
    }
}

/// Where the rod's axis starts: 1 cm before the plate's face at −x, `offset` beside its middle.
fn start(scene: &Scene, offset: f64) -> Vec2 {
    let [x, y] = scene.plate_start_m;
    [
        x - scene.plate_side_m / 2.0 - scene.tip_radius_m - 0.01,
        y + offset,
    ]
}

/// Where a convex function is least between `low` and `high` (golden section).
fn minimum(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let mut left = high - golden * (high - low);
    let mut right = low + golden * (high - low);
    let (mut at_left, mut at_right) = (f(left), f(right));
    for _ in 0..48 {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - golden * (high - low);
            at_left = f(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + golden * (high - low);
            at_right = f(right);
        }
    }
    f64::midpoint(low, high)
}

fn advance(from: Vec2, velocity: Vec2, secs: f64) -> Vec2 {
    [0, 1].map(|axis| from[axis] + velocity[axis] * secs)
}

fn dot(a: Vec2, b: Vec2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn norm(a: Vec2) -> f64 {
    a[0].hypot(a[1])
}

/// The plate of the MIT pushing set, pushed at 50 mm/s.
fn mit_scene() -> Scene {
    Scene {
        plate_side_m: 0.09,
        plate_height_m: 0.013,
        plate_mass_kg: 0.837,
        table_friction: 0.25,
        tip_radius_m: 0.004_75,
        tip_friction: 0.2,
        ..Scene::default()
    }
}

const VELOCITY: Vec2 = [0.05, 0.0];
const STEPS: usize = 960;
const STEP_SECS: f64 = 2.0 / STEPS as f64;

/// Yaw after 2 s, and the mean force over the second of them, of rapier and of the exact solution.
fn compare(scene: &Scene, offset: f64) -> [(f64, f64); 2] {
    let mut world = World::new(scene, start(scene, offset), STEP_SECS);
    let mut exact = Push::new(scene, offset);
    let (mut world_force, mut exact_force) = (0.0, 0.0);
    for step in 0..STEPS {
        let [fx, fy, _] = world.step(VELOCITY).force_newtons;
        let force = exact.step(VELOCITY, STEP_SECS);
        if step >= STEPS / 2 {
            world_force += norm([fx, fy]) / (STEPS / 2) as f64;
            exact_force += norm(force) / (STEPS / 2) as f64;
        }
    }
    [
        (world.plate_pose()[2], world_force),
        (exact.pose[2], exact_force),
    ]
}

#[test]
fn an_off_centre_push_turns_the_plate_as_the_exact_solution_says() {
    // Nearer to the middle the same angle of a foot's friction (see `world`) is a larger share of a smaller turn.
    for (offset, tolerance) in [(0.015, 0.02), (-0.015, 0.02), (0.005, 0.05)] {
        let [(yaw, force), (exact_yaw, exact_force)] = compare(&mit_scene(), offset);
        let (yaw_ratio, force_ratio) = (yaw / exact_yaw, force / exact_force);
        assert!((yaw_ratio - 1.0).abs() < tolerance, "{yaw} {exact_yaw}");
        assert!((force_ratio - 1.0).abs() < 0.05, "{force} {exact_force}");
    }
}

#[test]
fn a_centred_push_takes_the_friction_of_the_plates_weight() {
    let scene = mit_scene();
    let [(yaw, force), (exact_yaw, exact_force)] = compare(&scene, 0.0);
    let friction_newtons = scene.table_friction * scene.plate_mass_kg * 9.81;
    assert!((exact_force / friction_newtons - 1.0).abs() < 1e-6);
    assert!(
        (force / friction_newtons - 1.0).abs() < 0.05,
        "{force} {friction_newtons}"
    );
    assert!(
        yaw.abs() < 0.01 && exact_yaw.abs() < 1e-6,
        "{yaw} {exact_yaw}"
    );
}
