//! What rays and balls meet, apart from where is measured: places put on a wall cut its triangles,
//! but the wall stays what it was. A part of a hundred triangles with 40,000 places costs what a
//! hundred triangles cost at each.

use glam::Vec3;

use super::surface::{DROPPED, WeldedSurface};
use crate::TriMesh;
use crate::bvh::Bvh8;

/// Boxes more that a ray may meet: to test so many costs about what a tree over a hundred times as
/// many triangles does.
const MORE_BOXES: f64 = 32.0;

/// A surface before places were added to it.
#[derive(Debug, Clone)]
pub struct Walls {
    /// The surface, in the frame and the unit of the mesh with the places.
    pub mesh: TriMesh,
    /// For each triangle of the mesh with the places, the triangle of `mesh` that contains it.
    pub of: Vec<u32>,
}

impl Walls {
    /// Returns true if these belong to `fine`, and rays against them cost less: the boxes of long
    /// slanted triangles are mostly empty, and those of their parts are not.
    pub(super) fn serve(&self, fine: &TriMesh) -> bool {
        let right = self.of.len() == fine.triangles.len()
            && self.mesh.triangles.len() <= self.of.len()
            && self.of.iter().all(|&t| (t as usize) < self.mesh.triangles.len());
        let (lo, hi) = self.mesh.bounds();
        let (whole, parts) = (boxes(&self.mesh), boxes(fine));
        right && (whole - parts <= MORE_BOXES * half_surface(hi - lo) || whole <= 2.0 * parts)
    }
}

/// Half of the surface of a box of this size.
fn half_surface(size: Vec3) -> f64 {
    let d = size.as_dvec3();
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// The surface of the boxes around all triangles, halved: over that of the box around the mesh, so
/// many of them a ray through it meets.
fn boxes(mesh: &TriMesh) -> f64 {
    let one = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        half_surface(a.max(b).max(c) - a.min(b).min(c))
    };
    (0..mesh.triangles.len()).map(one).filter(|s| s.is_finite()).sum()
}

/// Gives a triangle that was cut for places its face normal at all corners. It is so long that the
/// area between its corners is a flat wall, not an approximation of a bent one.
pub(super) fn flatten_what_was_cut(corners: &mut [[Vec3; 3]], faces: &[Vec3], of: &[u32]) {
    let mut parts = vec![0u32; corners.len()];
    of.iter().for_each(|&t| parts[t as usize] += 1);
    for ((corners, &own), parts) in corners.iter_mut().zip(faces).zip(parts) {
        if parts > 1 {
            *corners = [own; 3];
        }
    }
}

/// The walls' triangles on which each place lies.
pub(super) struct OwnWalls<'a> {
    surface: &'a WeldedSurface,
    cut: Option<CutWalls<'a>>,
}

