//! The polygons of loaded files, so that an object whose topology nothing changed is written with
//! the faces of its file.
//!
//! Clay is made of triangles. Which polygon each belongs to follows from the list of triangles
//! alone, and strokes, masks, transforms, undo and duplicates leave that list as it is. So the
//! polygons are kept beside the scene under a hash of that list, and found again whenever an object
//! is written; whatever changes triangles gives a list that is not here. The list is compared as a
//! whole before it is believed.
//!
//! After a change of triangles (a Boolean, triangles cut under a brush, remeshing a part), the
//! faces whose triangles are all still there, corner by corner in their place, stay polygons; they
//! are found by the places alone, so what was moved as well is triangles.
//!
//! A session keeps those of its objects, see `session::stored_polygons`, and gives them back where
//! it is opened again.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use sculptd_clay::Snapshot;
use sculptd_geometry::face_attributes::NO_UV;
use sculptd_geometry::{FaceAttributes, GroupName, PolyMesh, TriMesh};

/// Bytes that are kept; the oldest go first.
const MOST_BYTES: usize = 1 << 30;

/// The faces of a file.
#[derive(Debug)]
pub struct FileFaces {
    /// The hash of the triangles, used to find them.
    pub key: u64,
    /// The list of triangles that the faces were cut into.
    triangles: Vec<[u32; 3]>,
    /// The mesh of the file.
    mesh: PolyMesh,
}

/// The faces of a file as stored in a session.
#[derive(Debug, Serialize, Deserialize)]
struct StoredFaces {
    triangles: Vec<[u32; 3]>,
    positions: Vec<glam::DVec3>,
    face_starts: Vec<u32>,
    corners: Vec<u32>,
    groups: Option<Vec<u32>>,
    attributes: Option<FaceAttributes>,
}

impl FileFaces {
    /// As bytes, for a session.
    ///
    /// # Errors
    /// Never with plain data such as this.
    pub fn to_bytes(&self) -> Result<Vec<u8>, postcard::Error> {
        let mesh = &self.mesh;
        postcard::to_stdvec(&StoredFaces {
            triangles: self.triangles.clone(),
            positions: mesh.positions.clone(),
            face_starts: mesh.face_starts.clone(),
            corners: mesh.corners.clone(),
            groups: mesh.groups.clone(),
            attributes: mesh.attributes.as_deref().cloned(),
        })
    }

    /// From the bytes of a session; `None` where they are not those of a mesh.
    fn from_bytes(bytes: &[u8]) -> Option<FileFaces> {
        let StoredFaces { triangles, positions, face_starts, corners, groups, attributes } =
            postcard::from_bytes(bytes).ok()?;
        let count = positions.len();
        let attributes = attributes.map(Arc::new);
        let mesh =
            PolyMesh { positions, face_starts, corners, groups, attributes, ..PolyMesh::new() };
        let named = |v: &u32| (*v as usize) < count;
        let sound = mesh.face_starts.first() == Some(&0)
            && mesh.face_starts.last().is_some_and(|l| *l as usize == mesh.corners.len())
            && mesh.face_starts.is_sorted()
            && mesh.corners.iter().chain(triangles.iter().flatten()).all(named)
            && mesh.groups.as_ref().is_none_or(|g| g.len() == mesh.face_count());
        sound.then(|| FileFaces { key: key(count, &triangles), triangles, mesh })
    }

    fn bytes(&self) -> usize {
        let m = &self.mesh;
        self.triangles.len() * 12
            + m.positions.len() * 24
            + (m.corners.len() + m.face_starts.len()) * 4
            + m.groups.as_ref().map_or(0, |g| g.len() * 4)
            + m.colours.as_ref().map_or(0, |c| c.len() * 4)
            + m.attributes.as_ref().map_or(0, |a| a.bytes())
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
        let bare = mesh.groups.is_none() && mesh.attributes.is_none();
        if mesh.face_count() == plain.triangles.len() && bare {
            return;
        }
        let key = key(plain.positions.len(), &plain.triangles);
        self.keep(FileFaces { key, triangles: plain.triangles.clone(), mesh });
    }

