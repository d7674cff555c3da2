//! Booleans of two solids, with the origin of every face.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::{
    BooleanChain, BooleanFacts, BooleanOptions, BooleanReport, Operation, ResultFaces, SolidState,
    compute,
};
use sculptd_geometry::section::{Section, Slicer};

use crate::array::shared;
use crate::errors;
use crate::job::{Progress, watched};
use crate::mesh::{Before, Mesh};

/// One result of a Boolean.
///
/// `mesh` is the solid; `operand` (uint8: 0 for A, 1 for B; uint32 for lists of more than 256) and
/// `face` (uint32) say for each of its faces which face of which operand it is or was cut from.
#[pyclass(frozen, module = "sculptd")]
#[derive(Debug)]
struct BooleanResult {
    operation: Operation,
    mesh: Py<Mesh>,
    operands: OperandNumbers,
    faces: Arc<Vec<u32>>,
    facts: BooleanFacts,
    report: Arc<BooleanReport>,
}

/// The operand of each face.
#[derive(Debug)]
enum OperandNumbers {
    Few(Arc<Vec<u8>>),
    Many(Arc<Vec<u32>>),
}

impl OperandNumbers {
    fn of(numbers: impl Iterator<Item = u32> + Clone) -> OperandNumbers {
        let few: Option<Vec<u8>> = numbers.clone().map(|n| u8::try_from(n).ok()).collect();
        match few {
            Some(few) => OperandNumbers::Few(Arc::new(few)),
            None => OperandNumbers::Many(Arc::new(numbers.collect())),
        }
    }
}

#[pymethods]
impl BooleanResult {
    /// 'union', 'intersection', 'difference' or 'reverse-difference'.
    #[getter]
    fn operation(&self) -> &'static str {
        self.operation.name()
    }

    /// The solid; of no faces where the result is empty.
    #[getter]
    fn mesh(&self, py: Python<'_>) -> Py<Mesh> {
        self.mesh.clone_ref(py)
    }

    /// For each face of the result: 0 where it is from A, 1 where it is from B, and of a list its
    /// place in it. uint8 (uint32 for lists of more than 256), shared.
    #[getter]
    fn operand<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.operands {
            OperandNumbers::Few(all) => shared(py, all.clone(), all, vec![all.len()]),
            OperandNumbers::Many(all) => shared(py, all.clone(), all, vec![all.len()]),
        }
    }

    /// For each face of the result: its face in that operand. uint32, shared.
    #[getter]
    fn face<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        shared(py, self.faces.clone(), &self.faces, vec![self.faces.len()])
    }

    /// In cubic units.
    #[getter]
    fn volume(&self) -> f64 {
        self.facts.volume
    }

    /// In square units.
    #[getter]
    fn area(&self) -> f64 {
        self.facts.area
    }

    /// Connected shells.
    #[getter]
    fn components(&self) -> usize {
        self.facts.components
    }

    /// Every edge has as many faces on one side as on the other.
    #[getter]
    fn closed(&self) -> bool {
        self.facts.closed
    }

    /// Every edge has two faces, every vertex one fan.
    #[getter]
    fn manifold(&self) -> bool {
        self.facts.manifold
    }

    /// The length within which places were taken as one.
    #[getter]
    fn tolerance(&self) -> f64 {
        self.report.tolerance
    }

    /// True if another tolerance may give another result.
    #[getter]
    fn depends_on_tolerance(&self) -> bool {
        self.report.depends_on_tolerance
    }

    /// One sentence each.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.report.warnings.clone()
    }

    fn __repr__(&self) -> String {
        format!(
            "<sculptd.BooleanResult {}: {} faces, volume {}>",
            self.operation.name(),
            self.faces.len(),
            self.facts.volume
        )
    }
}

fn options(tolerance: Option<f64>, faces: &str, keep_contact: bool) -> PyResult<BooleanOptions> {
    let faces = match faces {
        "as-operands" => ResultFaces::AsOperands,
        "triangles" => ResultFaces::Triangles,
        "convex" => ResultFaces::ConvexPolygons,
        "polygons" => ResultFaces::Polygons,
        other => {
            return Err(PyValueError::new_err(format!(
                "faces: expected 'as-operands', 'triangles', 'convex' or 'polygons', found \
                 '{other}'"
            )));
        }
    };
    if tolerance.is_some_and(|t| !(t >= 0.0 && t.is_finite())) {
        return Err(PyValueError::new_err("tolerance: expected a length of 0 or more"));
    }
    Ok(BooleanOptions { tolerance, faces, keep_contact, ..BooleanOptions::default() })
}

