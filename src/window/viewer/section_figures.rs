//! The section of the newest clay by the plane that cuts it, off to the side.

use glam::DVec3;
use sculptd_clay::Snapshot;
use sculptd_engine::scene::ObjectTransform;
use sculptd_geometry::PolyMesh;
use sculptd_geometry::section::Slicer;

use crate::look::CutPlane;
use crate::panels::state::SectionFigures;

/// The clay, its transform to the world, and the plane.
pub type SectionRequest = (Snapshot, ObjectTransform, CutPlane);

/// The clay that was cut last: while a plane moves, it is the same one.
#[derive(Debug, Default)]
pub struct SectionWork {
    held: Option<((u32, u64), PolyMesh)>,
}

impl SectionWork {
    /// Returns the figures of the section. `None`: the plane has no direction in the clay's frame.
    pub fn section(&mut self, (mesh, transform, cut): &SectionRequest) -> Option<SectionFigures> {
        let clay = (mesh.object_id(), mesh.revision());
        let held = self.held.take().filter(|held| held.0 == clay);
        let (_, poly) = self.held.insert(held.unwrap_or_else(|| (clay, mesh.to_tri().to_poly())));
        let [x, y, z, at] = cut.numbers().map(f64::from);
        let towards = DVec3::new(x, y, z);
        // In the clay's own frame, whose coordinates are exact.
        let normal = transform.turn.inverse() * towards;
        let offset = (at - transform.shift.dot(towards)) / transform.scale;
        let found = Slicer::new(poly, normal)?.at(offset);
        Some(SectionFigures {
            cut: *cut,
            area: found.area * transform.scale.powi(2),
            perimeter: found.perimeter * transform.scale,
            contours: found.contours.len(),
            open: found.open,
        })
    }
}
