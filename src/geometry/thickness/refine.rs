//! More places to measure at: a machine part has vertices on its edges only, and none on its walls.

use std::collections::BTreeMap;

use crate::TriMesh;

/// Triangles that refinement stops at.
const MOST: usize = 2_000_000;

/// Triangles smaller than this share of the spacing's square are long only because they are thin:
/// left as they are.
const SLIVER: f32 = 0.1;

/// The same surface with every triangle that is longer than `spacing` halved across its longest
/// edge, until none is (slivers excepted, see [`SLIVER`]) or [`MOST`] is reached. The mesh's own
/// vertices keep their indices; both triangles of an edge are cut at the same point, so a closed
/// mesh stays closed.
pub fn refine(mesh: &TriMesh, spacing: f32) -> TriMesh {
    let mut out = TriMesh { colours: None, ..mesh.clone() };
    let usable = |t: &[u32; 3]| {
        t.iter().all(|&v| mesh.positions.get(v as usize).is_some_and(|p| p.is_finite()))
    };
    if !(spacing > 0.0 && out.triangles.iter().all(usable)) {
        return out;
    }
    loop {
        let mut cut: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        let mut next = Vec::with_capacity(out.triangles.len());
        for t in &out.triangles {
            // Only a triangle's longest edge is cut in one round: slivers become round before they
            // become many.
            let length = |k: usize| {
                let (a, b) = (t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3]));
                (out.positions[a as usize].distance_squared(out.positions[b as usize]), a, b)
            };
            let longest = (0..3).map(length).fold((0.0, 0, 0), |m, e| if e > m { e } else { m });
            let [a, b, c] = t.map(|v| out.positions[v as usize]);
            let wide = (b - a).cross(c - a).length() * 0.5 > spacing * spacing * SLIVER;
            if longest.0 > spacing * spacing && wide {
                let fresh = (out.positions.len() + cut.len()) as u32;
                cut.entry((longest.1, longest.2)).or_insert(fresh);
            }
        }
        if cut.is_empty() || out.triangles.len() + 2 * cut.len() > MOST {
            return out;
        }
        let mut middles = vec![glam::Vec3::ZERO; cut.len()];
        for (&(a, b), &m) in &cut {
            middles[m as usize - out.positions.len()] =
                (out.positions[a as usize] + out.positions[b as usize]) * 0.5;
        }
        for &[a, b, c] in &out.triangles {
            let mid = |x: u32, y: u32| cut.get(&(x.min(y), x.max(y))).copied();
            split([a, b, c], [mid(a, b), mid(b, c), mid(c, a)], &mut next);
        }
        out.positions.extend(middles);
        out.triangles = next;
    }
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
        let fine = refine(&mesh, 0.5);
        let (a, b) = (measures(&mesh), measures(&fine));
        assert!((a.volume / b.volume - 1.0).abs() < 1e-6 && (a.area / b.area - 1.0).abs() < 1e-6);
        let s = super::super::Surface::new(&fine, 0.7);
        assert_eq!(
            (s.faults.boundary_edges, s.faults.crowded_edges, s.faults.inverted_edges),
            (0, 0, 0)
        );
        for t in 0..fine.triangles.len() {
            let [a, b, c] = fine.corners(t);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            assert!(
                longest <= 0.5 || (b - a).cross(c - a).length() * 0.5 <= 0.25 * SLIVER * 1.0001,
                "{longest}"
            );
        }
        assert_eq!(fine.positions[..4], mesh.positions[..]);
    }
}
