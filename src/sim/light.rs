//! The lamp: how bright it makes a surface, and the shadows it casts, soft because it is round and near.

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::polygon::{Point, hull};

/// Points of the lamp that cast a shadow each.
const SAMPLES: usize = 14;
/// Light that comes from everywhere.
const AMBIENT: f64 = 0.42;

/// A round lamp facing down.
pub(super) struct Lamp {
    centre: Vector3<f64>,
    samples: Vec<Vector3<f64>>,
}

impl Lamp {
    /// A lamp at `centre` of `radius` metres.
    pub fn new(centre: Vector3<f64>, radius: f64) -> Self {
        // Fermat's spiral: points spread evenly over a disc.
        let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
        let samples = (0..SAMPLES)
            .map(|i| {
                let reach = radius * ((i as f64 + 0.5) / SAMPLES as f64).sqrt();
                let (sin, cos) = (i as f64 * golden_angle).sin_cos();
                centre + Vector3::new(reach * cos, reach * sin, 0.0)
            })
            .collect();
        Self { centre, samples }
    }

    /// Brightness of a matt surface at `point` with unit `normal`; about 1 where the lamp is straight above.
    pub fn brightness(&self, point: Vector3<f64>, normal: Vector3<f64>) -> f64 {
        let to_lamp = self.centre - point;
        let falloff = (self.centre.z / to_lamp.norm()).powi(2);
        let lambert = normal.dot(&to_lamp.normalize()).max(0.0);
        AMBIENT + (1.0 - AMBIENT) * falloff * lambert
    }

    /// Share of a shadow's depth that one sample contributes.
    pub fn sample_share(&self) -> f64 {
        1.0 / self.samples.len() as f64
    }

    /// For each sample of the lamp, the outline on the plane at `height` of the shadows of convex solids, each
    /// given by points at or above that plane and below the lamp.
    pub fn shadows<'a>(
        &'a self,
        solids: &'a [Vec<Vector3<f64>>],
        height: f64,
    ) -> impl Iterator<Item = Vec<Vec<Point>>> + 'a {
        self.samples.iter().map(move |lamp| {
            let cast = |point: &Vector3<f64>| {
                let on_plane = lamp + (point - lamp) * ((lamp.z - height) / (lamp.z - point.z));
                [on_plane.x, on_plane.y]
            };
            solids
                .iter()
                .map(|solid| hull(solid.iter().map(cast).collect()))
                .collect()
        })
    }
}
