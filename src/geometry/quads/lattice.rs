//! From the fields to one vertex a lattice point: edges whose ends mean the same point are
//! collapsed, and what the fields left uneven is evened out. All of it by operations that keep the
//! surface a manifold of the same genus, borders and lines.

use glam::DVec3;

use super::even::{collapse_short, flip_to_delaunay, split_long};
use super::orientation::closest_pair;
use super::position::{LatticeFrame, closest_points};
use super::surface::{EditSurface, GONE};
use super::target::ProjectionTarget;
use crate::job::{Cancelled, Job};

/// Points of one cluster lie no farther apart, in steps.
const ONE_POINT: f64 = 0.6;
/// Rounds of collapses; each makes others possible.
const ROUNDS: usize = 6;

/// The lattice index of `b`'s point in the frame of `a`, rounded.
fn offset(a: &LatticeFrame, b: &LatticeFrame, step: f64) -> [f64; 2] {
    let (i, j) = closest_points(a, b, step);
    let (p, q) = closest_pair(a.along, a.normal, b.along, b.normal);
    // The rotation from the cross of `b` to `a`'s.
    let own = [a.along, a.normal.cross(a.along)];
    let other = [b.along, b.normal.cross(b.along)];
    let mut turned = [0.0; 2];
    for (k, axis) in other.iter().enumerate() {
        // `q` is the direction of `b` that goes with `p` of `a`.
        let along = axis.dot(q);
        let beside = axis.dot(b.normal.cross(q));
        let (x, y) = (p, a.normal.cross(p));
        let d = x * along + y * beside;
        turned[0] += d.dot(own[0]) * j[k];
        turned[1] += d.dot(own[1]) * j[k];
    }
    [i[0] - turned[0], i[1] - turned[1]].map(f64::round)
}

/// Collapses the fine surface to one vertex per lattice point; vertices end on the lattice points.
pub(super) fn collapse_to_lattice(
    s: &mut EditSurface,
    frames: &[LatticeFrame],
    step: f64,
    job: &Job,
) -> Result<(), Cancelled> {
    let mut same: Vec<(f64, u32, u32)> = Vec::new();
    for (a, b) in s.edges() {
        let (f, g) = (&frames[a as usize], &frames[b as usize]);
        if offset(f, g, step) == [0.0; 2] {
            same.push((f.origin.distance_squared(g.origin), a, b));
        }
    }
    same.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    // The sum and the number of lattice points, by vertex that stays.
    let mut sums: Vec<(DVec3, f64)> = frames.iter().map(|f| (f.origin, 1.0)).collect();
    let mut home: Vec<u32> = (0..frames.len() as u32).collect();
    for _ in 0..ROUNDS {
        job.check()?;
        let before = same.len();
        same.retain(|&(_, a, b)| {
            let (a, b) = (root(&mut home, a), root(&mut home, b));
            if a == b {
                return false;
            }
            let ((keep, gone), two) = if s.rank(b) > s.rank(a) { ((b, a), 1) } else { ((a, b), 0) };
            let mean = |v: u32| sums[v as usize].0 / sums[v as usize].1;
            let far = mean(keep).distance(mean(gone)) > ONE_POINT * step;
            if far || s.sides(keep, gone)[0] == GONE {
                return !far;
            }
            let both = s.rank(keep) == s.rank(gone);
            let (keep, gone) = if s.can_collapse(keep, gone) {
                (keep, gone)
            } else if two == 0 && both && s.can_collapse(gone, keep) {
                (gone, keep)
            } else {
                return true;
            };
            s.collapse(keep, gone);
            home[gone as usize] = keep;
            if s.rank(keep) == 0 || both {
                let (sum, n) = sums[gone as usize];
                sums[keep as usize].0 += sum;
                sums[keep as usize].1 += n;
            }
            false
        });
        if same.len() == before {
            break;
        }
    }
    for v in 0..s.positions.len() {
        if !s.around[v].is_empty() && !s.pinned[v] {
            s.positions[v] = sums[v].0 / sums[v].1;
        }
    }
    Ok(())
}

fn root(home: &mut [u32], mut v: u32) -> u32 {
    while home[v as usize] != v {
        home[v as usize] = home[home[v as usize] as usize];
        v = home[v as usize];
    }
    v
}

/// Puts the vertices on the surface or its lines, and evens out what the lattice left uneven.
pub(super) fn settle(
    s: &mut EditSurface,
    target: &ProjectionTarget,
    step: f64,
    job: &Job,
) -> Result<(), Cancelled> {
    *s = s.compact();
    project(s, target);
    flip_to_delaunay(s, job)?;
    for _ in 0..2 {
        collapse_short(s, 0.6 * step, 1.7 * step, job)?;
        drop_three_valent(s);
        split_long(s, 1.75 * step, job)?;
        flip_to_delaunay(s, job)?;
        project(s, target);
    }
    drop_three_valent(s);
    *s = s.compact();
    Ok(())
}

fn project(s: &mut EditSurface, target: &ProjectionTarget) {
    for v in 0..s.positions.len() {
        if s.pinned[v] || s.around[v].is_empty() {
            continue;
        }
        let p = s.positions[v];
        s.positions[v] = if s.lines[v].is_empty() {
            target.surface(p, s.vertex_normal(v as u32))
        } else {
            target.line(p, s.chain[v])
        };
    }
}

/// A free vertex between three triangles says nothing: they become one.
fn drop_three_valent(s: &mut EditSurface) {
    let mut near = Vec::new();
    for v in 0..s.positions.len() as u32 {
        if s.around[v as usize].len() == 3 && s.lines[v as usize].is_empty() {
            s.neighbours(v, &mut near);
            if let Some(&w) = near.iter().find(|&&w| s.can_collapse(w, v)) {
                s.collapse(w, v);
            }
        }
    }
}