fn computed(
    py: Python<'_>,
    a: &Mesh,
    b: &Mesh,
    operations: &[Operation],
    options: BooleanOptions,
    progress: &Progress,
) -> PyResult<Vec<BooleanResult>> {
    let (a, b, operations) = (a.poly().clone(), b.poly().clone(), operations.to_vec());
    let (solids, report) = watched(py, progress, move |job| {
        compute([a.as_ref(), b.as_ref()], &operations, &options, job, || 0.0)
    })?
    .map_err(|e| errors::boolean(py, &e))?;
    let report = Arc::new(report);
    let result = |s: sculptd_geometry::boolean::BooleanSolid| {
        Ok(BooleanResult {
            operation: s.operation,
            mesh: Py::new(py, Mesh::joined(s.mesh, report.warnings.clone()))?,
            operands: OperandNumbers::of(s.origins.iter().map(|o| o.operand.into())),
            faces: Arc::new(s.origins.iter().map(|o| o.face).collect()),
            facts: s.facts,
            report: report.clone(),
        })
    };
    solids.into_iter().map(result).collect()
}

/// One operation with each mesh of a list in turn.
fn chained(
    py: Python<'_>,
    meshes: Vec<Arc<PolyMesh>>,
    operation: Operation,
    options: BooleanOptions,
    progress: &Progress,
) -> PyResult<BooleanResult> {
    if meshes.is_empty() {
        return Err(PyValueError::new_err("expected at least one mesh"));
    }
    if operation == Operation::ReverseDifference && meshes.len() > 2 {
        return Err(PyValueError::new_err("reverse-difference: expected one mesh, not a list"));
    }
    let (solid, report) = watched(py, progress, move |job| {
        let mut chain = BooleanChain::new(&meshes[0], meshes.len() - 1, options);
        for tool in &meshes[1..] {
            chain.step(operation, tool, None, job, || 0.0)?;
        }
        chain.finish(job)
    })?
    .map_err(|e| errors::boolean(py, &e))?;
    Ok(BooleanResult {
        operation,
        mesh: Py::new(py, Mesh::joined(solid.mesh, report.warnings.clone()))?,
        operands: OperandNumbers::of(solid.origins.iter().map(|o| o.operand)),
        faces: Arc::new(solid.origins.iter().map(|o| o.face).collect()),
        facts: solid.facts,
        report: Arc::new(report),
    })
}

/// The mesh of one Boolean with the settings of [`boolean`], for the operators of [`Mesh`].
pub fn combined(py: Python<'_>, a: &Mesh, b: &Mesh, operation: Operation) -> PyResult<Mesh> {
    let options = options(None, "as-operands", false)?;
    if matches!(operation, Operation::Union | Operation::Difference)
        && let Some(mesh) = from_state(py, a, b, operation, options)?
    {
        return Ok(mesh);
    }
    let made = computed(py, a, b, &[operation], options, &None)?.into_iter().next();
    let made = made.ok_or_else(|| PyValueError::new_err("no result"))?;
    Ok(made.mesh.get().__copy__())
}

/// The same where `a` came from a Boolean, at the cost of what `b` cuts; None where that does not
/// decide.
fn from_state(
    py: Python<'_>,
    a: &Mesh,
    b: &Mesh,
    operation: Operation,
    options: BooleanOptions,
) -> PyResult<Option<Mesh>> {
    let (state, whole) = match &a.before {
        Before::Other => return Ok(None),
        Before::Boolean => (None, Some(a.poly().clone())),
        Before::State(state) => (Some(state.clone()), None),
    };
    let tool = b.poly().clone();
    let made = watched(py, &None, move |job| {
        let begun = match (state, &whole) {
            (None, Some(mesh)) => SolidState::new(mesh, options, job)?,
            (state, _) => state,
        };
        begun.map_or(Ok(None), |state| state.step(operation, &tool, job))
    })?
    .map_err(|e| errors::boolean(py, &e))?;
    Ok(made.map(|(state, report)| Mesh::state(state, report.warnings)))
}

