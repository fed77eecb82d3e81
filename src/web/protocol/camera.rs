//! Where a new client's camera starts.

use serde::Serialize;

use super::about;

/// Where the camera is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetCameraPositionMessage")]
pub struct CameraPosition {
    /// In the world.
    pub position: [f32; 3],
    /// Whether it is only for the start.
    pub initial: bool,
}

about!(CameraPosition, "SetCameraPositionMessage" of client);

/// What the camera looks at and turns around.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "SetCameraLookAtMessage")]
pub struct CameraLookAt {
    /// In the world.
    pub look_at: [f32; 3],
    /// Whether it is only for the start.
    pub initial: bool,
}

about!(CameraLookAt, "SetCameraLookAtMessage" of client);

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn they_are_what_the_reference_sends() {
        let name = "s2c_097_camera_initial.bin";
        let initial = true;
        holds(
            &CameraPosition {
                position: [4.5, -4.5, 3.5],
                initial,
            },
            name,
            0,
        );
        holds(
            &CameraLookAt {
                look_at: [0.0, 0.0, 0.4],
                initial,
            },
            name,
            1,
        );
    }
}
