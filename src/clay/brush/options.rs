//! What may be set on every brush: its images, what it leaves alone, how the pen's path becomes
//! dabs.

use serde::{Deserialize, Serialize};

/// Images of the brush beside the three planes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mirror {
    /// Normal of one more plane of symmetry, of any length; zero: none.
    pub plane: [f32; 3],
    /// Where it stands: from the work's middle along the normal, in bounding radii; -10 to 10.
    pub offset: f32,
    /// Copies about the axis, the brush itself counted; 1 to 16.
    pub radial: u8,
    /// 0, 1, 2: x, y, z through the work's middle.
    pub axis: u8,
}

impl Default for Mirror {
    fn default() -> Self {
        Mirror { plane: [0.0; 3], offset: 0.0, radial: 1, axis: 1 }
    }
}

/// What a dab leaves alone by itself.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AutoMask {
    /// Only what faces the eye; fades over the last 0.2 of the cosine.
    pub front_faces: bool,
    /// The border of an open surface stays.
    pub boundary: bool,
    /// Only what hangs together with the point under the pen, within the brush.
    pub topology: bool,
    /// Only what turns from the dab's normal by at most so much, fading over a third of it; 0:
    /// everything; to 180 degrees.
    pub normal_degrees: f32,
    /// Above 0 the more only hollows are touched, below 0 only ridges; -1 to 1.
    pub cavity: f32,
    /// Only the face set that the stroke began in; each image has its own.
    pub face_sets: bool,
}

impl AutoMask {
    /// Whether anything is left alone.
    pub fn is_on(&self) -> bool {
        *self != AutoMask::default()
    }
}

/// What the wanted length of edges is measured by.
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

/// How the pen's path becomes dabs.
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

/// How the pen's path becomes dabs, and how the brush follows it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PathSettings {
    /// The way from path to dabs.
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
    /// How far dabs are strewn about the path, in radii; 0 to 2.
    pub jitter: f32,
    /// What dabs are strewn by.
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
