//! What the size page shows: measures, the shadow along a direction, distances to another shape.

use crate::look::CutPlane;
use glam::DVec3;
use sculptd_geometry::projection::PlaneRegion;

/// Measurements of one state of the object; lengths in the mesh's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    pub revision: u64,
    pub volume: f64,
    pub area: f64,
    pub dimensions: [f64; 3],
    /// Areas of the shadows along x, y and z.
    pub projected: [f64; 3],
    /// Direction of view of the shadow.
    pub direction: DVec3,
    pub shadow: f64,
    pub outline: Vec<PlaneRegion>,
}

/// The section of the object by a plane; lengths in the world's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionFigures {
    pub cut: CutPlane,
    pub area: f64,
    pub perimeter: f64,
    pub contours: usize,
    /// Contours with two ends: the object is open there.
    pub open: usize,
}

/// Reference of distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DistanceTarget {
    /// The object as it was opened, or as it was when the person chose to keep it.
    #[default]
    Before,
    /// The held object, at its current place.
    HeldObject,
}

/// Summary of the distance map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DistanceSummary {
    pub min: f32,
    pub max: f32,
    /// Mean of the squares' root.
    pub rms: f32,
    /// Vertices known, of all.
    pub known: (usize, usize),
}

#[derive(Debug)]
pub struct SizesPage {
    pub found: Option<Box<Measured>>,
    pub direction: DVec3,
    pub against: DistanceTarget,
    pub distances: Option<DistanceSummary>,
    /// Of the plane that cuts the object.
    pub section: Option<SectionFigures>,
    /// The drawing's file.
    pub file: String,
}

impl Default for SizesPage {
    fn default() -> Self {
        SizesPage {
            found: None,
            direction: DVec3::NEG_Z,
            against: DistanceTarget::default(),
            distances: None,
            section: None,
            file: "outline.svg".into(),
        }
    }
}
