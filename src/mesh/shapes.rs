//! Primitive solids, for the start of a session and as tools.

use glam::Vec3;

use super::TriMesh;

/// A ball of radius 1 with about `vertices` vertices: a cube's faces as grids, pushed out to the sphere.
pub fn sphere_of_about(vertices: usize) -> TriMesh {
    let n = ((vertices.max(8) - 2) as f64 / 6.0).sqrt().round().max(1.0) as i32;
    let mut ids = std::collections::BTreeMap::new();
    let mut mesh = TriMesh::default();
    let mut vertex = |p: [i32; 3], mesh: &mut TriMesh| {
        *ids.entry(p).or_insert_with(|| {
            // Equal angles rather than equal steps: cells of more even size.
            let q = p.map(|v| (f64::from(v) / f64::from(n) * std::f64::consts::FRAC_PI_4).tan() as f32);
            mesh.positions.push(Vec3::from_array(q).normalize());
            mesh.positions.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        for side in [-n, n] {
            for i in (-n..n).step_by(2) {
                for j in (-n..n).step_by(2) {
                    let at = |u: i32, v: i32| {
                        let mut p = [0; 3];
                        p[axis] = side;
                        p[(axis + 1) % 3] = u;
                        p[(axis + 2) % 3] = v;
                        p
                    };
                    let corners = [at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)];
                    let [a, b, c, d] = corners.map(|p| vertex(p, &mut mesh));
                    let quads = if side > 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                    mesh.triangles.extend(quads);
                }
            }
        }
    }
    mesh
}
