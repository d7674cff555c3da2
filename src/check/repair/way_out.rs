//! The way of a hole from the lowest place of a void out through the wall: the shortest one, where
//! a level way counts twice as long as one straight down.

use glam::{DVec2, DVec3};
use sculptd_geometry::portable::PortableMath;

use super::section_region::SectionRegion;
use super::tool::PlaneFrame;
use crate::layers::sweep::NO_VOID;
use crate::part::{PreparedPart, Standing};

/// Share of the radius by which a level hole is cut into the floor, so that nothing is left on it.
const SUNK: f64 = 0.05;
/// Share of the radius by which a hole reaches beyond the wall on both sides.
const BEYOND: f64 = 0.25;
/// Rays around a hole.
const RIM: usize = 12;
/// Directions of slanted ways: around, and down from the horizontal.
const TURNS: usize = 24;
const FALLS: usize = 6;
/// Level ways that are looked at, at most.
const MOST_LEVEL: usize = 1500;
/// A way that the plate seals is taken only where there is no other.
const SEALED_COST: f64 = 1e6;

/// A search for the way out of one void. Places are about the part's centre.
pub(super) struct WaySearch<'a> {
    pub part: &'a PreparedPart,
    pub stand: &'a Standing,
    /// The void of each triangle.
    pub void_of: &'a [u32],
    /// The void.
    pub number: u32,
    /// Of the hole.
    pub radius: f64,
    /// The direction in which the hole leads; away from the plate for an air inlet.
    pub down: DVec3,
    /// True if a plate seals what leads down to it.
    pub plate: bool,
}

/// A hole: a cylinder around the line from `start` along `along`.
#[derive(Debug, Clone, Copy)]
pub(super) struct WayOut {
    /// The point at which the wall begins.
    pub start: DVec3,
    /// Of unit length.
    pub along: DVec3,
    /// The length of the wall on the axis.
    pub wall: f64,
    /// The ends of the cylinder, from `start`.
    pub begin: f64,
    pub end: f64,
    /// True if the plate seals it.
    pub sealed: bool,
}

/// A way with its cost.
type RatedWay = (f64, WayOut);

