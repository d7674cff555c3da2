//! Two triangles: whether they cross, with exact signs.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Returns true if three points are collinear, exactly.
pub(super) fn on_a_line(a: DVec3, b: DVec3, c: DVec3) -> bool {
    (0..3).all(|axis| {
        let flat = |p: DVec3| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
        orient2d(flat(a), flat(b), flat(c)) == 0.0
    })
}

pub(super) fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let at = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(at(a), at(b), at(c), at(d))
}

/// The way two triangles meet where that may be a crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Meet {
    No,
    /// Their insides have a line or an area in common.
    Cross,
    /// An edge (by its number) of the second, or of the first, runs through the other's inside. A
    /// crossing, if the surface continues on the other side.
    Along(Which, usize),
    /// Edge of the first, edge of the second: parts of one line. A crossing, if the surfaces change
    /// sides there.
    Edges(usize, usize),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Which {
    First,
    Second,
}

/// The plane of a triangle, made ready for many points.
struct RoundedPlane {
    at: DVec3,
    /// Twice the triangle's area long.
    normal: DVec3,
    /// The sizes of what `normal` is a difference of.
    size: DVec3,
}

impl RoundedPlane {
    fn new([a, b, c]: [DVec3; 3]) -> RoundedPlane {
        let (u, w) = (b - a, c - a);
        let left = DVec3::new(u.y * w.z, u.z * w.x, u.x * w.y);
        let right = DVec3::new(u.z * w.y, u.x * w.z, u.y * w.x);
        RoundedPlane { at: a, normal: left - right, size: left.abs() + right.abs() }
    }

    /// On which side of the plane a point is, as [`side`] says it; None where rounding may hide it
    /// (Shewchuk's first filter).
    fn side(&self, p: DVec3) -> Option<f64> {
        let d = self.at - p;
        let det = self.normal.dot(d);
        (det.abs() > 1e-15 * self.size.dot(d.abs())).then_some(det)
    }
}

/// Returns true if an edge of the first triangle separates it from the second, seen along the
/// first's normal, by more than rounding: common corners may be on the edge.
fn beside(ps: [DVec3; 3], pt: [DVec3; 3], s: [u32; 3], t: [u32; 3]) -> bool {
    let n = (ps[1] - ps[0]).cross(ps[2] - ps[0]);
    let reach = ps.iter().chain(&pt).fold(DVec3::ZERO, |r, p| r.max(p.abs())).max_element();
    (0..3).any(|k| {
        let j = (k + 1) % 3;
        let out = (ps[j] - ps[k]).cross(n);
        // The triangle's own third corner is on the other side by more than rounding too.
        let far = 1e-13 * reach * out.length();
        far > 0.0
            && (ps[(k + 2) % 3] - ps[k]).dot(out) < -far
            && (0..3).all(|i| t[i] == s[k] || t[i] == s[j] || (pt[i] - ps[k]).dot(out) > far)
    })
}

/// Returns the way two triangles meet beyond their shared parts.
pub(super) fn triangles_meet(positions: &[DVec3], s: [u32; 3], t: [u32; 3]) -> Meet {
    let p = |v: u32| positions[v as usize];
    let shared = s.iter().filter(|v| t.contains(v)).count();
    let (ps, pt) = (s.map(p), t.map(p));
    // A common vertex is in both planes: known without arithmetic.
    let sides = |plane: [u32; 3], at: [DVec3; 3], of: [u32; 3], near: [Option<f64>; 3]| {
        [0, 1, 2].map(|i| match near[i] {
            Some(side) => side,
            None if plane.contains(&of[i]) => 0.0,
            None => side(at[0], at[1], at[2], p(of[i])),
        })
    };
    let rounded = |plane: [u32; 3], at: [DVec3; 3], of: [u32; 3]| {
        let rounded = RoundedPlane::new(at);
        of.map(|v| if plane.contains(&v) { None } else { rounded.side(p(v)) })
    };
    let near = rounded(s, ps, t);
    // Coplanar neighbours need exact signs, but this test separates them without.
    let unsure = (0..3).any(|i| near[i].is_none() && !s.contains(&t[i]));
    if unsure && (beside(ps, pt, s, t) || beside(pt, ps, t, s)) {
        return Meet::No;
    }
    let of_t = sides(s, ps, t, near);
    let zeros = |d: &[f64; 3]| d.iter().filter(|&&v| v == 0.0).count();
    if zeros(&of_t) == 3 {
        return if overlap(ps, pt) { Meet::Cross } else { Meet::No };
    }
    if shared >= 2 {
        return Meet::No;
    }
    let astride = |d: &[f64; 3]| d.iter().any(|&v| v > 0.0) && d.iter().any(|&v| v < 0.0);
    if !astride(&of_t) && zeros(&of_t) < 2 {
        return Meet::No;
    }
    let of_s = sides(t, pt, s, rounded(t, pt, s));
    match (astride(&of_s), astride(&of_t)) {
        (true, true) if lines_overlap(ps, of_s, pt, of_t) => Meet::Cross,
        (true, false) => edge_on(&of_t)
            .filter(|&k| runs_through(pt[k], pt[(k + 1) % 3], ps))
            .map_or(Meet::No, |k| Meet::Along(Which::Second, k)),
        (false, true) => edge_on(&of_s)
            .filter(|&k| runs_through(ps[k], ps[(k + 1) % 3], pt))
            .map_or(Meet::No, |k| Meet::Along(Which::First, k)),
        (false, false) => match (edge_on(&of_s), edge_on(&of_t)) {
            (Some(i), Some(j))
                if along_each_other([ps[i], ps[(i + 1) % 3]], [pt[j], pt[(j + 1) % 3]]) =>
            {
                Meet::Edges(i, j)
            }
            _ => Meet::No,
        },
        _ => Meet::No,
    }
}

