//! Wall thickness of every vertex.

use std::sync::Arc;

use glam::DVec3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use sculptd_geometry::thickness::check::ThicknessLimits;
use sculptd_geometry::thickness::partition::PartitionSettings;
use sculptd_geometry::thickness::ready::ReadyPart;
use sculptd_geometry::thickness::summary::{BeyondArea, ThicknessSummary};
use sculptd_geometry::thickness::{
    self, Comparison, EdgePolicy, LeastWall, MeasuredPlaces, MeasuredSide, ThicknessMethod,
    ThicknessSettings, WallQuery,
};

use crate::array::shared;
use crate::errors;
use crate::job::{Progress, watched};
use crate::measure::to_python;
use crate::mesh::Mesh;
use crate::part_check::wall_limits;

/// The thickness of the walls of a part, one value a vertex of the mesh, in the mesh's unit.
#[pyclass(frozen, module = "sculptd")]
#[derive(Debug)]
pub struct Thickness {
    /// At the vertices, and at the middles of the triangles if asked for.
    pub measured: Arc<thickness::Thickness>,
    /// At the places that `part` has, from which the least wall and all statistics are.
    judged: Arc<thickness::Thickness>,
    pub part: Arc<ReadyPart>,
    summary: ThicknessSummary,
    reasons: Arc<Vec<u8>>,
}

