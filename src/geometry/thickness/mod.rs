//! Wall thickness of a solid, at every vertex or face, by rays or by the inscribed sphere.
//!
//! * One ray: the way through the wall along the normal. It jumps at steps, and under a rib it sees
//!   rib and all.
//! * A cone of rays: the mean depth of the wall ahead (Shapira, Shamir, Cohen-Or 2008). It smooths
//!   what is narrower than itself.
//! * The inscribed sphere: the ball that fits. It goes to zero in every convex edge, see
//!   [`EdgePolicy`].
//!
//! Guaranteed: the same values with any number of threads, with and without AVX2; a face that
//! touches the vertex is never hit from it; a value is missing only with a [`Reason`]. Not
//! guaranteed: anything about the solid that the triangles stand for. The stated error is against
//! the triangles' own surface, smoothed where it bends by less than the crease.

pub mod ball;
mod bands;
mod below;
pub mod change_report;
pub mod changes;
pub mod check;
pub mod colour;
pub mod cone;
mod edges;
#[cfg(test)]
mod known_balls;
#[cfg(test)]
mod known_walls;
pub mod least;
mod measuring;
pub mod medial_curve;
mod opposed;
pub mod overlap;
pub mod partition;
pub mod preset;
pub mod probe;
pub mod ray;
pub mod ready;
pub mod refine;
pub mod report;
mod rolled;
pub mod samples;
mod shaft;
pub mod sharp_edges;
pub mod side_cones;
pub mod summary;
pub mod surface;
mod valley;
mod walls;
pub mod warnings;
pub mod worst;

use glam::{DMat3, DVec3};

use crate::job::Cancelled;
pub use below::walls_below;
pub use cone::{Cone, Outliers, Weights};
pub use least::{Comparison, LeastWall, ThinFacet};
pub use measuring::{WallQuery, measure, measure_at_places, measure_prepared};
pub use ray::Correction;
pub use samples::AreaSample;
pub use surface::{MeshFaults, WeldedSurface};
pub use walls::Walls;

/// The definition of thickness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ThicknessMethod {
    /// One ray along the normal, see [`least`]: exact, and the least wall is proven.
    Ray,
    /// The mean of a cone of rays (the shape diameter function), see [`ray`].
    Cone,
    /// The largest ball between the place and the side opposite, see [`ball`].
    Sphere,
}

/// The measured side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeasuredSide {
    /// The wall behind the surface.
    Wall,
    /// The gap in front of it (clearance).
    Gap,
}

/// The value of a vertex on a sharp edge, where "the opposite side" has no meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum EdgePolicy {
    /// The value measured with the mean of the normals.
    Raw,
    /// The median of the nearest vertices beside the edge; where there are none (a box of eight
    /// vertices), the smallest of the walls under the faces that meet there.
    Extrapolate,
    /// The inscribed sphere, which goes to zero there.
    Sphere,
    /// No value, with [`Reason::Edge`].
    Neutral,
}

/// The reason for a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[repr(u8)]
pub enum Reason {
    /// Measured here.
    Measured,
    /// On a sharp edge, or a ball held by one: the value follows the edge policy, or is missing
    /// under `Neutral`.
    Edge,
    /// Missing: no wall ahead; the mesh is open there, or nothing is in front of it.
    NothingAhead,
    /// Missing: the faces around the vertex cancel each other, so there is no direction to measure
    /// in.
    NoNormal,
    /// Missing: the vertex belongs to no face of any area.
    NoFace,
}

/// The places to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MeasuredPlaces {
    /// At each welded vertex.
    Vertices,
    /// At each triangle's centroid as well.
    VerticesAndFaces,
}

/// The settings of a measurement. The default is that of `sculptd thickness`: one ray along the
/// normal. A cone has 25 rays within 60 degrees, corrected by the chord.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ThicknessSettings {
    /// The definition of thickness.
    pub method: ThicknessMethod,
    /// The measured side: walls or gaps.
    pub side: MeasuredSide,
    /// Rays in a cone, 1 to 1000.
    pub rays: usize,
    /// The cone's full angle, degrees, 0 to 120.
    pub opening: f32,
    /// The correction of a ray's length.
    pub correction: Correction,
    /// The rule for outliers among the rays of a cone.
    pub outliers: Outliers,
    /// The weight of a ray in the cone's mean.
    pub weights: Weights,
    /// The value of a vertex on a sharp edge.
    pub edges: EdgePolicy,
    /// An edge that turns by more than this, degrees, is sharp.
    pub crease: f32,
    /// The places to measure.
    pub at: MeasuredPlaces,
}

impl Default for ThicknessSettings {
    fn default() -> Self {
        ThicknessSettings {
            method: ThicknessMethod::Ray,
            side: MeasuredSide::Wall,
            rays: 25,
            opening: 60.0,
            correction: Correction::Chord,
            outliers: Outliers::SigmaMedian,
            weights: Weights::Plain,
            edges: EdgePolicy::Extrapolate,
            crease: 40.0,
            at: MeasuredPlaces::Vertices,
        }
    }
}

