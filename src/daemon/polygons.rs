//! The polygons of loaded files, so that an object whose topology nothing changed is written with
//! the faces of its file.
//!
//! Clay is made of triangles. Which polygon each belongs to follows from the list of triangles
//! alone, and strokes, masks, transforms, undo and duplicates leave that list as it is. So the
//! polygons are kept beside the scene under a hash of that list, and found again whenever an object
//! is written; whatever changes triangles gives a list that is not here. The list is compared as a
//! whole before it is believed.
//!
//! Not promised: a session that is opened again has triangles, until its file is loaded again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use sculptd_geometry::{PolyMesh, TriMesh};

/// Bytes that are kept; the oldest go first.
const MOST_BYTES: usize = 1 << 30;

/// The faces of a file.
#[derive(Debug)]
struct FileFaces {
    key: u64,
    /// The list that they were cut into.
    triangles: Vec<[u32; 3]>,
    /// The mesh of the file.
    mesh: PolyMesh,
}

impl FileFaces {
    fn bytes(&self) -> usize {
        let m = &self.mesh;
        self.triangles.len() * 12
            + m.positions.len() * 24
            + (m.corners.len() + m.face_starts.len()) * 4
            + m.groups.as_ref().map_or(0, |g| g.len() * 4)
            + m.colours.as_ref().map_or(0, |c| c.len() * 4)
    }
}

/// The polygons of the files that this process has loaded.
#[derive(Debug, Default)]
pub struct PolygonStore {
    files: Mutex<VecDeque<Arc<FileFaces>>>,
}

/// One for the process: meshes are loaded by the command line, the window and the control socket.
static STORE: PolygonStore = PolygonStore { files: Mutex::new(VecDeque::new()) };

/// FNV-1a over the corners, a word at a time.
fn key(vertices: usize, triangles: &[[u32; 3]]) -> u64 {
    let start = (0xcbf2_9ce4_8422_2325u64 ^ vertices as u64).wrapping_mul(0x0000_0100_0000_01b3);
    let eat = |h: u64, v: &u32| (h ^ u64::from(*v)).wrapping_mul(0x0000_0100_0000_01b3);
    triangles.iter().flatten().fold(start, eat)
}

impl PolygonStore {
    /// Keeps the faces of a file that were cut into these triangles.
    pub fn remember(&self, mesh: PolyMesh, plain: &TriMesh) {
        if mesh.face_count() == plain.triangles.len() && mesh.groups.is_none() {
            return;
        }
        let key = key(plain.positions.len(), &plain.triangles);
        let new = Arc::new(FileFaces { key, triangles: plain.triangles.clone(), mesh });
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.retain(|f| f.key != key);
        files.push_back(new);
        while files.len() > 1 && files.iter().map(|f| f.bytes()).sum::<usize>() > MOST_BYTES {
            files.pop_front();
        }
    }

    /// An object's mesh with the faces and groups of its file, where its triangles are still those
    /// of the file; else its triangles. A coordinate that is where the file had it has the file's
    /// double precision: rows of vertices that a stroke moves only upwards stay rows.
    pub fn polygons(&self, plain: &TriMesh) -> PolyMesh {
        let key = key(plain.positions.len(), &plain.triangles);
        let found = {
            let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
            files.iter().find(|f| f.key == key).cloned()
        };
        let same = |f: &Arc<FileFaces>| {
            f.triangles == plain.triangles && f.mesh.positions.len() == plain.positions.len()
        };
        let Some(file) = found.filter(same) else { return plain.to_poly() };
        let place = |(now, then): (&glam::Vec3, &glam::DVec3)| {
            glam::DVec3::select(then.as_vec3().cmpeq(*now), *then, now.as_dvec3())
        };
        let positions = plain.positions.iter().zip(&file.mesh.positions).map(place).collect();
        PolyMesh { positions, colours: plain.colours.clone(), ..file.mesh.clone() }
    }
}

/// Keeps the faces of a file for this process.
pub fn remember(mesh: PolyMesh, plain: &TriMesh) {
    STORE.remember(mesh, plain);
}

/// As [`PolygonStore::polygons`], of the files that this process has loaded.
pub fn polygons(plain: &TriMesh) -> PolyMesh {
    STORE.polygons(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};
    use sculptd_geometry::shapes;

    #[test]
    fn quads_come_back_until_a_triangle_is_another() {
        let store = PolygonStore::default();
        let mut quads = shapes::torus(3.0, 1.0, 24, 12);
        quads.groups = Some((0..quads.face_count() as u32).map(|f| f / 100).collect());
        quads.positions.iter_mut().for_each(|p| *p += DVec3::splat(0.1));
        let mut plain = quads.triangulate().0;
        assert_eq!(store.polygons(&plain), plain.to_poly(), "of a file that was never loaded");
        store.remember(quads.clone(), &plain);
        assert_eq!(store.polygons(&plain), quads, "to the bit, where nothing moved");
        plain.positions[7] += Vec3::Y;
        let moved = store.polygons(&plain);
        assert_eq!((&moved.corners, &moved.groups), (&quads.corners, &quads.groups));
        let raised = f64::from(plain.positions[7].y);
        assert_eq!(moved.positions[7], DVec3 { y: raised, ..quads.positions[7] });
        assert_eq!(moved.positions[8], quads.positions[8]);
        plain.triangles.swap(3, 4);
        assert_eq!(store.polygons(&plain), plain.to_poly());
    }
}
