//! Fewer irregular vertices: operations on the quads that bring the number of faces around the
//! vertices nearer to four (two on a border), where the shape allows.

use glam::DVec3;

use super::pairing::squareness;
use super::quad_surface::{QuadSurface, corners};
use super::surface::GONE;
use crate::job::{Cancelled, Job};

/// The square of what vertex `v` has too many or too few with `faces` around it.
fn excess(s: &QuadSurface, v: u32, faces: usize) -> i64 {
    if s.pinned[v as usize] {
        return 0;
    }
    let wanted = if s.border[v as usize] { 2 } else { 4 };
    let by = faces as i64 - wanted;
    by * by
}

/// Runs one pass of every operation; returns the number of operations.
pub(super) fn run_pass(s: &mut QuadSurface, job: &Job) -> Result<usize, Cancelled> {
    let mut done = 0;
    for v in 0..s.positions.len() as u32 {
        done += usize::from(s.remove_doublet(v));
    }
    for f in 0..s.faces.len() as u32 {
        if f % 1024 == 0 {
            job.check()?;
        }
        if s.alive(f as usize) {
            done += usize::from(close_best(s, f) || turn_best(s, f));
        }
    }
    Ok(done)
}

/// Closes the quad where that makes its surroundings more regular.
fn close_best(s: &mut QuadSurface, f: u32) -> bool {
    let face = s.faces[f as usize];
    if face[3] == GONE {
        return false;
    }
    for k in 0..4 {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| face[(k + i) % 4]);
        let n = |v: u32| s.around[v as usize].len();
        let before =
            excess(s, a, n(a)) + excess(s, b, n(b)) + excess(s, c, n(c)) + excess(s, d, n(d));
        if n(b) == 0 || n(d) == 0 {
            continue;
        }
        let merged = n(a) + n(c) - 2;
        let after = excess(s, a, merged) + excess(s, b, n(b) - 1) + excess(s, d, n(d) - 1);
        // A quad less is only worth it where two vertices become regular.
        if after + 1 >= before || !s.can_close(f, k) {
            continue;
        }
        let fixed = !s.lines[a as usize].is_empty();
        let to = if fixed {
            s.positions[a as usize]
        } else {
            s.positions[a as usize].midpoint(s.positions[c as usize])
        };
        if closes_upright(s, f, a, c, to) {
            s.close(f, k);
            s.positions[a as usize] = to;
            return true;
        }
    }
    false
}

/// Returns true if no face around turns over when `a` and `c` meet at `to`.
fn closes_upright(s: &QuadSurface, f: u32, a: u32, c: u32, to: DVec3) -> bool {
    let up = (s.vertex_normal(a) + s.vertex_normal(c)).normalize_or_zero();
    s.around[a as usize].iter().chain(&s.around[c as usize]).filter(|&&g| g != f).all(|&g| {
        let place = |v: u32| if v == a || v == c { to } else { s.positions[v as usize] };
        let face = s.faces[g as usize];
        if face[3] == GONE {
            let p = [face[0], face[1], face[2]].map(place);
            (p[1] - p[0]).cross(p[2] - p[0]).dot(up) > 0.0
        } else {
            squareness(face.map(place), up) > 0.0
        }
    })
}

/// Turns an edge of the quad where that makes its surroundings more regular.
fn turn_best(s: &mut QuadSurface, f: u32) -> bool {
    for k in 0..4 {
        let Some((g, six)) = s.hexagon(f, k) else { continue };
        if g < f {
            continue;
        }
        let n = |v: u32| s.around[v as usize].len();
        for cut in [1, 2] {
            let (out, into) = ([six[0], six[3]], [six[cut], six[cut + 3]]);
            let least = |v: u32| if s.lines[v as usize].is_empty() { 4 } else { 2 };
            if out.iter().any(|&v| n(v) < least(v)) || s.joined(into[0], into[1]) {
                continue;
            }
            let before: i64 = out.iter().chain(&into).map(|&v| excess(s, v, n(v))).sum();
            let after: i64 = out.iter().map(|&v| excess(s, v, n(v) - 1)).sum::<i64>()
                + into.iter().map(|&v| excess(s, v, n(v) + 1)).sum::<i64>();
            if after >= before {
                continue;
            }
            let up = (s.normal(f) + s.normal(g)).normalize_or_zero();
            let upright = QuadSurface::cut(six, cut)
                .iter()
                .all(|q| squareness(q.map(|v| s.positions[v as usize]), up) > 0.02);
            if upright {
                s.turn(f, g, six, cut);
                return true;
            }
        }
    }
    false
}

/// Quads of less than this are looked at by [`mend_folded`]: an angle of 10 or 170 degrees.
const FOLDED: f64 = 0.015;