/// Returns the edge whose ends are in the plane, given the corners' sides of it.
fn edge_on(d: &[f64; 3]) -> Option<usize> {
    (0..3).find(|&k| d[k] == 0.0 && d[(k + 1) % 3] == 0.0)
}

/// Returns true if the lines in which two triangles cut each other's plane have more than a point
/// in common; each is astride the other's plane. After Guigue and Devillers, *Fast and robust
/// triangle-triangle overlap test using orientation predicates* (2003).
fn lines_overlap(ps: [DVec3; 3], of_s: [f64; 3], pt: [DVec3; 3], of_t: [f64; 3]) -> bool {
    // Turned so that the first corner is alone on its side, the others on the other side or on the
    // plane; then the second and the third change places where the other's plane looks away.
    let alone = |d: [f64; 3]| {
        (0..3)
            .find(|&k| {
                let others = [d[(k + 1) % 3], d[(k + 2) % 3]];
                d[k] > 0.0 && others.iter().all(|&v| v <= 0.0)
                    || d[k] < 0.0 && others.iter().all(|&v| v >= 0.0)
            })
            .unwrap_or(0)
    };
    let turned = |p: [DVec3; 3], k: usize| [p[k], p[(k + 1) % 3], p[(k + 2) % 3]];
    let (i, j) = (alone(of_s), alone(of_t));
    let (mut a, mut b) = (turned(ps, i), turned(pt, j));
    if of_s[i] < 0.0 {
        b.swap(1, 2);
    }
    if of_t[j] < 0.0 {
        a.swap(1, 2);
    }
    side(a[0], a[1], b[0], b[1]) < 0.0 && side(a[0], a[2], b[2], b[0]) < 0.0
}

/// Returns true if a piece of a line in the triangle's plane runs through the triangle's inside.
fn runs_through(p: DVec3, q: DVec3, t: [DVec3; 3]) -> bool {
    let flat = flatten([t, t]);
    let (a, p, q) = (t.map(&flat), flat(p), flat(q));
    let turn = orient2d(a[0], a[1], a[2]);
    let beside =
        |k: usize| [p, q].iter().all(|&x| orient2d(a[k], a[(k + 1) % 3], x) * turn.signum() <= 0.0);
    let of = a.map(|x| orient2d(p, q, x));
    turn != 0.0 && of.iter().any(|&v| v > 0.0) && of.iter().any(|&v| v < 0.0) && !(0..3).any(beside)
}

/// Returns true if two pieces of one line have a length in common.
fn along_each_other(e: [DVec3; 2], f: [DVec3; 2]) -> bool {
    let d = (e[1] - e[0]).abs();
    let axis = if d.x >= d.y && d.x >= d.z {
        0
    } else if d.y >= d.z {
        1
    } else {
        2
    };
    let range = |e: [DVec3; 2]| (e[0][axis].min(e[1][axis]), e[0][axis].max(e[1][axis]));
    let ((a, b), (c, d)) = (range(e), range(f));
    a.max(c) < b.min(d)
}

/// Drops the axis along which the larger of two triangles has the longest normal.
pub(super) fn flatten([s, t]: [[DVec3; 3]; 2]) -> impl Fn(DVec3) -> Coord<f64> {
    let n = ((s[1] - s[0]).cross(s[2] - s[0])).abs();
    let m = ((t[1] - t[0]).cross(t[2] - t[0])).abs();
    let n = n.max(m);
    move |p: DVec3| {
        if n.x >= n.y && n.x >= n.z {
            Coord { x: p.y, y: p.z }
        } else if n.y >= n.z {
            Coord { x: p.z, y: p.x }
        } else {
            Coord { x: p.x, y: p.y }
        }
    }
}

/// Returns true if two coplanar triangles have an area in common: no edge's line separates them.
pub(super) fn overlap(ps: [DVec3; 3], pt: [DVec3; 3]) -> bool {
    let flat = flatten([ps, pt]);
    let (a, b) = (ps.map(&flat), pt.map(&flat));
    let apart = |a: &[Coord<f64>; 3], b: &[Coord<f64>; 3]| {
        let turn = orient2d(a[0], a[1], a[2]);
        turn == 0.0
            || (0..3).any(|i| {
                let j = (i + 1) % 3;
                b.iter().all(|&q| orient2d(a[i], a[j], q) * turn.signum() <= 0.0)
            })
    };
    !apart(&a, &b) && !apart(&b, &a)
}
