//! What a recording is of.

use crate::sample::DeviceId;

/// Kind of the recorded device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    /// A pen tablet.
    Pen,
    /// A hand tracker.
    Hand,
}

/// The device of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceInfo {
    /// Name of the model, or of the device where the model is not known.
    pub name: String,
    /// Pen or hands.
    pub kind: DeviceKind,
    /// Size of the active area of a pen; zero for hands.
    pub area_mm: glam::Vec2,
    /// Number under which its samples go out.
    pub device: DeviceId,
    /// Model and parser of each interface with the reasons, as text for people.
    pub notes: Vec<String>,
}
