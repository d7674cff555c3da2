//! Which facets may have a wall below a limit at all: groups of near facets are compared with what
//! is within the limit behind them, by the directions that their normals span. Where nothing there
//! faces a group, none of its facets has such a wall, and none is looked at.

use glam::Vec3;
use rayon::prelude::*;

use super::surface::{DROPPED, WeldedSurface};
use crate::bvh::{Bvh8, LEAF, NO_TRIANGLE, WideNode};
use crate::job::{Cancelled, Job};
use crate::portable::PortableMath;

/// Most facets of a group.
const GROUP: u32 = 64;
/// A quarter turn, less what rounding may hide.
const FACING: f32 = std::f32::consts::FRAC_PI_2 - 0.02;
/// Groups of one task.
const CHUNK: usize = 64;

/// Directions within an angle of an axis; a negative angle: none.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalCone {
    pub axis: Vec3,
    pub angle: f32,
}

impl NormalCone {
    pub const NONE: NormalCone = NormalCone { axis: Vec3::ZERO, angle: -1.0 };

    /// A cone around other cones.
    pub fn around(cones: &[NormalCone]) -> NormalCone {
        let all = cones.iter().filter(|c| c.angle >= 0.0);
        let sum: Vec3 = all.clone().map(|c| c.axis).sum();
        if all.clone().next().is_none() {
            return NormalCone::NONE;
        }
        let axis = sum.normalize_or_zero();
        if axis == Vec3::ZERO {
            return NormalCone { axis: Vec3::Z, angle: std::f32::consts::PI };
        }
        let angle = all.map(|c| between(axis, c.axis) + c.angle).fold(0.0, f32::max);
        NormalCone { axis, angle: angle.min(std::f32::consts::PI) }
    }

    /// Whether some direction of one is turned by a right angle or more from some of the other.
    fn may_oppose(&self, other: &NormalCone) -> bool {
        let both = self.angle >= 0.0 && other.angle >= 0.0;
        both && between(self.axis, other.axis) + self.angle + other.angle >= FACING
    }
}

fn between(a: Vec3, b: Vec3) -> f32 {
    a.dot(b).clamp(-1.0, 1.0).portable_acos()
}

/// A box with the cone of its normals, and the number of its facets.
#[derive(Clone, Copy)]
struct FacetGroup {
    child: u32,
    lo: Vec3,
    hi: Vec3,
    cone: NormalCone,
    facets: u32,
}

fn bounds(node: &WideNode, i: usize) -> (Vec3, Vec3) {
    let at = |k: usize| node.planes[k][i];
    (Vec3::new(at(0), at(1), at(2)), Vec3::new(at(3), at(4), at(5)))
}

/// Returns the kept triangles, near ones one after the other, that may have a wall below `limit`
/// behind them. `sign` is 1 if normals point out of the measured side, -1 if into it.
pub(super) fn may_be_thin(
    surface: &WeldedSurface,
    tree: &Bvh8,
    sign: f64,
    limit: f64,
    job: &Job,
) -> Result<Vec<u32>, Cancelled> {
    let nodes = tree.nodes();
    let none = FacetGroup {
        child: 0,
        lo: Vec3::INFINITY,
        hi: Vec3::NEG_INFINITY,
        cone: NormalCone::NONE,
        facets: 0,
    };
    let normals = |pack: u32| {
        let ids = tree.packs()[pack as usize].id;
        let kept = ids
            .into_iter()
            .filter(|&t| t != NO_TRIANGLE && surface.triangles[t as usize][0] != DROPPED);
        kept.map(|t| NormalCone { axis: surface.face_normals[t as usize], angle: 0.0 })
    };
    // Children come after their parent.
    let mut groups = vec![[none; 8]; nodes.len()];
    for n in (0..nodes.len()).rev() {
        for i in 0..8 {
            let node = &nodes[n];
            if node.planes[0][i] == f32::INFINITY {
                continue;
            }
            let (child, (lo, hi)) = (node.child[i], bounds(node, i));
            let (cone, facets) = if child & LEAF != 0 {
                let mut own = [NormalCone::NONE; 4];
                normals(child & !LEAF).zip(&mut own).for_each(|(c, to)| *to = c);
                (NormalCone::around(&own), 4)
            } else {
                let below = &groups[child as usize];
                let facets = below.iter().map(|g| g.facets).sum();
                (NormalCone::around(&below.map(|g| g.cone)), facets)
            };
            groups[n][i] = FacetGroup { child, lo, hi, cone, facets };
        }
    }
    job.check()?;
    let mut small = Vec::new();
    let mut todo: Vec<FacetGroup> =
        groups.first().map_or(Vec::new(), |g| g.iter().rev().copied().collect());
    while let Some(g) = todo.pop() {
        if g.facets > GROUP && g.child & LEAF == 0 {
            todo.extend(groups[g.child as usize].iter().rev());
        } else if g.facets > 0 {
            small.push(g);
        }
    }
    let (lo, hi) = tree.bounds();
    let slack = (lo.abs().max(hi.abs()).max_element()) * 4e-6;
    let chunks = small.par_chunks(CHUNK).map(|chunk| {
        job.check()?;
        let mut stack = Vec::new();
        let mut out: Vec<u32> = Vec::new();
        for g in chunk {
            if !opposed(&groups, g, sign, limit as f32 + slack, &mut stack) {
                continue;
            }
            stack.clear();
            stack.push(g.child);
            while let Some(child) = stack.pop() {
                if child & LEAF != 0 {
                    out.extend(tree.packs()[(child & !LEAF) as usize].id);
                } else {
                    let below = groups[child as usize].iter().rev();
                    stack.extend(below.filter(|g| g.facets > 0).map(|g| g.child));
                }
            }
        }
        Ok(out)
    });
    let found = chunks.collect::<Result<Vec<_>, Cancelled>>()?.concat();
    let mut seen = vec![false; surface.triangles.len()];
    let once = |t: &u32| {
        seen.get_mut(*t as usize).is_some_and(|seen| !std::mem::replace(seen, true))
            && surface.triangles[*t as usize][0] != DROPPED
    };
    Ok(found.into_iter().filter(once).collect())
}

