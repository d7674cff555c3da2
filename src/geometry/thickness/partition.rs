//! Parts of equal wall: the surface divided where its thickness changes (Shapira, Shamir, Cohen-Or
//! 2008, "Consistent mesh partitioning and skeletonisation using the shape diameter function").
//!
//! The thickness of the triangles is gathered into a few levels, on a scale of ratios. Between two
//! neighbouring levels the surface is then divided at the least cost: a triangle on the wrong side
//! pays by its area and distance, and the border pays by its length, less along a concave
//! crease. Each division is a minimum cut, so it is exact.

use glam::DVec3;

use super::surface::{DROPPED, WeldedSurface};
use super::{Thickness, ThicknessError};
use crate::disjoint_sets::DisjointSets;
use crate::job::{Cancelled, Job};
use crate::min_cut::CutGraph;
use crate::portable::PortableMath;
use crate::thickness::summary::triangle_area;

/// The part of a triangle without area, or of one on a shell without any value.
pub const NO_PART: u32 = u32::MAX;

/// The greatest number of levels.
pub const MOST_LEVELS: usize = 16;
/// The greatest number that is chosen without being asked for.
const MOST_CHOSEN: usize = 8;
/// Levels are added until walls differ from their level by less than this ratio less one.
const SAME_WALL: f64 = 0.08;
/// The usual smoothing: more than 1, since the rim of a wall is as wide as the wall and no wall
/// itself.
pub const SMOOTHING: f32 = 1.25;
/// Classes of the logarithm of the thickness, for the choice of levels.
const BINS: usize = 512;
/// The border's price along a concave edge of 90 degrees or more, of that on a flat surface.
const CONCAVE: f64 = 0.1;

/// The settings of a division.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartitionSettings {
    /// Levels of thickness, 1 to [`MOST_LEVELS`]; `None`: as few as have walls within about 8 % of
    /// their level, at most 8.
    pub levels: Option<usize>,
    /// A spot of another level stays part of its surroundings if its radius is less than about this
    /// many walls, and a strip if its width is; 0 to 10.
    pub smoothing: f32,
}

impl Default for PartitionSettings {
    fn default() -> Self {
        PartitionSettings { levels: None, smoothing: SMOOTHING }
    }
}

/// A border between two parts.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct PartBorder {
    /// The other part.
    pub part: u32,
    /// In the mesh's unit.
    pub length: f64,
}

/// A connected part of the surface whose walls are of one level. Lengths are in the mesh's unit.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct WallPart {
    /// Index into [`WallPartition::levels`].
    pub level: u32,
    /// Half of the part's area is thinner.
    pub median: f32,
    /// The least and the greatest value of its triangles.
    pub range: [f32; 2],
    /// Of its triangles.
    pub area: f64,
    /// The number of its triangles.
    pub triangles: u32,
    /// The middle of its surface.
    pub centre: [f64; 3],
    /// Its borders with other parts, by the other part.
    pub borders: Vec<PartBorder>,
}

/// A surface divided into parts of equal wall.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct WallPartition {
    /// The usual thickness of each level, rising.
    pub levels: Vec<f32>,
    /// The parts, the largest first.
    pub parts: Vec<WallPart>,
    /// The part of each triangle, or [`NO_PART`].
    #[serde(skip)]
    pub of: Vec<u32>,
}

impl WallPartition {
    /// The same with its places moved, from a mesh about the origin to where its file has it.
    pub fn moved(mut self, by: DVec3) -> WallPartition {
        self.parts.iter_mut().for_each(|p| p.centre = (DVec3::from(p.centre) + by).to_array());
        self
    }
}

/// An edge between two triangles.
pub(super) struct SharedEdge {
    pub(super) triangles: [u32; 2],
    pub(super) ends: [u32; 2],
}

/// The edges at which triangles meet; where more than two do, each is joined to the next.
pub(super) fn shared_edges(surface: &WeldedSurface) -> Vec<SharedEdge> {
    let mut sides: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * surface.triangles.len());
    for (t, &[a, b, c]) in surface.triangles.iter().enumerate() {
        if a != DROPPED {
            sides.extend([(a, b), (b, c), (c, a)].map(|(x, y)| (x.min(y), x.max(y), t as u32)));
        }
    }
    sides.sort_unstable();
    let pairs = sides.windows(2).filter(|two| (two[0].0, two[0].1) == (two[1].0, two[1].1));
    pairs
        .map(|two| SharedEdge { triangles: [two[0].2, two[1].2], ends: [two[0].0, two[0].1] })
        .collect()
}

