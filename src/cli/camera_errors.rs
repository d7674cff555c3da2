//! The exit codes of what can go wrong with a camera.

use super::Fail;
use sculptd_camera::models::ModelsError;
use sculptd_camera::source::CameraError;
use sculptd_daemon::camera_hands::CameraStartError;

/// Turns the error of a camera or its models into one with the right exit code.
pub fn failed(e: &CameraStartError) -> Fail {
    match e {
        CameraStartError::Camera(CameraError::Denied(_)) => Fail::Permission(e.to_string()),
        CameraStartError::Camera(
            CameraError::Absent(_) | CameraError::Busy(_) | CameraError::Format { .. },
        )
        | CameraStartError::Models(ModelsError::Missing { .. })
        | CameraStartError::Thread(_) => Fail::Device(e.to_string()),
        _ => Fail::Input(e.to_string()),
    }
}
