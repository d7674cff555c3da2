//! Two versions of a part compared: where its walls became thinner and where thicker.
//!
//! A place of the later version is compared with the place of the earlier one from which it came:
//! the same place, or the one where the line along its normal meets the surface of the earlier
//! version through nothing but what was removed there, or added. A place without one, such as on a
//! side of a new pocket, is new and is not compared. Neither are edges, which are no walls.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use super::check::{CheckedPart, SPOTS};
use super::probe::{FoundPlace, WallProber};
use super::ready::ReadyPart;
use super::sharp_edges::OPPOSED;
use super::{ThicknessError, ThicknessSettings};
use crate::TriMesh;
use crate::disjoint_sets::DisjointSets;
use crate::job::{Cancelled, Job};

/// Classes of the histogram: the first is the area that is not compared, the others run from minus
/// to plus [`WallChanges::histogram_top`], the middle one about 0.
pub const CHANGE_CLASSES: usize = 102;
/// Places compared between two looks at the job.
const CHUNK: usize = 512;

/// The change at a place: the wall of the later version and that of the earlier one.
#[derive(Debug, Clone, Copy)]
struct WallChange {
    before: f32,
    after: f32,
}

impl WallChange {
    fn difference(self) -> f32 {
        self.after - self.before
    }
}

/// A place whose wall became thinner.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ThinnedSpot {
    /// In the coordinates of the later version's file, in millimetres.
    pub position: [f64; 3],
    /// Out of the wall, of unit length.
    pub normal: [f32; 3],
    /// The wall of the earlier version, in millimetres.
    pub before: f32,
    /// The wall of the later version, in millimetres.
    pub after: f32,
    /// The area of the region around it, in square millimetres.
    pub area: f64,
}

/// The changes of a part's walls. Lengths are in millimetres, areas in square millimetres of the
/// later version.
#[derive(Debug, Clone, Serialize)]
pub struct WallChanges {
    /// Differences up to this are rounding.
    pub tolerance: f32,
    /// The area that was compared.
    pub compared_area: f64,
    /// The area without a wall, or without a place of the earlier version to compare with.
    pub new_area: f64,
    /// The area with thinner walls.
    pub thinner_area: f64,
    /// The area with thicker walls.
    pub thicker_area: f64,
    /// The area with walls below the limit that were not below it before; `null` without a limit.
    pub newly_below_area: Option<f64>,
    /// The difference by which a wall became thinnest, negative or 0; `null` if nothing was
    /// compared.
    pub most_thinned: Option<f32>,
    /// The difference by which a wall became thickest, positive or 0.
    pub most_thickened: Option<f32>,
    /// The mean difference over the compared area.
    pub mean: Option<f32>,
    /// The area in each of [`CHANGE_CLASSES`] classes of the difference.
    pub histogram: Vec<f64>,
    /// The end of the histogram's and the colours' scale on both sides: the largest difference, or
    /// the median wall of the later version if that is less. The last classes hold what is beyond.
    pub histogram_top: f32,
    /// The worst places of regions of at least the limits' smallest area, at most [`SPOTS`]: those
    /// that came below the limit, the thinnest first; without a limit those that became thinner.
    pub spots: Vec<ThinnedSpot>,
    /// The difference at the middle of each triangle of the later version, NaN where none was
    /// compared.
    #[serde(skip)]
    pub of_triangles: Vec<f32>,
}

/// The earlier version of a part, to compare places of a later one with.
#[derive(Debug)]
pub struct EarlierVersion {
    prober: WallProber,
    /// A point of the surface that is nearer than this is the same place.
    tolerance: f32,
}

impl EarlierVersion {
    /// Prepares `mesh`. Differences up to `tolerance` are rounding, in the mesh's unit.
    ///
    /// # Errors
    /// Returns an error if a setting is out of range, or the job was cancelled.
    pub fn new(
        mesh: &TriMesh,
        tolerance: f32,
        settings: &ThicknessSettings,
        job: &Job,
    ) -> Result<EarlierVersion, ThicknessError> {
        Ok(EarlierVersion { prober: WallProber::new(mesh, settings, job)?, tolerance })
    }

    /// Returns the wall at the place from which `place` of a later version came; `None` where the
    /// place is new, or there was no wall. `out` is the direction out of the later version there,
    /// of unit length. `is_clear` tells whether a ray from `place` meets nothing of the later
    /// version between two distances.
    pub fn wall(
        &self,
        place: DVec3,
        out: Vec3,
        is_clear: impl Fn(Vec3, [f32; 2]) -> bool,
    ) -> Option<f32> {
        let was = self.origin(place, out, is_clear)?;
        let same_side = f64::from(out.dot(was.away)) >= OPPOSED;
        same_side.then(|| self.prober.wall(&was)).flatten()
    }