impl Thickness {
    /// Divides the surface into parts of equal wall. Needs values of the triangles
    /// ([`super::MeasuredPlaces::VerticesAndFaces`]); triangles that are large beside their wall
    /// are never cut, so a coarse part should have been refined.
    ///
    /// # Errors
    /// Returns an error if a setting is out of its range, or if there are no values of triangles.
    pub fn partition(
        &self,
        settings: PartitionSettings,
        job: &Job,
    ) -> Result<WallPartition, ThicknessError> {
        let PartitionSettings { levels, smoothing } = settings;
        let say = |what, got, expected| Err(ThicknessError::Setting { what, got, expected });
        if let Some(n) = levels.filter(|n| !(1..=MOST_LEVELS).contains(n)) {
            return say("the number of levels", n as f32, "from 1 to 16");
        }
        if !(0.0..=10.0).contains(&smoothing) {
            return say("the smoothing", smoothing, "from 0 to 10 walls");
        }
        if self.face_values.len() != self.surface.triangles.len() {
            return say("the number of values of triangles", 0.0, "one for each triangle");
        }
        Ok(partition(&self.surface, &self.face_values, levels, f64::from(smoothing), job)?)
    }
}

fn partition(
    surface: &WeldedSurface,
    values: &[f32],
    levels: Option<usize>,
    smoothing: f64,
    job: &Job,
) -> Result<WallPartition, Cancelled> {
    let area: Vec<f64> = (0..surface.triangles.len())
        .map(|t| surface.corners(t).map_or(0.0, triangle_area))
        .collect();
    let logs: Vec<f64> = values
        .iter()
        .map(|&v| if v > 0.0 && v.is_finite() { f64::from(v).portable_ln() } else { f64::NAN })
        .collect();
    let means = level_means(&logs, &area, levels);
    let edges = shared_edges(surface);
    let prices: Vec<f64> = edges.iter().map(|e| border_price(surface, e)).collect();
    let mut level = vec![0u32; values.len()];
    for (k, two) in means.windows(2).enumerate() {
        let (middle, half) = (0.5 * (two[0] + two[1]), 0.5 * (two[1] - two[0]));
        // A disc of the thicker level stays if its area's gain is more than the price of its rim,
        // that is, if its radius exceeds the smoothing times the wall.
        let line = smoothing * half * middle.portable_exp();
        let thicker = divided(&logs, &area, &edges, &prices, [middle, half], line).cut(job)?;
        job.progress((k + 1) as f32 / means.len() as f32);
        for (l, thicker) in level.iter_mut().zip(thicker) {
            *l += u32::from(thicker && *l == k as u32);
        }
    }
    Ok(collect(surface, values, &area, &edges, &level, &means))
}

/// For each triangle, whether it is on the thicker side of `middle`.
fn divided(
    logs: &[f64],
    area: &[f64],
    edges: &[SharedEdge],
    prices: &[f64],
    [middle, half]: [f64; 2],
    line: f64,
) -> CutGraph {
    // A rim, whose value is far beyond both levels, counts as no more than a wall of a level.
    let pull: Vec<f64> = logs
        .iter()
        .zip(area)
        .map(|(x, a)| if x.is_nan() { 0.0 } else { 2.0 * a * (x - middle).clamp(-half, half) })
        .collect();
    let all: f64 = pull.iter().map(|p| p.abs()).sum::<f64>() + line * prices.iter().sum::<f64>();
    let unit = if all > 0.0 { (1u64 << 60) as f64 / all } else { 0.0 };
    let whole = |cost: f64| (cost * unit).round() as i64;
    let weighted: Vec<(u32, u32, i64)> = edges
        .iter()
        .zip(prices)
        .map(|(e, p)| (e.triangles[0], e.triangles[1], whole(line * p)))
        .collect();
    CutGraph::new(pull.into_iter().map(whole).collect(), &weighted)
}

/// The price of a border along an edge: its length, less where the surface is concave there.
fn border_price(surface: &WeldedSurface, edge: &SharedEdge) -> f64 {
    let [a, b] = edge.ends.map(|v| surface.positions[v as usize]);
    let [m, n] = edge.triangles.map(|t| surface.face_normals[t as usize]);
    let other = edge.triangles[1] as usize;
    let middle = surface.corners(other).map_or(a, |[p, q, r]| (p + q + r) / 3.0);
    let outward = if surface.faults.inside_out { -1.0 } else { 1.0 };
    let turn = f64::from(1.0 - m.dot(n)).clamp(0.0, 1.0);
    let concave = (middle - a).dot(m) * outward > 0.0;
    f64::from(a.distance(b)) * if concave { 1.0 - (1.0 - CONCAVE) * turn } else { 1.0 }
}

