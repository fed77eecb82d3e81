//! Reads the force between two colliders out of rapier's solver.

use rapier3d::prelude::*;

use super::world::Touch;

/// The force that `other` puts on `own` in the step just made, and where.
///
/// The normal impulse is that of the whole step. Of friction only the last solver pass is kept, as the vector that
/// warm-starts the next step; in steady sliding all passes are alike, so it stands for each of them.
pub(super) fn touch(physics: &PhysicsWorld, own: ColliderHandle, other: ColliderHandle) -> Touch {
    let Some(pair) = physics.narrow_phase.contact_pair(own, other) else {
        return Touch::default();
    };
    let parameters = &physics.integration_parameters;
    let passes = parameters.num_solver_iterations as f32;
    // Normals and friction are those of the pair's first collider: normals lead out of it, friction acts on it.
    let own_sign = if pair.collider1 == own { 1.0 } else { -1.0 };
    let mut impulse = Vector::ZERO;
    let mut outward = Vector::ZERO;
    for manifold in pair.solver_manifolds() {
        for point in &manifold.points {
            let pressed = point.data.impulse * manifold.data.normal;
            outward += own_sign * pressed;
            impulse += own_sign * (passes * point.data.warmstart_tangent_world - pressed);
        }
    }
    let toward = outward.normalize_or_zero();
    let force = impulse / parameters.dt;
    Touch {
        force_newtons: [force.x, force.y, force.z].map(f64::from),
        toward_contact: [toward.x, toward.y].map(f64::from),
    }
}