    fn origin(
        &self,
        place: DVec3,
        out: Vec3,
        is_clear: impl Fn(Vec3, [f32; 2]) -> bool,
    ) -> Option<FoundPlace> {
        let near = self.prober.found(place)?;
        if near.point.as_dvec3().distance(place) as f32 <= self.tolerance {
            return Some(near);
        }
        // Outwards from within the earlier version through what was removed, or inwards from
        // outside of it through what was added.
        [out, -out].into_iter().find_map(|dir| {
            let far = self.prober.first_on(place.as_vec3(), dir, [0.0, f32::INFINITY])?;
            let was = self.prober.found(place + dir.as_dvec3() * f64::from(far))?;
            let clear = is_clear(dir, [self.tolerance, far - self.tolerance]);
            (clear && was.away.dot(out) > 0.0).then_some(was)
        })
    }
}

/// Both versions, ready to be measured.
struct Versions {
    before: EarlierVersion,
    after: WallProber,
    /// From the frame of the later version to that of the earlier one.
    shift: DVec3,
}

impl Versions {
    fn change(&self, place: Vec3) -> Option<WallChange> {
        let now = self.after.found(place.as_dvec3())?;
        let after = self.after.wall(&now)?;
        let there = now.point.as_dvec3() + self.shift;
        let clear = |dir: Vec3, range| self.after.first_on(now.point, dir, range).is_none();
        let before = self.before.wall(there, now.away, clear)?;
        Some(WallChange { before, after })
    }

    fn changes(&self, places: &[Vec3], job: &Job) -> Result<Vec<Option<WallChange>>, Cancelled> {
        let of = |chunk: &[Vec3]| {
            job.check()?;
            Ok(chunk.iter().map(|&p| self.change(p)).collect::<Vec<_>>())
        };
        Ok(places.par_chunks(CHUNK).map(of).collect::<Result<Vec<_>, Cancelled>>()?.concat())
    }
}

impl WallChanges {
    /// Compares `before` with the later version `after`, which was measured as `checked`.
    ///
    /// # Errors
    /// Returns an error if a setting is out of range, or the job was cancelled.
    pub fn new(
        before: &ReadyPart,
        after: &ReadyPart,
        checked: &CheckedPart,
        settings: &ThicknessSettings,
        job: &Job,
    ) -> Result<WallChanges, ThicknessError> {
        let (measured, answer) = (&checked.thickness, &checked.answer);
        let shift = after.mesh.centre - before.mesh.centre;
        // Each coordinate of both is rounded, and moved to the frame of the other.
        let (lo, hi) = before.mesh.mesh.bounds();
        let reach = lo.abs().max(hi.abs()).max_element() + shift.length() as f32;
        let grain = (before.mesh.grain + after.mesh.grain) as f32;
        let tolerance = 8.0 * (measured.rounding + reach * 1e-6 + grain);
        let versions = Versions {
            before: EarlierVersion::new(before.original_mesh(), tolerance, settings, job)?,
            after: WallProber::new(after.original_mesh(), settings, job)?,
            shift,
        };
        let places: Vec<Vec3> = measured.samples.iter().map(|s| s.position).collect();
        let found = versions.changes(&places, job)?;
        let mesh = &after.mesh.mesh;
        let middle = |t: usize| mesh.corners(t).iter().sum::<Vec3>() / 3.0;
        let middles: Vec<Vec3> = (0..mesh.triangles.len()).map(middle).collect();
        let of_triangles = versions.changes(&middles, job)?;
        let known = || found.iter().flatten().copied();
        let largest = known().map(|c| c.difference().abs()).fold(0.0, f32::max);
        // The rims of a plate are as thick as it is long: their change would press that of walls
        // into one colour.
        let usual = answer.summary.median.unwrap_or(largest);
        let top = largest.min(usual).max(tolerance);
        let each = measured.sample_area;
        let area =
            |of: &dyn Fn(WallChange) -> bool| known().filter(|c| of(*c)).count() as f64 * each;
        let mut histogram = vec![0.0; CHANGE_CLASSES];
        for change in &found {
            let share = change.map(|c| (c.difference() / top).clamp(-1.0, 1.0));
            let class = share.map_or(0, |s| (51.0 + 50.0 * s).round() as usize);
            histogram[class] += each;
        }
        let count = known().count();
        let sum: f64 = known().map(|c| f64::from(c.difference())).sum();
        let extreme = |sign: f32| {
            let most = known().map(|c| c.difference() * sign).fold(0.0, f32::max);
            (count > 0).then_some(if most > tolerance { most * sign } else { 0.0 })
        };
        let limit = answer.limits.fail_below.or(answer.limits.warn_below);
        let newly_below = |limit: f32| {
            move |c: WallChange| c.after < limit - tolerance && c.before >= limit - tolerance
        };
        let thinner = |c: WallChange| c.difference() < -tolerance;
        let counts = |c: &WallChange| limit.map_or(thinner(*c), |l| newly_below(l)(*c));
        let thinned: Vec<(Vec3, WallChange)> = places
            .iter()
            .zip(&found)
            .filter_map(|(&place, change)| Some((place, change.filter(counts)?)))
            .collect();
        let rank = |c: &WallChange| if limit.is_some() { c.after } else { c.difference() };
        let least = answer.limits.minimum_area;
        let spots = regions(&thinned, [each, least], rank, after, &versions.after);
        Ok(WallChanges {
            tolerance,
            compared_area: count as f64 * each,
            new_area: (found.len() - count) as f64 * each,
            thinner_area: area(&thinner),
            thicker_area: area(&|c| c.difference() > tolerance),
            newly_below_area: limit.map(|l| area(&newly_below(l))),
            most_thinned: extreme(-1.0),
            most_thickened: extreme(1.0),
            mean: (count > 0).then(|| (sum / count as f64) as f32),
            histogram,
            histogram_top: top,
            spots,
            of_triangles: of_triangles
                .into_iter()
                .map(|c| c.map_or(f32::NAN, WallChange::difference))
                .collect(),
        })
    }
}

