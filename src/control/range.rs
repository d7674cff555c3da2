//! The range of each number in a request, declared once.
//!
//! The constants here are what the types' schema attributes name, so that the schema, the check at
//! the daemon's door (which reads the schema, see `check`), this documentation and a
//! program that draws sliders all use the same values.

/// The least and the greatest value of a number, both allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

impl Range {
    /// Whether `value` is a number within the range.
    pub fn contains(self, value: f64) -> bool {
        value >= self.min && value <= self.max
    }
}

/// A coordinate of a point in space, in the mesh's unit.
pub const COORDINATE: Range = Range { min: -1e6, max: 1e6 };
/// A length above 0, in the mesh's unit.
pub const LENGTH: Range = Range { min: 1e-6, max: 1e6 };
/// A coordinate of a point in the view. (0, 0) is the top left and (1, 1) the bottom right; points
/// outside are beside the view.
pub const VIEW: Range = Range { min: -10.0, max: 10.0 };
/// A share: of pressure, or of a measure.
pub const SHARE: Range = Range { min: 0.0, max: 1.0 };
/// The camera's turn about +y, radians.
pub const YAW: Range = Range { min: -1000.0, max: 1000.0 };
/// The camera's pitch, radians: 89 degrees up and down.
pub const PITCH: Range = Range { min: -1.553_343, max: 1.553_343 };
/// From the camera's target to its eye, in the mesh's unit.
pub const DISTANCE: Range = Range { min: 1e-6, max: 1e6 };
/// The camera's vertical field of view, radians.
pub const FIELD_OF_VIEW: Range = Range { min: 0.01, max: 3.0 };
/// Width over height of the view.
pub const ASPECT: Range = Range { min: 0.05, max: 20.0 };
/// A coordinate in a hand tracker's space, mm.
pub const TRACKER_MM: Range = Range { min: -1999.0, max: 1999.0 };
/// Half the side of the part of the tracked space that is used, mm.
pub const REACH_MM: Range = Range { min: 30.0, max: 1000.0 };
/// The time of a point within a stroke, milliseconds.
pub const STROKE_MS: Range = Range { min: 0.0, max: 60_000.0 };
