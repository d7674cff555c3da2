//! The least wall of a solid, proven: no point of the surface was left out.
//!
//! Definition (*ray*): at a point of a facet, the length of the ray opposite the facet's normal to
//! the first facet that faces it. The least wall is the least of these over all points of all
//! facets. `FacetShaft` computes it exactly for a pair of facets, and a walk over the tree finds
//! the pairs; the walk skips everything deeper than the least wall found so far. So the result
//! depends neither on the positions of samples, nor on the triangles that a flat facet is cut into.
//!
//! Edges: a wall has two sides. What the ray meets is the other side if it is turned by at most 40
//! degrees from parallel, or if it is the bottom of a valley in the surface: the root of a groove
//! or the tip of a pit, however steep. A side that is turned more and goes on beside the ray makes
//! an edge with this one, and an edge is not a wall. An edge of less than 40 degrees is a wall that
//! runs out to zero; one that ends in a land or a rounding is as thick as that land or rounding.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use super::Opposite;
use super::shaft::{FacetShaft, Patch};
use super::sharp_edges::{OPPOSED, grazing};
use super::surface::WeldedSurface;
use super::valley::Valley;
use crate::bvh::{Bvh8, Ray};
use crate::job::{Cancelled, Job};

/// Rounding of a coordinate moves the distance of two facets by at most this many of it.
const ROUNDINGS: f64 = 4.0;
/// Slope beyond which sides are a wall beside the shaft and not below it.
const STEEPEST: f64 = 50.0;
/// The number of parts into which a patch is cut to decide which of them are hidden.
const PARTS: usize = 256;
/// Facets in a task; what one task finds bounds the later facets of the same task.
const CHUNK: usize = 512;
/// Facets in the first round; each round has twice as many, and starts from what the last found.
const ROUND: usize = 4096;

/// The solid, as the search needs it.
#[derive(Debug)]
pub(super) struct Solid<'a> {
    pub tree: &'a Bvh8,
    pub surface: &'a WeldedSurface,
    /// 1 if normals point out of the measured side, -1 if into it.
    pub sign: f64,
    /// The greatest error of a coordinate, in the mesh's unit.
    pub grain: f64,
    /// See [`WeldedSurface::tilts`].
    pub tilts: &'a [f32],
    /// True to ignore sides turned by more than 40 degrees from parallel.
    pub opposed_only: bool,
}

/// The least wall between two bounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LeastWall {
    /// No wall is thinner.
    pub lower: f64,
    /// Some wall is no thicker.
    pub upper: f64,
    /// The thinnest wall that was found, by the coordinates as they are.
    pub value: f64,
    /// The bounds are proven over the whole surface, and not only at sampled places.
    pub certified: bool,
    /// The bounds differ by rounding only.
    pub settled: bool,
    /// The point from which the wall of `upper` is measured.
    pub position: [f64; 3],
    /// The opposite point of that wall.
    pub opposite: [f64; 3],
    /// Out of the wall at `position`, of unit length.
    pub normal: [f64; 3],
}

/// The comparison of a wall with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Comparison {
    /// Not below the limit; a tie passes.
    Reached,
    /// Below the limit for sure.
    Below,
    /// The bounds are too far apart to decide.
    Undecided,
}

impl LeastWall {
    /// Returns the point from which it is measured.
    pub fn place(&self) -> DVec3 {
        self.position.into()
    }

    /// Compares with a limit. A limit between bounds that differ by rounding only is a tie, which
    /// passes.
    pub fn against(&self, limit: f64) -> Comparison {
        if self.upper < limit {
            Comparison::Below
        } else if self.lower >= limit || self.settled {
            Comparison::Reached
        } else {
            Comparison::Undecided
        }
    }
}