/// The logarithms of the levels, rising: the means that minimise the squared distance of the area
/// to its nearest mean, exactly, up to the width of a class.
fn level_means(logs: &[f64], area: &[f64], levels: Option<usize>) -> Vec<f64> {
    let known = || logs.iter().zip(area).filter(|(x, a)| x.is_finite() && **a > 0.0);
    let low = known().map(|k| *k.0).fold(f64::INFINITY, f64::min);
    let high = known().map(|k| *k.0).fold(f64::NEG_INFINITY, f64::max);
    if !(low <= high) {
        return vec![0.0];
    }
    let width = ((high - low) / BINS as f64).max(1e-12);
    // Of each class its area, and the area times the logarithm and its square.
    let mut bins = vec![[0.0f64; 3]; BINS];
    for (x, a) in known() {
        let bin = &mut bins[(((x - low) / width) as usize).min(BINS - 1)];
        let x = x - low;
        *bin = [bin[0] + a, bin[1] + a * x, bin[2] + a * x * x];
    }
    bins.retain(|b| b[0] > 0.0);
    let mut sums = vec![[0.0f64; 3]];
    for b in &bins {
        let last = sums[sums.len() - 1];
        sums.push([last[0] + b[0], last[1] + b[1], last[2] + b[2]]);
    }
    let n = bins.len();
    let cost = |from: usize, to: usize| {
        let [a, x, xx] = [0, 1, 2].map(|k| sums[to][k] - sums[from][k]);
        (xx - x * x / a).max(0.0)
    };
    let most = levels.unwrap_or(MOST_CHOSEN).min(n);
    // The least cost of the first `to` classes with one level more each round, and where the last
    // level begins.
    let mut best: Vec<f64> = (0..=n).map(|to| if to == 0 { 0.0 } else { cost(0, to) }).collect();
    let mut begins = vec![vec![0usize; n + 1]];
    let enough = |best: &[f64]| best[n] <= sums[n][0] * SAME_WALL * SAME_WALL;
    while begins.len() < most && (levels.is_some() || !enough(&best)) {
        let k = begins.len();
        let (mut next, mut begin) = (vec![f64::INFINITY; n + 1], vec![0usize; n + 1]);
        for to in k + 1..=n {
            for from in k..to {
                let c = best[from] + cost(from, to);
                if c < next[to] {
                    (next[to], begin[to]) = (c, from);
                }
            }
        }
        best = next;
        begins.push(begin);
    }
    let mut means = Vec::new();
    let mut to = n;
    for begin in begins.iter().rev() {
        let from = begin[to];
        means.push(low + (sums[to][1] - sums[from][1]) / (sums[to][0] - sums[from][0]));
        to = from;
    }
    means.reverse();
    means
}

/// Sorts values, each with its area; half of the area has at most the returned one.
pub(super) fn median_by_area(values: &mut [(f32, f64)]) -> Option<f32> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = values.iter().map(|v| v.1).sum::<f64>() / 2.0;
    let mut passed = 0.0;
    let middle = values.iter().find(|v| {
        passed += v.1;
        passed >= half
    });
    middle.or(values.first()).map(|v| v.0)
}

