//! Primitive solids by their numbers, tessellated for sculpting: triangles of nearly the same size
//! everywhere, no slivers at a pole or in a cap.
//!
//! A solid of revolution is made of rings about +y. Each ring has as many vertices as its length
//! asks for, and two neighbouring rings are joined by walking along both at once, always to the
//! vertex that lies next in angle.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::{TriMesh, shapes};

/// A primitive and its numbers, world units. Its middle is the origin; what has an axis stands
/// along +y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Primitive {
    /// Its shape.
    pub shape: PrimitiveShape,
    /// The length of an edge of its triangles, about; > 0.
    pub edge: f64,
}

/// Shape of a primitive. Lengths are > 0 and at most 1e6.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum PrimitiveShape {
    /// A box of these sides.
    Box([f64; 3]),
    /// A ball of this radius.
    Ball(f64),
    /// A closed cylinder: radius, height.
    Cylinder([f64; 2]),
    /// A closed cone with its tip up: radius of its base, height.
    Cone([f64; 2]),
    /// A torus about +y: from the middle to the middle of its tube, radius of the tube, which is
    /// the smaller.
    Torus([f64; 2]),
    /// A closed tube: outer radius, inner radius, which is the smaller, height.
    Tube([f64; 3]),
    /// A flat sheet that faces up, open: its sides along x and z.
    Plane([f64; 2]),
}

/// The primitive's numbers are out of their ranges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("expected lengths of 0 to 1e6, and an edge that gives at most 4,000,000 vertices")]
pub struct BadPrimitive;

/// Vertices of a primitive, at most.
const MOST_VERTICES: f64 = 4e6;
/// Vertices of a primitive whose edge is not given, about.
const USUAL_VERTICES: f64 = 20_000.0;

impl PrimitiveShape {
    /// Its surface, and the longest of its lengths; `None`: out of range.
    fn area(&self) -> Option<f64> {
        let fine = |all: &[f64]| all.iter().all(|l| *l > 0.0 && *l <= 1e6);
        let pi = std::f64::consts::PI;
        let area = match self {
            PrimitiveShape::Box(s) if fine(s) => 2.0 * (s[0] * s[1] + s[1] * s[2] + s[2] * s[0]),
            PrimitiveShape::Ball(r) if fine(&[*r]) => 4.0 * pi * r * r,
            PrimitiveShape::Cylinder([r, h]) if fine(&[*r, *h]) => TAU * r * (r + h),
            PrimitiveShape::Cone([r, h]) if fine(&[*r, *h]) => pi * r * (r + r.portable_hypot(*h)),
            PrimitiveShape::Torus([a, b]) if fine(&[*a, *b]) && b < a => TAU * TAU * a * b,
            PrimitiveShape::Tube([o, i, h]) if fine(&[*o, *i, *h]) && i < o => {
                TAU * (o + i) * h + TAU * (o * o - i * i)
            }
            PrimitiveShape::Plane(s) if fine(s) => s[0] * s[1],
            _ => return None,
        };
        Some(area)
    }

    /// The edge that gives about 20,000 vertices.
    pub fn usual_edge(&self) -> f64 {
        // A triangle of even sides covers sqrt(3)/4 e^2, and there are two a vertex.
        let area = self.area().unwrap_or(1.0);
        (area / USUAL_VERTICES / (3f64.sqrt() * 0.5)).sqrt()
    }

    /// Returns its default name.
    pub fn name(&self) -> &'static str {
        match self {
            PrimitiveShape::Box(_) => "box",
            PrimitiveShape::Ball(_) => "ball",
            PrimitiveShape::Cylinder(_) => "cylinder",
            PrimitiveShape::Cone(_) => "cone",
            PrimitiveShape::Torus(_) => "torus",
            PrimitiveShape::Tube(_) => "tube",
            PrimitiveShape::Plane(_) => "plane",
        }
    }
}

