//! The balanced k-d order: what is near in space is near in memory, and eight, sixty-four, 512
//! neighbours in a row are always a compact patch.
//!
//! Each range is cut across its longest axis. The left part gets the largest power of two of cells
//! that is less than all of them, so groups of eight cells in a row are subtrees. The cut is by
//! (coordinate, number): a total order, so the result does not depend on how the work was shared.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::Vec3;

use super::Homes;
use sculptd_geometry::TriMesh;

/// Something with a place and a number.
pub(crate) type Item = (Vec3, u32);

/// Below this many items a range is ordered by one thread.
const FORK: usize = 16_384;

fn longest_axis(items: &[Item]) -> usize {
    let (lo, hi) = items
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), i| (lo.min(i.0), hi.max(i.0)));
    let d = hi - lo;
    if d.x >= d.y && d.x >= d.z {
        0
    } else if d.y >= d.z {
        1
    } else {
        2
    }
}

/// Orders `items` into cells `first..last`; cell `c` begins at item `start(c) - start(first)`.
pub(crate) fn order(
    items: &mut [Item],
    first: usize,
    last: usize,
    start: &(impl Fn(usize) -> usize + Sync),
) {
    if last - first <= 1 || items.len() <= 1 {
        return;
    }
    let left = (last - first).next_power_of_two() / 2;
    let middle = first + left;
    let at = start(middle) - start(first);
    if at > 0 && at < items.len() {
        let axis = longest_axis(items);
        items
            .select_nth_unstable_by(at, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    }
    let (a, b) = items.split_at_mut(at.min(items.len()));
    if a.len() + b.len() > FORK {
        rayon::join(|| order(a, first, middle, start), || order(b, middle, last, start));
    } else {
        order(a, first, middle, start);
        order(b, middle, last, start);
    }
}

/// Orders `items` so that each run of `cell` is compact; all runs but the last are full.
pub(crate) fn order_runs(items: &mut [Item], cell: usize) {
    let cells = items.len().div_ceil(cell);
    let n = items.len();
    order(items, 0, cells, &|c| (c * cell).min(n));
}

/// Brings the vertices that have a closed ring of six to the front of page `page`, the order else
/// as it was. `touching`: the triangles with a corner in the page.
///
/// A ring is closed where each vertex on it begins as many of the edges opposite as it ends; here
/// sums of scrambled numbers are compared. If ever two rings fooled them, the page would have its
/// regular vertices end one earlier.
pub(super) fn regular_first(
    tri: &TriMesh,
    homes: &Homes,
    page: u32,
    own: &mut [Item],
    touching: &[AtomicU32],
) {
    let scrambled = |v: u32| v.wrapping_mul(0x9E37_79B1) ^ (v.wrapping_mul(0x85EB_CA77) >> 15);
    let mut rings = vec![(0u32, 0u32); own.len()];
    for t in touching {
        let corners = tri.triangles[t.load(Relaxed) as usize];
        for k in 0..3 {
            let v = corners[k] as usize;
            if homes.page[v] == page {
                let (count, twist) = &mut rings[homes.local[v] as usize];
                *count += 1;
                let (next, last) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                *twist = twist.wrapping_add(scrambled(next)).wrapping_sub(scrambled(last));
            }
        }
    }
    let regular = |i: usize| rings[i] == (6, 0);
    let items = own.to_vec();
    let order =
        (0..items.len()).filter(|&i| regular(i)).chain((0..items.len()).filter(|&i| !regular(i)));
    own.iter_mut().zip(order).for_each(|(to, from)| *to = items[from]);
}
