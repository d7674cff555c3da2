//! A turntable: one picture a frame while the camera goes once round the object.

use std::path::PathBuf;

use sculptd_engine::camera::Camera;

/// A turntable under way.
#[derive(Debug)]
pub(super) struct Turntable {
    pub(super) folder: PathBuf,
    /// Pictures of a whole turn, and the one that is next.
    pub(super) frames: u32,
    pub(super) next: u32,
    /// The camera at the beginning.
    pub(super) from: Camera,
}