/// The worst place of each region of places beside each other, the worst first. `each`: the area of
/// a place; `least`: that of the smallest region.
fn regions(
    places: &[(Vec3, WallChange)],
    [each, least]: [f64; 2],
    rank: impl Fn(&WallChange) -> f32,
    part: &ReadyPart,
    prober: &WallProber,
) -> Vec<ThinnedSpot> {
    // Places are spread evenly: neighbours are in the same cell or in cells that touch.
    let side = 1.5 * each.sqrt() as f32;
    let cell = |p: Vec3| (p / side).floor().as_ivec3().to_array();
    let mut first: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    let mut sets = DisjointSets::new(places.len());
    for (i, (place, _)) in places.iter().enumerate() {
        let own = cell(*place);
        for step in 0..27 {
            let beside = [0, 1, 2].map(|k| own[k] + step / 3i32.pow(k as u32) % 3 - 1);
            if let Some(&other) = first.get(&beside) {
                sets.join(i as u32, other);
            }
        }
        first.entry(own).or_insert(i as u32);
    }
    let mut found: BTreeMap<u32, (usize, f64)> = BTreeMap::new();
    for i in 0..places.len() {
        let (worst, area) = found.entry(sets.root(i as u32)).or_insert((i, 0.0));
        *area += each;
        if rank(&places[i].1) < rank(&places[*worst].1) {
            *worst = i;
        }
    }
    let mut spots: Vec<(usize, f64)> = found.into_values().filter(|s| s.1 >= least).collect();
    spots.sort_by(|a, b| rank(&places[a.0].1).total_cmp(&rank(&places[b.0].1)));
    let spot = |(i, area): (usize, f64)| {
        let (place, WallChange { before, after }) = places[i];
        let normal = prober.found(place.as_dvec3()).map_or(Vec3::ZERO, |p| p.away).to_array();
        ThinnedSpot { position: part.mesh.to_file(place).to_array(), normal, before, after, area }
    };
    spots.into_iter().take(SPOTS).map(spot).collect()
}

#[cfg(test)]
mod tests {
    use super::super::check::{ThicknessLimits, Verdict};
    use super::super::known_walls::drawn_out;
    use super::*;
    use crate::PolyMesh;
    use crate::shapes::cuboid;

