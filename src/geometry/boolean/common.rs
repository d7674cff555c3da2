//! Both operands over one list of points. Where the surfaces are near each other, their places
//! within the tolerance become one point; elsewhere each keeps its points.

use glam::DVec3;
use rayon::prelude::*;

use super::points::PointSet;
use crate::boolean::box_tree::Span;
use crate::boolean::broad_phase;
use crate::boolean::broad_phase::SurfaceView;
use crate::job::{Cancelled, Job};
use crate::{PolyMesh, triangulate};

/// With fewer faces, one thread is as quick as several.
pub(super) const FEW: usize = 1 << 12;

/// Both results, at once where the work is `large`: to wake a thread takes longer than a small one.
pub(super) fn join_where<A: Send, B: Send>(
    large: bool,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if large { rayon::join(a, b) } else { (a(), b()) }
}

/// Both operands over common points.
pub struct Common {
    /// All points of both.
    pub points: PointSet,
    /// Corners over the points.
    pub meshes: [PolyMesh; 2],
    /// Triangles of each operand.
    pub triangles: [Vec<[u32; 3]>; 2],
    /// First triangle of each face, and the number of all.
    pub starts: [Vec<u32>; 2],
    /// The box around each operand.
    pub bounds: [Span; 2],
    /// Triangles whose boxes are within the tolerance of each other, ascending.
    pub pairs: Vec<(u32, u32)>,
    /// Both operands are one surface. Then `pairs` may be those of before the points were common,
    /// until [`Common::pair_again`].
    pub same_surface: bool,
}

impl Common {
    /// The pairs of the triangles as they are over the common points.
    pub fn pair_again(&mut self, job: &Job) -> Result<(), Cancelled> {
        let at = &self.points.at;
        let surfaces = [0, 1].map(|s| SurfaceView { triangles: &self.triangles[s], at, base: 0 });
        self.pairs = broad_phase::pairs(surfaces, self.bounds, 4.0 * self.points.tolerance(), job)?;
        Ok(())
    }
}

/// Returns true if both operands are the same surface: the same triangles over the common points,
/// in the same direction. Then nothing is between them, however often they cross themselves.
fn same_surface(a: &[[u32; 3]], b: &[[u32; 3]], contact: usize) -> bool {
    // Triangles that shrank to less are nothing.
    let whole = |t: &&[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    let least_first = |&[a, b, c]: &[u32; 3]| match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    };
    // Without a place in contact, no triangle of one is a triangle of the other. Most pairs of
    // solids differ in the first triangle.
    let first = a.iter().find(whole).map(least_first);
    if contact == 0 || first.is_none() || !b.iter().any(|t| Some(least_first(t)) == first) {
        return false;
    }
    let sorted = |t: &[[u32; 3]]| {
        let mut all: Vec<[u32; 3]> = t.iter().filter(whole).map(least_first).collect();
        all.par_sort_unstable();
        all
    };
    sorted(a) == sorted(b)
}

