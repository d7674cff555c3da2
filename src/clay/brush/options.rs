//! The settings common to every brush: its images, its automatic masking, the conversion of the
//! pen's path to dabs.

use serde::{Deserialize, Serialize};

/// Images of a brush at most, itself counted.
pub const IMAGES: usize = 32;

/// Images of the brush beside the three planes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mirror {
    /// Normal of one more plane of symmetry, of any length; zero: none.
    pub plane: [f32; 3],
    /// Offset of the plane from the clay's middle along the normal, in bounding radii; -10 to 10.
    pub offset: f32,
    /// The number of copies about the axis, including the brush itself; 1 to 16.
    pub radial: u8,
    /// 0, 1, 2: x, y, z through the work's middle.
    pub axis: u8,
}

impl Default for Mirror {
    fn default() -> Self {
        Mirror { plane: [0.0; 3], offset: 0.0, radial: 1, axis: 1 }
    }
}

/// Automatic masking of a dab.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AutoMask {
    /// Restricts the brush to clay that faces the eye; fades over the last 0.2 of the cosine.
    pub front_faces: bool,
    /// Protects the border of an open surface.
    pub boundary: bool,
    /// Restricts the brush to clay connected, within the brush, to the point under the pen.
    pub topology: bool,
    /// Restricts the brush to clay within this angle of the dab's normal, fading over a third of
    /// it; from 0 to 180 degrees, where 0 means everything.
    pub normal_degrees: f32,
    /// Above 0 restricts the brush to hollows, below 0 to ridges; -1 to 1.
    pub cavity: f32,
    /// Restricts the brush to the face set at the start of the stroke, for each image separately.
    pub face_sets: bool,
}

impl AutoMask {
    /// Returns true if any rule protects vertices.
    pub fn is_on(&self) -> bool {
        *self != AutoMask::default()
    }
}

/// The unit of the target edge length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// Triangles stay as they are.
    #[default]
    Off,
    /// The brush's radius.
    Brush,
    /// The work's bounding radius when it was put in place.
    Work,
    /// The view's height, at the brush's depth.
    View,
}

/// Triangles cut to a wanted size under the brush, after the dabs of a tick. Not for brushes that
/// hold or count from where the stroke began (grab and its kin, layer, texture, a saturated
/// stroke): new vertices were nowhere then.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TopologySettings {
    /// What [`TopologySettings::edge`] is a share of.
    pub by: Measure,
    /// Wanted length of edges as a share of the measure; 0.002 to 1.
    pub edge: f32,
    /// Longer edges are split.
    pub split: bool,
    /// Shorter ones are collapsed.
    pub collapse: bool,
}

impl Default for TopologySettings {
    fn default() -> Self {
        TopologySettings { by: Measure::Off, edge: 0.15, split: true, collapse: true }
    }
}

/// The conversion of the pen's path to dabs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// One dab a spacing along the surface.
    #[default]
    Space,
    /// One dab a report of the pen, wherever it is.
    Dots,
    /// As space, and dabs go on while the pen rests.
    Airbrush,
    /// One dab where the pen came down, as large as it was dragged.
    Anchored,
    /// One dab that is carried along until the pen lifts.
    DragDot,
    /// A straight line from where the pen came down to where it lifts.
    Line,
    /// A curve laid by its points, or near all that was drawn: it may be changed before the brush
    /// is drawn along it.
    Curve,
}

/// The conversion of the pen's path to dabs, and the way the brush follows the path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathSettings {
    /// The conversion from path to dabs.
    pub method: Method,
    /// Dabs go on while the pen rests, whatever the method.
    pub continuous: bool,
    /// Ticks between the dabs of a resting pen; 1 to 1000.
    pub every_ticks: f32,
    /// Length of the lazy rope by which the brush is drawn, as a share of the view's height; 0 to
    /// 0.5.
    pub rope: f32,
    /// Pen reports that are averaged; 0 and 1: none; at most 64.
    pub average: u8,
    /// The random offset of dabs from the path, in radii; 0 to 2.
    pub jitter: f32,
    /// The seed of the random offsets.
    pub seed: u32,
    /// Strength counts over every fifth of the radius travelled, so that neither closer dabs nor
    /// more reports of the pen build up more. Off: each dab has the whole strength.
    pub compensate: bool,
}

impl Default for PathSettings {
    fn default() -> Self {
        PathSettings {
            method: Method::Space,
            continuous: false,
            every_ticks: 4.0,
            rope: 0.0,
            average: 0,
            jitter: 0.0,
            seed: 1,
            compensate: true,
        }
    }
}
