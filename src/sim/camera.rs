//! A pinhole camera: where a point of the scene falls in the image, and what of the table a pixel sees.

use nalgebra::Vector3;

/// A camera that looks at a point, upright.
pub(super) struct Camera {
    eye: Vector3<f64>,
    right: Vector3<f64>,
    down: Vector3<f64>,
    forward: Vector3<f64>,
    focal_px: f64,
    centre_px: f64,
}

impl Camera {
    /// A camera at `eye` (metres) whose square image of `size_px` a side is centred on `target`; what lies
    /// `field_m` apart beside the target fills the image's width.
    pub fn look_at(eye: Vector3<f64>, target: Vector3<f64>, field_m: f64, size_px: usize) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(&Vector3::z()).normalize();
        Self {
            eye,
            right,
            down: forward.cross(&right),
            forward,
            focal_px: size_px as f64 * (target - eye).norm() / field_m,
            centre_px: size_px as f64 / 2.0,
        }
    }

    /// Where the camera stands, in metres.
    pub fn eye(&self) -> Vector3<f64> {
        self.eye
    }

    /// Column and row of a point in front of the camera; pixel (0, 0) spans 0 to 1.
    pub fn project(&self, point: Vector3<f64>) -> [f64; 2] {
        let ray = point - self.eye;
        let scale = self.focal_px / ray.dot(&self.forward);
        [
            self.centre_px + scale * ray.dot(&self.right),
            self.centre_px + scale * ray.dot(&self.down),
        ]
    }

    /// The point of the table (z = 0) seen at a column and row.
    pub fn on_table(&self, column: f64, row: f64) -> Vector3<f64> {
        let ray = self.forward * self.focal_px
            + self.right * (column - self.centre_px)
            + self.down * (row - self.centre_px);
        self.eye - ray * (self.eye.z / ray.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_of_the_table_is_seen_where_it_projects_to() {
        let target = Vector3::new(0.5, 0.0, 0.0);
        let camera = Camera::look_at(Vector3::new(1.0, -0.4, 0.8), target, 0.5, 64);
        let [column, row] = camera.project(target);
        assert!((column - 32.0).abs() < 1e-9 && (row - 32.0).abs() < 1e-9);
        let point = Vector3::new(0.6, 0.1, 0.0);
        let [column, row] = camera.project(point);
        assert!((camera.on_table(column, row) - point).norm() < 1e-9);
        // Farther away is higher up in the image.
        assert!(camera.project(Vector3::new(0.3, 0.1, 0.0))[1] < row);
    }
}