/// Puts places of the operands that are within `eps` of each other on one point, where the surfaces
/// are near each other. `lap` is called as each phase ends.
pub fn common(
    operands: [&PolyMesh; 2],
    eps: f64,
    job: &Job,
    lap: &mut dyn FnMut(&'static str),
) -> Result<Common, Cancelled> {
    let bases = [0, operands[0].positions.len() as u32];
    let slack = 4.0 * eps;
    let bounds = operands.map(|m| bounds(&m.positions));
    let large = operands.iter().any(|m| m.face_count() >= FEW);
    let (a, b) = join_where(
        large,
        || split(operands[0], &operands[0].positions, job),
        || split(operands[1], &operands[1].positions, job),
    );
    let ((mut ta, mut sa), (mut tb, mut sb)) = (a?, b?);
    let surface =
        |s: usize, triangles| SurfaceView { triangles, at: &operands[s].positions, base: 0 };
    let pairs = broad_phase::pairs([surface(0, &ta), surface(1, &tb)], bounds, slack, job)?;
    lap("broad_phase");
    let mut points =
        PointSet::new([&operands[0].positions[..], &operands[1].positions[..]].concat(), eps);
    let mut names: Vec<u32> = (0..points.at.len() as u32).collect();
    // Ascending. There may be thousands of pairs to a triangle.
    let corners = |s: usize, t: &[[u32; 3]], of: fn(&(u32, u32)) -> u32| -> Vec<u32> {
        let mut near = vec![false; operands[s].positions.len()];
        for p in &pairs {
            t[of(p) as usize].iter().for_each(|&v| near[v as usize] = true);
        }
        (0..near.len() as u32).filter(|&v| near[v as usize]).collect()
    };
    let close = [corners(0, &ta, |p| p.0), corners(1, &tb, |p| p.1)];
    let (mut renamed, mut shrunk) = ([false; 2], [false; 2]);
    for s in 0..2 {
        job.check()?;
        for v in &close[s] {
            let own = bases[s] + v;
            let name = points.list(own);
            names[own as usize] = name;
            renamed[s] |= name != own;
        }
        let mut known: Vec<u32> = close[s].iter().map(|v| names[(bases[s] + v) as usize]).collect();
        known.sort_unstable();
        shrunk[s] = known.windows(2).any(|w| w[0] == w[1]);
    }
    let named = |s: usize, v: u32| names[(bases[s] + v) as usize];
    let mut again = false;
    let mut one =
        |s: usize, t: &mut Vec<[u32; 3]>, starts: &mut Vec<u32>| -> Result<PolyMesh, Cancelled> {
            let m = operands[s];
            job.check()?;
            // Polygons of both that are the same by now are to come in the same triangles.
            if shrunk[s] || renamed[s] && t.len() != m.face_count() {
                let mesh = without_doubles(m, |v| named(s, v));
                (*t, *starts) = split(&mesh, &points.at, job)?;
                again = true;
                return Ok(mesh);
            }
            t.par_iter_mut().with_min_len(FEW).for_each(|t| *t = t.map(|v| named(s, v)));
            let corners = m.corners.par_iter().with_min_len(FEW);
            let corners = corners.map(|&v| named(s, v)).collect();
            Ok(PolyMesh { face_starts: m.face_starts.clone(), corners, ..PolyMesh::new() })
        };
    let meshes = [one(0, &mut ta, &mut sa)?, one(1, &mut tb, &mut sb)?];
    let same_surface = same_surface(&ta, &tb, points.contact.places);
    let (triangles, starts) = ([ta, tb], [sa, sb]);
    let mut out = Common { points, meshes, triangles, starts, bounds, pairs, same_surface };
    if again && !same_surface {
        out.pair_again(job)?;
    }
    lap("weld");
    Ok(out)
}

fn bounds(at: &[DVec3]) -> Span {
    at.par_chunks(1 << 15).map(|c| Span::of(c.iter().copied())).reduce(|| Span::EMPTY, Span::join)
}

/// The mesh with other names for its corners, and no corner twice in a row.
fn without_doubles(m: &PolyMesh, name: impl Fn(u32) -> u32) -> PolyMesh {
    let mut out = PolyMesh::new();
    out.corners.reserve(m.corners.len());
    let mut ring: Vec<u32> = Vec::new();
    for f in m.faces() {
        ring.clear();
        for &c in f {
            let v = name(c);
            if ring.last() != Some(&v) {
                ring.push(v);
            }
        }
        while ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        // A face that shrank to an edge keeps its number and has no corners.
        if ring.len() < 3 {
            ring.clear();
        }
        out.push_face(&ring);
    }
    out
}

/// Triangles, and the first of each face.
fn split(mesh: &PolyMesh, at: &[DVec3], job: &Job) -> Result<(Vec<[u32; 3]>, Vec<u32>), Cancelled> {
    let n = mesh.face_count();
    if mesh.corners.len() == 3 * n
        && mesh.face_starts.par_windows(2).with_min_len(FEW).all(|w| w[1] - w[0] == 3)
    {
        let triangles = mesh.corners.par_chunks_exact(3).with_min_len(FEW);
        let triangles = triangles.map(|c| [c[0], c[1], c[2]]).collect();
        return Ok((triangles, (0..=n as u32).collect()));
    }
    let mut triangles = Vec::with_capacity(mesh.corners.len());
    let mut starts = Vec::with_capacity(n + 1);
    starts.push(0);
    for (i, f) in mesh.faces().enumerate() {
        if i % 65_536 == 0 {
            job.check()?;
        }
        match *f {
            [] => {}
            [a, b, c] => triangles.push([a, b, c]),
            _ => triangulate::face(at, f, &mut triangles),
        }
        starts.push(triangles.len() as u32);
    }
    Ok((triangles, starts))
}
