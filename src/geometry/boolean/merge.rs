//! Cells of one face with the same classification, joined into as few simple polygons as dropping
//! the borders between two gives.

use glam::DVec3;

use super::pieces::{FacePiece, PieceShape, triangles};
use super::points::Map;
use super::ring_joining::joined_rings;
use crate::PolyMesh;
use crate::triangulate::area_vector;

/// A polygon of the result over the common points.
#[derive(Debug, Clone)]
pub struct ResultPolygon {
    /// The operand that it comes from, 0 or 1.
    pub side: u8,
    /// The operand's face.
    pub face: u32,
    /// Counter-clockwise, over the common points.
    pub corners: Vec<u32>,
}

/// Polygons of all pieces in cells of one face and place. `flat` says that the face is a plane, so
/// that cells may be joined.
pub fn polygons(
    side: u8,
    face: u32,
    group: &[&FacePiece],
    flat: bool,
    at: &[DVec3],
) -> Vec<ResultPolygon> {
    let mut rings: Vec<Vec<u32>> = Vec::new();
    for p in group {
        match &p.shape {
            PieceShape::PlanarCell(c) if !c.holes.is_empty() => {
                let loops: Vec<&[u32]> =
                    std::iter::once(&c.outer).chain(&c.holes).map(Vec::as_slice).collect();
                let n: DVec3 = loops.iter().map(|l| area_vector(at, l)).sum();
                rings.extend(triangles(&loops, n, at).into_iter().map(|t| t.to_vec()));
            }
            // A border that touches itself at a point is no simple polygon.
            PieceShape::PlanarCell(c) if repeats(&c.outer) => {
                rings.extend(
                    triangles(&[&c.outer], DVec3::ZERO, at).into_iter().map(|t| t.to_vec()),
                );
            }
            PieceShape::PlanarCell(c) => rings.push(c.outer.clone()),
            PieceShape::Border(b) => rings.push(b.clone()),
            PieceShape::Whole => {}
        }
    }
    if flat && rings.len() > 1 {
        rings = joined_rings(&rings, at);
    }
    rings.into_iter().map(|corners| ResultPolygon { side, face, corners }).collect()
}

fn repeats(ring: &[u32]) -> bool {
    let mut sorted = ring.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|w| w[0] == w[1])
}

/// Returns true if a face is planar, within the tolerance.
pub fn is_flat(mesh: &PolyMesh, f: usize, at: &[DVec3], eps: f64) -> bool {
    let c = mesh.face(f);
    if c.len() == 3 {
        return true;
    }
    let n = area_vector(at, c).normalize_or_zero();
    let o = at[c[0] as usize];
    c.iter().all(|&v| (at[v as usize] - o).dot(n).abs() <= 2.0 * eps)
}

/// Drops corners that only subdivide a straight edge between two polygons, unless an input face has
/// them there.
pub fn straighten(
    polygons: &mut [ResultPolygon],
    meshes: &[PolyMesh; 2],
    kept: impl Fn(u32) -> bool,
    at: &[DVec3],
    eps: f64,
) {
    let mut uses: Map<u32, Vec<usize>> = Map::default();
    let mut order = Vec::new();
    for (i, p) in polygons.iter().enumerate() {
        for &v in &p.corners {
            let u = uses.entry(v).or_default();
            if u.is_empty() {
                order.push(v);
            }
            u.push(i);
        }
    }
    for v in order {
        let users = &uses[&v];
        if kept(v)
            || users.iter().any(|&i| {
                meshes[polygons[i].side as usize].face(polygons[i].face as usize).contains(&v)
            })
        {
            continue;
        }
        let ends = |i: usize| {
            let c = &polygons[i].corners;
            let k = c.iter().position(|&x| x == v)?;
            let (a, b) = (c[(k + c.len() - 1) % c.len()], c[(k + 1) % c.len()]);
            (c.len() > 3).then_some((a.min(b), a.max(b)))
        };
        let Some((a, b)) = ends(users[0]) else { continue };
        if a == b || users.iter().any(|&i| ends(i) != Some((a, b))) {
            continue;
        }
        let (o, x) = (at[a as usize], at[v as usize]);
        let d = (at[b as usize] - o).normalize_or_zero();
        let w = x - o;
        if (w - d * w.dot(d)).length() > 4.0 * eps {
            continue;
        }
        for &i in &uses[&v] {
            polygons[i].corners.retain(|&x| x != v);
        }
    }
}
