//! Cells of one face with the same classification, joined into as few simple polygons as dropping
//! the borders between two gives.

use glam::DVec3;

use super::pieces::{FacePiece, PieceShape, triangles};
use super::points::Map;
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
        rings = joined_rings(rings, at);
    }
    rings.into_iter().map(|corners| ResultPolygon { side, face, corners }).collect()
}

fn repeats(ring: &[u32]) -> bool {
    let mut sorted = ring.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).any(|w| w[0] == w[1])
}

/// Joins polygons that share one chain of edges and touch nowhere else, until none do.
pub fn joined_rings(rings: Vec<Vec<u32>>, at: &[DVec3]) -> Vec<Vec<u32>> {
    joined_rings_where(rings, |r| !spiked(r, at))
}

/// As [`joined_rings`], where `accept` takes the polygon that two become.
pub fn joined_rings_where(rings: Vec<Vec<u32>>, accept: impl Fn(&[u32]) -> bool) -> Vec<Vec<u32>> {
    let mut rings: Vec<Option<Vec<u32>>> = rings.into_iter().map(Some).collect();
    let mut owner: Map<(u32, u32), usize> = Map::default();
    let edges = |r: &[u32]| (0..r.len()).map(|i| (r[i], r[(i + 1) % r.len()])).collect::<Vec<_>>();
    for (i, r) in rings.iter().enumerate() {
        owner.extend(edges(r.as_deref().unwrap_or(&[])).into_iter().map(|e| (e, i)));
    }
    let mut i = 0;
    while i < rings.len() {
        let Some(own) = rings[i].clone() else {
            i += 1;
            continue;
        };
        let joined = edges(&own).into_iter().find_map(|(a, b)| {
            let j = *owner.get(&(b, a))?;
            if j == i {
                return None;
            }
            joined(&own, rings[j].as_ref()?).filter(|r| accept(r)).map(|r| (j, r))
        });
        match joined {
            Some((j, r)) => {
                for edge in edges(&own) {
                    owner.remove(&edge);
                }
                // All that a ring owns is among its edges: the rest of the map stays unread.
                for edge in edges(&rings[j].take().unwrap_or_default()) {
                    if owner.get(&edge) == Some(&j) {
                        owner.remove(&edge);
                    }
                }
                owner.extend(edges(&r).into_iter().map(|e| (e, i)));
                rings[i] = Some(r);
            }
            None => i += 1,
        }
    }
    rings.into_iter().flatten().collect()
}

/// Returns true if the border somewhere runs back along itself.
fn spiked(ring: &[u32], at: &[DVec3]) -> bool {
    let n = ring.len();
    (0..n).any(|i| {
        let [a, o, b] = [i + n - 1, i, i + 1].map(|k| at[ring[k % n] as usize]);
        let (u, v) = (a - o, b - o);
        u.dot(v) > 0.0
            && u.cross(v).length_squared() <= 1e-18 * u.length_squared() * v.length_squared()
    })
}

fn joined(p: &[u32], q: &[u32]) -> Option<Vec<u32>> {
    let (n, m) = (p.len(), q.len());
    let common = p.iter().filter(|v| q.contains(v)).count();
    let back = |i: usize| {
        let (a, b) = (p[i % n], p[(i + 1) % n]);
        (0..m).any(|k| q[k] == b && q[(k + 1) % m] == a)
    };
    let start = (0..n).find(|&i| back(i) && !back(i + n - 1))?;
    let length = (0..n).take_while(|&k| back(start + k)).count();
    if common != length + 1 || length >= n.min(m) {
        return None;
    }
    // p from the chain's end around to its start, then q from there on.
    let mut out: Vec<u32> = (length..=n).map(|k| p[(start + k) % n]).collect();
    let from = q.iter().position(|&v| v == p[start % n])?;
    out.extend((1..m - length).map(|k| q[(from + k) % m]));
    (out.len() >= 3).then_some(out)
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
