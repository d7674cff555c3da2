//! What begins and what is sealed while a part is built layer by layer: one sweep of the surface
//! along the build direction.
//!
//! The part of the surface below a height consists of pieces, which begin at local minima and join
//! at saddles (the merge tree: Carr, Snoeyink and Axen, "Computing contour trees in all
//! dimensions", 2003). Where the solid is above a minimum, a contour begins with nothing below it:
//! an *island*. Where the solid is below it, a pit begins. A pit is sealed until its surface joins
//! one from which the outside can be reached; what it holds up to that height is a *cup*. A void
//! that is never joined to the outside is enclosed, or sealed by the plate.
//!
//! Pieces of the surface that are not joined can border the same void: a ball that floats in a
//! bowl. So where a contour begins, a ray straight down finds the surface or the region of the
//! plate that borders the same void.
//!
//! Heights, volumes and areas are exact up to the rounding of the vertices.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use sculptd_geometry::disjoint_sets::DisjointSets;
use sculptd_geometry::distance::topology::NO_PARTNER;
use sculptd_geometry::job::{Cancelled, Job};

use super::plate::{OUTSIDE, PlateContact};
use super::voids::{NONE, Voids, measured, walls};
use crate::part::{PreparedPart, Standing};

/// A contour that begins with nothing below it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundIsland {
    /// The lowest point, or the centre of the flat bottom.
    pub position: DVec3,
    /// Above the plate.
    pub height: f64,
    /// The number of the layer in which it begins; the first layer is 1.
    pub layer: usize,
    /// The area of its flat bottom; 0 where it begins in a point or an edge.
    pub area: f64,
}

/// A void that is sealed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SealedVoid {
    /// The centre of its volume.
    pub position: DVec3,
    /// Its volume, up to the height at which it opens.
    pub volume: f64,
    /// The height above the plate at which it opens; `None` where it stays sealed.
    pub opens: Option<f64>,
    /// True if only the plate seals it below: it is open once it is off the plate.
    pub through: bool,
    /// Its number in [`SweepResult::void_of`].
    pub number: u32,
}

/// The findings of one sweep.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SweepResult {
    /// The lowest first.
    pub islands: Vec<FoundIsland>,
    /// Voids that open upwards, or are sealed by the plate; the largest first.
    pub cups: Vec<SealedVoid>,
    /// Voids that never open; the largest first.
    pub trapped: Vec<SealedVoid>,
    /// The number of the void that each triangle borders, or [`NO_VOID`]; empty without voids.
    pub void_of: Vec<u32>,
}

/// The number of no void.
pub const NO_VOID: u32 = NONE;

/// A piece of the surface below the sweep's height.
#[derive(Clone, Copy)]
struct Piece {
    /// The vertex at which it began.
    birth: u32,
}

