//! The flat face of a solid around one of its triangles, and the plane through it.
//!
//! A face of a solid is many triangles, whose corners were each rounded to single precision. The
//! plane of one small triangle does not show which triangles belong to the face, because its
//! corners' rounding tilts it. So the region grows and its plane is fitted in turns: the wider the
//! region, the smaller the tilt that rounding can explain.

use glam::DVec3;
use rayon::prelude::*;

use crate::TriMesh;
use crate::disjoint_sets::DisjointSets;

/// Rounding errors of one coordinate that a corner of a flat face may lie off its plane: a corner
/// lies off by at most sqrt(3) of them, and the plane of rounded corners is off by as much.
const ERRORS: f64 = 8.0;
/// Turns of growing and fitting; a region that still changes is taken as it is.
const TURNS: usize = 12;
/// Cosine of the largest angle between neighbouring sides of an outline that are one side.
const STRAIGHT: f64 = 0.999_999;

/// A flat face of a mesh, in double precision.
#[derive(Debug, Clone)]
pub struct FlatRegion {
    /// Its triangles, ascending.
    pub triangles: Vec<u32>,
    /// Outwards, unit length.
    pub normal: DVec3,
    /// The centre of its area, in its plane.
    pub middle: DVec3,
    /// In the square of the mesh's unit.
    pub area: f64,
    /// The greatest distance of its corners from its plane.
    pub off: f64,
    /// The directed edges around it: the face lies to the left of each, seen from outside.
    outline: Vec<[DVec3; 2]>,
}

/// Half of the last place of a number of this size in single precision.
fn rounding(reach: f64) -> f64 {
    if reach > 0.0 { 2f64.powi(reach.log2().floor() as i32 - 24) } else { 0.0 }
}

fn corners(mesh: &TriMesh, t: u32) -> [DVec3; 3] {
    mesh.triangles[t as usize].map(|v| mesh.positions[v as usize].as_dvec3())
}

/// Twice the area, as a vector along the normal.
fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// A region as it grows.
struct Fit {
    normal: DVec3,
    middle: DVec3,
    area: f64,
}

impl Fit {
    fn of(mesh: &TriMesh, triangles: &[u32]) -> Option<Fit> {
        let first = corners(mesh, *triangles.first()?)[0];
        let (mut vector, mut sum, mut weight) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for &t in triangles {
            let c = corners(mesh, t).map(|p| p - first);
            let own = area_vector(c);
            let size = own.length();
            vector += own;
            sum += (c[0] + c[1] + c[2]) * (size / 3.0);
            weight += size;
        }
        let normal = vector.try_normalize()?;
        (weight > 0.0).then(|| Fit { normal, middle: first + sum / weight, area: weight * 0.5 })
    }

    fn height(&self, p: DVec3) -> f64 {
        (p - self.middle).dot(self.normal)
    }
}

/// The edges of a mesh and the triangles at either side.
struct TriangleNeighbours {
    /// For each side of each triangle the triangle beyond it.
    beyond: Vec<[u32; 3]>,
}

impl TriangleNeighbours {
    const NONE: u32 = u32::MAX;

    fn of(mesh: &TriMesh) -> TriangleNeighbours {
        let side = |t: &[u32; 3], k: usize| (t[k], t[(k + 1) % 3]);
        // The sides by their lower vertex: counted, then filled.
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        for t in &mesh.triangles {
            (0..3).map(|k| side(t, k)).for_each(|(a, b)| starts[a.min(b) as usize + 1] += 1);
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        // The upper vertex and the side: three times the triangle, and which of its sides.
        let mut all = vec![(0u32, 0u32); mesh.triangles.len() * 3];
        for (i, t) in mesh.triangles.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = side(t, k);
                let slot = &mut next[a.min(b) as usize];
                all[*slot as usize] = (a.max(b), (i * 3 + k) as u32);
                *slot += 1;
            }
        }
        let mut beyond = vec![[TriangleNeighbours::NONE; 3]; mesh.triangles.len()];
        for v in 0..mesh.positions.len() {
            let around = &mut all[starts[v] as usize..starts[v + 1] as usize];
            around.sort_unstable();
            for group in around.chunk_by(|x, y| x.0 == y.0) {
                // Of an edge with more than two triangles none is a way.
                if let [(_, a), (_, b)] = *group {
                    beyond[a as usize / 3][a as usize % 3] = b / 3;
                    beyond[b as usize / 3][b as usize % 3] = a / 3;
                }
            }
        }
        TriangleNeighbours { beyond }
    }
}

impl FlatRegion {
    /// Returns the flat face that holds `triangle`. On a curved surface that is the triangle alone,
    /// or with its few coplanar neighbours. Returns `None` if there is no such triangle, or it has
    /// no area.
    pub fn around(mesh: &TriMesh, triangle: u32) -> Option<FlatRegion> {
        mesh.triangles.get(triangle as usize)?;
        FlatRegion::with(mesh, &TriangleNeighbours::of(mesh), triangle)
    }