/// The connected parts of equal level, the largest first.
fn collect(
    surface: &WeldedSurface,
    values: &[f32],
    area: &[f64],
    edges: &[SharedEdge],
    level: &[u32],
    means: &[f64],
) -> WallPartition {
    let n = level.len();
    let mut joined = DisjointSets::new(n);
    for e in edges {
        let [a, b] = e.triangles;
        if level[a as usize] == level[b as usize] {
            joined.join(a, b);
        }
    }
    let kept = |t: &u32| surface.triangles[*t as usize][0] != DROPPED;
    let mut members: Vec<(u32, u32)> =
        (0..n as u32).filter(kept).map(|t| (joined.root(t), t)).collect();
    members.sort_unstable();
    let mut found: Vec<(WallPart, Vec<u32>)> = Vec::new();
    for part in members.chunk_by(|a, b| a.0 == b.0) {
        let own: Vec<u32> = part.iter().map(|m| m.1).collect();
        let mut by_value: Vec<(f32, f64)> = own
            .iter()
            .map(|&t| (values[t as usize], area[t as usize]))
            .filter(|v| v.0.is_finite())
            .collect();
        let Some(median) = median_by_area(&mut by_value) else { continue };
        let range = [by_value[0].0, by_value[by_value.len() - 1].0];
        let all: f64 = own.iter().map(|&t| area[t as usize]).sum();
        let mut centre = DVec3::ZERO;
        for &t in &own {
            let Some([a, b, c]) = surface.corners(t as usize) else { continue };
            centre += ((a + b + c) / 3.0).as_dvec3() * area[t as usize];
        }
        let centre = if all > 0.0 { centre / all } else { DVec3::ZERO };
        let part = WallPart {
            level: level[own[0] as usize],
            median,
            range,
            area: all,
            triangles: own.len() as u32,
            centre: centre.to_array(),
            borders: Vec::new(),
        };
        found.push((part, own));
    }
    found.sort_by(|a, b| b.0.area.total_cmp(&a.0.area).then(a.1[0].cmp(&b.1[0])));
    let mut of = vec![NO_PART; n];
    for (p, (_, own)) in found.iter().enumerate() {
        own.iter().for_each(|&t| of[t as usize] = p as u32);
    }
    let mut parts: Vec<WallPart> = found.into_iter().map(|f| f.0).collect();
    let mut borders: Vec<(u32, u32, f64)> = Vec::new();
    for e in edges {
        let [a, b] = e.triangles.map(|t| of[t as usize]);
        if a != b && a != NO_PART && b != NO_PART {
            let [p, q] = e.ends.map(|v| surface.positions[v as usize]);
            let length = f64::from(p.distance(q));
            borders.extend([(a, b, length), (b, a, length)]);
        }
    }
    borders.sort_by_key(|b| (b.0, b.1));
    for border in borders.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let length = border.iter().map(|b| b.2).sum();
        parts[border[0].0 as usize].borders.push(PartBorder { part: border[0].1, length });
    }
    let levels = means.iter().map(|m| m.portable_exp() as f32).collect();
    WallPartition { levels, parts, of }
}

#[cfg(test)]
mod tests {
    use super::super::refine::refine;
    use super::super::{MeasuredPlaces, ThicknessSettings, measure};
    use super::*;
    use crate::TriMesh;
    use crate::shapes;
    use glam::DQuat;

    const PAIRS: MeasuredPlaces = MeasuredPlaces::VerticesAndFaces;

    fn divided_part(mesh: &TriMesh, how: PartitionSettings) -> (TriMesh, WallPartition) {
        let settings = ThicknessSettings { at: PAIRS, ..ThicknessSettings::default() };
        let measured = measure(mesh, &settings, &Job::default()).expect("not cancelled");
        (mesh.clone(), measured.partition(how, &Job::default()).expect("valid settings"))
    }

    /// A slab 60 x 40 of 2 mm whose second half has 5 mm, in triangles of about a millimetre.
    fn two_walls(turn: DQuat) -> TriMesh {
        let profile = [[0.0, 0.0], [60.0, 0.0], [60.0, 5.0], [30.0, 5.0], [30.0, 2.0], [0.0, 2.0]];
        let n = profile.len() as u32;
        let mut mesh = crate::PolyMesh::new();
        for y in [0.0, 40.0] {
            mesh.positions.extend(profile.map(|[x, z]| turn * DVec3::new(x, y, z)));
        }
        let mut face = |corners: &[u32]| {
            mesh.corners.extend(corners);
            mesh.face_starts.push(mesh.corners.len() as u32);
        };
        face(&(0..n).collect::<Vec<_>>());
        face(&(n..2 * n).rev().collect::<Vec<_>>());
        (0..n).for_each(|i| face(&[i, i + n, (i + 1) % n + n, (i + 1) % n]));
        refine(&mesh.triangulate().0, 1.0).mesh
    }