impl WaySearch<'_> {
    /// The best way; `None` where no ray leads out.
    pub fn best(&self) -> Option<WayOut> {
        let faces: Vec<u32> = (0..self.part.triangles() as u32)
            .filter(|&t| self.void_of.get(t as usize) == Some(&self.number))
            .collect();
        let deepest = self.corners(&faces).map(|p| p.dot(self.down)).fold(f64::MIN, f64::max);
        let slack = 2.0 * self.part.tolerance;
        let low = |p: &DVec3| p.dot(self.down) >= deepest - slack;
        let floor: Vec<u32> = faces
            .iter()
            .copied()
            .filter(|&t| self.part.corners(t).is_some_and(|c| c.iter().all(low)))
            .collect();
        // A void that is open to the plate has the plate as its floor.
        let plated = self.plate && -deepest <= self.stand.plate + self.stand.slack;
        let foot = self.foot(&faces, &floor, low);
        let mut ways: Vec<RatedWay> = Vec::new();
        if let Some((foot, clear)) = foot.filter(|_| !plated) {
            let back = if clear >= self.radius { BEYOND * self.radius } else { self.radius };
            ways.extend(self.way(foot, self.down, back.min(self.free(foot))));
            if floor.is_empty() {
                ways.extend(self.slanted(foot));
            }
        }
        if plated || !floor.is_empty() {
            ways.extend(self.level(&faces, deepest));
        }
        // The first of equals.
        let best = ways.into_iter().reduce(|a, b| if b.0 < a.0 * (1.0 - 1e-6) { b } else { a });
        best.map(|b| b.1)
    }

    fn corners(&self, faces: &[u32]) -> impl Iterator<Item = DVec3> {
        faces.iter().filter_map(|&t| self.part.corners(t)).flatten()
    }

    /// The lowest place of a void, and its distance to the boundary of a flat floor: the place of
    /// the floor that is furthest from its boundary, the middle of the longest lowest edge, or the
    /// lowest vertex.
    fn foot(
        &self,
        faces: &[u32],
        floor: &[u32],
        low: impl Fn(&DVec3) -> bool,
    ) -> Option<(DVec3, f64)> {
        let first = self.corners(faces).find(|p| low(p))?;
        if !floor.is_empty() {
            let frame = PlaneFrame::new(first, self.down);
            let mut lines: Vec<[DVec2; 2]> = Vec::new();
            for &t in floor {
                let Some(corners) = self.part.corners(t) else { continue };
                for k in 0..3 {
                    let beyond = self.part.across(t, k);
                    if beyond.is_none_or(|u| floor.binary_search(&u).is_err()) {
                        lines.push([frame.flat(corners[k]), frame.flat(corners[(k + 1) % 3])]);
                    }
                }
            }
            if let Some((place, clear)) = SectionRegion::new(lines).widest() {
                return Some((frame.place(place), clear));
            }
        }
        let mut best = (0.0, first);
        for corners in faces.iter().filter_map(|&t| self.part.corners(t)) {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                if low(&a) && low(&b) && a.distance(b) > best.0 {
                    best = (a.distance(b), (a + b) * 0.5);
                }
            }
        }
        Some((best.1, 0.0))
    }

    /// Half the room above a place of the void's floor.
    fn free(&self, foot: DVec3) -> f64 {
        let least = self.part.tolerance + 16.0 * self.part.rounding();
        let ceiling = self.part.distance_along(foot, -self.down, least);
        ceiling.map_or(f64::INFINITY, |(d, _)| 0.5 * d)
    }

    /// Ways that fall from a place in all directions, and level ones.
    fn slanted(&self, foot: DVec3) -> Vec<RatedWay> {
        let (x, y) = self.down.any_orthonormal_pair();
        let mut out = Vec::new();
        for fall in 0..FALLS {
            let angle = std::f64::consts::FRAC_PI_2 * fall as f64 / FALLS as f64;
            let (sine, cosine) = angle.portable_sin_cos();
            for turn in 0..TURNS {
                let around = std::f64::consts::TAU * turn as f64 / TURNS as f64;
                let (s, c) = around.portable_sin_cos();
                let along = (x * c + y * s) * cosine + self.down * sine;
                // The lower side of the hole is at the foot.
                let lift = (1.0 - SUNK) * self.radius * cosine;
                let from = foot - self.down * lift;
                out.extend(self.way(from, along, BEYOND * self.radius));
            }
        }
        out
    }

    /// Level ways through the walls around the floor; the hole begins at the foot of the wall.
    fn level(&self, faces: &[u32], deepest: f64) -> Vec<RatedWay> {
        let height = deepest - 0.1 * self.radius;
        let axis = deepest - (1.0 - SUNK) * self.radius;
        let mut starts: Vec<(f64, DVec3, DVec3, f64)> = Vec::new();
        for &t in faces {
            let Some(corners) = self.part.corners(t) else { continue };
            let depths = corners.map(|p| p.dot(self.down) - height);
            let mut ends = Vec::with_capacity(2);
            for k in 0..3 {
                let (a, b) = (depths[k], depths[(k + 1) % 3]);
                if (a < 0.0) != (b < 0.0) {
                    ends.push(corners[k].lerp(corners[(k + 1) % 3], a / (a - b)));
                }
            }
            let [a, b] = ends[..] else { continue };
            let normal = self.part.normals[t as usize];
            let fall = normal.dot(self.down);
            let Some(along) = (-(normal - self.down * fall)).try_normalize() else { continue };
            // A wall that leans goes back between its foot and the axis of the hole.
            let lean = fall.abs() / (1.0 - fall * fall).max(1e-9).sqrt() * self.radius;
            if lean > 2.0 * self.radius {
                continue;
            }
            let middle = (a + b) * 0.5;
            let from = middle + self.down * (axis - middle.dot(self.down));
            starts.push((a.distance(b), from, along, BEYOND * self.radius + lean));
        }
        // The widest walls first.
        starts.sort_by(|a, b| b.0.total_cmp(&a.0));
        starts.truncate(MOST_LEVEL);
        let way = |(_, from, along, back): (f64, DVec3, DVec3, f64)| self.way(from, along, back);
        starts.into_iter().filter_map(way).collect()
    }

    /// The way along a line that starts on the wall, or in the void before it, and begins `back`
    /// behind its start.
    fn way(&self, from: DVec3, along: DVec3, back: f64) -> Option<RatedWay> {
        let part = self.part;
        // The surfaces of voids that the line passes are no way out.
        let outer = |t: u32| self.void_of.get(t as usize).is_none_or(|n| *n == NO_VOID);
        let least = part.tolerance;
        let (exit, out) = part.exit_along(from, along, least, outer)?;
        // A line that starts in the void enters the wall further on.
        let own = |t: u32| self.void_of.get(t as usize) == Some(&self.number);
        let entry = part.distance_along(from, along, least);
        let entry = entry.filter(|(d, t)| own(*t) && *d < exit).map_or(0.0, |(d, _)| d);
        let entry = if along.dot(self.down) > 0.99 { 0.0 } else { entry };
        let (x, y) = along.any_orthonormal_pair();
        let mut end = exit;
        let mut sealed = self.meets_plate(from + along * exit, out);
        for i in 0..RIM {
            let (s, c) = (std::f64::consts::TAU * i as f64 / RIM as f64).portable_sin_cos();
            let rim = from + (x * c + y * s) * self.radius;
            if let Some((d, t)) = part.exit_along(rim, along, least, outer) {
                end = end.max(d.min(exit + 4.0 * self.radius));
                sealed |= self.meets_plate(rim + along * d, t);
            }
        }
        let sealed = self.plate && sealed;
        let wall = exit - entry;
        let cost = (end - entry) * (2.0 - along.dot(self.down).clamp(0.0, 1.0));
        let cost = cost + if sealed { SEALED_COST * part.sizes.area.sqrt() } else { 0.0 };
        let start = from + along * entry;
        let end = end - entry + BEYOND * self.radius;
        Some((cost, WayOut { start, along, wall, begin: -(entry + back), end, sealed }))
    }

    /// Returns true if a place of the outside, on a face that looks down, is on the plate or so
    /// near that a hole there touches it.
    fn meets_plate(&self, place: DVec3, t: u32) -> bool {
        let looks_down = self.part.normals[t as usize].dot(self.stand.up) < -0.1;
        let height = place.dot(self.stand.up) - self.stand.plate;
        looks_down && height <= self.stand.slack + SUNK * self.radius
    }
}
