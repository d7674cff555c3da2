//! What a Boolean would make of the object, shown while the second object is still held: computed
//! in the background from a snapshot. The world knows nothing of it.

use std::collections::BTreeMap;

use glam::Vec3;

use super::pages::Vertex;
use sculptd_clay::{Corner, Cut, Snapshot};
use sculptd_daemon::boolean_jobs;
use sculptd_engine::hand::{HeldObject, MenuItem, Similarity};
use sculptd_geometry::boolean;
use sculptd_geometry::boolean::{BooleanOptions, Operation};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh};

/// What is asked for.
#[derive(Debug, Clone)]
pub struct PreviewRequest {
    pub mesh: Snapshot,
    pub thing: HeldObject,
    pub choice: MenuItem,
}

/// The clay's tone where the held object has made a surface: warm against every material.
const TINT: [u8; 4] = [255, 196, 96, 255];
const PLAIN: [u8; 4] = [255; 4];

/// Triangles that stand in the place of pages of the object.
#[derive(Debug, Clone)]
pub struct Preview {
    /// Of the object that it was computed from.
    pub revision: u64,
    pub pages: usize,
    pub place: Similarity,
    pub choice: MenuItem,
    /// Pages that are not drawn, ascending; `None`: all of them.
    pub hidden: Option<Vec<u32>>,
    pub vertices: Vec<Vertex>,
    pub triangles: Vec<[u32; 3]>,
    /// Of these, how many the held object has made.
    pub made: usize,
    /// Least and greatest corner of a mesh that was read and is not clay yet, and that the view is
    /// framed on.
    pub bounds: Option<(Vec3, Vec3)>,
}

/// Triangles with a tone each, joined where place and tone are the same, so that a cut has a sharp
/// edge.
#[derive(Default)]
struct TriangleGatherer {
    names: BTreeMap<([u32; 3], bool), u32>,
    /// Place, sum of areas, the clay's own normal where it has one.
    places: Vec<(Vec3, Vec3, Option<Vec3>, bool)>,
    triangles: Vec<[u32; 3]>,
    made: usize,
}

impl TriangleGatherer {
    fn push(&mut self, corners: [(Vec3, Option<Vec3>); 3], made: bool) {
        let [a, b, c] = corners.map(|p| p.0);
        let across = (b - a).cross(c - a);
        self.made += usize::from(made);
        let t = corners.map(|(p, own)| {
            let (names, places) = (&mut self.names, &mut self.places);
            let i = *names.entry((p.to_array().map(f32::to_bits), made)).or_insert_with(|| {
                places.push((p, Vec3::ZERO, own, made));
                places.len() as u32 - 1
            });
            places[i as usize].1 += across;
            i
        });
        self.triangles.push(t);
    }

    fn finish(self, request: &PreviewRequest, hidden: Option<Vec<u32>>) -> Preview {
        let vertex = |&(p, across, own, made): &(Vec3, Vec3, Option<Vec3>, bool)| {
            let normal = own.unwrap_or_else(|| across.normalize_or_zero());
            Vertex::new(p, normal, 0.0, if made { TINT } else { PLAIN })
        };
        Preview {
            revision: request.mesh.revision(),
            pages: request.mesh.page_count(),
            place: request.thing.place,
            choice: request.choice,
            hidden,
            vertices: self.places.iter().map(vertex).collect(),
            triangles: self.triangles,
            made: self.made,
            bounds: None,
        }
    }
}

/// A mesh that was read, in the place of the whole object of `pages` pages: what is shown while the
/// clay is still made of it.
pub fn of_mesh(mesh: &TriMesh, pages: usize) -> Preview {
    let mut normals = vec![Vec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let across = (b - a).cross(c - a);
        t.iter().for_each(|&v| normals[v as usize] += across);
    }
    let colour = |i: usize| mesh.colours.as_ref().and_then(|c| c.get(i)).copied().unwrap_or(PLAIN);
    let pairs = mesh.positions.iter().zip(&normals).enumerate();
    let vertex = |(i, (p, n)): (usize, (&Vec3, &Vec3))| {
        Vertex::new(*p, n.normalize_or_zero(), 0.0, colour(i))
    };
    Preview {
        revision: 0,
        pages,
        place: Similarity::NONE,
        choice: MenuItem::Add,
        hidden: None,
        vertices: pairs.map(vertex).collect(),
        triangles: mesh.triangles.clone(),
        made: 0,
        bounds: Some(mesh.bounds()),
    }
}

/// Computes it; `None` where the choice joins nothing.
///
/// # Errors
/// As a Boolean: an open thing, or an object that cannot be cut.
/// [`boolean::BooleanError::Cancelled`] when a newer one is request.
pub fn compute(
    request: &PreviewRequest,
    job: &Job,
) -> Result<Option<Preview>, boolean::BooleanError> {
    let Some(operation) = boolean_jobs::operation(request.choice) else { return Ok(None) };
    let tool = request.thing.placed().to_poly();
    let options = BooleanOptions::default();
    if let Some(cut) =
        sculptd_clay::local_boolean::local(&request.mesh, &tool, operation, &options, job)?
    {
        return Ok(Some(of_cut(request, &cut)));
    }
    whole(request, &tool, operation, job).map(Some)
}

/// The pages that lose a triangle, without it and with what comes.
fn of_cut(request: &PreviewRequest, cut: &Cut) -> Preview {
    let mesh = &request.mesh;
    let mut gone: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &(page, t) in cut.removed() {
        gone.entry(page).or_default().push(t);
    }
    let mut out = TriangleGatherer::default();
    for (&p, gone) in &mut gone {
        gone.sort_unstable();
        let page = mesh.page(p);
        for t in (0..page.triangles().len()).filter(|t| gone.binary_search(&(*t as u32)).is_err()) {
            let corner = |v: u16| (page.point(v as usize), Some(page.normal(v as usize)));
            out.push(page.triangles()[t].map(corner), false);
        }
    }
    for corners in cut.added() {
        let made = corners.iter().all(|c| matches!(c, Corner::New(_)));
        out.push(
            corners.map(|c| match c {
                Corner::Old((p, v)) => {
                    let page = mesh.page(p);
                    (page.point(v as usize), Some(page.normal(v as usize)))
                }
                Corner::New(i) => (cut.new_vertices()[i as usize].place, None),
            }),
            made,
        );
    }
    out.finish(request, Some(gone.into_keys().collect()))
}

fn whole(
    request: &PreviewRequest,
    tool: &PolyMesh,
    operation: Operation,
    job: &Job,
) -> Result<Preview, boolean::BooleanError> {
    let work = request.mesh.to_tri().to_poly();
    let (solids, _) =
        boolean::compute([&work, tool], &[operation], &BooleanOptions::default(), job, || 0.0)?;
    let mut out = TriangleGatherer::default();
    for solid in &solids {
        let (plain, faces) = solid.mesh.triangulate();
        for (i, face) in faces.iter().enumerate() {
            let made = solid.origins.get(*face as usize).is_some_and(|o| o.operand == 1);
            out.push(plain.corners(i).map(|p| (p, None)), made);
        }
    }
    Ok(out.finish(request, None))
}
