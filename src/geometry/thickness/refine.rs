//! More places to measure at: a machine part has vertices on its edges only, and none on its walls.
//! Triangles are bisected across their longest edge (Rivara, "Algorithms for refining triangular
//! grids suitable for adaptive and multigrid techniques", 1984).

use crate::TriMesh;
use crate::job::Job;
use crate::weld::weld_keys;

/// Triangles that refinement stops at.
const MOST: usize = 2_000_000;

/// Triangles smaller than this share of the spacing's square are long only because they are thin:
/// left as they are.
const SLIVER: f32 = 0.1;

/// A triangle lower than this share of the spacing is a sliver, and so is one lower than
/// [`ROUNDINGS`] roundings of the largest coordinate. No edge of a sliver is cut: the middle of an
/// edge is rounded to single precision, which would fold the halves of a sliver over each other,
/// and a fold is measured as a wall of no thickness.
const LOW: f32 = 0.01;
const ROUNDINGS: f32 = 64.0;

/// The number of an edge that is not cut in any case.
const NOT_LONG: u32 = u32::MAX;

/// A triangle that may be cut, and the numbers of its edges ab, bc, ca.
struct OpenTriangle {
    triangle: u32,
    edges: [u32; 3],
}

/// A surface in smaller triangles.
#[derive(Debug, Clone)]
pub struct Refined {
    /// The surface. The vertices that it had before come first.
    pub mesh: TriMesh,
    /// Of each of its triangles, the triangle that it was cut from.
    pub of: Vec<u32>,
}

/// The same surface with every triangle that is longer than `spacing` halved across its longest
/// edge that may be cut, until none is (slivers excepted, see `SLIVER` and `LOW`) or two million
/// are reached. The mesh's own vertices keep their indices; both triangles of an edge are cut at
/// the same point, so a closed mesh stays closed.
pub fn refine(mesh: &TriMesh, spacing: f32) -> Refined {
    let whole = |mesh: &TriMesh| {
        let of = (0..mesh.triangles.len() as u32).collect();
        Refined { mesh: TriMesh { colours: None, ..mesh.clone() }, of }
    };
    refine_within(mesh, spacing, usize::MAX).unwrap_or_else(|| whole(mesh))
}

