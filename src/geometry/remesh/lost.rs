//! What a voxel grid did not hold: parts of the old surface that the new one is nowhere near.
//!
//! The old surface is sampled at its corners and the middles of its triangles; the new vertices are
//! marked in a grid of cells as large as a voxel. A sample without a mark in its cell or one of the
//! 26 around it is further than a voxel from every new vertex. Samples inside the solid (an inner
//! shell, the overlap of two) are meant to go, and do not count.

use glam::{DVec3, UVec3, Vec3};

use crate::TriMesh;
use crate::distance::DistanceSolid;

/// Cells along the longest side at most: the marks then take 17 MB.
const MOST_CELLS: f64 = 510.0;
/// A sample counts as inside if a point this many voxels outside its triangle is inside.
const OUTSIDE: f64 = 0.05;

/// Parts of the old surface that are further than a voxel from the new one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LostParts {
    /// The area of their triangles, in the square of the mesh's unit.
    pub area: f64,
    /// A place on the largest of those triangles.
    pub place: Vec3,
}

struct Marks {
    lo: DVec3,
    cell: f64,
    size: UVec3,
    bits: Vec<u64>,
}

impl Marks {
    fn index(&self, cell: UVec3) -> usize {
        ((cell.z * self.size.y + cell.y) * self.size.x + cell.x) as usize
    }

    fn cell_of(&self, p: Vec3) -> UVec3 {
        // One empty cell around all.
        let cell = ((p.as_dvec3() - self.lo) / self.cell).floor() + 1.0;
        cell.clamp(DVec3::ONE, self.size.as_dvec3() - 2.0).as_uvec3()
    }

    fn of(points: &[Vec3], (lo, hi): (Vec3, Vec3), voxel: f64) -> Marks {
        let extent = (hi - lo).as_dvec3();
        let cell = voxel.max(extent.max_element() / MOST_CELLS);
        let size = (extent / cell).ceil().as_uvec3() + 3;
        let count = size.x as usize * size.y as usize * size.z as usize;
        let mut marks = Marks { lo: lo.as_dvec3(), cell, size, bits: vec![0; count.div_ceil(64)] };
        for p in points {
            let i = marks.index(marks.cell_of(*p));
            marks.bits[i / 64] |= 1 << (i % 64);
        }
        marks
    }

    fn is_near(&self, p: Vec3) -> bool {
        let middle = self.cell_of(p);
        let around = |z: u32, y: u32| {
            (middle.x - 1..=middle.x + 1).any(|x| {
                let i = self.index(UVec3::new(x, y, z));
                self.bits[i / 64] >> (i % 64) & 1 == 1
            })
        };
        (middle.z - 1..=middle.z + 1).any(|z| (middle.y - 1..=middle.y + 1).any(|y| around(z, y)))
    }
}

/// Returns the parts of `old`, from which `solid` was built, that are far from all new vertices.
pub(crate) fn lost_parts(
    old: &TriMesh,
    solid: &DistanceSolid,
    new: &[Vec3],
    voxel: f64,
) -> Option<LostParts> {
    let marks = Marks::of(new, old.bounds(), voxel);
    let (mut area, mut largest, mut place) = (0.0, 0.0, Vec3::ZERO);
    for corners in (0..old.triangles.len()).map(|t| old.corners(t)) {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let Some(far) = corners.into_iter().chain([middle]).find(|p| !marks.is_near(*p)) else {
            continue;
        };
        // From the corner toward the middle: a corner belongs to several sides.
        let at = far.lerp(middle, 0.1).as_dvec3();
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let cross = (b - a).cross(c - a);
        let normal = cross.normalize_or_zero();
        let shares = |side: f64| solid.inside(at + normal * (side * OUTSIDE * voxel), None);
        // A wall of the solid has it on one side alone.
        if shares(1.0) == shares(-1.0) {
            continue;
        }
        let own = cross.length() * 0.5;
        area += own;
        if own > largest {
            (largest, place) = (own, far);
        }
    }
    (area > 0.0).then_some(LostParts { area, place })
}

#[cfg(test)]
mod tests {
    use super::super::{RemeshSettings, remesh};
    use super::*;
    use crate::job::Job;
    use crate::shapes;

    fn lost(mesh: &TriMesh, side: usize, sharp: bool) -> Option<LostParts> {
        let solid = DistanceSolid::build(mesh, &Job::default()).expect("built");
        remesh(mesh, &solid, RemeshSettings { side, sharp }, &Job::default()).expect("made").lost
    }

    fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> TriMesh {
        shapes::cuboid(DVec3::from(lo), DVec3::from(hi)).triangulate().0
    }

    fn joined(a: &TriMesh, b: &TriMesh) -> TriMesh {
        let mut all = a.clone();
        let offset = all.positions.len() as u32;
        all.positions.extend(&b.positions);
        all.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + offset)));
        all
    }

    #[test]
    fn a_fin_thinner_than_a_voxel_is_reported_with_its_place() {
        let body = cuboid([0.0; 3], [40.0, 40.0, 10.0]);
        let fin = cuboid([19.8, 5.0, 9.0], [20.2, 35.0, 30.0]);
        for sharp in [false, true] {
            let coarse = lost(&joined(&body, &fin), 20, sharp).expect("the fin is lost");
            assert!(coarse.place.z > 12.0, "{coarse:?}");
            assert!(coarse.area > 500.0 && coarse.area < 3000.0, "{coarse:?}");
        }
    }

    #[test]
    fn what_is_thicker_than_two_voxels_is_never_reported() {
        for (mesh, side) in [
            (shapes::icosphere(10.0, 12), 16),
            (cuboid([0.0; 3], [40.0, 30.0, 10.0]), 40),
            (shapes::torus(10.0, 3.0, 48, 24).triangulate().0, 48),
        ] {
            for sharp in [false, true] {
                assert_eq!(lost(&mesh, side, sharp), None);
            }
        }
        // An inner shell is meant to go.
        let nested = joined(&shapes::icosphere(10.0, 12), &shapes::icosphere(4.0, 8));
        assert_eq!(lost(&nested, 40, false), None);
    }
}