    #[test]
    fn a_stepped_slab_has_its_two_walls_and_the_border_at_the_step() {
        for turn in [DQuat::IDENTITY, DQuat::from_scaled_axis(DVec3::new(0.7, -0.4, 1.9))] {
            let how = PartitionSettings { levels: Some(3), ..PartitionSettings::default() };
            let (mesh, found) = divided_part(&two_walls(turn), how);
            let walls: Vec<f32> = found.parts.iter().map(|p| p.median).collect();
            // Thick and thin; the rims, which measure along the slab, are narrow beside that.
            assert_eq!(found.parts.len(), 2, "{walls:?}");
            let large: Vec<&WallPart> = found.parts.iter().collect();
            assert!((large[0].median - 5.0).abs() < 1e-3, "{walls:?}");
            assert!((large[1].median - 2.0).abs() < 1e-3, "{walls:?}");
            for (part, (x, area)) in large.iter().zip([(45.4, 3020.0), (14.5, 2600.0)]) {
                assert!((part.area - area).abs() < 0.03 * area, "{}", part.area);
                let centre = turn.inverse() * DVec3::from(part.centre);
                assert!((centre.x - x).abs() < 1.0 && (centre.y - 20.0).abs() < 1.0, "{centre}");
            }
            // The border runs along the step, once around.
            let border = large[0].borders.iter().find(|b| b.part == 1).expect("they meet");
            assert!((border.length - 84.0).abs() < 12.0, "{}", border.length);
            for (t, &part) in found.of.iter().enumerate().filter(|p| *p.1 < 2) {
                let [a, b, c] = mesh.corners(t).map(|p| turn.inverse() * p.as_dvec3());
                let middle = (a + b + c) / 3.0;
                let at_step = (middle.x - 30.0).abs() < 1.5;
                assert!(at_step || (middle.x > 30.0) == (part == 0), "{middle} in {part}");
            }
            let all: f64 = found.parts.iter().map(|p| p.area).sum();
            let area = crate::measure::measures(&mesh).area;
            assert!((all / area - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn levels_are_as_few_as_the_walls_need() {
        let ball = shapes::icosphere(10.0, 24);
        let (_, found) = divided_part(&ball, PartitionSettings::default());
        assert_eq!((found.levels.len(), found.parts.len()), (1, 1), "{:?}", found.levels);
        assert!((found.levels[0] - 20.0).abs() < 0.3);
        let (_, found) = divided_part(&two_walls(DQuat::IDENTITY), PartitionSettings::default());
        for wall in [2.0, 5.0] {
            assert!(
                found.levels.iter().any(|l| (l / wall - 1.0).abs() < 0.02),
                "{:?}",
                found.levels
            );
        }
    }

    #[test]
    fn more_smoothing_never_makes_the_borders_longer() {
        let mesh = two_walls(DQuat::IDENTITY);
        let rims = |smoothing| {
            let how = PartitionSettings { levels: Some(4), smoothing };
            let (_, found) = divided_part(&mesh, how);
            found.parts.iter().flat_map(|p| &p.borders).map(|b| b.length).sum::<f64>()
        };
        let lengths = [0.0, 1.25, 6.0].map(rims);
        assert!(lengths[0] >= lengths[1] && lengths[1] >= lengths[2], "{lengths:?}");
    }

    #[test]
    fn senseless_settings_are_refused() {
        let settings = ThicknessSettings { at: PAIRS, ..ThicknessSettings::default() };
        let ball = shapes::icosphere(1.0, 4);
        let measured = measure(&ball, &settings, &Job::default()).expect("not cancelled");
        for how in [
            PartitionSettings { levels: Some(0), smoothing: 0.5 },
            PartitionSettings { levels: Some(17), smoothing: 0.5 },
            PartitionSettings { levels: None, smoothing: -1.0 },
            PartitionSettings { levels: None, smoothing: f32::NAN },
        ] {
            assert!(measured.partition(how, &Job::default()).is_err(), "{how:?}");
        }
        let job = Job::default();
        let plain = measure(&ball, &ThicknessSettings::default(), &job).expect("not cancelled");
        assert!(plain.partition(PartitionSettings::default(), &job).is_err());
    }

    #[test]
    fn a_partition_and_a_curve_end_when_they_are_cancelled() {
        let job = Job::default();
        let settings = ThicknessSettings { at: PAIRS, ..ThicknessSettings::default() };
        let ball = shapes::torus(20.0, 3.0, 40, 20).triangulate().0;
        let measured = measure(&ball, &settings, &job).expect("not cancelled");
        assert!(measured.medial_curve(&job).is_ok());
        job.cancel();
        let how = PartitionSettings { levels: Some(2), ..PartitionSettings::default() };
        assert!(matches!(measured.partition(how, &job), Err(ThicknessError::Cancelled(_))));
        assert!(matches!(measured.medial_curve(&job), Err(ThicknessError::Cancelled(_))));
    }
}