    fn keep(&self, new: FileFaces) {
        let (key, new) = (new.key, Arc::new(new));
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        files.retain(|f| f.key != key);
        files.push_back(new);
        while files.len() > 1 && files.iter().map(|f| f.bytes()).sum::<usize>() > MOST_BYTES {
            files.pop_front();
        }
    }

    /// The faces of the file that an object was loaded from, where its triangles are still those of
    /// the file. Looks at the triangles only where a file has as many.
    pub fn of(&self, clay: &Snapshot) -> Option<Arc<FileFaces>> {
        let (vertices, triangles) = (clay.vertex_count(), clay.triangle_count());
        let alike: Vec<Arc<FileFaces>> = {
            let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
            let fits = |f: &&Arc<FileFaces>| {
                f.triangles.len() == triangles && f.mesh.positions.len() == vertices
            };
            files.iter().filter(fits).cloned().collect()
        };
        if alike.is_empty() {
            return None;
        }
        let plain = clay.to_tri();
        alike.into_iter().find(|f| f.triangles == plain.triangles)
    }

    /// Takes faces out of a session. False: the bytes are not those of a mesh.
    pub fn restore(&self, bytes: &[u8]) -> bool {
        FileFaces::from_bytes(bytes).map(|faces| self.keep(faces)).is_some()
    }

    /// An object's mesh with the faces, groups, texture coordinates and names of its file, where
    /// its triangles are still those of the file; else with the faces that are still there, or its
    /// triangles. A coordinate that is where the file had it has the file's double precision: rows
    /// of vertices that a stroke moves only upwards stay rows.
    pub fn polygons(&self, plain: &TriMesh) -> PolyMesh {
        let key = key(plain.positions.len(), &plain.triangles);
        let found = {
            let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
            files.iter().find(|f| f.key == key).cloned()
        };
        let same = |f: &Arc<FileFaces>| {
            f.triangles == plain.triangles && f.mesh.positions.len() == plain.positions.len()
        };
        let Some(file) = found.filter(same) else {
            return self.untouched(plain).unwrap_or_else(|| plain.to_poly());
        };
        let place = |(now, then): (&glam::Vec3, &glam::DVec3)| {
            glam::DVec3::select(then.as_vec3().cmpeq(*now), *then, now.as_dvec3())
        };
        let positions = plain.positions.iter().zip(&file.mesh.positions).map(place).collect();
        PolyMesh { positions, colours: plain.colours.clone(), ..file.mesh.clone() }
    }
}

impl PolygonStore {
    /// Restores the faces of a file for an object whose triangles have changed. It uses the file
    /// with the most surviving faces: those whose triangles are all unchanged. The remaining
    /// triangles form a separate group. `None`: no face of any file survives.
    fn untouched(&self, plain: &TriMesh) -> Option<PolyMesh> {
        let files: Vec<Arc<FileFaces>> = {
            let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
            files.iter().cloned().collect()
        };
        if files.is_empty() {
            return None;
        }
        let places = TrianglesByPlace::of(plain);
        let found = files.iter().map(|f| (places.faces(f), f));
        let (faces, file) = found.max_by_key(|(faces, _)| faces.len())?;
        (!faces.is_empty()).then(|| places.mesh(plain, file, &faces))
    }
}

/// A face of a file that an object still has: its number, and its triangles there.
type FoundFace = (u32, std::ops::Range<usize>);

/// The vertices and triangles of an object by their places.
struct TrianglesByPlace {
    /// The bits of each place that one vertex alone has, ascending, and the vertex.
    vertices: Vec<([u32; 3], u32)>,
    /// The corners of each triangle from the lowest on, ascending, and the triangle.
    triangles: Vec<([u32; 3], u32)>,
}

/// From the lowest corner on, the same way around.
fn from_lowest(t: [u32; 3]) -> [u32; 3] {
    match t {
        [a, b, c] if b < a && b < c => [b, c, a],
        [a, b, c] if c < a && c < b => [c, a, b],
        t => t,
    }
}

fn bits(p: glam::Vec3) -> [u32; 3] {
    p.to_array().map(|v| (v + 0.0).to_bits())
}

