//! The solids that repairs cut with: cylinders and half spaces.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::shapes;

use super::{RepairError, combined};

/// Sides of the prism that stands for a cylinder.
pub(super) const SIDES: u32 = 48;

/// A cylinder as a prism.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cylinder {
    /// The centre of its first end.
    pub from: DVec3,
    /// The centre of its last end.
    pub to: DVec3,
    pub radius: f64,
    /// True for a prism around the cylinder, false for one in it.
    pub around: bool,
}

impl Cylinder {
    /// The prism, with its corners in the same directions for every cylinder of this axis.
    pub fn mesh(&self) -> PolyMesh {
        let way = self.to - self.from;
        let axis = way.normalize_or(DVec3::Z);
        let (x, y) = axis.any_orthonormal_pair();
        let corner = (PI / f64::from(SIDES)).portable_cos();
        let radius = if self.around { self.radius / corner } else { self.radius };
        let mut mesh = shapes::cylinder(radius, way.length(), SIDES);
        let middle = (self.from + self.to) * 0.5;
        // A right-handed frame keeps the outside outside.
        let y = if x.cross(y).dot(axis) < 0.0 { -y } else { y };
        mesh.positions.iter_mut().for_each(|p| *p = middle + x * p.x + y * p.y + axis * p.z);
        mesh
    }

    /// Returns true if two of them may meet.
    fn near(&self, other: &Cylinder) -> bool {
        let span = |c: &Cylinder| {
            let reach = DVec3::splat(c.radius * 1.1);
            (c.from.min(c.to) - reach, c.from.max(c.to) + reach)
        };
        let ((a, b), (c, d)) = (span(self), span(other));
        a.cmple(d).all() && c.cmple(b).all()
    }
}

/// One solid out of several cylinders.
pub(super) fn united(all: &[Cylinder], job: &Job) -> Result<PolyMesh, RepairError> {
    let mut out = PolyMesh::new();
    for (i, cylinder) in all.iter().enumerate() {
        job.check()?;
        let mesh = cylinder.mesh();
        if all[..i].iter().any(|c| c.near(cylinder)) {
            out = combined(&out, &mesh, Operation::Union, job)?.0;
        } else {
            append(&mut out, &mesh);
        }
    }
    Ok(out)
}

pub(super) fn append(to: &mut PolyMesh, mesh: &PolyMesh) {
    let base = to.positions.len() as u32;
    to.positions.extend(&mesh.positions);
    for face in mesh.faces() {
        to.push_face(&face.iter().map(|v| v + base).collect::<Vec<_>>());
    }
}

/// A block below the plane `up . p = offset` that encloses all of a part there.
pub(super) fn half_space(mesh: &PolyMesh, up: DVec3, offset: f64) -> PolyMesh {
    let all = || mesh.corners.iter().map(|&c| mesh.positions[c as usize]);
    let (lo, hi) =
        all().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let (middle, size) = ((lo + hi) * 0.5, (hi - lo).length());
    let foot = middle + up * (offset - up.dot(middle));
    let (x, y) = up.any_orthonormal_pair();
    let y = if x.cross(y).dot(up) < 0.0 { -y } else { y };
    let mut out = shapes::cuboid(DVec3::NEG_ONE, DVec3::new(1.0, 1.0, 0.0));
    for p in &mut out.positions {
        *p = foot + (x * p.x + y * p.y) * size + up * (p.z * 2.0 * size);
    }
    out
}

/// The two directions of a plane with this normal, and a place in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlaneFrame {
    pub u: DVec3,
    pub v: DVec3,
    pub origin: DVec3,
}

impl PlaneFrame {
    /// The plane through `origin`; `normal` is of unit length.
    pub fn new(origin: DVec3, normal: DVec3) -> PlaneFrame {
        let (u, v) = normal.any_orthonormal_pair();
        PlaneFrame { u, v, origin }
    }

    /// A place in the plane.
    pub fn flat(&self, p: DVec3) -> DVec2 {
        let from = p - self.origin;
        DVec2::new(from.dot(self.u), from.dot(self.v))
    }

    /// The place in space.
    pub fn place(&self, p: DVec2) -> DVec3 {
        self.origin + self.u * p.x + self.v * p.y
    }
}
