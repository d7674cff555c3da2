//! The section of the newest clay by the plane that cuts it, off to the side.

use glam::DVec3;
use sculptd_clay::Snapshot;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::section::Slicer;

use crate::look::CutPlane;
use crate::panels::state::SectionFigures;

/// The clay, its transform to the world, and the plane.
pub type SectionRequest = (Snapshot, ObjectTransform, CutPlane);

/// Returns the figures of the section. `None`: the plane has no direction in the clay's frame.
pub fn section((mesh, transform, cut): &SectionRequest) -> Option<SectionFigures> {
    let [x, y, z, at] = cut.numbers().map(f64::from);
    let towards = DVec3::new(x, y, z);
    // In the clay's own frame, whose coordinates are exact.
    let normal = transform.turn.inverse() * towards;
    let offset = (at - transform.shift.dot(towards)) / transform.scale;
    let poly = mesh.to_tri().to_poly();
    let found = Slicer::new(&poly, normal)?.at(offset);
    Some(SectionFigures {
        cut: *cut,
        area: found.area * transform.scale.powi(2),
        perimeter: found.perimeter * transform.scale,
        contours: found.contours.len(),
        open: found.open,
    })
}
