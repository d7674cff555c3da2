//! Even triangles: the input surface cut as finely as the fields need it, with all edges of about
//! one length, by splits, collapses, flips and tangential relaxation (Botsch and Kobbelt, "A
//! remeshing approach to multiresolution modeling", 2004). Lines stay lines.

use glam::DVec3;
use rayon::prelude::*;

use super::surface::{EditSurface, GONE};
use super::target::ProjectionTarget;
use crate::job::{Cancelled, Job};

/// Rounds of all four operations.
const ROUNDS: usize = 4;
/// Passes of splits or of collapses in one round.
const PASSES: usize = 24;

/// Cuts `surface` so that its edges are about `length` long.
pub(super) fn even_out(
    surface: &mut EditSurface,
    target: &ProjectionTarget,
    length: f64,
    job: &Job,
) -> Result<(), Cancelled> {
    for round in 0..ROUNDS {
        split_long(surface, length * 4.0 / 3.0, job)?;
        collapse_short(surface, length * 0.8, length * 4.0 / 3.0, job)?;
        if round == 0 {
            *surface = surface.compact();
        }
        flip_to_delaunay(surface, job)?;
        relax(surface, target, job)?;
    }
    *surface = surface.compact();
    Ok(())
}

/// Splits edges above the limit at their middle, longest first, until there are none.
pub(super) fn split_long(s: &mut EditSurface, limit: f64, job: &Job) -> Result<(), Cancelled> {
    for _ in 0..PASSES {
        job.check()?;
        let mut long: Vec<(f64, u32, u32)> = s
            .edges()
            .into_iter()
            .map(|(a, b)| (s.positions[a as usize].distance(s.positions[b as usize]), a, b))
            .filter(|e| e.0 > limit)
            .collect();
        if long.is_empty() {
            break;
        }
        long.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        for (_, a, b) in long {
            let middle = s.positions[a as usize].midpoint(s.positions[b as usize]);
            s.split(a, b, middle);
        }
    }
    Ok(())
}

/// Collapses edges below `short` where no edge becomes longer than `long` and no triangle turns.
pub(super) fn collapse_short(
    s: &mut EditSurface,
    short: f64,
    long: f64,
    job: &Job,
) -> Result<(), Cancelled> {
    for _ in 0..PASSES {
        job.check()?;
        let mut done = 0;
        for (a, b) in s.edges() {
            if s.around[a as usize].is_empty() || s.around[b as usize].is_empty() {
                continue;
            }
            let (p, q) = (s.positions[a as usize], s.positions[b as usize]);
            if p.distance_squared(q) >= short * short || s.sides(a, b)[0] == GONE {
                continue;
            }
            // The one with more to say stays.
            let (keep, gone) = if s.rank(b) > s.rank(a) { (b, a) } else { (a, b) };
            let to = if s.rank(keep) == s.rank(gone) && s.rank(keep) < 2 {
                p.midpoint(q)
            } else {
                s.positions[keep as usize]
            };
            if s.can_collapse(keep, gone) && fits(s, keep, gone, to, long) {
                s.collapse(keep, gone);
                s.positions[keep as usize] = to;
                done += 1;
            }
        }
        if done == 0 {
            break;
        }
    }
    Ok(())
}

/// Returns true if merging both vertices at `to` keeps edges short and triangles upright.
fn fits(s: &EditSurface, keep: u32, gone: u32, to: DVec3, long: f64) -> bool {
    for (v, other) in [(keep, gone), (gone, keep)] {
        for &t in &s.around[v as usize] {
            let tri = s.triangles[t as usize];
            if tri.contains(&other) {
                continue;
            }
            if tri
                .iter()
                .any(|&w| w != v && s.positions[w as usize].distance_squared(to) > long * long)
            {
                return false;
            }
            let (old, new) = (s.normal(t), s.normal_with(t, v, to));
            // Slivers may become anything, others turn by 45 degrees at most.
            if old.length() > 1e-4 * long * long
                && old.dot(new) < 0.7 * old.length() * new.length().max(1e-12)
            {
                return false;
            }
        }
    }
    true
}

/// Flips edges whose opposite angles sum to more than half a turn, where the surface stays as flat
/// as it was.
pub(super) fn flip_to_delaunay(s: &mut EditSurface, job: &Job) -> Result<(), Cancelled> {
    for _ in 0..6 {
        job.check()?;
        let mut done = 0;
        for (a, b) in s.edges() {
            let Some(quad) = s.flippable(a, b) else { continue };
            let [p, q, r, t] = quad.map(|v| s.positions[v as usize]);
            // cot(at r) + cot(at t) < 0: not Delaunay.
            let cot = |at: DVec3, x: DVec3, y: DVec3| {
                let (u, v) = (x - at, y - at);
                u.dot(v) / u.cross(v).length().max(1e-30)
            };
            if cot(r, p, q) + cot(t, p, q) >= -1e-9 {
                continue;
            }
            let (m, n) = ((q - p).cross(r - p), (t - p).cross(q - p));
            let (x, y) = ((t - r).cross(q - r), (r - t).cross(p - t));
            let old = m.normalize_or_zero().dot(n.normalize_or_zero());
            let new = x.normalize_or_zero().dot(y.normalize_or_zero());
            let up = (m + n).normalize_or_zero();
            if new >= 0.9f64.min(old) - 1e-9 && x.dot(up) > 0.0 && y.dot(up) > 0.0 {
                s.flip(quad);
                done += 1;
            }
        }
        if done == 0 {
            break;
        }
    }
    Ok(())
}

/// Moves free vertices to the middle of their neighbours along the surface, vertices of lines to
/// the middle of theirs along the lines; all at once.
fn relax(s: &mut EditSurface, target: &ProjectionTarget, job: &Job) -> Result<(), Cancelled> {
    job.check()?;
    let moved: Vec<DVec3> = (0..s.positions.len() as u32)
        .into_par_iter()
        .map_init(Vec::new, |near, v| {
            let p = s.positions[v as usize];
            if s.pinned[v as usize] || s.around[v as usize].is_empty() {
                return p;
            }
            if let [a, b] = s.lines[v as usize][..] {
                let middle = s.positions[a as usize].midpoint(s.positions[b as usize]);
                return target.line(p + (middle - p) * 0.5, s.chain[v as usize]);
            }
            s.neighbours(v, near);
            let middle =
                near.iter().map(|&w| s.positions[w as usize]).sum::<DVec3>() / near.len() as f64;
            let up = s.vertex_normal(v).normalize_or_zero();
            let step = middle - p;
            let to = target.surface(p + (step - up * step.dot(up)) * 0.7, up);
            // No triangle may turn.
            let turns =
                s.around[v as usize].iter().any(|&t| s.normal_with(t, v, to).dot(up) <= 0.0);
            if turns { p } else { to }
        })
        .collect();
    s.positions = moved;
    Ok(())
}