/// A facet with walls below a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinFacet {
    /// Index into the mesh's triangles.
    pub triangle: u32,
    /// The least wall under it; infinite if it is only under the side of a valley, whose bottom is
    /// under another facet.
    pub least: f64,
    /// The point from which that is measured.
    pub position: DVec3,
    /// Out of the wall, of unit length.
    pub normal: DVec3,
    /// The welded vertices at its corners.
    pub corners: [u32; 3],
    /// The area with walls below the limit.
    pub area: f64,
    /// The greatest error of `area`.
    pub error: f64,
}

/// A wall that a search found.
#[derive(Debug, Clone, Copy)]
struct FoundWall {
    depth: f64,
    foot: DVec3,
    hit: DVec3,
    away: DVec3,
}

/// The state of a search.
#[derive(Debug, Clone, Copy)]
struct Search {
    /// Thinner walls than this, by more than the tolerance, are searched for.
    best: f64,
    found: Option<FoundWall>,
    /// The least depth of places that may be hidden, which was not decided.
    open: f64,
    /// The least depth that rounding may have hidden at the sides of a shaft.
    low: f64,
    /// Whether a side that is turned too far for a wall came above `best`; not looked for where it
    /// is true from the beginning.
    aside: bool,
}

impl Search {
    /// A search for what is thinner than `best`.
    fn below(best: f64, found: Option<FoundWall>, aside: bool) -> Search {
        Search { best, found, open: f64::INFINITY, low: f64::INFINITY, aside }
    }
}

