//! A part made ready for its walls to be judged: one solid, with places to measure at. The command,
//! the daemon and the C interface judge a part in this way.

use super::check::{CheckedPart, ThicknessLimits, add_places, check};
use super::{
    Thickness, ThicknessError, ThicknessSettings, WallQuery, Walls, measure_at_places, overlap,
};
use crate::boolean::BooleanError;
use crate::job::Job;
use crate::{CentredMesh, PolyMesh, TriMesh};

/// A part whose walls can be judged.
///
/// ```
/// use sculptd_geometry::job::Job;
/// use sculptd_geometry::shapes::cuboid;
/// use sculptd_geometry::thickness::ThicknessSettings;
/// use sculptd_geometry::thickness::check::{ThicknessLimits, Verdict};
/// use sculptd_geometry::thickness::ready::ReadyPart;
/// use glam::DVec3;
///
/// let plate = cuboid(DVec3::ZERO, DVec3::new(40.0, 40.0, 0.7));
/// let settings = ThicknessSettings::default();
/// let part = ReadyPart::new(&plate, 1.0, None, settings.crease, &Job::default()).unwrap();
/// let limits = ThicknessLimits { fail_below: Some(0.8), ..Default::default() };
/// let checked = part.judge("plate", &settings, limits, &Job::default(), || 0.0).unwrap();
/// assert_eq!(checked.answer.verdict, Verdict::Fail);
/// ```
#[derive(Debug, Clone)]
pub struct ReadyPart {
    /// The part about its centre, refined where it has too few places to measure at.
    pub mesh: CentredMesh,
    /// The part's walls before places were added; `None` where none were.
    pub walls: Option<Walls>,
    /// True if shells overlapped: the part is their union.
    pub united: bool,
}

impl ReadyPart {
    /// Prepares `part`. `scale`: millimetres a unit of the mesh. `spacing`: the longest edge
    /// between two places, in millimetres; without it a coarse part gets places by itself.
    /// `crease`: the angle of a sharp edge, in degrees.
    ///
    /// # Errors
    /// Returns an error if shells overlap and their union fails.
    pub fn new(
        part: &PolyMesh,
        scale: f64,
        spacing: Option<f32>,
        crease: f32,
        job: &Job,
    ) -> Result<ReadyPart, BooleanError> {
        let union = overlap::united(part, job)?;
        let mut mesh = CentredMesh::new(union.as_ref().unwrap_or(part), scale);
        if union.is_some() {
            mesh.counts = CentredMesh::new(part, scale).counts;
        }
        let walls = add_places(&mut mesh.mesh, spacing, crease);
        Ok(ReadyPart { mesh, walls, united: union.is_some() })
    }

    /// The part without added places.
    pub fn original_mesh(&self) -> &TriMesh {
        self.walls.as_ref().map_or(&self.mesh.mesh, |w| &w.mesh)
    }

    /// Measures the part at its places, with a list of the facets that have walls below `limit`, in
    /// millimetres.
    ///
    /// # Errors
    /// Returns an error if the settings are out of range, or the job was cancelled.
    pub fn measure(
        &self,
        settings: &ThicknessSettings,
        limit: Option<f32>,
        job: &Job,
    ) -> Result<Thickness, ThicknessError> {
        let query =
            WallQuery { limit: limit.map(f64::from), thinnest: false, grain: self.mesh.grain };
        measure_at_places(&self.mesh.mesh, self.walls.as_ref(), settings, query, job)
    }

    /// Measures the part and compares it with `limits`; see [`check`].
    ///
    /// # Errors
    /// Returns an error if the settings are out of range, or the job was cancelled.
    pub fn judge(
        &self,
        file: &str,
        settings: &ThicknessSettings,
        limits: ThicknessLimits,
        job: &Job,
        seconds: impl Fn() -> f64,
    ) -> Result<CheckedPart, ThicknessError> {
        check(file, &self.mesh, self.walls.as_ref(), settings, limits, job, seconds)
    }
}