/// Sweeps a closed part. `layer` is the height of a layer; `plate` says whether the part stands on
/// a plate that seals what it encloses.
pub fn sweep(
    part: &PreparedPart,
    stand: &Standing,
    contact: &PlateContact,
    layer: f64,
    plate: bool,
    job: &Job,
) -> Result<SweepResult, Cancelled> {
    let names = &part.topology().triangles;
    let heights = &stand.heights;
    let vertices = part.places.len();
    let before = |a: u32, b: u32| {
        heights[a as usize].total_cmp(&heights[b as usize]).then(a.cmp(&b)).is_lt()
    };
    let touches = |t: usize| plate && contact.triangles[t];
    // Each edge by its upper vertex.
    let mut starts = vec![0u32; vertices + 1];
    let mut used = vec![false; vertices];
    let edge = |t: usize, k: usize| {
        let beyond = part.across(t as u32, k);
        let once = beyond.is_none_or(|u| u as usize > t);
        let inner = touches(t) && beyond.is_none_or(|u| touches(u as usize));
        let (a, b) = (names[t][k], names[t][(k + 1) % 3]);
        (once && !inner && a != b).then(|| if before(a, b) { (a, b) } else { (b, a) })
    };
    for (t, corners) in names.iter().enumerate() {
        if corners[0] == NO_PARTNER {
            continue;
        }
        corners.iter().for_each(|&v| used[v as usize] = true);
        for (_, upper) in (0..3).filter_map(|k| edge(t, k)) {
            starts[upper as usize + 1] += 1;
        }
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut at = starts.clone();
    let mut below = vec![0u32; starts[vertices] as usize];
    for (t, _) in names.iter().enumerate().filter(|(_, c)| c[0] != NO_PARTNER) {
        for (lower, upper) in (0..3).filter_map(|k| edge(t, k)) {
            below[at[upper as usize] as usize] = lower;
            at[upper as usize] += 1;
        }
    }
    job.check()?;
    let mut order: Vec<u32> = (0..vertices as u32).filter(|&v| used[v as usize]).collect();
    order.par_sort_unstable_by(|&a, &b| {
        heights[a as usize].total_cmp(&heights[b as usize]).then(a.cmp(&b))
    });
    job.check()?;

    let regions = contact.regions() as u32 + 1;
    let node = |v: u32| v + regions;
    let mut voids = Voids::new(vertices + regions as usize, part.tolerance);
    for v in 0..vertices as u32 {
        voids.low[node(v) as usize] = heights[v as usize];
    }
    let (beside, free) = contact.beside();
    let mut known = vec![false; vertices];
    if plate {
        for (loop_vertices, region) in &beside {
            for &v in *loop_vertices {
                known[v as usize] = true;
                voids.join(*region, node(v), stand.plate);
            }
        }
    } else {
        (1..regions).for_each(|r| voids.join(OUTSIDE, r, stand.plate));
    }
    let (u, v) = stand.plan();
    let region_below = |p: DVec3| {
        if plate { contact.region_at(DVec2::new(p.dot(u), p.dot(v)), None) } else { OUTSIDE }
    };
    let lowest = |t: u32| {
        let [a, b, c] = names[t as usize];
        let ab = if before(a, b) { a } else { b };
        if before(ab, c) { ab } else { c }
    };

    let mut surface = DisjointSets::new(vertices);
    let mut pieces: Vec<Piece> = (0..vertices as u32).map(|birth| Piece { birth }).collect();
    // Contours that began, with the height at which they joined an older one.
    let mut begun: Vec<(u32, f64)> = Vec::new();
    let solid_above = |v: u32| part.topology().vertex_normals[v as usize].dot(stand.up) <= 0.0;
    for &v in &order {
        let own = &below[starts[v as usize] as usize..starts[v as usize + 1] as usize];
        let height = heights[v as usize];
        if own.is_empty() && !known[v as usize] {
            let hidden = plate && height <= stand.plate + stand.slack;
            if hidden {
                let region = region_below(part.places[v as usize]);
                voids.join(region, node(v), height);
            } else if solid_above(v) {
                match floor_below(part, stand, part.places[v as usize]) {
                    Some((_, t)) => voids.join(node(v), node(lowest(t)), height),
                    None => voids.join(region_below(part.places[v as usize]), node(v), height),
                }
            }
        }
        for &w in own {
            voids.join(node(v), node(w), height);
            let (a, b) = (surface.root(v), surface.root(w));
            if a == b {
                continue;
            }
            let (x, y) = (pieces[a as usize].birth, pieces[b as usize].birth);
            let (elder, younger) = if before(x, y) { (x, y) } else { (y, x) };
            if younger != v {
                begun.push((younger, height));
            }
            surface.join(a, b);
            pieces[a.min(b) as usize] = Piece { birth: elder };
        }
    }
    job.check()?;
    let mut roots: Vec<u32> = order.iter().map(|&v| surface.root(v)).collect();
    roots.sort_unstable();
    roots.dedup();
    begun.extend(roots.iter().map(|&r| (pieces[r as usize].birth, f64::INFINITY)));
    begun.retain(|&(v, _)| solid_above(v));
    let islands = islands(part, stand, layer, &begun);

    // Voids that are still sealed.
    let mut sealed: Vec<u32> = (1..vertices as u32 + regions)
        .filter(|&n| n < regions || used[(n - regions) as usize])
        .filter(|&n| voids.cup[n as usize] == NONE)
        .map(|n| voids.sets.root(n))
        .filter(|&r| r != OUTSIDE)
        .collect();
    sealed.sort_unstable();
    sealed.dedup();
    for root in sealed {
        voids.close(root, None);
    }
    let mut found = measured(part, stand, &voids, |t| node(lowest(t)), contact);
    // The region of the plate that a cup stands on.
    let mut plated = vec![false; found.len()];
    for r in 1..regions {
        let cup = voids.cup[r as usize];
        if cup != NONE {
            plated[cup as usize] = true;
            if let Some(level) = voids.opened[cup as usize] {
                let sum = &mut found[cup as usize];
                let deep = level - stand.plate;
                sum.volume += deep * free[r as usize];
            }
        }
    }
    let void_of = walls(part, &voids, |t| node(lowest(t)), contact);
    let mut out = SweepResult { islands, void_of, ..Default::default() };
    for (number, ((sum, opens), plated)) in found.iter().zip(&voids.opened).zip(plated).enumerate()
    {
        let number = number as u32;
        if !(sum.volume > 0.0) {
            continue;
        }
        let opens = opens.map(|h| h - stand.plate);
        let position = sum.moment / sum.volume;
        let height = position.dot(stand.up).clamp(stand.plate, stand.top);
        let position = position + stand.up * (height - position.dot(stand.up));
        let through = plated && opens.is_some();
        let found = SealedVoid { position, volume: sum.volume, opens, through, number };
        if opens.is_some() || plated { &mut out.cups } else { &mut out.trapped }.push(found);
    }
    out.cups.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    out.trapped.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    Ok(out)
}

/// The surface straight below a point: its distance and triangle. Beside an edge that a ray may
/// miss, it is looked for again a little to the side.
fn floor_below(part: &PreparedPart, stand: &Standing, p: DVec3) -> Option<(f64, u32)> {
    let (u, v) = stand.plan();
    let step = 16.0 * part.rounding();
    [DVec3::ZERO, u, v, -u, -v]
        .iter()
        // Not the walls that go up from the point itself.
        .find_map(|side| part.distance_along(p + *side * step, -stand.up, 4.0 * step))
}

/// The islands among the contours that began.
fn islands(
    part: &PreparedPart,
    stand: &Standing,
    layer: f64,
    begun: &[(u32, f64)],
) -> Vec<FoundIsland> {
    let plane = |k: f64| stand.plate + (k + 0.5) * layer;
    let slack = part.tolerance;
    let mut chosen: Vec<(u32, usize)> = Vec::new();
    for &(v, joined) in begun {
        let height = stand.heights[v as usize];
        let k = ((height + slack - stand.plate) / layer - 0.5).floor() + 1.0;
        if !(k >= 1.0 && plane(k) < joined - slack && plane(k) < stand.top) {
            continue;
        }
        // The layer below reaches up to here.
        let under = part
            .distance_along(part.places[v as usize], -stand.up, slack)
            .is_some_and(|(d, _)| height - d >= plane(k - 1.0));
        if !under {
            chosen.push((v, k as usize + 1));
        }
    }
    if chosen.is_empty() {
        return Vec::new();
    }
    let bottoms = FlatBottoms::new(part, stand);
    let mut out: Vec<FoundIsland> = chosen
        .into_iter()
        .map(|(v, layer)| {
            let (area, centre) = bottoms.at(v);
            let position = centre.unwrap_or(part.places[v as usize]);
            let height = stand.heights[v as usize] - stand.plate;
            FoundIsland { position, height, layer, area }
        })
        .collect();
    out.sort_by(|a, b| a.height.total_cmp(&b.height).then(b.area.total_cmp(&a.area)));
    out
}

/// The flat regions that look straight down.
struct FlatBottoms {
    /// A triangle at each vertex, and the sums of each region by its first triangle.
    at_vertex: Vec<u32>,
    region: Vec<u32>,
    sums: Vec<(f64, DVec3)>,
}

impl FlatBottoms {
    fn new(part: &PreparedPart, stand: &Standing) -> FlatBottoms {
        let names = &part.topology().triangles;
        let flat = |t: usize| {
            let level = |c: &[u32; 3]| {
                let h = c.map(|v| stand.heights[v as usize]);
                h[0].max(h[1]).max(h[2]) - h[0].min(h[1]).min(h[2]) <= part.tolerance
            };
            part.areas[t] > 0.0 && part.normals[t].dot(stand.up) < 0.0 && level(&names[t])
        };
        let flat: Vec<bool> = (0..names.len()).map(flat).collect();
        let mut sets = DisjointSets::new(names.len());
        let mut at_vertex = vec![NONE; part.places.len()];
        for t in (0..names.len()).filter(|&t| flat[t]) {
            for k in 0..3 {
                at_vertex[names[t][k] as usize] = t as u32;
                if let Some(u) = part.across(t as u32, k).filter(|&u| flat[u as usize]) {
                    sets.join(t as u32, u);
                }
            }
        }
        let region: Vec<u32> = (0..names.len() as u32).map(|t| sets.root(t)).collect();
        let mut sums = vec![(0.0, DVec3::ZERO); names.len()];
        for t in (0..names.len()).filter(|&t| flat[t]) {
            let sum = &mut sums[region[t] as usize];
            sum.0 += part.areas[t];
            sum.1 += part.middle(t as u32) * part.areas[t];
        }
        FlatBottoms { at_vertex, region, sums }
    }

    /// The area and the centre of the flat bottom at a vertex.
    fn at(&self, v: u32) -> (f64, Option<DVec3>) {
        match self.at_vertex[v as usize] {
            NONE => (0.0, None),
            t => {
                let (area, moment) = self.sums[self.region[t as usize] as usize];
                (area, Some(moment / area))
            }
        }
    }
}