/// Whether something within `limit` behind a group may face it.
fn opposed(
    groups: &[[FacetGroup; 8]],
    group: &FacetGroup,
    sign: f64,
    limit: f32,
    stack: &mut Vec<u32>,
) -> bool {
    if group.cone.angle < 0.0 {
        return false;
    }
    // The box that shafts of the group reach, by the directions into the wall.
    let into = group.cone.axis * -(sign as f32);
    let (mut lo, mut hi) = (group.lo, group.hi);
    for k in 0..3 {
        let from_axis = into[k].clamp(-1.0, 1.0).portable_acos();
        let most = (from_axis - group.cone.angle).max(0.0).portable_cos();
        let least = (from_axis + group.cone.angle).min(std::f32::consts::PI).portable_cos();
        hi[k] += most.max(0.0) * limit + limit * 1e-3;
        lo[k] += least.min(0.0) * limit - limit * 1e-3;
    }
    stack.clear();
    stack.push(0);
    while let Some(n) = stack.pop() {
        for g in &groups[n as usize] {
            let near = g.facets > 0 && g.lo.cmple(hi).all() && g.hi.cmpge(lo).all();
            if near && g.cone.may_oppose(&group.cone) {
                if g.child & LEAF != 0 {
                    return true;
                }
                stack.push(g.child);
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::super::{
        MeasuredSide, ThicknessSettings, WallQuery, measure_at_places, walls_below,
    };
    use super::*;
    use crate::shapes::{cuboid, icosphere, torus};
    use glam::DVec3;

    #[test]
    fn no_thin_facet_is_left_out() {
        let slab = cuboid(DVec3::ZERO, DVec3::new(20.0, 30.0, 1.5)).triangulate().0;
        let mut lump = icosphere(10.0, 24);
        for p in &mut lump.positions {
            *p *= 1.0 + 0.3 * ((p.x * 0.9).sin() * (p.y * 0.8).cos() * (p.z * 1.1).sin());
        }
        let ring = torus(9.0, 1.0, 64, 24).triangulate().0;
        let job = Job::default();
        for mesh in [slab, lump, ring] {
            let tree = Bvh8::build(&mesh, &job).expect("built");
            let surface = WeldedSurface::new(&mesh, 0.7);
            for (side, limit) in [
                (MeasuredSide::Wall, 1.6),
                (MeasuredSide::Wall, 6.0),
                (MeasuredSide::Gap, 3.0),
                (MeasuredSide::Gap, 40.0),
            ] {
                let found = walls_below(&surface, &tree, side, limit, 0.0, &job).expect("run");
                let settings = ThicknessSettings { side, ..ThicknessSettings::default() };
                let query = WallQuery { limit: Some(limit), ..WallQuery::default() };
                let whole = measure_at_places(&mesh, None, &settings, query, &job).expect("run");
                let mut all = whole.thin.expect("a limit").facets;
                all.retain(|f| f.least.is_finite());
                let names = |f: &[super::super::ThinFacet]| -> Vec<(u32, i64)> {
                    f.iter().map(|f| (f.triangle, (f.least * 1e3).round() as i64)).collect()
                };
                assert_eq!(names(&found.facets), names(&all), "{side:?} {limit}");
            }
        }
    }
}
