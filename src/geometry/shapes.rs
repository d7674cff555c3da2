//! Primitive solids, for the start of a session, as tools, and to measure with. All closed ones are
//! oriented outwards.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::{PolyMesh, TriMesh};
use crate::portable::PortableMath;

fn poly(positions: Vec<DVec3>, faces: impl IntoIterator<Item = impl AsRef<[u32]>>) -> PolyMesh {
    let mut mesh = PolyMesh::new();
    mesh.positions = positions;
    for f in faces {
        mesh.push_face(f.as_ref());
    }
    mesh
}

/// The box from `min` to `max`: 8 vertices, 6 quadrilaterals.
pub fn cuboid(min: DVec3, max: DVec3) -> PolyMesh {
    let positions = (0..8)
        .map(|i| {
            let pick = |bit: u32, lo: f64, hi: f64| if i & bit == 0 { lo } else { hi };
            DVec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z))
        })
        .collect();
    poly(
        positions,
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]],
    )
}

/// A flat sheet in the plane z = 0, centred, of `nx` by `ny` quadrilaterals (at least 1); open.
pub fn grid(size_x: f64, size_y: f64, nx: u32, ny: u32) -> PolyMesh {
    let (nx, ny) = (nx.max(1), ny.max(1));
    let mut positions = Vec::with_capacity((nx as usize + 1) * (ny as usize + 1));
    for j in 0..=ny {
        for i in 0..=nx {
            let (u, v) = (i as f64 / nx as f64 - 0.5, j as f64 / ny as f64 - 0.5);
            positions.push(DVec3::new(u * size_x, v * size_y, 0.0));
        }
    }
    let at = |i, j| j * (nx + 1) + i;
    let faces = (0..ny)
        .flat_map(|j| {
            (0..nx).map(move |i| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
        })
        .collect::<Vec<_>>();
    poly(positions, faces)
}

/// Rings of `around` vertices (at least 3), from the first to the last, closed by one polygon at
/// either end. `rings`: (radius, z), z rising for an outside that faces out.
fn lathe(rings: &[(f64, f64)], around: u32) -> PolyMesh {
    let n = around.max(3);
    let mut positions = Vec::new();
    let mut mesh = PolyMesh::new();
    let mut start = Vec::new();
    for &(r, z) in rings {
        start.push((positions.len() as u32, r > 0.0));
        if r > 0.0 {
            positions.extend((0..n).map(|i| {
                let (s, c) = (TAU * i as f64 / n as f64).portable_sin_cos();
                DVec3::new(r * c, r * s, z)
            }));
        } else {
            positions.push(DVec3::new(0.0, 0.0, z));
        }
    }
    mesh.positions = positions;
    if let (Some(&(s, true)), Some(&(e, last))) = (start.first(), start.last()) {
        mesh.push_face(&(0..n).rev().map(|i| s + i).collect::<Vec<_>>());
        if last {
            mesh.push_face(&(0..n).map(|i| e + i).collect::<Vec<_>>());
        }
    }
    for w in start.windows(2) {
        let ((a, wide_a), (b, wide_b)) = (w[0], w[1]);
        for i in 0..n {
            let j = (i + 1) % n;
            match (wide_a, wide_b) {
                (true, true) => mesh.push_face(&[a + i, a + j, b + j, b + i]),
                (true, false) => mesh.push_face(&[a + i, a + j, b]),
                (false, true) => mesh.push_face(&[a, b + j, b + i]),
                (false, false) => {}
            }
        }
    }
    mesh
}

/// Around the z axis, centred: two polygons of `around` corners and `around` quadrilaterals.
pub fn cylinder(radius: f64, height: f64, around: u32) -> PolyMesh {
    lathe(&[(radius, -height / 2.0), (radius, height / 2.0)], around)
}

/// Base at z = 0, tip at z = `height`.
pub fn cone(radius: f64, height: f64, around: u32) -> PolyMesh {
    lathe(&[(radius, 0.0), (0.0, height)], around)
}

/// By latitude and longitude, poles on the z axis: quadrilaterals, triangles at the poles. `rings`
/// >= 2, `around` >= 3.
pub fn uv_sphere(radius: f64, rings: u32, around: u32) -> PolyMesh {
    let rings = rings.max(2);
    let profile: Vec<(f64, f64)> = (0..=rings)
        .map(|i| {
            let (s, c) = (PI * i as f64 / rings as f64).portable_sin_cos();
            (if i == 0 || i == rings { 0.0 } else { radius * s }, -radius * c)
        })
        .collect();
    lathe(&profile, around)
}

/// Around the z axis: `major` from the axis to the tube's middle, `minor` the tube's radius.
pub fn torus(major: f64, minor: f64, around: u32, across: u32) -> PolyMesh {
    let (n, m) = (around.max(3), across.max(3));
    let mut positions = Vec::with_capacity((n * m) as usize);
    for i in 0..n {
        let (si, ci) = (TAU * i as f64 / n as f64).portable_sin_cos();
        for j in 0..m {
            let (sj, cj) = (TAU * j as f64 / m as f64).portable_sin_cos();
            let r = major + minor * cj;
            positions.push(DVec3::new(r * ci, r * si, minor * sj));
        }
    }
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let faces = (0..n)
        .flat_map(|i| (0..m).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
        .collect::<Vec<_>>();
    poly(positions, faces)
}

/// The regular icosahedron's corners on the unit sphere and its outward faces.
fn icosahedron() -> ([DVec3; 12], [[u32; 3]; 20]) {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut p = [DVec3::ZERO; 12];
    for (n, (a, b)) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)].into_iter().enumerate() {
        p[n] = DVec3::new(a, b, 0.0);
        p[n + 4] = DVec3::new(0.0, a, b);
        p[n + 8] = DVec3::new(b, 0.0, a);
    }
    let f = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (p.map(DVec3::normalize), f)
}