impl Solid<'_> {
    /// Walls whose difference from a limit is smaller tie with it.
    pub fn tolerance(&self) -> f64 {
        ROUNDINGS * self.grain + self.step()
    }

    /// The search does not look for walls that are thinner by less than this.
    fn step(&self) -> f64 {
        0.5 * self.grain
    }

    fn shaft(&self, t: u32, erode: f64) -> Option<FacetShaft> {
        let corners = self.surface.corners(t as usize)?.map(Vec3::as_dvec3);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero() * self.sign;
        if normal == DVec3::ZERO {
            return None;
        }
        // The direction of a narrower one is not known.
        FacetShaft::new(corners, -normal, erode).filter(|p| p.height > 8.0 * self.grain)
    }

    /// The cosine of the angle between facet `t`, turned round, and the shaft's facet.
    fn facing(&self, shaft: &FacetShaft, t: u32) -> f64 {
        self.surface.face_normals[t as usize].as_dvec3().dot(shaft.into) * self.sign
    }

    /// The least wall over all facets, or nothing where no place has a wall. `order` are the
    /// facets, those near to each other in space one after the other.
    pub fn least(&self, order: &[u32], job: &Job) -> Result<Option<LeastWall>, Cancelled> {
        let mut all = self.first_bound(order, job)?;
        let (mut from, mut size) = (0, ROUND);
        let done = AtomicUsize::new(0);
        while from < order.len() {
            let round = &order[from..(from + size).min(order.len())];
            let best = all.best;
            let found: Vec<Search> = round
                .par_chunks(CHUNK)
                .map(|chunk| {
                    job.check()?;
                    let mut search = Search::below(best, None, true);
                    chunk.iter().for_each(|&t| self.facet(t, &mut search));
                    done.fetch_add(chunk.len(), Relaxed);
                    Ok(search)
                })
                .collect::<Result<_, Cancelled>>()?;
            for s in found {
                all.open = all.open.min(s.open);
                all.low = all.low.min(s.low);
                let better = |f: &FoundWall| all.found.is_none_or(|a| f.depth < a.depth);
                if let Some(f) = s.found.filter(better) {
                    (all.found, all.best) = (Some(f), f.depth);
                }
            }
            from += round.len();
            size *= 2;
        }
        let error = ROUNDINGS * self.grain;
        Ok(all.found.map(|f| LeastWall {
            lower: (f.depth - self.step()).min(all.open).min(all.low).max(error) - error,
            upper: f.depth + error,
            value: f.depth,
            certified: true,
            settled: all.open >= f.depth - error,
            position: f.foot.to_array(),
            opposite: f.hit.to_array(),
            normal: f.away.to_array(),
        }))
    }

    /// A wall by one ray in the middle of some facets: what is deeper needs no look.
    fn first_bound(&self, order: &[u32], job: &Job) -> Result<Search, Cancelled> {
        const RAYS: usize = 50_000;
        let step = order.len().div_ceil(RAYS).max(1);
        let some: Vec<u32> = order.iter().copied().step_by(step).collect();
        let found: Vec<Option<FoundWall>> = some
            .par_chunks(CHUNK)
            .map(|chunk| {
                job.check()?;
                let walls = chunk.iter().filter_map(|&t| {
                    let shaft = self.shaft(t, 0.0)?;
                    let corners = self.surface.corners(t as usize)?.map(Vec3::as_dvec3);
                    let foot = corners.iter().sum::<DVec3>() / 3.0;
                    let (u, depth) = self.first_hit(&shaft, t, foot)?;
                    let wall = depth > ROUNDINGS * self.grain && self.facing(&shaft, u) >= OPPOSED;
                    let (hit, away) = (foot + shaft.into * depth, -shaft.into);
                    wall.then_some(FoundWall { depth, foot, hit, away })
                });
                Ok(walls.min_by(|a, b| a.depth.total_cmp(&b.depth)))
            })
            .collect::<Result<_, Cancelled>>()?;
        let found = found.into_iter().flatten().min_by(|a, b| a.depth.total_cmp(&b.depth));
        let best = found.map_or(f64::INFINITY, |f| f.depth);
        Ok(Search::below(best, found, true))
    }

    /// The first facet that faces `t` under `foot`, a point of `t`, and its depth.
    fn first_hit(&self, shaft: &FacetShaft, t: u32, foot: DVec3) -> Option<(u32, f64)> {
        let ray = Ray::new(foot.as_vec3(), shaft.into.as_vec3());
        let faces = |u: u32| u != t && self.facing(shaft, u) > grazing(self.tilts, t, u);
        self.tree.closest_hit(ray, faces).map(|h| (h.triangle, f64::from(h.t)))
    }

    /// Looks under facet `t`.
    fn facet(&self, t: u32, search: &mut Search) {
        let Some(shaft) = self.shaft(t, 2.0 * self.grain) else { return };
        let (tolerance, least) = (self.step(), ROUNDINGS * self.grain);
        let depth = search.best - tolerance;
        let from = if self.opposed_only { OPPOSED } else { 0.0 };
        shaft.each_below(self.tree, depth, |u, corners| {
            let facing = self.facing(&shaft, u);
            if u != t && facing > grazing(self.tilts, t, u).max(from) {
                if facing < OPPOSED {
                    self.valley(&shaft, t, u, search);
                    search.aside = search.aside || {
                        let patch = shaft.clip(corners.map(Vec3::as_dvec3), least);
                        patch.lowest().is_some_and(|c| c.z < search.best)
                    };
                    return search.best - tolerance;
                }
                let patch = shaft.clip(corners.map(Vec3::as_dvec3), least);
                let low = patch.lowest().map_or(f64::INFINITY, |c| c.z);
                if low < search.best - tolerance && !patch.narrow(2.0 * self.grain) {
                    self.settle(&shaft, t, facing, patch, search);
                }
            }
            search.best - tolerance
        });
    }

    /// Finds the least wall of a patch that is below what is known. Cuts it until the lowest place
    /// of a part is not hidden behind another side.
    fn settle(&self, shaft: &FacetShaft, t: u32, facing: f64, patch: Patch, search: &mut Search) {
        let tolerance = self.step();
        let mut parts = vec![patch];
        let mut count = 0;
        while let Some(part) = parts.pop() {
            let Some(low) = part.lowest().filter(|c| c.z < search.best - tolerance) else {
                continue;
            };
            if part.narrow(2.0 * self.grain) {
                continue;
            }
            count += 1;
            if count > PARTS {
                search.open = search.open.min(low.z);
                continue;
            }
            if self.hidden(shaft, t, low, part.middle()) {
                parts.extend(part.halves());
                continue;
            }
            // The sides of shafts were moved inwards, and narrow patches left out.
            let slope = (1.0 / (facing * facing) - 1.0).max(0.0).sqrt();
            self.found(shaft, low, slope, search);
        }
    }

    /// A wall at `low`, lower than what is known. `slope` is by how much the depth changes beside.
    fn found(&self, shaft: &FacetShaft, low: DVec3, slope: f64, search: &mut Search) {
        search.low = search.low.min(low.z - ROUNDINGS * self.grain * slope.min(STEEPEST));
        search.best = low.z;
        search.found = Some(FoundWall {
            depth: low.z,
            foot: shaft.foot(low),
            hit: shaft.place(low),
            away: -shaft.into,
        });
    }

    /// Looks for the bottoms of valleys along the sides of facet `u`, which is turned too far to be
    /// a wall's other side.
    fn valley(&self, shaft: &FacetShaft, t: u32, u: u32, search: &mut Search) {
        self.along(shaft.into).each_bottom(u, |ends| {
            // A line has no width: between two shafts it would be in neither.
            let (least, wider) = (ROUNDINGS * self.grain, 4.0 * self.grain);
            let Some(ends) = shaft.clip_line(ends, least, wider) else { return };
            let [low, high] = if ends[0].z <= ends[1].z { ends } else { [ends[1], ends[0]] };
            if low.z < search.best - self.step() && !self.hidden(shaft, t, low, low) {
                let along = (high - low).truncate().length().max(self.grain);
                self.found(shaft, low, (high.z - low.z) / along, search);
            }
        });
    }

    /// Something that is not opposite comes before a place: what lies behind it does not count.
    /// `middle` is where to look for it, a little beside the place.
    fn hidden(&self, shaft: &FacetShaft, t: u32, low: DVec3, middle: DVec3) -> bool {
        let inside = low.lerp(middle, 1e-3);
        let Some((u, depth)) = self.first_hit(shaft, t, shaft.foot(inside)) else { return false };
        depth < inside.z - 16.0 * self.grain && self.facing(shaft, u) < OPPOSED
    }

    fn along(&self, into: DVec3) -> Valley<'_> {
        let Solid { surface, tilts, sign, grain, .. } = *self;
        Valley { surface, tilts, sign, into, grain }
    }

    /// Returns true if facet `u`, met by the ray from `place` along `into`, is no other side of a
    /// wall there: it is turned too far, and not the side of a valley.
    pub fn is_edge(&self, place: DVec3, into: DVec3, u: u32) -> bool {
        let facing = self.surface.face_normals[u as usize].as_dvec3().dot(into) * self.sign;
        facing < OPPOSED && !self.along(into).is_side(u, place.dot(into))
    }

    /// Returns true if a value at welded vertex `v` of `surface` to this side is an edge's.
    pub fn of_edge(&self, surface: &WeldedSurface, v: usize, opposite: Opposite) -> bool {
        let away = surface.normals[v].as_dvec3() * self.sign;
        match opposite {
            Opposite::Parallel => false,
            Opposite::Turned(u) => self.is_edge(surface.positions[v].as_dvec3(), -away, u),
            Opposite::Corner => true,
        }
    }

    /// The facets with walls below `limit`, rising; `sides`: also those that are only under the
    /// sides of valleys.
    pub fn thin(
        &self,
        order: &[u32],
        limit: f64,
        sides: bool,
        job: &Job,
    ) -> Result<Vec<ThinFacet>, Cancelled> {
        let area = |&t: &u32| self.shaft(t, 0.0).map_or(0.0, |p| p.area);
        let all: f64 = order.iter().map(area).sum();
        let found: Vec<Vec<ThinFacet>> = order
            .par_chunks(CHUNK)
            .map(|chunk| {
                job.check()?;
                Ok(chunk.iter().filter_map(|&t| self.thin_facet(t, limit, sides, all)).collect())
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut found = found.concat();
        found.sort_unstable_by_key(|f| f.triangle);
        Ok(found)
    }

    fn thin_facet(&self, t: u32, limit: f64, sides: bool, all: f64) -> Option<ThinFacet> {
        let below = limit + self.step();
        let mut search = Search::below(below, None, !sides);
        self.facet(t, &mut search);
        if search.found.is_none() && !(sides && search.aside) {
            return None;
        }
        let shaft = self.shaft(t, 0.0)?;
        let (area, error) = self.area_below(&shaft, t, limit, all);
        let corners = self.surface.triangles[t as usize];
        let (least, position, normal) = match search.found {
            Some(wall) => (wall.depth, wall.foot, wall.away),
            // Under the side of a valley whose bottom is under another facet.
            None if area > 0.0 => {
                let middle = self.surface.corners(t as usize)?.iter().sum::<Vec3>() / 3.0;
                (f64::INFINITY, middle.as_dvec3(), -shaft.into)
            }
            None => return None,
        };
        Some(ThinFacet { triangle: t, least, position, normal, corners, area, error })
    }

    /// The area of the shaft's triangle with walls below `limit`, and its error.
    fn area_below(&self, shaft: &FacetShaft, t: u32, limit: f64, all: f64) -> (f64, f64) {
        /// The share of the whole surface that is not cut any more.
        const SMALL: f64 = 1e-5;
        let least = ROUNDINGS * self.grain;
        let mut met: Vec<(u32, [Vec3; 3])> = Vec::new();
        shaft.each_below(self.tree, limit, |u, corners| {
            if u != t {
                met.push((u, corners));
            }
            limit
        });
        met.sort_unstable_by_key(|m| m.0);
        met.dedup_by_key(|m| m.0);
        let (mut area, mut again) = (0.0, 0.0);
        for (u, corners) in met {
            let facing = self.facing(shaft, u);
            let mut patch = shaft.clip(corners.map(Vec3::as_dvec3), least);
            patch.cut(|c| limit - c.z);
            if patch.narrow(2.0 * self.grain) {
                continue;
            }
            let side = grazing(self.tilts, t, u);
            if facing > side {
                if !self.is_edge(shaft.foot(DVec3::ZERO), shaft.into, u) {
                    area += patch.area();
                }
            } else if facing < -side {
                // A ray that re-enters matter may leave it again and be counted twice.
                again += patch.area();
            }
        }
        if again <= 0.0 || area <= 0.0 {
            return (area.min(shaft.area), 0.0);
        }
        if shaft.area <= SMALL * all {
            return self.area_by_rays(shaft, t, limit);
        }
        shaft.four().iter().fold((0.0, 0.0), |(area, error), &corners| {
            let Some(part) = FacetShaft::new(corners, shaft.into, 0.0) else {
                return (area, error);
            };
            let (own, doubt) = self.area_below(&part, t, limit, all);
            (area + own, error + doubt)
        })
    }

    /// The same by four rays, for a small triangle.
    fn area_by_rays(&self, shaft: &FacetShaft, t: u32, limit: f64) -> (f64, f64) {
        let parts = shaft.four();
        let hits = parts.iter().filter(|c| {
            let foot = c.iter().sum::<DVec3>() / 3.0;
            self.first_hit(shaft, t, foot)
                .is_some_and(|(u, depth)| depth < limit && !self.is_edge(foot, shaft.into, u))
        });
        let share = hits.count() as f64 / 4.0;
        (shaft.area * share, if share > 0.0 && share < 1.0 { shaft.area * 0.25 } else { 0.0 })
    }
}