/// The same; none where that takes more than `most` vertices.
pub(super) fn refine_within(mesh: &TriMesh, spacing: f32, most_vertices: usize) -> Option<Refined> {
    let mut out = TriMesh { colours: None, ..mesh.clone() };
    let mut of: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let usable = |t: &[u32; 3]| {
        t.iter().all(|&v| mesh.positions.get(v as usize).is_some_and(|p| p.is_finite()))
    };
    if !(spacing > 0.0 && out.triangles.iter().all(usable)) {
        return Some(Refined { mesh: out, of });
    }
    let reach = mesh.positions.iter().fold(0.0f32, |r, p| r.max(p.abs().max_element()));
    let least = (LOW * spacing).max(ROUNDINGS * f32::EPSILON * reach);
    // An edge no longer than the spacing is never cut, so a triangle of three such edges stays.
    let most = spacing * spacing;
    let mut settled = vec![false; out.triangles.len()];
    loop {
        let slivers = edges_of_slivers(&out, &settled, least);
        // The long edges of the others, each with a number: no other is cut.
        let mut open: Vec<OpenTriangle> = Vec::new();
        let mut long: Vec<[u32; 3]> = Vec::new();
        for (t, settled) in settled.iter_mut().enumerate().filter(|s| !*s.1) {
            let [a, b, c] = out.triangles[t];
            let mut own = OpenTriangle { triangle: t as u32, edges: [NOT_LONG; 3] };
            let mut all_short = true;
            for (slot, (a, b)) in own.edges.iter_mut().zip([(a, b), (b, c), (c, a)]) {
                let length = out.positions[a as usize].distance_squared(out.positions[b as usize]);
                if length > most {
                    *slot = long.len() as u32;
                    long.push([a.min(b), a.max(b), length.to_bits()]);
                }
                all_short &= length <= most;
            }
            *settled = all_short;
            open.push(own);
        }
        // The bits of a length are the same on both sides of an edge.
        let Ok((edges, edge_of)) = weld_keys(long.len(), &Job::default(), |i| long[i]) else {
            return Some(Refined { mesh: out, of });
        };
        let mut middle: Vec<Option<u32>> = vec![None; edges.len()];
        let mut cut: Vec<[u32; 3]> = Vec::new();
        for own in &mut open {
            for e in own.edges.iter_mut().filter(|e| **e != NOT_LONG) {
                *e = edge_of[*e as usize];
            }
            // Only a triangle's longest edge is cut in one round: slivers become round before they
            // become many.
            let longest = own
                .edges
                .iter()
                .filter(|&&e| e != NOT_LONG)
                .map(|&e| (edges[e as usize], e))
                .filter(|([a, b, _], _)| slivers.binary_search(&(*a, *b)).is_err())
                .map(|([a, b, length], e)| (f32::from_bits(length), [a, b, 0], e))
                .fold((0.0, [0; 3], 0), |m, e| if (e.0, e.1) > (m.0, m.1) { e } else { m });
            if longest.0 <= most {
                continue;
            }
            let [a, b, c] = out.corners(own.triangle as usize);
            let wide = (b - a).cross(c - a).length() * 0.5 > most * SLIVER;
            let slot = &mut middle[longest.2 as usize];
            if wide && slot.is_none() {
                *slot = Some((out.positions.len() + cut.len()) as u32);
                cut.push(longest.1);
            }
        }
        if out.positions.len() + cut.len() > most_vertices {
            return None;
        }
        if cut.is_empty() || out.triangles.len() + 2 * cut.len() > MOST {
            return Some(Refined { mesh: out, of });
        }
        let room = out.triangles.len() + 2 * cut.len();
        let (mut next, mut next_of) = (Vec::with_capacity(room), Vec::with_capacity(room));
        let mut next_settled = Vec::with_capacity(room);
        let mut own = open.iter().peekable();
        for (t, (corners, &whole)) in out.triangles.iter().zip(&of).enumerate() {
            match own.next_if(|o| o.triangle as usize == t) {
                Some(o) => {
                    // No edge has the number of one that is not long.
                    let mids = o.edges.map(|e| middle.get(e as usize).copied().flatten());
                    split(*corners, mids, &mut next);
                }
                None => next.push(*corners),
            }
            next_of.resize(next.len(), whole);
            next_settled.resize(next.len(), settled[t]);
        }
        let middles: Vec<glam::Vec3> = cut
            .iter()
            .map(|&[a, b, _]| (out.positions[a as usize] + out.positions[b as usize]) * 0.5)
            .collect();
        (of, settled) = (next_of, next_settled);
        out.positions.extend(middles);
        out.triangles = next;
    }
}

