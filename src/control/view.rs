//! The camera, and the part of the tracked space that hands use.

use serde::{Deserialize, Serialize};

#[cfg(test)]
use crate::range::{ASPECT, COORDINATE, DISTANCE, FIELD_OF_VIEW, PITCH, REACH_MM, TRACKER_MM, YAW};

/// The camera: a turntable in a right-handed world, +y up. As parameters of `camera`, only the
/// named settings change; a reply contains all.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct CameraSettings {
    /// The point that the camera turns about, in the mesh's unit; [`crate::range::COORDINATE`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(
        test,
        schemars(inner(range(min = COORDINATE.min, max = COORDINATE.max)))
    )]
    pub target: Option<[f32; 3]>,
    /// Radians about +y, 0 looks along -z; [`crate::range::YAW`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = YAW.min, max = YAW.max)))]
    pub yaw: Option<f32>,
    /// Radians, positive looks down; [`crate::range::PITCH`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = PITCH.min, max = PITCH.max)))]
    pub pitch: Option<f32>,
    /// From the target to the eye, in the mesh's unit; [`crate::range::DISTANCE`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = DISTANCE.min, max = DISTANCE.max)))]
    pub distance: Option<f32>,
    /// Vertical field of view, radians; [`crate::range::FIELD_OF_VIEW`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(
        test,
        schemars(range(min = FIELD_OF_VIEW.min, max = FIELD_OF_VIEW.max))
    )]
    pub fov_y: Option<f32>,
    /// Width over height of the view; [`crate::range::ASPECT`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = ASPECT.min, max = ASPECT.max)))]
    pub aspect: Option<f32>,
    /// No perspective.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orthographic: Option<bool>,
}

/// Parameters of `reach`: the cube of the tracked space that is laid over the object. Both fields,
/// or none to measure the hands for five seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct ReachParams {
    /// The cube's middle in the tracker's space, mm; [`crate::range::TRACKER_MM`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(
        test,
        schemars(inner(range(min = TRACKER_MM.min, max = TRACKER_MM.max)))
    )]
    pub middle_mm: Option<[f32; 3]>,
    /// Half its side, mm; [`crate::range::REACH_MM`].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = REACH_MM.min, max = REACH_MM.max)))]
    pub half_mm: Option<f32>,
}

/// Reply of `reach`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ReachReply {
    /// The hands are measured now.
    pub measuring: bool,
}
