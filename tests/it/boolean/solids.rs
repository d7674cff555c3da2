//! Solids as a mesh and as disjoint convex parts, so that volumes and areas of all four results are
//! known without a Boolean.

use glam::{DMat3, DVec3};
use sculptd_geometry::PolyMesh;

/// A convex solid as half-spaces: points x with n.x <= d, n of unit length.
pub type Convex = Vec<(DVec3, f64)>;

#[derive(Clone)]
pub struct Solid {
    pub mesh: PolyMesh,
    pub parts: Vec<Convex>,
}

impl Solid {
    pub fn and(mut self, other: Solid) -> Solid {
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(&other.mesh.positions);
        for f in other.mesh.faces() {
            self.mesh.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>());
        }
        self.parts.extend(other.parts);
        self
    }

    /// Turns and moves the solid. Each point is computed separately, so that originally equal
    /// planes differ by rounding.
    pub fn placed(mut self, turn: DMat3, shift: DVec3) -> Solid {
        for p in &mut self.mesh.positions {
            *p = turn * *p + shift;
        }
        for part in &mut self.parts {
            for (n, d) in part {
                *n = turn * *n;
                *d += n.dot(shift);
            }
        }
        self
    }
}

/// A polygon (counter-clockwise from above) drawn up from z = low to high. `along`: 0, 1 or 2, the
/// axis that z becomes.
pub fn prism(outline: &[(f64, f64)], low: f64, high: f64, along: usize) -> Solid {
    let put = |x: f64, y: f64, z: f64| match along {
        0 => DVec3::new(z, x, y),
        1 => DVec3::new(y, z, x),
        _ => DVec3::new(x, y, z),
    };
    let n = outline.len() as u32;
    let mut mesh = PolyMesh::new();
    for z in [low, high] {
        mesh.positions.extend(outline.iter().map(|&(x, y)| put(x, y, z)));
    }
    mesh.push_face(&(0..n).rev().collect::<Vec<_>>());
    mesh.push_face(&(n..2 * n).collect::<Vec<_>>());
    for i in 0..n {
        let j = (i + 1) % n;
        mesh.push_face(&[i, j, n + j, n + i]);
    }
    let mut flat = PolyMesh::new();
    flat.positions = outline.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
    flat.push_face(&(0..n).collect::<Vec<_>>());
    let wedge = |t: &[u32; 3]| {
        let mut part: Convex = (0..3)
            .map(|k| {
                let (a, b) = (outline[t[k] as usize], outline[t[(k + 1) % 3] as usize]);
                let normal = put(b.1 - a.1, a.0 - b.0, 0.0).normalize();
                (normal, normal.dot(put(a.0, a.1, 0.0)))
            })
            .collect();
        part.push((put(0.0, 0.0, -1.0), -low));
        part.push((put(0.0, 0.0, 1.0), high));
        part
    };
    let parts = flat.triangles().0.iter().map(wedge).collect();
    Solid { mesh, parts }
}

pub fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Solid {
    let mut s =
        prism(&[(lo[0], lo[1]), (hi[0], lo[1]), (hi[0], hi[1]), (lo[0], hi[1])], lo[2], hi[2], 2);
    let (lo, hi) = (DVec3::from(lo), DVec3::from(hi));
    s.parts =
        vec![(0..3).flat_map(|k| [(DVec3::AXES[k], hi[k]), (-DVec3::AXES[k], -lo[k])]).collect()];
    s
}

/// A box with a closed hollow in it.
pub fn hollow(lo: [f64; 3], hi: [f64; 3], wall: f64) -> Solid {
    let mut s = cuboid(lo, hi);
    let (il, ih) = (lo.map(|x| x + wall), hi.map(|x| x - wall));
    let mut inner = cuboid(il, ih);
    inner.parts.clear();
    sculptd_geometry::repair::flip(&mut inner.mesh);
    s = s.and(inner);
    s.parts.clear();
    let (mut l, mut h) = (lo, hi);
    for k in 0..3 {
        let (mut low, mut high) = ((l, h), (l, h));
        low.1[k] = il[k];
        high.0[k] = ih[k];
        s.parts.extend(cuboid(low.0, low.1).parts);
        s.parts.extend(cuboid(high.0, high.1).parts);
        (l[k], h[k]) = (il[k], ih[k]);
    }
    s
}

pub fn regular(sides: u32, radius: f64, (x, y): (f64, f64), first: f64) -> Vec<(f64, f64)> {
    (0..sides)
        .map(|i| {
            let a = first + f64::from(i) * std::f64::consts::TAU / f64::from(sides);
            (x + radius * a.cos(), y + radius * a.sin())
        })
        .collect()
}