/// One Boolean of two closed solids: 'union', 'intersection', 'difference' (A minus B) or
/// 'reverse-difference' (B minus A).
///
/// `b`: a mesh, or a list of meshes that are joined with `a` one after another; each costs what it
/// cuts, not what `a` has become.
/// `tolerance`: length within which places are one; None takes what the coordinates can resolve.
/// `faces`: what cut faces become: 'as-operands', 'triangles', 'convex' or 'polygons'.
/// `keep_contact`: faces in which the solids only touch belong to the intersection too.
/// `progress`: called with 0 to 1 about ten times a second; an exception from it cancels.
///
/// If an operand of several shells crosses itself, and the result does too, the operand is replaced
/// by the solid of all places that it goes around; `warnings` says so.
///
/// Raises BooleanFailed with `kind` and `operand` where an operand is open or inside out, or where
/// no result passes the checks.
#[pyfunction]
#[pyo3(signature = (a, b, operation="union", *, tolerance=None, faces="as-operands",
                    keep_contact=false, progress=None))]
fn boolean(
    py: Python<'_>,
    a: &Bound<'_, Mesh>,
    b: &Bound<'_, PyAny>,
    operation: &str,
    tolerance: Option<f64>,
    faces: &str,
    keep_contact: bool,
    progress: Progress,
) -> PyResult<BooleanResult> {
    let wanted = Operation::ALL.into_iter().find(|o| o.name() == operation).ok_or_else(|| {
        let names = Operation::ALL.map(Operation::name).join(", ");
        PyValueError::new_err(format!("operation: expected one of {names}; found '{operation}'"))
    })?;
    let options = options(tolerance, faces, keep_contact)?;
    if let Ok(b) = b.cast::<Mesh>() {
        let made = computed(py, a.get(), b.get(), &[wanted], options, &progress)?;
        return made.into_iter().next().ok_or_else(|| PyValueError::new_err("no result"));
    }
    let mut all = vec![a.get().poly().clone()];
    all.append(&mut surfaces(b)?);
    chained(py, all, wanted, options, &progress)
}

/// The surfaces of a list of meshes.
fn surfaces(list: &Bound<'_, PyAny>) -> PyResult<Vec<Arc<PolyMesh>>> {
    fn surface(item: PyResult<Bound<'_, PyAny>>) -> PyResult<Arc<PolyMesh>> {
        let item = item?;
        Ok(item.cast::<Mesh>()?.get().poly().clone())
    }
    list.try_iter()?.map(surface).collect()
}

/// The union of a list of closed solids, which may have any number of meshes but none. The settings
/// are those of `boolean`.
#[pyfunction]
#[pyo3(signature = (meshes, *, tolerance=None, faces="as-operands", progress=None))]
fn union(
    py: Python<'_>,
    meshes: &Bound<'_, PyAny>,
    tolerance: Option<f64>,
    faces: &str,
    progress: Progress,
) -> PyResult<BooleanResult> {
    let options = options(tolerance, faces, false)?;
    chained(py, surfaces(meshes)?, Operation::Union, options, &progress)
}

/// All four results from one arrangement: a dict by the names of the operations.
#[pyfunction]
#[pyo3(signature = (a, b, *, tolerance=None, faces="as-operands", keep_contact=false,
                    progress=None))]
fn boolean_all<'py>(
    py: Python<'py>,
    a: &Bound<'py, Mesh>,
    b: &Bound<'py, Mesh>,
    tolerance: Option<f64>,
    faces: &str,
    keep_contact: bool,
    progress: Progress,
) -> PyResult<Bound<'py, PyDict>> {
    let options = options(tolerance, faces, keep_contact)?;
    let out = PyDict::new(py);
    for result in computed(py, a.get(), b.get(), &Operation::ALL, options, &progress)? {
        out.set_item(result.operation.name(), result)?;
    }
    Ok(out)
}

