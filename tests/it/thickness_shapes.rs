//! Shapes of which the thickness is known, and seeded randomness.

use glam::Vec3;
use sculptd_geometry::TriMesh;

/// SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to 1, 1 excluded.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// Of unit length, all directions alike.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let z = self.unit() * 2.0 - 1.0;
        let (s, c) = (self.unit() * std::f32::consts::TAU).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * c, r * s, z)
    }
}

/// A globe of `rings` by `sectors`, closed.
pub(crate) fn sphere(radius: f32, rings: usize, sectors: usize) -> TriMesh {
    let mut mesh = TriMesh::default();
    mesh.positions.push(Vec3::Z * radius);
    for r in 1..rings {
        let (st, ct) = (std::f64::consts::PI * r as f64 / rings as f64).sin_cos();
        for s in 0..sectors {
            let (sp, cp) = (std::f64::consts::TAU * s as f64 / sectors as f64).sin_cos();
            mesh.positions.push((glam::DVec3::new(st * cp, st * sp, ct) * radius as f64).as_vec3());
        }
    }
    mesh.positions.push(Vec3::NEG_Z * radius);
    let last = mesh.positions.len() as u32 - 1;
    let at = |r: usize, s: usize| (1 + (r - 1) * sectors + s % sectors) as u32;
    for s in 0..sectors {
        mesh.triangles.push([0, at(1, s), at(1, s + 1)]);
        for r in 1..rings - 1 {
            mesh.triangles.push([at(r, s), at(r + 1, s), at(r + 1, s + 1)]);
            mesh.triangles.push([at(r, s), at(r + 1, s + 1), at(r, s + 1)]);
        }
        mesh.triangles.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
    }
    mesh
}

/// Joins `other` to `mesh`.
pub(crate) fn join(mut mesh: TriMesh, other: &TriMesh) -> TriMesh {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + base)));
    mesh
}

/// The same surface seen from the other side.
pub(crate) fn flipped(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// Two concentric globes, the inner one a cavity.
pub(crate) fn shell(outer: f32, inner: f32, rings: usize) -> TriMesh {
    join(sphere(outer, rings, rings * 2), &flipped(sphere(inner, rings, rings * 2)))
}

/// A hollow cylinder along z.
pub(crate) fn tube(
    outer: f32,
    inner: f32,
    length: f32,
    sectors: usize,
    rows: usize,
    across: usize,
) -> TriMesh {
    let mut mesh = TriMesh::default();
    // Once round the wall's section: up the outside, in over the top, down the inside, out over the
    // bottom.
    let mut section = Vec::new();
    for i in 0..rows {
        section.push((outer, length * i as f32 / rows as f32));
    }
    for i in 0..across {
        section.push((outer + (inner - outer) * i as f32 / across as f32, length));
    }
    for i in 0..rows {
        section.push((inner, length * (rows - i) as f32 / rows as f32));
    }
    for i in 0..across {
        section.push((inner + (outer - inner) * i as f32 / across as f32, 0.0));
    }
    let n = section.len();
    for s in 0..sectors {
        let (sin, cos) = (std::f64::consts::TAU * s as f64 / sectors as f64).sin_cos();
        for &(r, z) in &section {
            mesh.positions.push(Vec3::new((r as f64 * cos) as f32, (r as f64 * sin) as f32, z));
        }
    }
    let at = |s: usize, i: usize| ((s % sectors) * n + i % n) as u32;
    for s in 0..sectors {
        for i in 0..n {
            mesh.triangles.push([at(s, i), at(s + 1, i), at(s + 1, i + 1)]);
            mesh.triangles.push([at(s, i), at(s + 1, i + 1), at(s, i + 1)]);
        }
    }
    mesh
}

/// The surface of the cells of a grid that are solid; `planes` are the grid's coordinates on each
/// axis.
pub(crate) fn cells(planes: [&[f32]; 3], solid: impl Fn([usize; 3]) -> bool) -> TriMesh {
    let mut mesh = TriMesh::default();
    let n = planes.map(|p| p.len());
    let mut known = vec![u32::MAX; n[0] * n[1] * n[2]];
    let filled = |c: [isize; 3]| {
        (0..3).all(|a| c[a] >= 0 && (c[a] as usize) < n[a] - 1) && solid(c.map(|x| x as usize))
    };
    for k in 0..n[2] as isize - 1 {
        for j in 0..n[1] as isize - 1 {
            for i in 0..n[0] as isize - 1 {
                let cell = [i, j, k];
                if !filled(cell) {
                    continue;
                }
                for axis in 0..3 {
                    for side in 0..2isize {
                        let mut next = cell;
                        next[axis] += side * 2 - 1;
                        if filled(next) {
                            continue;
                        }
                        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                        let mut corner = |du: isize, dv: isize| {
                            let mut c = cell;
                            c[axis] += side;
                            c[u] += du;
                            c[v] += dv;
                            let c = c.map(|x| x as usize);
                            let slot = &mut known[(c[2] * n[1] + c[1]) * n[0] + c[0]];
                            if *slot == u32::MAX {
                                *slot = mesh.positions.len() as u32;
                                mesh.positions.push(Vec3::new(
                                    planes[0][c[0]],
                                    planes[1][c[1]],
                                    planes[2][c[2]],
                                ));
                            }
                            *slot
                        };
                        let q = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                        let two = [[q[0], q[1], q[2]], [q[0], q[2], q[3]]];
                        mesh.triangles.extend(if side == 1 {
                            two
                        } else {
                            two.map(|t| [t[0], t[2], t[1]])
                        });
                    }
                }
            }
        }
    }
    mesh
}

/// `cells + 1` planes from `from` to `to`.
pub(crate) fn planes(from: f32, to: f32, cells: usize) -> Vec<f32> {
    (0..=cells).map(|i| from + (to - from) * i as f32 / cells as f32).collect()
}

/// A plate of `size`, `n` cells a side, one cell thick.
pub(crate) fn slab(size: f32, thickness: f32, n: usize) -> TriMesh {
    let side = planes(0.0, size, n);
    cells([&side, &side, &[0.0, thickness]], |_| true)
}

/// Between z = 0 and z = x tan(angle), from x = 20 to x = 60.
pub(crate) fn wedge(angle: f32, n: usize) -> TriMesh {
    let mut mesh = cells([&planes(20.0, 60.0, n), &planes(0.0, 40.0, n), &[0.0, 1.0]], |_| true);
    for p in &mut mesh.positions {
        p.z = (p.z as f64 * p.x as f64 * (angle as f64).tan()) as f32;
    }
    mesh
}

/// A plate 3 thick with ribs 2 thick and 12 high, at x = 10 to 12, 22 to 24, 34 to 36.
pub(crate) fn ribbed() -> TriMesh {
    let x = planes(0.0, 46.0, 46);
    let y = planes(0.0, 30.0, 30);
    let z = planes(0.0, 15.0, 15);
    cells([&x, &y, &z], |c| c[2] < 3 || matches!(c[0], 10..12 | 22..24 | 34..36))
}
