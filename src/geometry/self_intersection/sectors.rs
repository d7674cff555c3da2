//! Fans of many triangles that do not all face the same way, as at the tip of a cone whose side is
//! wrinkled: each two of their triangles would be compared, which is most of the time on a mesh of
//! slivers.
//!
//! Triangles that follow each other around a vertex and face along one axis cover, seen along it, a
//! sector once, as long as that is less than a whole turn: no two of them have more in common than
//! the vertex or an edge. A fan is cut into such sectors. All signs are certain.

use std::collections::HashMap;

use glam::DVec3;

/// So many triangles at a vertex are worth it.
pub(super) const MANY: usize = 48;

/// The sector of each corner of large fans: a number of its own, 0 for none; empty where no fan is
/// large.
#[derive(Debug, Default)]
pub(super) struct Sectors {
    of: Vec<u32>,
}

/// A corner of a triangle at the fan's vertex: three times the triangle and which of its corners,
/// and the ends of its two edges, in the triangle's order.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: u32,
    first: u32,
    second: u32,
}

impl Sectors {
    /// Whether two triangles that share this vertex are of one sector at it.
    #[inline(always)]
    pub fn share(&self, triangles: &[[u32; 3]], v: u32, t: u32, u: u32) -> bool {
        !self.of.is_empty() && {
            let sector = |t: u32| {
                let k = triangles[t as usize].iter().position(|&w| w == v);
                k.map_or(0, |k| self.of[3 * t as usize + k])
            };
            let own = sector(t);
            own != 0 && own == sector(u)
        }
    }

    /// Cuts the fan at `v` into sectors. Nothing where its edges are not those of two triangles that
    /// run against each other, or of one.
    pub fn part(
        &mut self,
        v: u32,
        around: &[u32],
        facing: &[u8],
        positions: &[DVec3],
        flat: &[u32],
    ) {
        let Some(order) = in_order(around, flat) else { return };
        if self.of.is_empty() {
            self.of = vec![0; flat.len()];
        }
        let mut begin = 0;
        while begin < order.len() {
            let rest = &order[begin..];
            let bits = facing[rest[0].at as usize / 3];
            let length = |bit: u8| run(v, rest, bit, facing, positions);
            let longest = (0..6).filter(|bit| bits >> bit & 1 == 1).map(length).max().unwrap_or(1);
            for corner in &rest[..longest] {
                self.of[corner.at as usize] = rest[0].at + 1;
            }
            begin += longest;
        }
    }
}

/// The corners so that each that can follows the one that it shares an edge with.
fn in_order(around: &[u32], flat: &[u32]) -> Option<Vec<Corner>> {
    let corner = |&at: &u32| {
        let begin = at - at % 3;
        let end = |k: u32| flat[(begin + (at + k) % 3) as usize];
        Corner { at, first: end(1), second: end(2) }
    };
    let corners: Vec<Corner> = around.iter().map(corner).collect();
    let by_first: HashMap<u32, usize> =
        corners.iter().enumerate().map(|(i, c)| (c.first, i)).collect();
    let by_second: HashMap<u32, usize> =
        corners.iter().enumerate().map(|(i, c)| (c.second, i)).collect();
    if by_first.len() < corners.len() || by_second.len() < corners.len() {
        return None;
    }
    let mut left = vec![true; corners.len()];
    let mut order = Vec::with_capacity(corners.len());
    // Ways that have a beginning come first; what is left then goes around.
    let begins = |i: &usize| !by_second.contains_key(&corners[*i].first);
    let all = 0..corners.len();
    for start in all.clone().filter(begins).chain(all.clone()) {
        let mut next = Some(start);
        while let Some(i) = next.filter(|&i| std::mem::take(&mut left[i])) {
            order.push(corners[i]);
            next = by_first.get(&corners[i].second).copied();
        }
    }
    Some(order)
}

/// How many of these corners, from the first on, follow each other, face along the direction `bit`
/// and go around less than once; at least one.
fn run(v: u32, corners: &[Corner], bit: u8, facing: &[u8], positions: &[DVec3]) -> usize {
    let (axis, back) = (usize::from(bit / 2), bit % 2 == 1);
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let seen = |w: u32| {
        let p = positions[w as usize];
        if back { (p[j], p[i]) } else { (p[i], p[j]) }
    };
    let o = seen(v);
    // In which of the four half planes that begin at an axis a place is: from that axis on, half a
    // turn.
    let halves = |w: u32| {
        let (x, y) = seen(w);
        let (right, left) = (x > o.0, x < o.0);
        let (above, below) = (y > o.1, y < o.1);
        let level = !above && !below;
        let upright = !right && !left;
        [
            above || level && right,
            left || upright && above,
            below || level && left,
            right || upright && below,
        ]
    };
    let mut passed = [false; 4];
    let mut count = 0;
    for (n, corner) in corners.iter().enumerate() {
        let follows = n == 0 || corners[n - 1].second == corner.first;
        if !follows || facing[corner.at as usize / 3] >> bit & 1 == 0 {
            break;
        }
        // A whole turn passes all four axes; each triangle spans less than half of one.
        let (from, to) = (halves(corner.first), halves(corner.second));
        (0..4).for_each(|k| passed[k] |= !from[k] && to[k]);
        if passed == [true; 4] {
            break;
        }
        count = n + 1;
    }
    count.max(1)
}
