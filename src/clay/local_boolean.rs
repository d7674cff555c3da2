//! A tool out of clay (or onto it) at the cost of the tool's region: only triangles whose boxes
//! meet the tool's box are cut, and what comes of it is a [`Cut`], which writes only the pages
//! around ([`crate::Clay::graft`]).
//!
//! The clay is not looked at as a whole, so it is trusted to be closed; what is put in has the
//! border of what is taken out, edge by edge and in the same direction, so it is as closed after as
//! it was before. Where that fails, nothing is given and the caller goes the long way.

use glam::{DVec3, Vec3};

use crate::{Corner, Cut, Home, NewVertex, Page, Snapshot, home_of};
use sculptd_geometry::boolean::arrange::{Arrangement, FaceState};
use sculptd_geometry::boolean::classify::{Around, crossings};
use sculptd_geometry::boolean::points::Map;
use sculptd_geometry::boolean::{
    BooleanError, BooleanOptions, NAMES, Operation, check, single_tolerance,
};
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, triangulate};

/// Pieces of each surface that are classified again.
const SAMPLES: usize = 4;

/// Union or difference of the clay and a tool (A and B); None where only the whole can tell: for an
/// intersection, or where the cut does not close.
pub fn local(
    clay: &Snapshot,
    tool: &PolyMesh,
    operation: Operation,
    options: &BooleanOptions,
    job: &Job,
) -> Result<Option<Cut>, BooleanError> {
    if !matches!(operation, Operation::Union | Operation::Difference) {
        return Ok(None);
    }
    check(tool, NAMES[1], job)?;
    let (lo, hi) = clay.bounds();
    let reach = tool
        .positions
        .iter()
        .fold(lo.abs().max(hi.abs()).max_element() as f64, |r, p| r.max(p.abs().max_element()));
    let floor = reach * 2f64.powi(-49);
    let box_of = |(lo, hi): (DVec3, DVec3), p: &DVec3| (lo.min(*p), hi.max(*p));
    let (low, high) = tool.positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), box_of);
    // Clay is in single precision, and so was a tool before it was placed.
    let resolved = single_tolerance(reach, (high - low).max_element());
    let wanted = options.tolerance.unwrap_or(resolved).max(floor).max(f64::MIN_POSITIVE);
    let patch = ToolSurroundings::of(clay, tool, 4.0 * wanted);
    let winding = |p: DVec3| winding(clay, p);
    let around = Around { winding: &winding, bounds: None, samples: SAMPLES };
    for factor in [1.0, 0.125, 1.0 / 64.0] {
        let eps = (wanted * factor).max(floor);
        let a = Arrangement::new([&patch.mesh, tool], eps, floor, Some(around), job, &mut |_| ())?;
        if a.doubt.is_none()
            && let Some(change) = patch.change(&a, clay, operation, options.keep_contact, job)
        {
            job.check()?;
            return Ok(Some(Cut::new(
                clay,
                patch.bounds,
                change.removed,
                change.added,
                change.new,
            )));
        }
    }
    Ok(None)
}

/// The clay's triangles near the tool.
struct ToolSurroundings {
    /// The tool's box, rounded outwards.
    bounds: (Vec3, Vec3),
    mesh: PolyMesh,
    /// One a vertex.
    homes: Vec<Home>,
    /// One a triangle: page, index in it.
    triangles: Vec<(u32, u32)>,
}

struct Change {
    removed: Vec<(u32, u32)>,
    added: Vec<[Corner; 3]>,
    new: Vec<NewVertex>,
}

impl ToolSurroundings {
    fn of(clay: &Snapshot, tool: &PolyMesh, slack: f64) -> ToolSurroundings {
        let (lo, hi) = tool
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        let (lo, hi) = (lo - slack, hi + slack);
        let meets = |l: Vec3, h: Vec3| l.as_dvec3().cmple(hi).all() && lo.cmple(h.as_dvec3()).all();
        let outwards = (lo.as_vec3().map(f32::next_down), hi.as_vec3().map(f32::next_up));
        let mut out = ToolSurroundings {
            bounds: outwards,
            mesh: PolyMesh::new(),
            homes: Vec::new(),
            triangles: Vec::new(),
        };
        let mut names: Map<Home, u32> = Map::default();
        clay.each_page_in(meets, |p, page| {
            let t = page.topology();
            for (i, corners) in page.triangles().iter().enumerate() {
                let [a, b, c] = page.corners(i);
                if !meets(a.min(b).min(c), a.max(b).max(c)) {
                    continue;
                }
                let face = corners.map(|v| {
                    let home = home_of(t, p, v);
                    *names.entry(home).or_insert_with(|| {
                        out.homes.push(home);
                        out.mesh.positions.push(page.point(v as usize).as_dvec3());
                        out.homes.len() as u32 - 1
                    })
                });
                out.mesh.push_face(&face);
                out.triangles.push((p, i as u32));
            }
        });
        out
    }

