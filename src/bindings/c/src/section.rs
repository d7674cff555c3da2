//! Sections by planes across the boundary.

use glam::DVec3;
use sculptd_geometry::job::Job;
use sculptd_geometry::section::{Section, Slicer};

use crate::boundary::{
    Failure, SculptdStatus, exclusive, guarded, hand_out, optional, reference, slice, take_back,
};
use crate::mesh::SculptdMesh;

/// The sections of a mesh by parallel planes. It never changes.
#[derive(Debug)]
pub struct SculptdSections {
    all: Vec<Section>,
}

impl SculptdSections {
    fn get(&self, index: usize) -> Result<&Section, Failure> {
        self.all.get(index).ok_or_else(|| {
            let count = self.all.len();
            Failure::argument(format!("section {index}: expected a number below {count}"))
        })
    }
}

/// Facts of one section.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdSectionFacts {
    /// In square units. Parts that overlap count once each; open contours count as if a straight
    /// line closed them.
    pub area: f64,
    /// The length of all contours, holes included, in the mesh's unit.
    pub perimeter: f64,
    /// The length of lines along which contours run out and back, both directions counted: doubled
    /// faces, and ridges in the plane. It is not part of the perimeter.
    pub folded: f64,
    /// The centre of the area; NaN where there is none.
    pub centroid: [f64; 3],
    /// The number of contours, holes included.
    pub contours: usize,
    /// The number of contours with two ends: the mesh is open there.
    pub open: usize,
    /// The length of the pieces whose triangles have the solid on the other side than their contour
    /// does, in the mesh's unit: faces are turned. Above 0, the area is that of the even-odd rule.
    pub turned: f64,
}

/// One contour of a section.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct SculptdContour {
    /// x, y, z of each point. They belong to the sections and live as long as they. The solid is to
    /// the left, seen against the normal.
    pub points: *const f64,
    /// The number of points. A closed contour names its first point again at the end.
    pub count: usize,
    /// In square units, below 0 for a hole.
    pub area: f64,
    /// False where the mesh is open: the contour has two ends.
    pub closed: bool,
}

/// Cuts a mesh by the planes `normal . p = offset`, one for each of `count` offsets. A plane
/// through a flat face gives the section just below the face. A closed mesh gives closed contours
/// alone; an open mesh gives what it has, with open contours marked.
///
/// # Safety
/// `mesh` came from this library and was not freed; `normal` has 3 numbers and `offsets` has
/// `count`; `sections` points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_sections(
    mesh: *const SculptdMesh,
    normal: *const f64,
    offsets: *const f64,
    count: usize,
    sections: *mut *mut SculptdSections,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let poly = unsafe { &reference(mesh, "mesh")?.poly };
        // SAFETY: as this function's caller promises.
        let (normal, offsets) =
            unsafe { (slice(normal, 3, "normal")?, slice(offsets, count, "offsets")?) };
        if let Some(at) = offsets.iter().position(|o| !o.is_finite()) {
            return Err(Failure::argument(format!("offsets[{at}]: expected a finite number")));
        }
        let slicer = Slicer::new(poly, DVec3::from_slice(normal)).ok_or_else(|| {
            Failure::argument("normal: expected three finite numbers that are not all 0")
        })?;
        let all = slicer
            .all(offsets, &Job::default())
            .map_err(|e| Failure(SculptdStatus::Defect, e.to_string()))?;
        // SAFETY: as this function's caller promises.
        unsafe { hand_out(sections, SculptdSections { all }) }
    })
}

/// Returns the number of sections, one for each offset; 0 for null.
///
/// # Safety
/// `sections` is null or came from this library and was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_sections_count(sections: *const SculptdSections) -> usize {
    // SAFETY: as this function's caller promises.
    unsafe { optional(sections) }.map_or(0, |s| s.all.len())
}

/// Writes the facts of one section.
///
/// # Safety
/// `sections` came from this library and was not freed; `facts` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_section_facts(
    sections: *const SculptdSections,
    section: usize,
    facts: *mut SculptdSectionFacts,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (section, facts) =
            unsafe { (reference(sections, "sections")?.get(section)?, exclusive(facts, "facts")?) };
        *facts = SculptdSectionFacts {
            area: section.area,
            perimeter: section.perimeter,
            folded: section.folded,
            centroid: section.centroid.unwrap_or(DVec3::NAN).to_array(),
            contours: section.contours.len(),
            open: section.open,
            turned: section.turned,
        };
        Ok(())
    })
}

/// Writes one contour of one section; open contours come first.
///
/// # Safety
/// `sections` came from this library and was not freed; `contour` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_section_contour(
    sections: *const SculptdSections,
    section: usize,
    index: usize,
    contour: *mut SculptdContour,
) -> SculptdStatus {
    guarded(|| {
        // SAFETY: as this function's caller promises.
        let (section, contour) = unsafe {
            (reference(sections, "sections")?.get(section)?, exclusive(contour, "contour")?)
        };
        let found = section.contours.get(index).ok_or_else(|| {
            let count = section.contours.len();
            Failure::argument(format!("contour {index}: expected a number below {count}"))
        })?;
        *contour = SculptdContour {
            points: bytemuck::cast_slice::<DVec3, f64>(&found.points).as_ptr(),
            count: found.points.len(),
            area: found.area,
            closed: found.closed,
        };
        Ok(())
    })
}

/// Frees sections; null is good.
///
/// # Safety
/// `sections` is null or came from this library, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_sections_free(sections: *mut SculptdSections) {
    // SAFETY: as this function's caller promises.
    unsafe { take_back(sections) }
}