/// A sphere of the icosahedron's 20 faces, each in `frequency` squared triangles (1 to 10,000): 10
/// f^2 + 2 vertices. Triangles near the middle of a face of the icosahedron are larger than those
/// at its corners.
pub fn icosphere(radius: f32, frequency: u32) -> TriMesh {
    let f = frequency.clamp(1, 10_000);
    let (corners, faces) = icosahedron();
    let count = 10 * f as usize * f as usize + 2;
    let mut positions: Vec<Vec3> = Vec::with_capacity(count);
    let place = |p: DVec3| (p.normalize() * radius as f64).as_vec3();
    positions.extend(corners.iter().map(|&c| place(c)));
    // Each edge's inner vertices, from the lower corner to the higher.
    let mut edges = [[u32::MAX; 12]; 12];
    for [a, b, c] in faces {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            let (lo, hi) = (i.min(j) as usize, i.max(j) as usize);
            if edges[lo][hi] == u32::MAX {
                edges[lo][hi] = positions.len() as u32;
                positions.extend(
                    (1..f).map(|k| place(corners[lo].lerp(corners[hi], k as f64 / f as f64))),
                );
            }
        }
    }
    let mut triangles = Vec::with_capacity(20 * f as usize * f as usize);
    for [a, b, c] in faces {
        let inner = positions.len() as u32;
        // Row j of f - j + 1 vertices runs from the side a-c to the side b-c.
        for j in 1..f {
            for i in 1..f - j {
                let (u, v) = (i as f64 / f as f64, j as f64 / f as f64);
                let [pa, pb, pc] = [a, b, c].map(|n| corners[n as usize]);
                positions.push(place(pa * (1.0 - u - v) + pb * u + pc * v));
            }
        }
        let on_edge = |from: u32, to: u32, k: u32| match k {
            0 => from,
            k if k == f => to,
            k if from < to => edges[from as usize][to as usize] + k - 1,
            k => edges[to as usize][from as usize] + (f - k) - 1,
        };
        let at = |i: u32, j: u32| {
            if j == 0 {
                on_edge(a, b, i)
            } else if i == 0 {
                on_edge(a, c, j)
            } else if i + j == f {
                on_edge(b, c, j)
            } else {
                // Rows before j hold f - 2, f - 3, ... inner vertices.
                let before = (j - 1) as u64 * (2 * f as u64 - 2 - j as u64) / 2;
                inner + before as u32 + i - 1
            }
        };
        for j in 0..f {
            for i in 0..f - j {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + 1 < f - j {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    TriMesh { positions, triangles, colours: None }
}

/// The [`icosphere`] of radius 1 whose vertex count is nearest to `vertices`; from 12 up to a
/// billion.
pub fn sphere_of_about(vertices: usize) -> TriMesh {
    let frequency = ((vertices.max(12) - 2) as f64 / 10.0).sqrt().round();
    icosphere(1.0, frequency as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every edge once each way, and the volume.
    fn closed_volume(mesh: &PolyMesh) -> f64 {
        let mut edges: Vec<(u32, u32)> = mesh
            .faces()
            .flat_map(|f| (0..f.len()).map(|i| (f[i], f[(i + 1) % f.len()])).collect::<Vec<_>>())
            .collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|w| w[0] != w[1]));
        assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()));
        let (t, _) = mesh.triangles();
        t.iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    #[test]
    fn solids_are_closed_and_have_their_volumes() {
        let near = |a: f64, b: f64, e: f64| assert!((a - b).abs() < e * b, "{a} {b}");
        near(closed_volume(&cuboid(DVec3::new(1., 2., 3.), DVec3::new(2., 4., 6.))), 6.0, 1e-14);
        near(closed_volume(&cylinder(2.0, 3.0, 1000)), PI * 12.0, 1e-4);
        near(closed_volume(&cone(2.0, 3.0, 1000)), PI * 4.0, 1e-4);
        near(closed_volume(&uv_sphere(2.0, 200, 400)), PI * 32.0 / 3.0, 1e-3);
        near(closed_volume(&torus(3.0, 1.0, 300, 200)), 2.0 * PI * PI * 3.0, 1e-3);
        for f in [1, 2, 3, 7, 40] {
            let m = icosphere(2.0, f);
            assert_eq!(m.positions.len(), 10 * (f * f) as usize + 2);
            assert_eq!(m.triangles.len(), 20 * (f * f) as usize);
            let v = closed_volume(&m.to_poly());
            assert!(v > 0.0);
            if f == 40 {
                near(v, PI * 32.0 / 3.0, 1e-2);
            }
        }
        assert_eq!(grid(1.0, 1.0, 3, 2).face_count(), 6);
        assert_eq!(sphere_of_about(20_000).positions.len(), 10 * 45 * 45 + 2);
    }
}