/// A profile of (radius, height), from the axis and back to it, counter-clockwise with the radius
/// to the right, turned about z. `quads`: convex parts of the profile, as indices into it.
pub fn revolved(profile: &[(f64, f64)], quads: &[&[usize]], around: u32) -> Solid {
    let mut mesh = PolyMesh::new();
    let angle = |i: u32| f64::from(i % around) * std::f64::consts::TAU / f64::from(around);
    let place = |(r, z): (f64, f64), i: u32| DVec3::new(r * angle(i).cos(), r * angle(i).sin(), z);
    let mut rows: Vec<Vec<u32>> = Vec::new();
    for &p in profile {
        let count = if p.0 == 0.0 { 1 } else { around };
        let base = mesh.positions.len() as u32;
        mesh.positions.extend((0..count).map(|i| place(p, i)));
        rows.push((0..around).map(|i| base + i % count).collect());
    }
    for k in 0..profile.len() - 1 {
        for i in 0..around as usize {
            let j = (i + 1) % around as usize;
            let mut f = vec![rows[k][i], rows[k][j], rows[k + 1][j], rows[k + 1][i]];
            f.dedup();
            if f.first() == f.last() {
                f.pop();
            }
            if f.len() > 2 {
                mesh.push_face(&f);
            }
        }
    }
    let mut parts = Vec::new();
    for i in 0..around {
        for q in quads {
            // Every plane of the part from three of its corners.
            let mut part: Convex = Vec::new();
            for (k, &a) in q.iter().enumerate() {
                let (a, b) = (profile[a], profile[q[(k + 1) % q.len()]]);
                if a.0 == 0.0 && b.0 == 0.0 {
                    continue;
                }
                let (p, r) = (place(a, i), place(b, i));
                let third = if a.0 > 0.0 { place(a, i + 1) } else { place(b, i + 1) };
                let n = (third - p).cross(r - p).normalize();
                part.push((n, n.dot(p)));
            }
            let (s, t) = (angle(i), angle(i + 1));
            part.push((DVec3::new(s.sin(), -s.cos(), 0.0), 0.0));
            part.push((DVec3::new(-t.sin(), t.cos(), 0.0), 0.0));
            parts.push(part);
        }
    }
    Solid { mesh, parts }
}

fn clip(polygon: &[DVec3], (n, d): (DVec3, f64)) -> Vec<DVec3> {
    let mut out = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (a, b) = (n.dot(p) - d, n.dot(q) - d);
        if a <= 0.0 {
            out.push(p);
        }
        if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
            out.push(p + (q - p) * (a / (a - b)));
        }
    }
    out
}

fn vector(polygon: &[DVec3]) -> DVec3 {
    let Some(&o) = polygon.first() else { return DVec3::ZERO };
    polygon.windows(2).map(|w| (w[0] - o).cross(w[1] - o)).sum::<DVec3>() / 2.0
}

/// Volume of a bounded convex solid: a pyramid over each face.
fn volume(part: &[(DVec3, f64)]) -> f64 {
    (0..part.len())
        .map(|i| {
            let (n, d) = part[i];
            // The same plane twice would be counted twice.
            if part[..i].iter().any(|&(m, e)| (m - n).length() < 1e-9 && (d - e).abs() < 1e-9) {
                return 0.0;
            }
            let (x, y) = n.any_orthonormal_pair();
            let mut face: Vec<DVec3> = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)]
                .iter()
                .map(|(s, t)| n * d + (x * *s + y * *t) * 1e3)
                .collect();
            for (j, &h) in part.iter().enumerate() {
                if j != i {
                    face = clip(&face, h);
                }
            }
            d * vector(&face).length() / 3.0
        })
        .sum()
}

/// Returns the expected volume and area of union, intersection, A - B, B - A.
pub fn expected(a: &Solid, b: &Solid) -> [(f64, f64); 4] {
    let total = |s: &Solid| s.parts.iter().map(|p| volume(p)).sum::<f64>();
    let mut both = 0.0;
    for p in &a.parts {
        for q in &b.parts {
            both += volume(&p.iter().chain(q).copied().collect::<Vec<_>>());
        }
    }
    let (va, vb) = (total(a), total(b));
    // Area of one's surface: outside, inside, on the other's facing the same way, facing the other
    // way.
    let split = |s: &Solid, o: &Solid| {
        let mut sum = [0.0; 4];
        for t in s.mesh.triangles().0 {
            let corners = t.map(|v| s.mesh.positions[v as usize]);
            let n = vector(&corners);
            let (whole, n) = (n.length(), n.normalize());
            let mut own = [whole, 0.0, 0.0, 0.0];
            for part in &o.parts {
                let on = part.iter().find(|(m, d)| {
                    n.dot(*m).abs() > 1.0 - 1e-9
                        && corners.iter().all(|c| (c.dot(*m) - d).abs() < 1e-9)
                });
                let mut piece = corners.to_vec();
                for &h in part.iter().filter(|h| on.is_none_or(|o| o != *h)) {
                    piece = clip(&piece, h);
                }
                let area = vector(&piece).length();
                let which = on.map_or(1, |(m, _)| if n.dot(*m) > 0.0 { 2 } else { 3 });
                own[which] += area;
                own[0] -= area;
            }
            // On a wall between two parts: within the solid.
            let inner = own[2].min(own[3]);
            if inner > 1e-12 {
                own = [own[0] + inner, own[1] + inner, own[2] - inner, own[3] - inner];
            }
            (0..4).for_each(|k| sum[k] += own[k]);
        }
        sum
    };
    let ([oa, ia, sa, ga], [ob, ib, _, gb]) = (split(a, b), split(b, a));
    [
        (va + vb - both, oa + sa + ob),
        (both, ia + sa + ib),
        (va - both, oa + ga + ib),
        (vb - both, ob + gb + ia),
    ]
}