/// The edges, lower vertex first, of triangles whose least height is below `least`; sorted. Without
/// those of the settled ones, which are not cut in any case.
fn edges_of_slivers(mesh: &TriMesh, settled: &[bool], least: f32) -> Vec<(u32, u32)> {
    let mut edges = Vec::new();
    let open = |i: &(usize, &[u32; 3])| !settled[i.0];
    for (i, t) in mesh.triangles.iter().enumerate().filter(open) {
        let [a, b, c] = mesh.corners(i);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        if (b - a).cross(c - a).length_squared() < least * least * longest {
            edges.extend((0..3).map(|k| {
                let (u, v) = (t[k], t[(k + 1) % 3]);
                (u.min(v), u.max(v))
            }));
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// The triangles of one whose edges ab, bc, ca may have a middle.
fn split([a, b, c]: [u32; 3], mids: [Option<u32>; 3], out: &mut Vec<[u32; 3]>) {
    match mids {
        [None, None, None] => out.push([a, b, c]),
        [Some(m), None, None] => out.extend([[a, m, c], [m, b, c]]),
        [None, Some(_), None] => split([b, c, a], [mids[1], None, None], out),
        [None, None, Some(_)] => split([c, a, b], [mids[2], None, None], out),
        [Some(m), Some(n), None] => out.extend([[a, m, c], [m, n, c], [m, b, n]]),
        [None, Some(_), Some(_)] => split([b, c, a], [mids[1], mids[2], None], out),
        [Some(_), None, Some(_)] => split([c, a, b], [mids[2], mids[0], None], out),
        [Some(m), Some(n), Some(o)] => out.extend([[a, m, o], [m, b, n], [o, n, c], [m, n, o]]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measures;
    use glam::Vec3;

    #[test]
    fn a_refined_solid_is_the_same_solid_and_closed() {
        let mesh = TriMesh {
            positions: vec![Vec3::ZERO, Vec3::X * 40.0, Vec3::Y * 3.0, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            colours: None,
        };
        let Refined { mesh: fine, of } = refine(&mesh, 0.5);
        let (a, b) = (measures(&mesh), measures(&fine));
        assert!((a.volume / b.volume - 1.0).abs() < 1e-6 && (a.area / b.area - 1.0).abs() < 1e-6);
        let s = super::super::WeldedSurface::new(&fine, 0.7);
        assert_eq!(
            (s.faults.boundary_edges, s.faults.crowded_edges, s.faults.inverted_edges),
            (0, 0, 0)
        );
        assert_eq!(of.len(), fine.triangles.len());
        for t in 0..fine.triangles.len() {
            let [a, b, c] = fine.corners(t);
            let [p, q, r] = mesh.corners(of[t] as usize);
            let normal = (q - p).cross(r - p).normalize();
            assert!([a, b, c].iter().all(|x| (*x - p).dot(normal).abs() < 1e-5), "{t}");
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            assert!(
                longest <= 0.5 || (b - a).cross(c - a).length() * 0.5 <= 0.25 * SLIVER * 1.0001,
                "{longest}"
            );
        }
        assert_eq!(fine.positions[..4], mesh.positions[..]);
    }

    #[test]
    fn slivers_are_not_bred() {
        // A rod along a slanted line, whose long sides are fans of slivers: one end's corners are
        // joined to a hundred points within a tenth of a millimetre at the other end.
        let (along, up) = (Vec3::new(0.6, 0.7, 0.387).normalize(), Vec3::new(0.1, -0.4, 0.9));
        let side = along.cross(up).normalize();
        let at = |x: f32, y: f32, z: f32| along * x + side * y + side.cross(along) * z;
        let mut positions = vec![at(0.0, 0.0, 0.0), at(0.0, 2.0, 0.0), at(0.0, 1.0, 2.0)];
        positions.extend((0..=100).map(|i| at(8000.0, i as f32 * 1e-3, 0.0)));
        positions.extend([at(8000.0, 2.0, 0.0), at(8000.0, 1.0, 2.0)]);
        let (far, top) = (103, 104);
        let mut triangles: Vec<[u32; 3]> = (3..103).map(|i| [0, i + 1, i]).collect();
        triangles.extend([[0, far, 103 - 1], [0, 1, far], [1, top, far], [1, 2, top]]);
        triangles.extend([[2, 3, top], [2, 0, 3], [0, 2, 1]]);
        triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
        let mesh = TriMesh { positions, triangles, colours: None };
        let fine = refine(&mesh, 2.0).mesh;
        // About 51,000 square millimetres: ten triangles for each square of the spacing.
        assert!(fine.triangles.len() < 128_000, "{}", fine.triangles.len());
        for t in 0..fine.triangles.len() {
            let [a, b, c] = fine.corners(t);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let height = (b - a).cross(c - a).length() / longest;
            // The mesh's own slivers stay; no other is made.
            assert!(height > 0.01 || longest > 7000.0, "{height} of {longest}");
        }
        assert!(fine.triangles.len() > 1000, "the wide sides are cut");
    }
}