impl Primitive {
    /// Its triangles, the same bits each time.
    ///
    /// # Errors
    /// [`BadPrimitive`] where a number is out of its range.
    pub fn triangles(&self) -> Result<TriMesh, BadPrimitive> {
        let area = self.shape.area().ok_or(BadPrimitive)?;
        let e = self.edge;
        let vertices = area / (e * e * 3f64.sqrt() * 0.5);
        if !(e > 0.0 && e.is_finite() && vertices <= MOST_VERTICES) {
            return Err(BadPrimitive);
        }
        Ok(match self.shape {
            PrimitiveShape::Box(sides) => cuboid(DVec3::from(sides), e),
            PrimitiveShape::Ball(radius) => {
                let frequency = (vertices / 10.0).sqrt().round().max(1.0);
                shapes::icosphere(radius as f32, frequency as u32)
            }
            PrimitiveShape::Cylinder([r, h]) => {
                let h = h * 0.5;
                revolve(&[[0.0, -h], [r, -h], [r, h], [0.0, h]], e)
            }
            PrimitiveShape::Cone([r, h]) => {
                revolve(&[[0.0, -h * 0.5], [r, -h * 0.5], [0.0, h * 0.5]], e)
            }
            PrimitiveShape::Torus([a, b]) => {
                let n = (TAU * b / e).ceil().max(8.0) as u32;
                let mut profile: Vec<[f64; 2]> = (0..n)
                    .map(|k| {
                        let (s, c) = (TAU * f64::from(k) / f64::from(n)).portable_sin_cos();
                        [a + b * c, b * s]
                    })
                    .collect();
                profile.push(profile[0]);
                revolve(&profile, e)
            }
            PrimitiveShape::Tube([o, i, h]) => {
                let h = h * 0.5;
                revolve(&[[o, -h], [o, h], [i, h], [i, -h], [o, -h]], e)
            }
            PrimitiveShape::Plane([x, z]) => plane(x, z, e),
        })
    }
}

fn parts(length: f64, edge: f64) -> u32 {
    (length / edge).round().max(1.0) as u32
}

fn plane(x: f64, z: f64, edge: f64) -> TriMesh {
    let (nx, nz) = (parts(x, edge), parts(z, edge));
    let mut mesh = TriMesh { positions: Vec::new(), triangles: Vec::new(), colours: None };
    for j in 0..=nz {
        for i in 0..=nx {
            let (u, v) = (f64::from(i) / f64::from(nx), f64::from(j) / f64::from(nz));
            let p = DVec3::new((u - 0.5) * x, 0.0, (v - 0.5) * z);
            mesh.positions.push(p.as_vec3());
        }
    }
    let at = |i: u32, j: u32| j * (nx + 1) + i;
    for j in 0..nz {
        for i in 0..nx {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            // The diagonals alternate, so that no direction is stiffer.
            let both =
                if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            mesh.triangles.extend(both);
        }
    }
    mesh
}

/// Six grids that share the vertices of their edges.
fn cuboid(sides: DVec3, edge: f64) -> TriMesh {
    let n = [parts(sides.x, edge), parts(sides.y, edge), parts(sides.z, edge)];
    let mut mesh = TriMesh { positions: Vec::new(), triangles: Vec::new(), colours: None };
    // Vertices on a side, by their place in the lattice; few are there of all that the lattice has.
    let mut known = std::collections::BTreeMap::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for far in [false, true] {
            for j in 0..n[v] {
                for i in 0..n[u] {
                    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
                        let mut at = [0; 3];
                        at[axis] = if far { n[axis] } else { 0 };
                        (at[u], at[v]) = (i, j);
                        *known.entry(at).or_insert_with(|| {
                            let share = |k: usize| f64::from(at[k]) / f64::from(n[k]) - 0.5;
                            let p = DVec3::new(share(0), share(1), share(2)) * sides;
                            mesh.positions.push(p.as_vec3());
                            mesh.positions.len() as u32 - 1
                        })
                    });
                    let [a, b, c, d] = corners;
                    let both = if (i + j) % 2 == 0 {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    };
                    mesh.triangles
                        .extend(both.map(|[a, b, c]| if far { [a, b, c] } else { [a, c, b] }));
                }
            }
        }
    }
    mesh
}

/// The surface that a profile of (radius, height) makes about +y; outwards is to the right of the
/// profile as it rises. A profile that ends where it began is closed.
fn revolve(profile: &[[f64; 2]], edge: f64) -> TriMesh {
    // Rows lie as far apart as the height of an even triangle.
    let step = edge * 3f64.sqrt() * 0.5;
    let mut line: Vec<DVec2> = Vec::new();
    for pair in profile.windows(2) {
        let (a, b) = (DVec2::from(pair[0]), DVec2::from(pair[1]));
        let n = parts((b - a).length(), step);
        line.extend((0..n).map(|k| a.lerp(b, f64::from(k) / f64::from(n))));
    }
    let closed = profile.first() == profile.last();
    if !closed {
        line.extend(profile.last().map(|p| DVec2::from(*p)));
    }
    let mut mesh = TriMesh { positions: Vec::new(), triangles: Vec::new(), colours: None };
    let mut rings: Vec<Ring> = Vec::with_capacity(line.len());
    for (row, p) in line.iter().enumerate() {
        let count = if p.x <= 0.0 { 1 } else { (TAU * p.x / edge).round().max(4.0) as u32 };
        // Every other row is turned by half a step, for even triangles.
        let turned = if row % 2 == 0 { 0.0 } else { 0.5 };
        let ring = Ring { first: mesh.positions.len() as u32, count, turned };
        for k in 0..count {
            let (s, c) = ring.angle(k).portable_sin_cos();
            mesh.positions.push(Vec3::new((p.x * c) as f32, p.y as f32, (p.x * s) as f32));
        }
        rings.push(ring);
    }
    for pair in rings.windows(2) {
        join(&pair[0], &pair[1], &mut mesh.triangles);
    }
    if let [first, .., last] = &rings[..]
        && closed
    {
        join(last, first, &mut mesh.triangles);
    }
    mesh
}

