//! Whether faces form a closed, oriented 2-manifold as they stand: each edge has two faces, which
//! run along it in opposite directions, and the faces around each vertex are one fan. Most results
//! are; only others are taken apart.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering::Relaxed};

use crate::PolyMesh;
use crate::job::{Cancelled, Job};

const NONE: u32 = u32::MAX;
/// Vertices that one thread looks at before it asks whether to go on.
const BLOCK: usize = 1 << 14;

/// Returns the number of corners at each of `points` points, if the mesh is such a manifold.
pub fn degrees(mesh: &PolyMesh, points: usize, job: &Job) -> Result<Option<Vec<u32>>, Cancelled> {
    let n = mesh.corners.len();
    let next = next(mesh);
    let head = |c: u32| mesh.corners[next[c as usize] as usize];
    // Edges at their lesser ends; corners at their points.
    let (mut starts, mut degrees, mut first) =
        (vec![0u32; points + 1], vec![0u32; points], vec![NONE; points]);
    for (c, &v) in mesh.corners.iter().enumerate() {
        if c % 262_144 == 0 {
            job.check()?;
        }
        degrees[v as usize] += 1;
        first[v as usize] = c as u32;
        starts[v.min(head(c as u32)) as usize + 1] += 1;
    }
    let mut sum = 0;
    for s in &mut starts {
        sum += *s;
        *s = sum;
    }
    // A corner's edge at the lesser end: the other end, and the corner.
    let mut at = vec![0u64; n];
    let mut to = starts.clone();
    for (c, &v) in mesh.corners.iter().enumerate() {
        if c % 262_144 == 0 {
            job.check()?;
        }
        let w = head(c as u32);
        let slot = &mut to[v.min(w) as usize];
        at[*slot as usize] = u64::from(v.max(w)) << 32 | c as u64;
        *slot += 1;
    }
    drop(to);
    job.check()?;
    let twins: Vec<AtomicU32> = (0..n).into_par_iter().map(|_| AtomicU32::new(NONE)).collect();
    let good = AtomicBool::new(true);
    (0..points.div_ceil(BLOCK)).into_par_iter().for_each(|block| {
        let mut list: Vec<u64> = Vec::new();
        for v in block * BLOCK..points.min((block + 1) * BLOCK) {
            list.clear();
            list.extend_from_slice(&at[starts[v] as usize..starts[v + 1] as usize]);
            list.sort_unstable();
            for pair in list.chunks(2) {
                let &[a, b] = pair else { return good.store(false, Relaxed) };
                let (c, d) = (a as u32, b as u32);
                let opposite = mesh.corners[c as usize] != mesh.corners[d as usize];
                if a >> 32 != b >> 32 || !opposite {
                    return good.store(false, Relaxed);
                }
                twins[c as usize].store(d, Relaxed);
                twins[d as usize].store(c, Relaxed);
            }
            // Two pairs of one edge are not two edges.
            if list.windows(2).skip(1).step_by(2).any(|w| w[0] >> 32 == w[1] >> 32) {
                return good.store(false, Relaxed);
            }
        }
        if job.cancelled() {
            good.store(false, Relaxed);
        }
    });
    job.check()?;
    if !good.load(Relaxed) {
        return Ok(None);
    }
    let one_fan = |v: usize| {
        let start = first[v];
        if start == NONE {
            return true;
        }
        let (mut c, mut steps) = (start, 0);
        loop {
            c = next[twins[c as usize].load(Relaxed) as usize];
            steps += 1;
            if c == start || steps > degrees[v] {
                return steps == degrees[v];
            }
        }
    };
    let fans = (0..points).into_par_iter().with_min_len(BLOCK).all(one_fan);
    job.check()?;
    Ok(fans.then_some(degrees))
}

/// The next corner around its face, of each.
fn next(mesh: &PolyMesh) -> Vec<u32> {
    let mut next: Vec<u32> = (1..=mesh.corners.len() as u32).collect();
    for w in mesh.face_starts.windows(2).filter(|w| w[0] < w[1]) {
        next[w[1] as usize - 1] = w[0];
    }
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;
    use glam::DVec3;

    fn of(mesh: &PolyMesh) -> Option<Vec<u32>> {
        degrees(mesh, mesh.positions.len(), &Job::default()).expect("not cancelled")
    }

    #[test]
    fn cubes_that_share_a_vertex_an_edge_or_lack_a_face() {
        let cube = cuboid(DVec3::ZERO, DVec3::ONE);
        assert_eq!(of(&cube), Some(vec![3; 8]));
        let mut open = cube.clone();
        open.face_starts.pop();
        open.corners.truncate(20);
        assert_eq!(of(&open), None);
        let mut turned = cube.clone();
        turned.corners[..4].reverse();
        assert_eq!(of(&turned), None);
        for joined in [vec![(0, 7)], vec![(0, 3), (4, 7)]] {
            let mut two = cube.clone();
            for f in cube.faces() {
                let named = |v: &u32| joined.iter().find(|j| j.0 == *v).map_or(v + 8, |j| j.1);
                two.push_face(&f.iter().map(named).collect::<Vec<_>>());
            }
            two.positions.extend(&cube.positions);
            assert_eq!(of(&two), None, "{joined:?}");
        }
    }
}