impl TrianglesByPlace {
    fn of(plain: &TriMesh) -> TrianglesByPlace {
        let numbered = plain.positions.iter().map(|p| bits(*p)).zip(0..);
        let mut vertices: Vec<([u32; 3], u32)> = numbered.collect();
        vertices.sort_unstable();
        let alone = vertices.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
        let vertices = alone.map(|same| same[0]).collect();
        let numbered = plain.triangles.iter().map(|t| from_lowest(*t)).zip(0..);
        let mut triangles: Vec<([u32; 3], u32)> = numbered.collect();
        triangles.sort_unstable();
        TrianglesByPlace { vertices, triangles }
    }

    fn vertex(&self, p: glam::Vec3) -> Option<u32> {
        let bits = bits(p);
        let at = self.vertices.binary_search_by(|v| v.0.cmp(&bits)).ok()?;
        Some(self.vertices[at].1)
    }

    fn triangle(&self, t: [u32; 3]) -> Option<u32> {
        let t = from_lowest(t);
        let at = self.triangles.binary_search_by(|x| x.0.cmp(&t)).ok()?;
        Some(self.triangles[at].1)
    }

    /// Returns the index here of each vertex of a file, if it exists.
    fn names(&self, file: &FileFaces) -> Vec<Option<u32>> {
        file.mesh.positions.iter().map(|p| self.vertex(p.as_vec3())).collect()
    }