/// Repairs quads that are reflex or folded: they are closed, or an edge of theirs is turned, where
/// the least square of the faces around becomes squarer. How many were.
pub(super) fn mend_folded(s: &mut QuadSurface) -> usize {
    let mut done = 0;
    for f in 0..s.faces.len() as u32 {
        if !s.alive(f as usize) || shape(s, f) >= FOLDED {
            continue;
        }
        done += usize::from(turn_folded(s, f) || close_folded(s, f));
    }
    done
}

/// Returns the quality of a face with these corners: 1 at best, 0 or below if it is folded.
fn shape_of(s: &QuadSurface, face: [u32; 4], up: DVec3) -> f64 {
    let at = |v: u32| s.positions[v as usize];
    if face[3] != GONE {
        return squareness(face.map(at), up);
    }
    let p = [face[0], face[1], face[2]].map(at);
    let sine = |k: usize| {
        let to = (p[(k + 1) % 3] - p[k]).normalize_or_zero();
        to.cross((p[(k + 2) % 3] - p[k]).normalize_or_zero()).dot(up)
    };
    sine(0).min(sine(1)).min(sine(2))
}

/// The shape of face `f`, seen along the mean of the normals at its corners.
fn shape(s: &QuadSurface, f: u32) -> f64 {
    let face = s.faces[f as usize];
    let up = corners(&face).iter().map(|&v| s.vertex_normal(v)).sum::<DVec3>();
    shape_of(s, face, up.normalize_or_zero())
}

fn close_folded(s: &mut QuadSurface, f: u32) -> bool {
    let face = s.faces[f as usize];
    if face[3] == GONE {
        return false;
    }
    let at = |k: usize| s.positions[face[k % 4] as usize];
    // The shorter diagonal first.
    let first = usize::from(at(1).distance_squared(at(3)) < at(0).distance_squared(at(2)));
    for k in [first, first + 2, first + 1, (first + 3) % 4] {
        let (a, c) = (face[k], face[(k + 2) % 4]);
        if !s.can_close(f, k) {
            continue;
        }
        let to = if s.lines[a as usize].is_empty() {
            s.positions[a as usize].midpoint(s.positions[c as usize])
        } else {
            s.positions[a as usize]
        };
        if closes_upright(s, f, a, c, to) {
            s.close(f, k);
            s.positions[a as usize] = to;
            return true;
        }
    }
    false
}

/// Another way to cut two faces.
struct FaceRecut {
    /// The worse shape of the new faces.
    least: f64,
    /// The second of the old faces.
    other: u32,
    one: [u32; 4],
    two: Option<[u32; 4]>,
}

/// Recuts the faces at an edge of `f`, so that the worse of them improves; two triangles may become
/// one quad.
fn turn_folded(s: &mut QuadSurface, f: u32) -> bool {
    let mut best: Option<FaceRecut> = None;
    for k in 0..corners(&s.faces[f as usize]).len() {
        let Some((g, ring)) = s.ring(f, k) else { continue };
        let now = shape(s, f).min(shape(s, g));
        let ends = [ring[0], ring[corners(&s.faces[f as usize]).len() - 1]];
        let few = |v: u32| {
            s.around[v as usize].len() < if s.lines[v as usize].is_empty() { 4 } else { 2 }
        };
        if ends.iter().any(|&v| few(v)) {
            continue;
        }
        let up = (s.normal(f) + s.normal(g)).normalize_or_zero();
        let n = ring.len();
        let mut offer = |one: [u32; 4], two: Option<[u32; 4]>| {
            let least = shape_of(s, one, up).min(two.map_or(1.0, |two| shape_of(s, two, up)));
            if least > now + 0.01 && best.as_ref().is_none_or(|b| least > b.least) {
                best = Some(FaceRecut { least, other: g, one, two });
            }
        };
        if n == 4 {
            offer([ring[0], ring[1], ring[2], ring[3]], None);
            continue;
        }
        for cut in 0..n {
            let v = |i: usize| ring[(cut + i) % n];
            // From the first to the fourth: a quad, and a quad or a triangle.
            if (n == 6 && cut >= 3) || s.joined(v(0), v(3)) {
                continue;
            }
            let two =
                [v(3), v(4), if n == 6 { v(5) } else { v(0) }, if n == 6 { v(0) } else { GONE }];
            offer([v(0), v(1), v(2), v(3)], Some(two));
        }
    }
    let Some(FaceRecut { other, one, two, .. }) = best else { return false };
    s.replace(f, other, one, two);
    true
}

/// Cuts the quads that are reflex or folded into triangles; returns their number.
pub(super) fn cut_folded(s: &mut QuadSurface) -> usize {
    let mut cut = 0;
    for f in 0..s.faces.len() as u32 {
        let face = s.faces[f as usize];
        if !s.alive(f as usize) || face[3] == GONE {
            continue;
        }
        let up = s.normal(f).normalize_or_zero();
        if squareness(face.map(|v| s.positions[v as usize]), up) < 0.0 {
            s.cut_quad(f);
            cut += 1;
        }
    }
    cut
}