    /// The same, with the neighbours at hand.
    fn with(mesh: &TriMesh, table: &TriangleNeighbours, triangle: u32) -> Option<FlatRegion> {
        let reach = mesh.positions.iter().fold(0f32, |r, p| r.max(p.abs().max_element()));
        let allowed = ERRORS * rounding(f64::from(reach));
        let mut taken = vec![triangle];
        let mut fit = Fit::of(mesh, &taken)?;
        for _ in 0..TURNS {
            let grown = grow(mesh, table, triangle, &fit, allowed);
            let same = grown == taken;
            // A region that shrinks around a seed that does not fit is none.
            let Some(better) = Fit::of(mesh, &grown) else { break };
            (taken, fit) = (grown, better);
            if same {
                break;
            }
        }
        let off = taken.iter().flat_map(|t| corners(mesh, *t)).map(|p| fit.height(p).abs());
        let off = off.fold(0.0, f64::max);
        let outline = outline(mesh, table, &taken);
        let Fit { normal, middle, area } = fit;
        Some(FlatRegion { triangles: taken, normal, middle, area, off, outline })
    }

    /// The straight side of the outline that is nearest to `p`, from its start to its end with the
    /// face to the left. Edges that go on in one line are one side.
    pub fn side_near(&self, p: DVec3) -> Option<[DVec3; 2]> {
        let distance = |[a, b]: &[DVec3; 2]| {
            let along = *b - *a;
            let t = ((p - *a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            if t.is_nan() { f64::INFINITY } else { (*a + along * t).distance_squared(p) }
        };
        let nearest = self.outline.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let way = (nearest[1] - nearest[0]).try_normalize()?;
        let on = |next: &[DVec3; 2]| {
            (next[1] - next[0]).try_normalize().is_some_and(|w| w.dot(way) > STRAIGHT)
        };
        let [mut from, mut to] = *nearest;
        // Each goes on at most once around.
        for _ in 0..self.outline.len() {
            let Some(next) = self.outline.iter().find(|s| s[0] == to && on(s)) else { break };
            to = next[1];
        }
        for _ in 0..self.outline.len() {
            let Some(last) = self.outline.iter().find(|s| s[1] == from && on(s)) else { break };
            from = last[0];
        }
        Some([from, to])
    }

    /// The directed edges around it, each with the face to its left, seen from outside.
    pub fn outline(&self) -> &[[DVec3; 2]] {
        &self.outline
    }
}

/// Returns the triangles connected to the first that are in the plane of `fit`, ascending.
fn grow(
    mesh: &TriMesh,
    table: &TriangleNeighbours,
    first: u32,
    fit: &Fit,
    allowed: f64,
) -> Vec<u32> {
    // A plane fitted to a region of this size is tilted by no more than its rounding over its size.
    let spread = (fit.area.sqrt() * 0.5).max(f64::MIN_POSITIVE);
    let lies = |t: u32| {
        let c = corners(mesh, t);
        let near = c.iter().all(|p| {
            let along = (*p - fit.middle).length();
            fit.height(*p).abs() <= allowed * (1.0 + along / spread)
        });
        // A sliver has no reliable normal.
        let vector = area_vector(c);
        let longest = (0..3).map(|k| c[k].distance(c[(k + 1) % 3])).fold(0.0, f64::max);
        let thick = vector.length() > 16.0 * allowed * longest;
        near && (!thick || vector.dot(fit.normal) > 0.9 * vector.length())
    };
    let mut seen = vec![false; mesh.triangles.len()];
    seen[first as usize] = true;
    let (mut taken, mut next) = (vec![first], 0);
    while let Some(&t) = taken.get(next) {
        next += 1;
        for beyond in table.beyond[t as usize] {
            if beyond != TriangleNeighbours::NONE
                && !std::mem::replace(&mut seen[beyond as usize], true)
                && lies(beyond)
            {
                taken.push(beyond);
            }
        }
    }
    taken.sort_unstable();
    taken
}

fn outline(mesh: &TriMesh, table: &TriangleNeighbours, taken: &[u32]) -> Vec<[DVec3; 2]> {
    let mut out = Vec::new();
    for &t in taken {
        let c = corners(mesh, t);
        for k in 0..3 {
            if taken.binary_search(&table.beyond[t as usize][k]).is_err() {
                out.push([c[k], c[(k + 1) % 3]]);
            }
        }
    }
    out
}

/// The largest flat face of each part of a mesh that hangs together, and every other of at least
/// `share` of the mesh's area, the largest first: what one solid can be put down on.
pub fn large_faces(mesh: &TriMesh, share: f64) -> Vec<FlatRegion> {
    let (areas, normals): (Vec<f64>, Vec<DVec3>) = (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .map(|t| area_vector(corners(mesh, t)))
        .map(|vector| (vector.length() * 0.5, vector.normalize_or_zero()))
        .unzip();
    let all: f64 = areas.iter().sum();
    let mut sets = DisjointSets::new(mesh.triangles.len());
    let table = TriangleNeighbours::of(mesh);
    for (t, beyond) in table.beyond.iter().enumerate() {
        // Candidates only; each region is grown again from its largest triangle.
        for &b in beyond.iter().filter(|b| (**b as usize) < t) {
            if normals[t].dot(normals[b as usize]) > 0.9999 {
                sets.join(t as u32, b);
            }
        }
    }
    // Of each group, by its root: its largest triangle and its area.
    let mut groups = vec![(0u32, 0.0f64); mesh.triangles.len()];
    for (t, &own) in areas.iter().enumerate() {
        let root = sets.root(t as u32);
        let (largest, sum) = &mut groups[root as usize];
        if root as usize == t || own > areas[*largest as usize] {
            *largest = t as u32;
        }
        *sum += own;
    }
    let mut out: Vec<FlatRegion> = groups
        .into_iter()
        .enumerate()
        .filter(|(root, (_, sum))| sets.root(*root as u32) as usize == *root && *sum >= share * all)
        .filter_map(|(_, (largest, _))| FlatRegion::with(mesh, &table, largest))
        .filter(|r| r.area >= share * all)
        .collect();
    out.sort_by(|a, b| b.area.total_cmp(&a.area).then(a.triangles[0].cmp(&b.triangles[0])));
    out.dedup_by(|a, b| a.triangles == b.triangles);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use glam::{DQuat, DVec3};

    /// A box with each side cut into a grid, turned, in single precision.
    fn turned_box(turn: DQuat, shift: DVec3) -> TriMesh {
        let plain = shapes::cuboid(DVec3::new(-2.0, -1.5, -0.25), DVec3::new(2.0, 1.5, 0.25));
        let mut mesh = quartered(&quartered(&plain.triangulate().0));
        for p in &mut mesh.positions {
            *p = (shift + turn * p.as_dvec3()).as_vec3();
        }
        mesh
    }

    /// Each triangle as four, without moving anything.
    fn quartered(mesh: &TriMesh) -> TriMesh {
        let mut out = TriMesh { positions: mesh.positions.clone(), ..TriMesh::default() };
        let mut made = std::collections::BTreeMap::new();
        for t in &mesh.triangles {
            let [d, e, f] = [0, 1, 2].map(|k| {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *made.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let at = |v: u32| mesh.positions[v as usize];
                    out.positions.push((at(a) + at(b)) * 0.5);
                    out.positions.len() as u32 - 1
                })
            });
            out.triangles.extend([[t[0], d, f], [t[1], e, d], [t[2], f, e], [d, e, f]]);
        }
        out
    }

    #[test]
    fn a_face_of_a_turned_box_is_found_whole_from_each_of_its_triangles() {
        let mut seed = 7u64;
        let mut dice = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for _ in 0..50 {
            let axis = DVec3::new(dice(), dice(), dice()).normalize_or(DVec3::X);
            let turn = DQuat::from_axis_angle(axis, dice() * 3.0);
            let shift = DVec3::new(dice(), dice(), dice()) * 20.0;
            let mesh = turned_box(turn, shift);
            let count = mesh.triangles.len() as u32;
            let mut areas: Vec<f64> = Vec::new();
            for t in 0..count {
                let face = FlatRegion::around(&mesh, t).expect("a face");
                let own = turn.inverse() * face.normal;
                let axis = own.abs().max_position();
                assert!(own.abs()[axis] > 1.0 - 1e-10, "{own}");
                let want = [1.5, 2.0, 12.0][axis];
                assert!((face.area - want).abs() < 1e-4, "{} of {want}", face.area);
                assert_eq!(face.triangles.len() as u32, count / 6);
                assert!(face.off < 1e-5 && face.triangles.contains(&t));
                areas.push(face.area);
            }
        }
    }

    #[test]
    fn a_side_runs_from_corner_to_corner_with_the_face_to_its_left() {
        let mesh = turned_box(DQuat::IDENTITY, DVec3::ZERO);
        let top = (0..mesh.triangles.len() as u32)
            .filter_map(|t| FlatRegion::around(&mesh, t))
            .find(|r| r.normal.z > 0.5)
            .expect("a top");
        let [a, b] = top.side_near(DVec3::new(0.3, -1.4, 0.25)).expect("a side");
        assert_eq!((a, b), (DVec3::new(-2.0, -1.5, 0.25), DVec3::new(2.0, -1.5, 0.25)));
        assert!((b - a).cross(top.middle - a).dot(top.normal) > 0.0);
    }

    #[test]
    fn a_ball_has_no_face_larger_than_a_triangle() {
        let ball = shapes::icosphere(1.0, 8);
        for t in 0..ball.triangles.len() as u32 {
            let face = FlatRegion::around(&ball, t).expect("a triangle");
            assert!(face.triangles.len() <= 2, "{}", face.triangles.len());
        }
        assert!(large_faces(&ball, 0.02).is_empty());
        let faces = large_faces(&turned_box(DQuat::IDENTITY, DVec3::ZERO), 0.02);
        let areas: Vec<f64> = faces.iter().map(|f| f.area).collect();
        assert_eq!(areas, [12.0, 12.0, 2.0, 2.0, 1.5, 1.5]);
    }
}
