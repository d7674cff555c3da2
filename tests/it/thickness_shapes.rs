//! Shapes of which the thickness is known, and seeded randomness.

use glam::Vec3;
use sculptd::mesh::TriMesh;

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
