//! What a Boolean would make of the object, shown while the second object is still held: computed
//! in the background from a snapshot. The world knows nothing of it.

use std::collections::BTreeMap;

use glam::{UVec3, Vec3};

use super::pages::Vertex;
use sculptd_clay::{Corner, Cut, Snapshot};
use sculptd_daemon::boolean_jobs;
use sculptd_engine::hand::{HeldObject, MenuItem, Similarity};
use sculptd_geometry::boolean;
use sculptd_geometry::boolean::{BooleanOptions, Operation};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh};

/// Request for a preview.
#[derive(Debug, Clone)]
pub struct PreviewRequest {
    pub mesh: Snapshot,
    pub thing: HeldObject,
    pub choice: MenuItem,
}

/// The clay's tone where the held object has made a surface: warm against every material.
const TINT: [u8; 4] = [255, 196, 96, 255];
const PLAIN: [u8; 4] = [255; 4];

/// Triangles that replace pages of the object.
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

/// Cells along the longest side of a mesh that is shown before there is clay of it.
const CELLS: f32 = 192.0;

/// Builds a coarse preview of a loaded mesh, shown instead of all `pages` pages while its clay is
/// being built. It is coarse, so that it appears at once: the vertices of each cell of a grid are
/// merged (Rossignac and Borrel, Multi-resolution 3D approximations, 1993).
pub fn of_mesh(mesh: &TriMesh, pages: usize) -> Preview {
    let (lo, hi) = mesh.bounds();
    let scale = CELLS / (hi - lo).max_element().max(1e-12);
    let last = ((hi - lo) * scale).as_uvec3();
    let cells = last + UVec3::ONE;
    let cell = |p: Vec3| {
        let at = ((p - lo) * scale).as_uvec3().min(last);
        (at.x + cells.x * (at.y + cells.y * at.z)) as usize
    };
    let colour = |i: usize| mesh.colours.as_ref().and_then(|c| c.get(i)).copied().unwrap_or(PLAIN);
    let mut first = vec![u32::MAX; (cells.x * cells.y * cells.z) as usize];
    let mut kept: Vec<(Vec3, Vec3, [u8; 4])> = Vec::new();
    let mut name = |(i, p): (usize, &Vec3)| {
        let slot = &mut first[cell(*p)];
        if *slot == u32::MAX {
            *slot = kept.len() as u32;
            kept.push((*p, Vec3::ZERO, colour(i)));
        }
        *slot
    };
    let names: Vec<u32> = mesh.positions.iter().enumerate().map(&mut name).collect();
    let mut triangles = Vec::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        let across = (b - a).cross(c - a);
        let [i, j, k] = t.map(|v| names[v as usize]);
        [i, j, k].iter().for_each(|&v| kept[v as usize].1 += across);
        if i != j && j != k && k != i {
            triangles.push([i, j, k]);
        }
    }
    let vertex = |&(p, n, colour): &(Vec3, Vec3, [u8; 4])| {
        Vertex::new(p, n.normalize_or_zero(), 0.0, colour)
    };
    Preview {
        revision: 0,
        pages,
        place: Similarity::NONE,
        choice: MenuItem::Add,
        hidden: None,
        vertices: kept.iter().map(vertex).collect(),
        triangles,
        made: 0,
        bounds: Some((lo, hi)),
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
    preview_of_all(request, &tool, operation, job).map(Some)
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

fn preview_of_all(
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

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::shapes;

    #[test]
    fn a_large_mesh_is_shown_coarse_and_whole() {
        let ball = shapes::sphere_of_about(400_000);
        let shown = of_mesh(&ball, 7);
        assert!(shown.triangles.len() * 2 < ball.triangles.len(), "{}", shown.triangles.len());
        assert!(shown.triangles.len() > 100_000, "{}", shown.triangles.len());
        let count = shown.vertices.len() as u32;
        assert!(shown.triangles.iter().flatten().all(|v| *v < count));
        assert_eq!((shown.pages, shown.bounds), (7, Some(ball.bounds())));
        assert!(shown.hidden.is_none(), "nothing of the old object is seen");
    }
}
