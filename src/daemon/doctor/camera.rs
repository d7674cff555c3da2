//! The camera that watches hands, and its models.

use super::Check;
use crate::camera_hands;
use crate::config::DevicesConfig;
use sculptd_camera::camera_thread::CameraChoice;
use sculptd_camera::models::SETUP_COMMAND;
use sculptd_camera::source::CameraError;
use sculptd_devices::Clock;

/// Checks that the configured camera opens and that its models are the tested ones.
pub(super) fn check(config: &DevicesConfig) -> Check {
    const NAME: &str = "camera";
    if config.camera.is_empty() {
        let models = match camera_hands::load_models() {
            Ok(_) => "the hand models are installed; try: sculptd run --camera",
            Err(_) => "for bare hands: sculptd camera setup",
        };
        return Check::skip(NAME, format!("devices.camera is empty: no camera is used; {models}"));
    }
    if let Err(e) = camera_hands::load_models() {
        return Check::fail(NAME, e.to_string(), SETUP_COMMAND);
    }
    match CameraChoice::from_text(&config.camera).open(&Clock::monotonic()) {
        Ok(camera) => Check::pass(NAME, camera.describe()),
        Err(e) => {
            let repair = match &e {
                CameraError::Denied(_) => {
                    "sudo usermod -aG video \"$(id -un)\"   # then log in again"
                }
                CameraError::Absent(_) => "plug it in, or set devices.camera = \"\"",
                CameraError::Busy(_) => "close the program that uses it",
                _ => "choose another camera: sculptd camera test",
            };
            Check::fail(NAME, e.to_string(), repair)
        }
    }
}