struct CutWalls<'a> {
    of: &'a [u32],
    /// Those of vertex `v` are `list[starts[v]..starts[v + 1]]`, rising.
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl<'a> OwnWalls<'a> {
    /// `of`: as [`Walls::of`]; none where the walls are the surface itself.
    pub(super) fn new(surface: &'a WeldedSurface, of: Option<&'a [u32]>) -> OwnWalls<'a> {
        let cut = of.map(|of| {
            let (mut starts, mut list) = (vec![0], Vec::with_capacity(surface.around.len()));
            let mut own = Vec::new();
            for v in 0..surface.positions.len() {
                own.clear();
                own.extend(surface.around(v).iter().map(|&t| of[t as usize]));
                own.sort_unstable();
                own.dedup();
                list.extend(&own);
                starts.push(list.len() as u32);
            }
            CutWalls { of, starts, list }
        });
        OwnWalls { surface, cut }
    }

    /// Those at welded vertex `v`, rising.
    pub(super) fn at(&self, v: usize) -> &[u32] {
        match &self.cut {
            Some(c) => &c.list[c.starts[v] as usize..c.starts[v + 1] as usize],
            None => self.surface.around(v),
        }
    }

    /// Returns the distance around welded vertex `v` within which its walls are ignored: as far as
    /// the surface's triangles at it reach everywhere. Infinite if the walls are those triangles.
    pub(super) fn clear(&self, v: usize) -> f32 {
        if self.cut.is_none() {
            return f32::INFINITY;
        }
        let p = self.surface.positions[v];
        let far = |&t: &u32| {
            let corners = self.surface.triangles[t as usize];
            let k = corners.iter().position(|&c| c as usize == v).unwrap_or(0);
            let [a, b] = [1, 2].map(|i| self.surface.positions[corners[(k + i) % 3] as usize]);
            let (to, edge) = (p - a, b - a);
            let along = (to.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            (to - edge * along).length()
        };
        self.surface.around(v).iter().map(far).fold(f32::INFINITY, f32::min)
    }

    /// That of which the surface's triangle `t` is a part.
    pub(super) fn of(&self, t: u32) -> u32 {
        self.cut.as_ref().map_or(t, |c| c.of[t as usize])
    }

    /// The surface's triangles in the order of the leaves of the walls' tree: neighbours in space
    /// are neighbours in time, and the caches stay warm.
    pub(super) fn in_order(&self, tree: &Bvh8) -> Vec<u32> {
        let count = self.surface.triangles.len();
        let kept = |t: &u32| self.surface.triangles[*t as usize][0] != DROPPED;
        let mut seen = vec![false; count];
        // A wall has at most as many triangles as the surface that was cut from it.
        let walls = tree.packs().iter().flat_map(|p| p.id).filter(|&t| {
            seen.get_mut(t as usize).is_some_and(|seen| !std::mem::replace(seen, true))
        });
        let Some(cut) = &self.cut else { return walls.filter(kept).collect() };
        // Of each wall its parts: `parts[first[w]..first[w + 1]]`.
        let mut first = vec![0u32; count + 1];
        cut.of.iter().for_each(|&w| first[w as usize + 1] += 1);
        for w in 0..count {
            first[w + 1] += first[w];
        }
        let (mut next, mut parts) = (first.clone(), vec![0u32; count]);
        for (t, &w) in cut.of.iter().enumerate() {
            parts[next[w as usize] as usize] = t as u32;
            next[w as usize] += 1;
        }
        let of = |w: u32| first[w as usize] as usize..first[w as usize + 1] as usize;
        walls.flat_map(|w| &parts[of(w)]).copied().filter(kept).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::refine::{Refined, refine};
    use super::super::{
        Thickness, ThicknessMethod, ThicknessSettings, WallQuery, measure_at_places,
    };
    use super::*;
    use crate::job::Job;
    use crate::shapes::{cuboid, cylinder};

    #[test]
    fn walls_say_what_their_parts_say() {
        let slab = cuboid(DVec3::new(-20.0, -10.0, -1.5), DVec3::new(20.0, 10.0, 1.5));
        for whole in [slab, cylinder(6.0, 20.0, 40)] {
            let whole = whole.triangulate().0;
            let Refined { mesh, of } = refine(&whole, 0.8);
            let walls = Walls { mesh: whole, of };
            assert!(walls.serve(&mesh));
            for method in [ThicknessMethod::Ray, ThicknessMethod::Sphere] {
                let settings = ThicknessSettings { method, ..ThicknessSettings::default() };
                let with = |walls: Option<&Walls>| {
                    measure_at_places(
                        &mesh,
                        walls,
                        &settings,
                        WallQuery::default(),
                        &Job::default(),
                    )
                    .expect("measured")
                };
                let (parts, whole) = (with(None), with(Some(&walls)));
                let quantiles =
                    |t: &Thickness| [0.1, 0.5, 0.9].map(|q| t.quantile(q).expect("walls"));
                let (a, b) = (quantiles(&parts), quantiles(&whole));
                println!("{method:?}: {a:?} {b:?}");
                assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 0.01 * a), "{a:?} {b:?}");
                let same = parts.values.iter().zip(&whole.values);
                let near = same.filter(|(a, b)| (*a - *b).abs() < 0.02 * *a).count();
                assert!(near * 100 > 95 * mesh.positions.len(), "{near}");
            }
        }
    }

    #[test]
    fn walls_of_another_mesh_are_left_out() {
        let whole = cuboid(DVec3::ZERO, DVec3::ONE).triangulate().0;
        let Refined { mesh, mut of } = refine(&whole, 0.4);
        of.pop();
        assert!(!Walls { mesh: whole.clone(), of }.serve(&mesh));
        let of = vec![12; mesh.triangles.len()];
        assert!(!Walls { mesh: whole.clone(), of }.serve(&mesh));
        let of = vec![0; whole.triangles.len()];
        assert!(!Walls { mesh, of }.serve(&whole), "more of them than there are parts");
    }
}