    /// Returns the triangles to remove and to add; `None` unless both have the same border.
    fn change(
        &self,
        a: &Arrangement,
        clay: &Snapshot,
        operation: Operation,
        keep_contact: bool,
        job: &Job,
    ) -> Option<Change> {
        let mut kept = vec![false; self.triangles.len()];
        let mut added: Vec<[u32; 3]> = Vec::new();
        let mut from: Vec<Option<u32>> = Vec::new();
        a.faces(operation, keep_contact, job, |origin, corners, state| {
            let clay = origin.operand == 0;
            if clay && state == FaceState::Whole && self.mesh.face(origin.face as usize) == corners
            {
                kept[origin.face as usize] = true;
                return;
            }
            match *corners {
                [x, y, z] => added.push([x, y, z]),
                _ => triangulate::face(&a.points.at, corners, &mut added),
            }
            from.resize(added.len(), clay.then_some(origin.face));
        });
        let removed: Vec<usize> = (0..kept.len()).filter(|&f| !kept[f]).collect();
        let mut edges: Vec<(u32, u32, i32)> = Vec::new();
        let mut count = |t: &[u32], sign: i32| {
            for k in 0..3 {
                let (x, y) = (t[k], t[(k + 1) % 3]);
                edges.push((x.min(y), x.max(y), if x < y { sign } else { -sign }));
            }
        };
        removed.iter().for_each(|&f| count(self.mesh.face(f), -1));
        added.iter().for_each(|t| count(t, 1));
        edges.sort_unstable();
        let even = |g: &[(u32, u32, i32)]| g.iter().map(|e| e.2).sum::<i32>() == 0;
        if !edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)).all(even) {
            return None;
        }
        let own = self.homes.len() as u32;
        let mut names: Map<u32, u32> = Map::default();
        let mut new: Vec<NewVertex> = Vec::new();
        let mut corner = |v: u32, face: Option<u32>| {
            if v < own {
                return Corner::Old(self.homes[v as usize]);
            }
            Corner::New(*names.entry(v).or_insert_with(|| {
                let place = a.points.at[v as usize];
                let (colour, mask) =
                    face.map_or(([255; 4], 0.0), |f| self.attributes(clay, f, place));
                new.push(NewVertex { place: place.as_vec3(), colour, mask });
                new.len() as u32 - 1
            }))
        };
        let added = added.iter().zip(&from).map(|(t, &f)| t.map(|v| corner(v, f))).collect();
        let removed = removed.into_iter().map(|f| self.triangles[f]).collect();
        Some(Change { removed, added, new })
    }

    /// Colour and mask of the clay at a place in one of its triangles.
    fn attributes(&self, clay: &Snapshot, face: u32, place: DVec3) -> ([u8; 4], f32) {
        let (p, i) = self.triangles[face as usize];
        let page: &Page = clay.page(p);
        let corners = page.triangles()[i as usize];
        let [a, b, c] = page.corners(i as usize).map(Vec3::as_dvec3);
        let n = (b - a).cross(c - a);
        let whole = n.length_squared().max(f64::MIN_POSITIVE);
        let share =
            |x: DVec3, y: DVec3| ((y - x).cross(place - x).dot(n) / whole).clamp(0.0, 1.0) as f32;
        let w = [share(b, c), share(c, a), share(a, b)];
        let sum = w.iter().sum::<f32>().max(f32::MIN_POSITIVE);
        let mix = |f: &dyn Fn(usize) -> f32| {
            (0..3).map(|k| w[k] * f(corners[k] as usize)).sum::<f32>() / sum
        };
        let colour = [0, 1, 2, 3].map(|k| mix(&|v| page.colour(v)[k] as f32).round() as u8);
        (colour, mix(&|v| page.mask(v)).clamp(0.0, 1.0))
    }
}

/// Returns the winding number of the clay around a point.
fn winding(clay: &Snapshot, o: DVec3) -> i32 {
    let (lo, hi) = clay.bounds();
    let (lo, hi) = (lo.as_dvec3(), hi.as_dvec3());
    if !(lo.cmple(o).all() && o.cmple(hi).all()) {
        return 0;
    }
    crossings(o, (hi - lo).length() * 2.0, |p, visit| {
        let inverse = 1.0 / (p - o);
        let meets = |l: Vec3, h: Vec3| {
            let (a, b) = ((l.as_dvec3() - o) * inverse, (h.as_dvec3() - o) * inverse);
            let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
            near.max(0.0) <= far.min(1.0) + 1e-9
        };
        let mut on = true;
        clay.each_page_in(meets, |_, page| {
            for i in 0..page.triangles().len() {
                let [a, b, c] = page.corners(i);
                if on && meets(a.min(b).min(c), a.max(b).max(c)) {
                    on = visit([a, b, c].map(Vec3::as_dvec3));
                }
            }
        });
    })
}
