//! What stands on the table: sizes, weights and frictions.

/// A square plate lying on a table and an upright round rod that pushes it. The table is the plane z = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Side of the plate, in metres.
    pub plate_side_m: f64,
    /// Height of the plate, in metres.
    pub plate_height_m: f64,
    /// Mass of the plate.
    pub plate_mass_kg: f64,
    /// Coulomb friction between plate and table.
    pub table_friction: f64,
    /// Where the plate's centre starts, x and y in metres; its yaw starts at 0.
    pub plate_start_m: [f64; 2],
    /// Radius of the rod, in metres.
    pub tip_radius_m: f64,
    /// Coulomb friction between rod and plate.
    pub tip_friction: f64,
    /// From the rod's contact up to the force-torque sensor.
    pub sensor_lever_m: f64,
    /// The rectangle the rod's axis may move in: lowest x, y and highest x, y, in metres.
    pub workspace_m: [[f64; 2]; 2],
}

impl Default for Scene {
    /// An aluminium plate of 14 cm and 1.5 kg, in the reach of a table-top arm whose base is the origin.
    fn default() -> Self {
        Self {
            plate_side_m: 0.14,
            plate_height_m: 0.03,
            plate_mass_kg: 1.5,
            table_friction: 0.32,
            plate_start_m: [0.50, 0.0],
            tip_radius_m: 0.008,
            tip_friction: 0.2,
            sensor_lever_m: 0.15,
            workspace_m: [[0.36, -0.15], [0.72, 0.15]],
        }
    }
}

impl Scene {
    /// Height of the rod's contact: the middle of the plate's sides.
    pub(super) fn contact_height_m(&self) -> f64 {
        self.plate_height_m / 2.0
    }

    /// Radius of the ring of the plate's four feet: the mean distance of a square's points from its centre, where
    /// the friction of a few points turns the plate as that of the whole underside does.
    pub(super) fn feet_ring_m(&self) -> f64 {
        0.3826 * self.plate_side_m
    }
}