/// Settings that mean nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ThicknessError {
    /// A setting is out of range.
    #[error("{what} is {got}: it must be {expected}")]
    Setting {
        /// The setting.
        what: &'static str,
        /// Its value.
        got: f32,
        /// The range.
        expected: &'static str,
    },
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ThicknessSettings {
    fn check(&self) -> Result<(), ThicknessError> {
        let say = |what, got, expected| Err(ThicknessError::Setting { what, got, expected });
        if !(1..=1000).contains(&self.rays) {
            return say("the number of rays", self.rays as f32, "from 1 to 1000");
        }
        if !(0.0..=120.0).contains(&self.opening) {
            return say("the cone's opening", self.opening, "from 0 to 120 degrees");
        }
        if !(0.0..=180.0).contains(&self.crease) {
            return say("the crease angle", self.crease, "from 0 to 180 degrees");
        }
        match self.outliers {
            Outliers::Within(low, high) if !(0.0 <= low && low < high && high <= 1.0) => {
                say("the outliers' range", low, "two shares from 0 to 1, the lower first")
            }
            Outliers::Range(share) if !(0.1..=0.9).contains(&share) => {
                say("the outliers' share of the range", share, "from 0.1 to 0.9")
            }
            _ => Ok(()),
        }
    }
}

/// The measured map. Lengths are in the mesh's unit; NaN stands for "no value", and `reasons` says
/// why.
#[derive(Debug, Clone)]
pub struct Thickness {
    /// The requested settings.
    pub settings: ThicknessSettings,
    /// One a vertex of the mesh.
    pub values: Vec<f32>,
    /// The reason for each value, one per vertex of the mesh.
    pub reasons: Vec<Reason>,
    /// The greatest error of each vertex's value besides rounding and the vertex's normal: the
    /// opposite facet's distance from the curved surface, and for a cone the distance of its mean
    /// from its axis.
    pub errors: Vec<f32>,
    /// One a triangle, with [`MeasuredPlaces::VerticesAndFaces`].
    pub face_values: Vec<f32>,
    /// The reason for each of `face_values`.
    pub face_reasons: Vec<Reason>,
    /// Places spread evenly over the area, for statistics that do not depend on how the part is
    /// meshed. Their triangles are those of the walls, where there were any.
    pub samples: Vec<AreaSample>,
    /// The area that each sample stands for.
    pub sample_area: f64,
    /// The least wall; `None` where no place has one.
    pub least: Option<LeastWall>,
    /// The facets below the limit that was asked for, by rays along the normal.
    pub thin: Option<ThinFacets>,
    /// Rays and ball queries asked for.
    pub queries: u64,
    /// The welded mesh that was measured.
    pub surface: WeldedSurface,
    /// The largest coordinate error of single precision here, in the mesh's unit.
    pub rounding: f32,
}

/// The facets of the walls with values below a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct ThinFacets {
    /// The limit.
    pub limit: f64,
    /// Rising by triangle.
    pub facets: Vec<ThinFacet>,
}

impl ThicknessSettings {
    /// Rays that are cast at a place; 1 for the sphere.
    pub fn rays_at_a_place(&self) -> usize {
        if self.method == ThicknessMethod::Cone { self.rays } else { 1 }
    }
}

impl Thickness {
    /// Compares the least wall with a limit; where every place belongs to an edge, the map's least
    /// value.
    pub fn compare(&self, limit: f32) -> Comparison {
        let limit = f64::from(limit);
        match self.least {
            Some(l) => l.against(limit),
            None => {
                let known = self.values.iter().copied().filter(|v| v.is_finite());
                let least = known.fold(f32::INFINITY, f32::min) + 8.0 * self.rounding;
                if f64::from(least) < limit { Comparison::Below } else { Comparison::Reached }
            }
        }
    }

    /// Turns all places, which were measured in a turned frame.
    fn turn_back(&mut self, turn: DMat3) {
        let turned = |p: [f64; 3]| (turn * DVec3::from(p)).to_array();
        if let Some(l) = &mut self.least {
            l.position = turned(l.position);
            l.opposite = turned(l.opposite);
            l.normal = turned(l.normal);
        }
        for s in &mut self.samples {
            s.position = (turn * s.position.as_dvec3()).as_vec3();
        }
        for f in self.thin.iter_mut().flat_map(|t| &mut t.facets) {
            (f.position, f.normal) = (turn * f.position, turn * f.normal);
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct SiteValue {
    value: f32,
    error: f32,
    reason: Reason,
    opposite: Opposite,
}

/// The other end of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Opposite {
    /// A side within 40 degrees of parallel.
    Parallel,
    /// This facet, which is turned by more.
    Turned(u32),
    /// The corner that holds a ball.
    Corner,
}

impl SiteValue {
    const fn missing(reason: Reason) -> Self {
        SiteValue { value: f32::NAN, error: 0.0, reason, opposite: Opposite::Parallel }
    }
}
