//! What a recording is of.

use crate::sample::DeviceId;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    Pen,
    Hand,
}

/// What plays.
#[derive(Debug, Clone, PartialEq)]
pub struct DeviceInfo {
    pub name: String,
    pub kind: DeviceKind,
    /// Size of the active area of a pen; zero for hands.
    pub area_mm: glam::Vec2,
    pub device: DeviceId,
    /// Which model and parser each interface got and why, for people.
    pub notes: Vec<String>,
}
