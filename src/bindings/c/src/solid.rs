//! Booleans and wall thickness across the boundary.

use sculptd_geometry::CentredMesh;
use sculptd_geometry::boolean::{BooleanOptions, Operation, compute};
use sculptd_geometry::job::Job;
use sculptd_geometry::thickness::{ThicknessMethod, ThicknessSettings, measure};

use crate::boundary::{
    Failure, SculptdStatus, copy_out, exclusive, guarded, hand_out, optional_mut, reference,
};
use crate::mesh::SculptdMesh;

/// A Boolean operation on two solids A and B.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SculptdOperation {
    /// A or B.
    Union = 0,
    /// A and B.
    Intersection = 1,
    /// A minus B.
    Difference = 2,
    /// B minus A.
    ReverseDifference = 3,
}

/// Facts of a Boolean's result.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdBooleanFacts {
    /// In cubic units.
    pub volume: f64,
    /// In square units.
    pub area: f64,
    /// The length within which places were taken as one.
    pub tolerance: f64,
    /// Connected shells.
    pub components: usize,
    /// Every edge has two faces, every vertex one fan.
    pub manifold: bool,
}

/// One Boolean of two closed solids. `operation` is a SculptdOperation. `tolerance`: the length
/// within which places are one; negative takes what the coordinates can resolve. `facts` may be
/// null.
///
/// # Safety
/// `a` and `b` came from this library and were not freed; `result` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_boolean(
    a: *const SculptdMesh,
    b: *const SculptdMesh,
    operation: u32,
    tolerance: f64,
    result: *mut *mut SculptdMesh,
    facts: *mut SculptdBooleanFacts,
) -> SculptdStatus {
    guarded(|| {
        // A number and not the enum: C may pass any number, which is no value of a Rust enum.
        let operation = match operation {
            x if x == SculptdOperation::Union as u32 => Operation::Union,
            x if x == SculptdOperation::Intersection as u32 => Operation::Intersection,
            x if x == SculptdOperation::Difference as u32 => Operation::Difference,
            x if x == SculptdOperation::ReverseDifference as u32 => Operation::ReverseDifference,
            x => return Err(Failure::argument(format!("operation {x}: expected 0 to 3"))),
        };
        if tolerance.is_nan() || tolerance == f64::INFINITY {
            return Err(Failure::argument("tolerance: expected a finite length, or less than 0"));
        }
        // SAFETY: as this function's caller promises.
        let operands = unsafe { [&reference(a, "a")?.poly, &reference(b, "b")?.poly] };
        let tolerance = Some(tolerance).filter(|t| *t >= 0.0);
        let options = BooleanOptions { tolerance, ..BooleanOptions::default() };
        let (solids, report) = compute(operands, &[operation], &options, &Job::default(), || 0.0)?;
        let Some(solid) = solids.into_iter().next() else {
            return Err(Failure(SculptdStatus::Defect, "a Boolean without a result".into()));
        };
        // SAFETY: as this function's caller promises.
        if let Some(facts) = unsafe { optional_mut(facts) } {
            *facts = SculptdBooleanFacts {
                volume: solid.facts.volume,
                area: solid.facts.area,
                tolerance: report.tolerance,
                components: solid.facts.components,
                manifold: solid.facts.manifold,
            };
        }
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(result, SculptdMesh::computed(solid.mesh)) }
    })
}

/// Statistics of a part's walls. A length is NaN where no vertex has a value.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdThickness {
    /// The least value.
    pub min: f32,
    /// The largest value.
    pub max: f32,
    /// The mean over the area.
    pub mean: f32,
    /// Half of the area is thinner.
    pub median: f32,
    /// The share of vertices with a value, 0 to 1.
    pub valid: f32,
}

/// The thickness of the wall under each vertex by one ray along its normal (`rays` 0 or 1), or by
/// a cone of `rays` rays, in the mesh's unit; NaN where there is none. `values` has room for
/// `count` numbers, as many as the mesh has vertices, or is null with a count of 0.
///
/// # Safety
/// `mesh` came from this library and was not freed; `values` has room; `statistics` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_thickness(
    mesh: *const SculptdMesh,
    rays: usize,
    values: *mut f32,
    count: usize,
    statistics: *mut SculptdThickness,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let poly = unsafe { &reference(mesh, "mesh")?.poly };
        if count != 0 && count != poly.positions.len() {
            return Err(Failure::argument(format!(
                "count is {count}: expected 0 or the number of vertices, {}",
                poly.positions.len()
            )));
        }
        // SAFETY: as this function's caller promises.
        let statistics = unsafe { exclusive(statistics, "statistics") }?;
        let method = if rays > 1 { ThicknessMethod::Cone } else { ThicknessMethod::Ray };
        let rays = rays.max(1);
        let settings = ThicknessSettings { method, rays, ..ThicknessSettings::default() };
        let part = CentredMesh::new(poly, 1.0);
        let measured = measure(&part.mesh, &settings, &Job::default())?;
        let s = measured.summary();
        let number = |v: Option<f32>| v.unwrap_or(f32::NAN);
        *statistics = SculptdThickness {
            min: number(s.min),
            max: number(s.max),
            mean: number(s.mean),
            median: number(s.median),
            valid: s.valid,
        };
        if count == 0 {
            return Ok(());
        }
        // SAFETY: as this function's caller promises; `count` is the number of values.
        unsafe { copy_out(&measured.values, values, "values") }
    })
}
