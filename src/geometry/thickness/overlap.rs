//! Parts of several shells: where shells overlap, the surface inside the other is no wall. Such a
//! part is measured on the union of its shells.

use glam::DVec3;

use crate::boolean::{BooleanError, solve};
use crate::bvh::Bvh8;
use crate::disjoint_sets::DisjointSets;
use crate::job::Job;
use crate::self_intersection;
use crate::weld::weld_positions;
use crate::winding::Winding;
use crate::{CentredMesh, PolyMesh, TriMesh};

/// Facets beside which the winding number is looked at.
const FACETS: usize = 4000;

/// Returns the union of the shells of `part`, or `None` if they do not overlap, or the part is
/// open.
///
/// # Errors
/// Returns an error if they overlap and no union passes the checks of [`solve`].
pub fn united(part: &PolyMesh, job: &Job) -> Result<Option<PolyMesh>, BooleanError> {
    let own = CentredMesh::new(part, 1.0).mesh;
    if !boxes_overlap(&own) || !overlaps(part, &own, job)? {
        return Ok(None);
    }
    solve(part, job).map(Some)
}

/// Returns true if the boxes of two shells overlap: the cheap test.
fn boxes_overlap(mesh: &TriMesh) -> bool {
    let (weld, positions) = weld_positions(&mesh.positions);
    let mut sets = DisjointSets::new(positions.len());
    let known = |t: &&[u32; 3]| t.iter().all(|&v| (v as usize) < weld.len());
    for t in mesh.triangles.iter().filter(known) {
        let [a, b, c] = t.map(|v| weld[v as usize]);
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut boxes: std::collections::BTreeMap<u32, [glam::Vec3; 2]> = Default::default();
    for (v, &p) in positions.iter().enumerate() {
        let own = boxes.entry(sets.root(v as u32)).or_insert([p, p]);
        *own = [own[0].min(p), own[1].max(p)];
    }
    let mut boxes: Vec<[glam::Vec3; 2]> = boxes.into_values().collect();
    boxes.sort_by(|a, b| a[0].x.total_cmp(&b[0].x));
    boxes.iter().enumerate().any(|(i, a)| {
        boxes[i + 1..]
            .iter()
            .take_while(|b| b[0].x <= a[1].x)
            .any(|b| a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all())
    })
}

/// Returns true if a facet is inside matter, or shells cross.
fn overlaps(part: &PolyMesh, own: &TriMesh, job: &Job) -> Result<bool, BooleanError> {
    let surface = super::WeldedSurface::new(own, 0.7);
    let faults = surface.faults;
    if faults.boundary_edges + faults.inverted_edges > 0 {
        return Ok(false);
    }
    let tree = Bvh8::build(own, job)?;
    let winding = Winding::build(&tree);
    let (lo, hi) = own.bounds();
    let above = f64::from((hi - lo).length()) * 1e-5;
    let step = own.triangles.len().div_ceil(FACETS).max(1);
    for t in (0..own.triangles.len()).step_by(step) {
        let Some(corners) = surface.corners(t) else { continue };
        let middle = corners.iter().map(|c| c.as_dvec3()).sum::<DVec3>() / 3.0;
        let normal = surface.face_normals[t].as_dvec3();
        let turn = winding.at(&tree, middle + normal * above);
        if turn > 0.5 || (turn - turn.round()).abs() < 0.2 && turn.round() < -0.5 {
            return Ok(!faults.inside_out);
        }
    }
    let triangles = part.triangles().0;
    Ok(!self_intersection::pairs(&part.positions, &triangles, job)?.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;

    fn both(a: &PolyMesh, b: &PolyMesh, turned: bool) -> PolyMesh {
        let mut out = a.clone();
        let first = out.positions.len() as u32;
        out.positions.extend(&b.positions);
        let corners = out.corners.len() as u32;
        out.face_starts.extend(b.face_starts[1..].iter().map(|s| s + corners));
        for f in b.faces() {
            let face = f.iter().map(|v| v + first);
            if turned { out.corners.extend(face.rev()) } else { out.corners.extend(face) }
        }
        out
    }

    #[test]
    fn shells_that_overlap_are_united_and_cavities_are_not() {
        let cube = |at: f64, size: f64| cuboid(DVec3::splat(at), DVec3::splat(at + size));
        let job = Job::default();
        let of = |m: &PolyMesh| united(m, &job).expect("united");
        let crossing = of(&both(&cube(0.0, 10.0), &cube(9.0, 10.0), false)).expect("they overlap");
        let (lo, hi) = crossing.triangulate().0.bounds();
        assert_eq!((lo, hi), (glam::Vec3::ZERO, glam::Vec3::splat(19.0)));
        let volume = crate::measure::measures(&crossing.triangulate().0).volume;
        assert!((volume - 1999.0).abs() < 1e-3, "{volume}");
        assert!(of(&both(&cube(0.0, 10.0), &cube(3.0, 4.0), false)).is_some(), "one in the other");
        assert!(of(&both(&cube(0.0, 10.0), &cube(3.0, 4.0), true)).is_none(), "a cavity");
        assert!(of(&both(&cube(0.0, 10.0), &cube(20.0, 4.0), false)).is_none(), "apart");
        assert!(of(&cube(0.0, 10.0)).is_none(), "one shell");
    }
}