    fn compared(before: &PolyMesh, after: &PolyMesh, limit: Option<f32>) -> (WallChanges, Verdict) {
        let (settings, job) = (ThicknessSettings::default(), Job::default());
        let ready = |part| ReadyPart::new(part, 1.0, None, settings.crease, &job).expect("ready");
        let (before, after) = (ready(before), ready(after));
        let limits = ThicknessLimits { fail_below: limit, ..Default::default() };
        let checked = after.judge("part", &settings, limits, &job, || 0.0).expect("measured");
        let changes = WallChanges::new(&before, &after, &checked, &settings, &job);
        (changes.expect("compared"), checked.answer.verdict)
    }

    /// Plates of 40 x 20 x 5 mm, one of them with a slot 10 mm wide and 2 mm deep across, far from
    /// the origin.
    fn versions() -> [PolyMesh; 2] {
        let profile = [
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, 5.0],
            [25.0, 5.0],
            [25.0, 3.0],
            [15.0, 3.0],
            [15.0, 5.0],
            [0.0, 5.0],
        ];
        let slot = drawn_out(&profile, 20.0);
        let (lo, hi) = slot
            .positions
            .iter()
            .fold((DVec3::MAX, DVec3::MIN), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        [cuboid(lo, hi), slot].map(|mut mesh| {
            mesh.positions.iter_mut().for_each(|p| *p += DVec3::new(3000.0, -500.0, 70.0));
            mesh
        })
    }

    fn summed(found: &WallChanges) -> WallChanges {
        WallChanges { of_triangles: Vec::new(), histogram: Vec::new(), ..found.clone() }
    }

    #[test]
    fn a_slot_thins_what_is_under_it_and_nothing_else() {
        let [plate, slot] = versions();
        let (found, verdict) = compared(&plate, &slot, Some(4.0));
        assert_eq!(verdict, Verdict::Fail);
        let near = |name: &str, value: f64, right: f64| {
            assert!((value - right).abs() <= 0.01 * right, "{name}: {value} for {right}");
        };
        // Its floor and what is opposite, by 2; the ends of the plate beside it, from 40 to 15.
        near("thinner", found.thinner_area, 2.0 * 200.0 + 2.0 * 40.0);
        near("below the limit", found.newly_below_area.expect("a limit"), 400.0);
        near("new", found.new_area, 2.0 * 40.0);
        let all = 2.0 * (40.0 * 20.0 + 5.0 * 20.0 + 40.0 * 5.0 - 10.0 * 2.0) + 2.0 * 2.0 * 20.0;
        near("all", found.compared_area + found.new_area, all);
        assert_eq!(found.thicker_area, 0.0);
        assert!((found.most_thinned.expect("walls") + 25.0).abs() < 1e-3, "{:?}", summed(&found));
        let thinned: Vec<f32> = found.of_triangles.iter().copied().filter(|d| *d < -1e-3).collect();
        let off = |d: &f32| (d + 2.0).abs().min((d + 25.0).abs());
        assert!(!thinned.is_empty() && thinned.iter().all(|d| off(d) < 1e-3));
        let spot = found.spots.first().expect("a spot");
        assert!((spot.before - 5.0).abs() < 1e-3 && (spot.after - 3.0).abs() < 1e-3, "{spot:?}");
        assert_eq!(found.spots.len(), 2, "{:?}", found.spots);
        near("spots", found.spots.iter().map(|s| s.area).sum(), 400.0);
        near("histogram", found.histogram.iter().sum(), all);
    }

    #[test]
    fn versions_the_other_way_round_are_thicker() {
        let [plate, slot] = versions();
        let (found, verdict) = compared(&slot, &plate, None);
        assert_eq!((found.thinner_area, verdict), (0.0, Verdict::Unjudged));
        assert!((found.most_thickened.expect("walls") - 25.0).abs() < 1e-3, "{:?}", summed(&found));
        assert!((found.thicker_area / 480.0 - 1.0).abs() < 0.01, "{:?}", summed(&found));
        // The ends of what fills the slot.
        assert!((found.new_area / 40.0 - 1.0).abs() < 0.01, "{:?}", summed(&found));
        assert!(found.spots.is_empty());
    }

    #[test]
    fn a_part_does_not_differ_from_itself_in_smaller_triangles() {
        let [_, slot] = versions();
        let fine = super::super::refine::refine(&slot.triangulate().0, 1.5).mesh;
        let (found, _) = compared(&slot, &fine.to_poly(), Some(2.0));
        assert!(found.most_thinned.expect("walls") > -1e-2, "{:?}", summed(&found));
        assert!(
            found.most_thickened.expect("walls") < 1e-2 && found.spots.is_empty(),
            "{:?}",
            summed(&found)
        );
    }
}
