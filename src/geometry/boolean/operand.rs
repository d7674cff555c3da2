//! The requirements for an operand, and its recommended properties.

use rayon::prelude::*;

use super::common::FEW;
use super::{BooleanError, emit};
use crate::PolyMesh;
use crate::job::{Cancelled, Job};
use crate::self_intersection;

/// Checks that the mesh is closed, oriented outwards and finite. Returns its volume.
pub fn check(mesh: &PolyMesh, operand: &'static str, job: &Job) -> Result<f64, BooleanError> {
    if !mesh.positions.par_iter().with_min_len(FEW).all(|p| p.is_finite()) {
        return Err(BooleanError::NotFinite { operand });
    }
    job.check()?;
    if !balanced(mesh) {
        let edges = open_edges(mesh);
        if edges > 0 {
            return Err(BooleanError::Open { operand, edges });
        }
    }
    job.check()?;
    let (volume, _) = emit::measure(mesh);
    if volume < 0.0 { Err(BooleanError::InsideOut { operand, volume }) } else { Ok(volume) }
}

/// Returns true if the edges sum to zero, each as a number of 128 bits with its direction as its
/// sign. The sum is zero if each edge has its partners, and otherwise almost never.
fn balanced(mesh: &PolyMesh) -> bool {
    let mix = |x: u64, by: u64| {
        let z = (x ^ (x >> 32)).wrapping_mul(by);
        (z ^ (z >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb)
    };
    let number = |a: u32, b: u32| {
        let edge = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let n = u128::from(mix(edge, 0xbf58_476d_1ce4_e5b9)) << 64
            | u128::from(mix(edge.wrapping_add(0x9e37_79b9_7f4a_7c15), 0xff51_afd7_ed55_8ccd));
        match a.cmp(&b) {
            std::cmp::Ordering::Less => n,
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Greater => n.wrapping_neg(),
        }
    };
    let part = |starts: &[u32]| {
        starts.windows(2).fold(0u128, |sum, w| {
            let f = &mesh.corners[w[0] as usize..w[1] as usize];
            let Some(&last) = f.last() else { return sum };
            f.iter().fold((sum, last), |(sum, a), &b| (sum.wrapping_add(number(a, b)), b)).0
        })
    };
    const BLOCK: usize = 1 << 14;
    let blocks = mesh.face_count().div_ceil(BLOCK);
    let block = |i: usize| {
        part(&mesh.face_starts[i * BLOCK..mesh.face_starts.len().min((i + 1) * BLOCK + 1)])
    };
    (0..blocks).into_par_iter().map(block).reduce(|| 0, u128::wrapping_add) == 0
}

/// Edges that lack a partner.
fn open_edges(mesh: &PolyMesh) -> usize {
    let mut half: Vec<(u32, u32, i32)> = Vec::with_capacity(mesh.corners.len());
    for f in mesh.faces() {
        for (i, &a) in f.iter().enumerate() {
            let b = f[(i + 1) % f.len()];
            half.push((a.min(b), a.max(b), if a < b { 1 } else { -1 }));
        }
    }
    half.par_sort_unstable();
    half.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1))
        .filter(|g| g[0].0 != g[0].1 && g.iter().map(|h| h.2).sum::<i32>() != 0)
        .count()
}

/// Returns true if triangles of an operand go through each other.
pub(super) fn crosses_itself(mesh: &PolyMesh, job: &Job) -> Result<bool, Cancelled> {
    Ok(!self_intersection::pairs(&mesh.positions, &mesh.triangles().0, job)?.is_empty())
}