#[pymethods]
impl Thickness {
    /// float32, one a vertex, read-only, shared; NaN where there is no value: see `reasons`.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values = &self.measured.values;
        shared(py, self.measured.clone(), values, vec![values.len()])
    }

    /// uint8, one a vertex: 0 measured, 1 on a sharp edge, 2 nothing ahead, 3 no normal, 4 no face.
    #[getter]
    fn reasons<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shared(py, self.reasons.clone(), &self.reasons, vec![self.reasons.len()])
    }

    /// float32, one a vertex: how far its value may be off, besides rounding and its normal.
    #[getter]
    fn errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let errors = &self.measured.errors;
        shared(py, self.measured.clone(), errors, vec![errors.len()])
    }

    /// The least wall; None where no place has one.
    #[getter]
    fn min(&self) -> Option<f32> {
        self.summary.min
    }

    /// The least wall between two bounds: a dict with `lower`, `upper`, `certified`, `position`,
    /// `opposite`; None where no place has a wall.
    #[getter]
    fn least<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let moved = |p: [f64; 3]| (DVec3::from(p) + self.part.mesh.centre).to_array();
        let least = self.judged.least.map(|l| LeastWall {
            position: moved(l.position),
            opposite: moved(l.opposite),
            ..l
        });
        least.map(|l| to_python(py, &l)).transpose()
    }

    /// Compares the least wall with `limit`, in the mesh's unit: True if it reaches the limit,
    /// False if it is below for sure, None if its bounds are too far apart to decide.
    ///
    /// A limit between the bounds of a certified wall is a tie, and a tie passes: the bounds hold
    /// the rounding of the file's coordinates. So True says that no wall is proven to be thinner.
    /// To keep the limit for sure, test `least['lower'] >= limit`.
    fn reaches(&self, limit: f32) -> Option<bool> {
        match self.judged.compare(limit) {
            Comparison::Reached => Some(true),
            Comparison::Below => Some(false),
            Comparison::Undecided => None,
        }
    }

    /// float32, one a triangle of the mesh: the value at its middle. Measured when `faces=True` was
    /// asked for, else empty.
    #[getter]
    fn face_values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values = &self.measured.face_values;
        shared(py, self.measured.clone(), values, vec![values.len()])
    }

    /// The largest value.
    #[getter]
    fn max(&self) -> Option<f32> {
        self.summary.max
    }

    /// The mean over the area.
    #[getter]
    fn mean(&self) -> Option<f32> {
        self.summary.mean
    }

    /// Half of the area is thinner.
    #[getter]
    fn median(&self) -> Option<f32> {
        self.summary.median
    }

    /// The share of vertices with a value, 0 to 1.
    #[getter]
    fn valid(&self) -> f32 {
        self.summary.valid
    }

    /// The greatest error of a value from rounding and from the cone's spread.
    #[getter]
    fn error_bound(&self) -> f32 {
        self.summary.error_bound
    }

    /// Every statistic as a dict, as `sculptd thickness --json` prints it.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.summary)
    }

    /// The area that is thinner than `limit`: in square units, and as a share of the whole, 0 to 1.
    fn below(&self, py: Python<'_>, limit: f32) -> PyResult<(f64, f64)> {
        let found = self.against(py, limit)?;
        let BeyondArea { area, all, .. } = found.area_beyond(limit, false);
        Ok((area, if all > 0.0 { area / all } else { 0.0 }))
    }

    /// The thinnest regions below `limit`, the worst first: named tuples `ThinPlace` of `position`,
    /// `thickness` and `area`.
    #[pyo3(signature = (limit, count=10))]
    fn worst<'py>(
        &self,
        py: Python<'py>,
        limit: f32,
        count: usize,
    ) -> PyResult<Bound<'py, PyList>> {
        let kind = py.import("sculptd.convert")?.getattr("ThinPlace")?;
        let out = PyList::empty(py);
        let found = self.against(py, limit)?;
        for spot in found.worst(limit, 0.0, count) {
            let position: (f64, f64, f64) = self.part.mesh.to_file(spot.position.into()).into();
            out.append(kind.call1((position, spot.thickness, spot.area))?)?;
        }
        Ok(out)
    }

    /// Judges the walls as `sculptd thickness --json` does: a dict with `verdict` ('pass', 'warn',
    /// 'fail', 'undecided' or 'unjudged'), `statement`, `least`, `worst` and the figures behind
    /// them. A limit between the bounds of a certified least wall is a tie, which passes. `preset`:
    /// a process or a material, such as 'fdm', 'sla' or 'abs'; the other limits, in mm, replace its
    /// own.
    #[pyo3(signature = (preset=None, *, fail_below=None, warn_below=None, fail_above=None,
                        progress=None))]
    fn judge<'py>(
        &self,
        py: Python<'py>,
        preset: Option<&str>,
        fail_below: Option<f32>,
        warn_below: Option<f32>,
        fail_above: Option<f32>,
        progress: Progress,
    ) -> PyResult<Bound<'py, PyAny>> {
        let limits = preset.map(wall_limits).transpose()?.unwrap_or_default();
        let given = ThicknessLimits { fail_below, warn_below, fail_above, ..Default::default() };
        let limits = limits.replaced_by(given);
        if !limits.is_valid() {
            return Err(PyValueError::new_err("limits: expected numbers above 0"));
        }
        let (part, settings) = (self.part.clone(), self.measured.settings);
        #[allow(clippy::disallowed_methods)] // The answer states its duration.
        let began = std::time::Instant::now();
        let seconds = move || began.elapsed().as_secs_f64();
        let found =
            watched(py, &progress, move |job| part.judge("", &settings, limits, job, seconds))?
                .map_err(|e| errors::thickness(&e))?;
        to_python(py, &found.answer)
    }

    /// Divides the surface into parts of equal wall. Returns uint32, one a triangle of the mesh:
    /// the number of its part, 4294967295 for none; and a dict of `levels` and `parts`, the largest
    /// first. Needs `faces=True`. `levels`: 1 to 16; None: as few as the walls need. A spot of
    /// another level belongs to its surroundings if its radius is below `smoothing` walls, and a
    /// strip if its width is: 0 to 10, where a larger number gives fewer and larger parts. The
    /// default of 1.25 is above 1 since the rim of a wall is as wide as the wall. On a blocky part,
    /// whose own pieces are little wider than thick, it swallows small pieces: set 0.5, or 0 to
    /// divide by thickness alone.
    #[pyo3(signature = (levels=None, smoothing=1.25))]
    fn parts<'py>(
        &self,
        py: Python<'py>,
        levels: Option<usize>,
        smoothing: f32,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        self.measured_faces("parts")?;
        let how = PartitionSettings { levels, smoothing };
        let (measured, centre) = (self.measured.clone(), self.part.mesh.centre);
        let found = watched(py, &None, move |job| measured.partition(how, job))?;
        let found = found.map_err(|e| errors::thickness(&e))?.moved(centre);
        let facts = to_python(py, &found)?;
        let of = Arc::new(found.of);
        Ok((shared(py, of.clone(), &of, vec![of.len()])?, facts))
    }

    /// The lines along the middle of the part's limbs: a dict of `nodes` (`position`, `thickness`,
    /// `area`) and `branches` (`nodes`, `length`, `mean`, `thinnest`, `joined`), the longest first.
    /// Needs `method='sphere'` and `faces=True`.
    fn medial_curve<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        if self.measured.settings.method != ThicknessMethod::Sphere {
            return Err(PyValueError::new_err("medial_curve: expected method='sphere'"));
        }
        self.measured_faces("medial_curve")?;
        let measured = self.measured.clone();
        let found = watched(py, &None, move |job| measured.medial_curve(job))?;
        to_python(py, &found.map_err(|e| errors::thickness(&e))?.moved(self.part.mesh.centre))
    }

    fn __repr__(&self) -> String {
        let s = &self.summary;
        let text = |v: Option<f32>| v.map_or("none".into(), |v| v.to_string());
        let [min, median, max] = [s.min, s.median, s.max].map(text);
        format!("<sculptd.Thickness min {min}, median {median}, max {max}>")
    }
}