/// Vertices about the axis, from `first` on.
struct Ring {
    first: u32,
    count: u32,
    /// Steps by which the first is turned.
    turned: f64,
}

impl Ring {
    fn angle(&self, k: u32) -> f64 {
        (f64::from(k) + self.turned) / f64::from(self.count) * TAU
    }

    fn vertex(&self, k: u32) -> u32 {
        self.first + k % self.count
    }
}

/// Triangles between a ring and the next one of the profile.
fn join(low: &Ring, high: &Ring, out: &mut Vec<[u32; 3]>) {
    // A ring of one vertex is a pole and has no sides.
    let sides = |ring: &Ring| if ring.count == 1 { 0 } else { ring.count };
    let (a_sides, b_sides) = (sides(low), sides(high));
    let (mut a, mut b) = (0, 0);
    while a < a_sides || b < b_sides {
        let forward_low = b == b_sides || (a < a_sides && low.angle(a + 1) <= high.angle(b + 1));
        let (p, q) = (low.vertex(a), high.vertex(b));
        if forward_low {
            out.push([p, q, low.vertex(a + 1)]);
            a += 1;
        } else {
            out.push([p, q, high.vertex(b + 1)]);
            b += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [(PrimitiveShape, f64, bool); 7] = [
        (PrimitiveShape::Box([2.0, 3.0, 1.0]), 6.0, true),
        (PrimitiveShape::Ball(1.0), 4.188_790_2, true),
        (PrimitiveShape::Cylinder([1.0, 2.0]), TAU, true),
        (PrimitiveShape::Cone([1.0, 3.0]), TAU * 0.5, true),
        (PrimitiveShape::Torus([2.0, 0.5]), 9.869_604_4, true),
        (PrimitiveShape::Tube([2.0, 1.0, 1.0]), 9.424_777_9, true),
        (PrimitiveShape::Plane([2.0, 1.0]), 0.0, false),
    ];

    #[test]
    fn each_is_closed_faces_outwards_and_has_even_triangles() {
        for (shape, volume, closed) in ALL {
            let edge = shape.usual_edge();
            let mesh = Primitive { shape, edge }.triangles().expect("in range");
            let about = mesh.positions.len();
            assert!((15_000..30_000).contains(&about), "{shape:?}: {about} vertices");
            let mut edges: Vec<(u32, u32)> = mesh
                .triangles
                .iter()
                .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
                .collect();
            edges.sort_unstable();
            assert!(edges.windows(2).all(|w| w[0] != w[1]), "{shape:?}: an edge twice");
            let whole = edges.iter().all(|(a, b)| edges.binary_search(&(*b, *a)).is_ok());
            assert_eq!(whole, closed, "{shape:?}");
            let at = |v: u32| mesh.positions[v as usize].as_dvec3();
            let found: f64 =
                mesh.triangles.iter().map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0).sum();
            assert!((found - volume).abs() <= 0.005 * volume.max(1.0), "{shape:?}: {found}");
            let long = edges.iter().map(|(a, b)| (at(*a) - at(*b)).length()).fold(0.0, f64::max);
            let short = edges.iter().map(|(a, b)| (at(*a) - at(*b)).length()).fold(1e9, f64::min);
            assert!(
                long < 1.8 * edge && short > 0.3 * edge,
                "{shape:?}: {short} to {long}, {edge}"
            );
            if !closed {
                let up = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).y > 0.0;
                assert!(mesh.triangles.iter().all(up), "{shape:?} faces up");
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        for (shape, edge) in [
            (PrimitiveShape::Ball(0.0), 0.1),
            (PrimitiveShape::Ball(f64::NAN), 0.1),
            (PrimitiveShape::Ball(1.0), 0.0),
            (PrimitiveShape::Ball(1.0), 1e-5),
            (PrimitiveShape::Torus([1.0, 1.0]), 0.1),
            (PrimitiveShape::Tube([1.0, 2.0, 1.0]), 0.1),
            (PrimitiveShape::Box([1.0, 1.0, 1e7]), 1.0),
        ] {
            assert_eq!(
                Primitive { shape, edge }.triangles().err(),
                Some(BadPrimitive),
                "{shape:?}"
            );
        }
    }
}
