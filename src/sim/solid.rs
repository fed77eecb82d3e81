//! The convex solids that are drawn: the plate and the pieces of the tool, all upright prisms.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{Scene, polygon::Point};

/// Sides of a prism that stands for a cylinder.
const ROUND_SIDES: usize = 20;
/// The rod's end hangs this high over the table.
const ROD_BOTTOM_M: f64 = 0.004;

/// An upright prism: a convex, counter-clockwise outline between two heights.
pub(super) struct Prism {
    outline: Vec<Point>,
    bottom_m: f64,
    top_m: f64,
    /// Reflectance of its surface, as the grey value under full light.
    pub grey: f64,
}

impl Prism {
    /// The plate at a pose x, y, yaw.
    pub fn plate(scene: &Scene, [x, y, yaw]: [f64; 3]) -> Self {
        let half = scene.plate_side_m / 2.0;
        let (sin, cos) = yaw.sin_cos();
        let outline = [[-half, -half], [half, -half], [half, half], [-half, half]]
            .map(|[u, v]| [x + cos * u - sin * v, y + sin * u + cos * v]);
        Self {
            outline: outline.to_vec(),
            bottom_m: 0.0,
            top_m: scene.plate_height_m,
            grey: 250.0,
        }
    }

    /// The rod below its holder.
    pub fn rod(scene: &Scene, tip_m: Point) -> Self {
        Self::round(tip_m, scene.tip_radius_m, ROD_BOTTOM_M, 0.150, 120.0)
    }

    /// What holds the rod, from its lowest piece up: a light collar, the dark sensor, the dark wrist.
    pub fn holder(tip_m: Point) -> [Self; 3] {
        [
            Self::round(tip_m, 0.015, 0.150, 0.160, 165.0),
            Self::round(tip_m, 0.022, 0.160, 0.190, 50.0),
            Self::round(tip_m, 0.019, 0.190, 0.55, 66.0),
        ]
    }

    fn round([x, y]: Point, radius: f64, bottom_m: f64, top_m: f64, grey: f64) -> Self {
        let outline = (0..ROUND_SIDES)
            .map(|i| {
                let (sin, cos) = (TAU * i as f64 / ROUND_SIDES as f64).sin_cos();
                [x + radius * cos, y + radius * sin]
            })
            .collect();
        Self {
            outline,
            bottom_m,
            top_m,
            grey,
        }
    }

    /// Its outline, x and y in metres, counter-clockwise.
    pub fn outline(&self) -> &[Point] {
        &self.outline
    }

    /// Height of its top face, in metres.
    pub fn top_m(&self) -> f64 {
        self.top_m
    }

    /// The corners at or above `height`; a solid that crosses it is cut there.
    pub fn corners_above(&self, height: f64) -> Vec<Vector3<f64>> {
        let bottom = self.bottom_m.max(height);
        [bottom, self.top_m.max(bottom)]
            .into_iter()
            .flat_map(|z| {
                self.outline
                    .iter()
                    .map(move |[x, y]| Vector3::new(*x, *y, z))
            })
            .collect()
    }

    /// The side faces, each with its unit normal and four corners.
    pub fn sides(&self) -> impl Iterator<Item = (Vector3<f64>, [Vector3<f64>; 4])> {
        let next = self.outline.iter().cycle().skip(1);
        self.outline.iter().zip(next).map(|(a, b)| {
            let normal = Vector3::new(b[1] - a[1], a[0] - b[0], 0.0).normalize();
            let corner = |p: &Point, z| Vector3::new(p[0], p[1], z);
            let corners = [
                corner(a, self.bottom_m),
                corner(b, self.bottom_m),
                corner(b, self.top_m),
                corner(a, self.top_m),
            ];
            (normal, corners)
        })
    }

    /// The top face.
    pub fn top(&self) -> Vec<Vector3<f64>> {
        let lift = |[x, y]: &Point| Vector3::new(*x, *y, self.top_m);
        self.outline.iter().map(lift).collect()
    }
}
