//! The solid as a field: distances, signs, grids, projections, remeshing.

mod distance;
mod projection;
mod remesh;

use std::path::{Path, PathBuf};

use glam::DVec3;
use sculptd_geometry::TriMesh;
use sculptd_geometry::io::read_mesh;
use sculptd_geometry::job::Job;

/// A small generator: splitmix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn within(&mut self, lo: DVec3, hi: DVec3) -> DVec3 {
        lo + (hi - lo) * DVec3::new(self.unit(), self.unit(), self.unit())
    }
}

pub fn load(path: &Path) -> Option<TriMesh> {
    let loaded = read_mesh(path, &Job::default()).ok()?;
    Some(loaded.mesh.triangulate().0).filter(|m| !m.triangles.is_empty())
}

/// The corpus's meshes of at most `most` triangles, with their names, in order.
pub fn meshes(most: usize) -> Vec<(String, TriMesh)> {
    let Some(corpus) = crate::corpus() else { return Vec::new() };
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(corpus.join("meshes")).unwrap().flatten().map(|e| e.path()).collect();
    paths.sort();
    paths
        .into_iter()
        .filter(|p| p.metadata().is_ok_and(|m| m.len() < 6_000_000))
        .filter_map(|p| Some((p.file_name()?.to_string_lossy().into_owned(), load(&p)?)))
        .filter(|(_, m)| m.triangles.len() <= most)
        // One holds the largest number there is as a coordinate.
        .filter(|(_, m)| m.bounds().1.max_element() < 1e15)
        .collect()
}

pub fn long() -> bool {
    std::env::var_os("SCULPTD_LONG").is_some()
}

pub fn bounds(mesh: &TriMesh) -> (DVec3, DVec3) {
    let (lo, hi) = mesh.bounds();
    (lo.as_dvec3(), hi.as_dvec3())
}

/// Every edge as often one way as the other, and by two faces only.
pub fn manifold(mesh: &TriMesh) -> bool {
    let mut edges: Vec<(u32, u32)> =
        mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    edges.sort_unstable();
    edges.windows(2).all(|w| w[0] != w[1])
        && edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok())
}
