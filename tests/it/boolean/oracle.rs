//! Convex polyhedra with small integer corners, and what a Boolean of two must give, in rational
//! numbers of 128 bits.

use glam::DVec3;
use sculptd_geometry::PolyMesh;

use super::random::Dice;

type V = [i64; 3];

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn dot(a: V, b: V) -> i64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A point of rational coordinates: `n / d`, d > 0, reduced.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Q {
    n: [i128; 3],
    d: i128,
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a.abs() } else { gcd(b, a % b) }
}

impl Q {
    fn of(v: V) -> Q {
        Q { n: v.map(i128::from), d: 1 }
    }
    fn to(self) -> DVec3 {
        DVec3::from(self.n.map(|x| x as f64 / self.d as f64))
    }
    /// n.x - d of a plane, times this point's denominator.
    fn above(self, p: &Plane) -> i128 {
        (0..3).map(|k| self.n[k] * i128::from(p.n[k])).sum::<i128>() - i128::from(p.d) * self.d
    }
}

#[derive(Clone, Debug)]
struct Plane {
    n: V,
    d: i64,
}

#[derive(Clone, Debug)]
pub struct Polyhedron {
    corners: Vec<V>,
    faces: Vec<Vec<u32>>,
}

/// The hull of four to eight random corners, with all its corners in one plane in one face.
pub fn polyhedron(dice: &mut Dice, side: i64) -> Option<Polyhedron> {
    let mut at: Vec<V> = Vec::new();
    for _ in 0..4 + dice.below(5) {
        let p = [0; 3].map(|_: i64| dice.below(side as u64 + 1) as i64);
        if !at.contains(&p) {
            at.push(p);
        }
    }
    let mut faces: Vec<Vec<usize>> = Vec::new();
    for i in 0..at.len() {
        for j in 0..at.len() {
            for k in 0..at.len() {
                if !(i < j && i < k && j != k) {
                    continue;
                }
                let n = cross(sub(at[j], at[i]), sub(at[k], at[i]));
                if n == [0; 3] || at.iter().any(|p| dot(n, sub(*p, at[i])) > 0) {
                    continue;
                }
                let mut on: Vec<usize> =
                    (0..at.len()).filter(|&p| dot(n, sub(at[p], at[i])) == 0).collect();
                // From the lowest corner around the face; corners within or on a side are left out.
                on.sort_by_key(|&p| at[p]);
                let mut ring = vec![on[0]];
                let leftmost = |o: usize| {
                    let rest = on.iter().copied().filter(|&p| p != o);
                    rest.reduce(|a, b| {
                        let t = dot(n, cross(sub(at[a], at[o]), sub(at[b], at[o])));
                        let (la, lb) = (sub(at[a], at[o]), sub(at[b], at[o]));
                        if t < 0 || (t == 0 && dot(lb, lb) > dot(la, la)) { b } else { a }
                    })
                };
                while let Some(next) = leftmost(ring[ring.len() - 1]) {
                    if next == ring[0] || ring.len() > on.len() {
                        break;
                    }
                    ring.push(next);
                }
                if ring.len() >= 3 && !faces.contains(&ring) {
                    faces.push(ring);
                }
            }
        }
    }
    if faces.len() < 4 {
        return None;
    }
    let faces = faces.into_iter().map(|f| f.into_iter().map(|v| v as u32).collect()).collect();
    Some(Polyhedron { corners: at, faces })
}

impl Polyhedron {
    pub fn mesh(&self) -> PolyMesh {
        let mut m = PolyMesh::new();
        m.positions = self.corners.iter().map(|c| DVec3::from(c.map(|x| x as f64))).collect();
        self.faces.iter().for_each(|f| m.push_face(f));
        sculptd_geometry::repair::drop_unused(&mut m);
        m
    }

    fn ring(&self, f: usize) -> Vec<Q> {
        self.faces[f].iter().map(|&v| Q::of(self.corners[v as usize])).collect()
    }

    fn planes(&self) -> Vec<Plane> {
        let plane = |f: &Vec<u32>| {
            let [a, b, c] = [0, 1, 2].map(|k| self.corners[f[k] as usize]);
            let n = cross(sub(b, a), sub(c, a));
            Plane { n, d: dot(n, a) }
        };
        self.faces.iter().map(plane).collect()
    }
}

fn clip(ring: &[Q], p: &Plane) -> Vec<Q> {
    let mut out = Vec::new();
    for (i, &q) in ring.iter().enumerate() {
        let r = ring[(i + 1) % ring.len()];
        let (s, t) = (q.above(p), r.above(p));
        if s <= 0 {
            out.push(q);
        }
        if (s < 0 && t > 0) || (s > 0 && t < 0) {
            // q + (r - q) S / (S - T) with S = s / q.d, T = t / r.d.
            let n = [0, 1, 2].map(|k| r.n[k] * s - q.n[k] * t);
            let d = r.d * s - q.d * t;
            let g = n.iter().fold(d, |g, &x| gcd(g, x)).abs() * d.signum();
            out.push(Q { n: n.map(|x| x / g), d: d / g });
        }
    }
    out
}

fn vector(ring: &[Q]) -> DVec3 {
    let p: Vec<DVec3> = ring.iter().map(|q| q.to()).collect();
    (1..p.len().max(2) - 1).map(|k| (p[k] - p[0]).cross(p[k + 1] - p[0])).sum::<DVec3>() / 2.0
}

/// Volume and area of union, intersection, A - B, B - A.
pub fn expected(a: &Polyhedron, b: &Polyhedron) -> [(f64, f64); 4] {
    // A face's area: all of it, within the other, on the other facing the same way, facing the
    // other way; and what the parts within and on (facing the same way) give to the volume of the
    // intersection.
    let split = |s: &Polyhedron, o: &Polyhedron, own: bool| {
        let (mut sum, mut volume, mut whole) = ([0.0; 4], 0.0, 0.0);
        let planes = s.planes();
        for f in 0..s.faces.len() {
            let ring = s.ring(f);
            whole += vector(&ring).dot(ring[0].to()) / 3.0;
            sum[0] += vector(&ring).length();
            let on = o.planes().into_iter().find(|p| ring.iter().all(|q| q.above(p) == 0));
            let mut piece = ring;
            for p in o.planes() {
                if on.as_ref().is_none_or(|x| (x.n, x.d) != (p.n, p.d)) {
                    piece = clip(&piece, &p);
                }
            }
            let which = on.map_or(1, |p| if dot(p.n, planes[f].n) > 0 { 2 } else { 3 });
            let v = vector(&piece);
            sum[which] += v.length();
            if which == 1 || (which == 2 && own) {
                volume += v.dot(piece.first().map_or(DVec3::ZERO, |q| q.to())) / 3.0;
            }
        }
        (sum, volume, whole)
    };
    let ((sa, ia, va), (sb, ib, vb)) = (split(a, b, true), split(b, a, false));
    let both = ia + ib;
    let (oa, ob) = (sa[0] - sa[1] - sa[2] - sa[3], sb[0] - sb[1] - sb[2] - sb[3]);
    [
        (va + vb - both, oa + ob + sa[2]),
        (both, sa[1] + sb[1] + sa[2]),
        (va - both, oa + sa[3] + sb[1]),
        (vb - both, ob + sb[3] + sa[1]),
    ]
}