impl Thickness {
    /// Refuses what needs a value of each triangle.
    fn measured_faces(&self, what: &str) -> PyResult<()> {
        if self.measured.face_values.len() == self.measured.surface.triangles.len() {
            return Ok(());
        }
        Err(PyValueError::new_err(format!("{what}: measure with thickness(mesh, faces=True)")))
    }

    /// The same measured against a limit, as the command line does.
    fn against(&self, py: Python<'_>, limit: f32) -> PyResult<Arc<thickness::Thickness>> {
        let settings = self.measured.settings;
        if settings.method != ThicknessMethod::Ray {
            return Ok(self.judged.clone());
        }
        let part = self.part.clone();
        watched(py, &None, move |job| part.measure(&settings, Some(limit), job))?
            .map(Arc::new)
            .map_err(|e| errors::thickness(&e))
    }
}

/// Measures the thickness of the walls under every vertex.
///
/// `method`: 'ray' (one ray along the normal; the least wall is proven), 'cone' (the mean of `rays`
/// rays within `opening` degrees, corrected by the chord) or 'sphere' (the largest ball between the
/// place and the side opposite). `faces=True` measures the middle of each triangle, too. `side`:
/// 'wall', or 'gap' for the clearance in front of the surface. `edges` is the value of a vertex on
/// a sharp edge: 'extrapolate', 'raw', 'sphere' or 'neutral'.
///
/// Lengths are in the unit of the mesh, and so are the limits of `reaches`, `below` and `worst`.
/// `judge` takes that unit as a millimetre: scale a mesh in another unit before, as
/// `mesh.transformed(scale=25.4)` does for inches.
#[pyfunction]
#[pyo3(signature = (mesh, *, method="ray", rays=25, opening=60.0, side="wall",
                    edges="extrapolate", faces=false, progress=None))]
fn thickness_of(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    method: &str,
    rays: usize,
    opening: f32,
    side: &str,
    edges: &str,
    faces: bool,
    progress: Progress,
) -> PyResult<Thickness> {
    let unknown = |what: &str, found: &str, expected: &str| {
        PyValueError::new_err(format!("{what}: expected {expected}; found '{found}'"))
    };
    let settings = ThicknessSettings {
        method: match method {
            "ray" => ThicknessMethod::Ray,
            "cone" => ThicknessMethod::Cone,
            "sphere" => ThicknessMethod::Sphere,
            other => return Err(unknown("method", other, "'ray', 'cone' or 'sphere'")),
        },
        side: match side {
            "wall" => MeasuredSide::Wall,
            "gap" => MeasuredSide::Gap,
            other => return Err(unknown("side", other, "'wall' or 'gap'")),
        },
        edges: match edges {
            "extrapolate" => EdgePolicy::Extrapolate,
            "raw" => EdgePolicy::Raw,
            "sphere" => EdgePolicy::Sphere,
            "neutral" => EdgePolicy::Neutral,
            other => {
                return Err(unknown("edges", other, "'extrapolate', 'raw', 'sphere' or 'neutral'"));
            }
        },
        rays,
        opening,
        at: if faces { MeasuredPlaces::VerticesAndFaces } else { MeasuredPlaces::Vertices },
        ..ThicknessSettings::default()
    };
    let poly = mesh.get().poly().clone();
    let found = watched(py, &progress, move |job| {
        let part = match ReadyPart::new(&poly, 1.0, None, settings.crease, job) {
            Ok(part) if !part.united => part,
            _ => return Ok(None),
        };
        let vertices = ThicknessSettings { at: MeasuredPlaces::Vertices, ..settings };
        let judged = Arc::new(part.measure(&vertices, None, job)?);
        // The values that are returned are those of the mesh as it was given.
        let measured = if part.walls.is_none() && settings.at == MeasuredPlaces::Vertices {
            judged.clone()
        } else {
            let query = WallQuery { grain: part.mesh.grain, ..WallQuery::default() };
            let whole = part.original_mesh();
            Arc::new(thickness::measure_at_places(whole, None, &settings, query, job)?)
        };
        Ok(Some((part, measured, judged)))
    })?
    .map_err(|e| errors::thickness(&e))?;
    let Some((part, measured, judged)) = found else {
        return Err(PyValueError::new_err(
            "the shells of the mesh overlap: unite them first and measure the result",
        ));
    };
    let mut summary = judged.summary();
    let moved = |p: [f32; 3]| part.mesh.to_file(p.into()).as_vec3().to_array();
    summary.thinnest = summary.thinnest.map(moved);
    summary.thickest = summary.thickest.map(moved);
    let reasons = Arc::new(measured.reasons.iter().map(|&r| r as u8).collect());
    Ok(Thickness { measured, judged, part: Arc::new(part), summary, reasons })
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Thickness>()?;
    m.add("thickness", wrap_pyfunction!(thickness_of, m)?)
}