/// Sections of a mesh by the planes `normal . p = offset`: for each offset a list of polylines,
/// (n, 3) float64, the solid to the left seen against the normal. A closed one ends with its first
/// point; a closed mesh gives closed ones only.
///
/// A vertex in the plane counts as above it, along the normal. So a plane through a flat face gives
/// what is just below the face, and the plane of a part's top gives its top. The lowest plane of a
/// part, or of a separate piece of it, has nothing below: it gives what is just above.
#[pyfunction]
#[pyo3(signature = (mesh, normal, offsets, *, progress=None))]
fn slices<'py>(
    py: Python<'py>,
    mesh: &Bound<'py, Mesh>,
    normal: [f64; 3],
    offsets: Vec<f64>,
    progress: Progress,
) -> PyResult<Vec<Vec<Bound<'py, PyAny>>>> {
    let sections = cut(py, mesh, normal, &offsets, &progress)?;
    let lines = |s: Section| s.contours.into_iter().map(|c| line(py, c.points)).collect();
    sections.into_iter().map(lines).collect()
}

/// A polyline as an array.
fn line(py: Python<'_>, points: Vec<glam::DVec3>) -> PyResult<Bound<'_, PyAny>> {
    let shape = vec![points.len(), 3];
    let points = Arc::new(points);
    shared(py, points.clone(), bytemuck::cast_slice::<_, f64>(&points), shape)
}

/// Sections of a mesh by the planes `normal . p = offset` with their sizes: for each offset a dict
/// of `area`, `perimeter`, `folded`, `turned`, `centroid` (None without area), `contours` and
/// `open`, the contours that the mesh leaves open. `folded` is the length of lines that run out and
/// back, such as doubled faces, and not part of the perimeter. `turned` is the length of the pieces
/// whose faces have the solid on the other side than their contour does. It is 0 where neighbouring
/// faces agree on the outside; above 0, `area` is that of the even-odd rule, and a sum over the
/// faces is another. Contours are as in `slices`, and so is a plane through a face: outer ones run
/// counter-clockwise, seen against the normal, and holes clockwise.
#[pyfunction]
#[pyo3(signature = (mesh, normal, offsets, *, progress=None))]
fn sections<'py>(
    py: Python<'py>,
    mesh: &Bound<'py, Mesh>,
    normal: [f64; 3],
    offsets: Vec<f64>,
    progress: Progress,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let of = |s: Section| {
        let out = PyDict::new(py);
        out.set_item("area", s.area)?;
        out.set_item("perimeter", s.perimeter)?;
        out.set_item("folded", s.folded)?;
        out.set_item("turned", s.turned)?;
        out.set_item("centroid", s.centroid.map(|c| c.to_array()))?;
        let (closed, open): (Vec<_>, Vec<_>) = s.contours.into_iter().partition(|c| c.closed);
        for (name, contours) in [("contours", closed), ("open", open)] {
            let lines = contours.into_iter().map(|c| line(py, c.points));
            out.set_item(name, lines.collect::<PyResult<Vec<_>>>()?)?;
        }
        Ok(out)
    };
    cut(py, mesh, normal, &offsets, &progress)?.into_iter().map(of).collect()
}

fn cut(
    py: Python<'_>,
    mesh: &Bound<'_, Mesh>,
    normal: [f64; 3],
    offsets: &[f64],
    progress: &Progress,
) -> PyResult<Vec<Section>> {
    let finite = offsets.iter().all(|o| o.is_finite());
    let (mesh, offsets) = (mesh.get().poly().clone(), offsets.to_vec());
    watched(py, progress, move |job| {
        let slicer = Slicer::new(&mesh, glam::DVec3::from(normal)).filter(|_| finite)?;
        Some(slicer.all(&offsets, job))
    })?
    .ok_or_else(|| {
        PyValueError::new_err("normal, offsets: expected finite numbers, the normal not zero")
    })?
    .map_err(errors::cancelled)
}

/// Adds what this file defines.
pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<BooleanResult>()?;
    m.add_function(wrap_pyfunction!(boolean, m)?)?;
    m.add_function(wrap_pyfunction!(boolean_all, m)?)?;
    m.add_function(wrap_pyfunction!(union, m)?)?;
    m.add_function(wrap_pyfunction!(sections, m)?)?;
    m.add_function(wrap_pyfunction!(slices, m)?)
}