    /// Returns the faces of a file that exist here.
    fn faces(&self, file: &FileFaces) -> Vec<FoundFace> {
        let names = self.names(file);
        let here = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| names[v as usize]);
            self.triangle([a?, b?, c?])
        };
        let (mut start, mut out) = (0, Vec::new());
        for (f, corners) in file.mesh.faces().enumerate() {
            // A face of n corners was cut into n - 2 triangles, in the order of the faces.
            let range = start..start + corners.len().saturating_sub(2);
            start = range.end;
            let own = file.triangles.get(range.clone());
            if own.is_some_and(|own| own.iter().all(|t| here(t).is_some())) {
                out.push((f as u32, range));
            }
        }
        out
    }

    fn mesh(&self, plain: &TriMesh, file: &FileFaces, faces: &[FoundFace]) -> PolyMesh {
        let names = self.names(file);
        let name = |v: u32| names[v as usize].unwrap_or_default();
        let mut out = PolyMesh::new();
        out.positions = plain.positions.iter().map(|p| p.as_dvec3()).collect();
        out.colours.clone_from(&plain.colours);
        let (mut groups, mut uv_corners) = (Vec::new(), Vec::new());
        let mut rest = vec![true; plain.triangles.len()];
        for (f, range) in faces {
            let corners = file.mesh.face(*f as usize);
            let ring: Vec<u32> = corners.iter().map(|v| name(*v)).collect();
            out.push_face(&ring);
            for (new, old) in ring.iter().zip(corners) {
                out.positions[*new as usize] = file.mesh.positions[*old as usize];
            }
            groups.push(file.mesh.groups.as_ref().map_or(0, |g| g[*f as usize]));
            if let Some((_, own)) = file.mesh.uvs() {
                let first = file.mesh.face_starts[*f as usize] as usize;
                uv_corners.extend_from_slice(&own[first..first + corners.len()]);
            }
            for t in &file.triangles[range.clone()] {
                if let Some(t) = self.triangle(t.map(name)) {
                    rest[t as usize] = false;
                }
            }
        }
        let other = file.mesh.groups.as_ref().and_then(|g| g.iter().max()).map_or(0, |m| m + 1);
        for (t, _) in plain.triangles.iter().zip(rest).filter(|(_, rest)| *rest) {
            out.push_face(t);
            groups.push(other);
        }
        out.groups = file.mesh.groups.is_some().then_some(groups);
        out.attributes = file.mesh.attributes.as_deref().map(|own| {
            if file.mesh.uvs().is_some() {
                uv_corners.resize(out.corners.len(), NO_UV);
            }
            let mut names = own.groups.clone();
            if !names.is_empty() {
                // New faces need a group name too; otherwise they would continue the last group.
                let group = "new".into();
                names.push(GroupName { group, ..GroupName::default() });
            }
            let (uvs, libraries) = (own.uvs.clone(), own.libraries.clone());
            Arc::new(FaceAttributes { uvs, uv_corners, groups: names, libraries })
        });
        out
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

/// As [`PolygonStore::of`], of the files that this process has loaded.
pub fn of(clay: &Snapshot) -> Option<Arc<FileFaces>> {
    STORE.of(clay)
}

/// As [`PolygonStore::restore`], for this process.
pub fn restore(bytes: &[u8]) -> bool {
    STORE.restore(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};
    use sculptd_clay::Clay;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    #[test]
    fn quads_come_back_until_a_triangle_is_another() {
        let store = PolygonStore::default();
        let mut quads = shapes::torus(3.0, 1.0, 24, 12);
        quads.groups = Some((0..quads.face_count() as u32).map(|f| f / 100).collect());
        quads.positions.iter_mut().for_each(|p| *p += DVec3::splat(0.1));
        let groups = (0..3).map(|g| GroupName { group: format!("g{g}"), ..GroupName::default() });
        let uv_corners = (0..quads.corners.len() as u32).map(|c| c % 7).collect();
        quads.attributes = Some(Arc::new(FaceAttributes {
            uvs: (0..7).map(|u| [f64::from(u), 0.5]).collect(),
            uv_corners,
            groups: groups.collect(),
            libraries: vec!["ring.mtl".into()],
        }));
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
        // As a session gives them back to another process.
        let mut clay = Clay::build(&plain, &Job::default()).expect("a form");
        let bytes = store.of(&clay.snapshot()).expect("the file's").to_bytes().expect("plain");
        let later = PolygonStore::default();
        assert!(later.of(&clay.snapshot()).is_none());
        assert!(later.restore(&bytes) && !later.restore(&bytes[..bytes.len() / 2]));
        assert_eq!(later.polygons(&plain), moved);
    }

    #[test]
    fn untouched_faces_stay_polygons_after_triangles_have_changed() {
        let store = PolygonStore::default();
        let mut quads = shapes::torus(3.0, 1.0, 24, 12);
        quads.groups = Some((0..quads.face_count() as u32).map(|f| f / 100).collect());
        let uv_corners = (0..quads.corners.len() as u32).map(|c| c % 7).collect();
        let groups: Vec<GroupName> =
            (0..3).map(|g| GroupName { group: format!("g{g}"), ..GroupName::default() }).collect();
        quads.attributes = Some(Arc::new(FaceAttributes {
            uvs: vec![[0.25, 0.5]; 7],
            uv_corners,
            groups,
            libraries: Vec::new(),
        }));
        let mut plain = quads.triangulate().0;
        store.remember(quads.clone(), &plain);
        // A corner more within the first face's first triangle, numbers turned around, and a vertex
        // moved: four faces around that, and the first, are triangles.
        let [a, b, c] = plain.triangles[0];
        let middle = plain.corners(0).iter().sum::<Vec3>() / 3.0;
        plain.positions.push(middle);
        let new = plain.positions.len() as u32 - 1;
        plain.triangles[0] = [a, b, new];
        plain.triangles.extend([[b, c, new], [c, a, new]]);
        let far = quads.face(150)[0];
        plain.positions[far as usize] += Vec3::Y;
        let count = plain.positions.len() as u32;
        plain.positions.reverse();
        plain.triangles.iter_mut().for_each(|t| *t = t.map(|v| count - 1 - v));
        let made = store.polygons(&plain);
        let four = made.faces().filter(|f| f.len() == 4).count();
        assert_eq!(four, quads.face_count() - 5);
        assert_eq!(made.face_count(), four + 4 * 2 + 4);
        let volume = |mesh: &TriMesh| sculptd_geometry::measure::measures(mesh).volume;
        assert!((volume(&made.triangulate().0) / volume(&plain) - 1.0).abs() < 1e-3);
        let (_, uvs) = made.uvs().expect("texture coordinates");
        assert_eq!(uvs.iter().filter(|uv| **uv == NO_UV).count(), 3 * (4 * 2 + 4));
        let of = made.groups.as_ref().expect("groups");
        assert_eq!((of[0], of.last()), (0, Some(&3)));
        assert_eq!(made.group_name(3).map(|g| g.group.as_str()), Some("new"));
        // Nothing of a form that was never a file.
        let ball = shapes::icosphere(1.0, 3);
        assert_eq!(store.polygons(&ball), ball.to_poly());
    }
}
