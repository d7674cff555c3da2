//! What a map of thickness comes to: statistics, the histogram, the share of the area below a
//! limit, the error bound.

use glam::Vec3;

use super::{AreaSample, Correction, Reason, Thickness, ThicknessMethod};

/// Classes of the histogram: the first is the area without a value, the other hundred run from 0 to
/// [`ThicknessSummary::histogram_top`].
pub const CLASSES: usize = 101;

/// The statistics of a map of thickness. Lengths are in the mesh's unit.
#[derive(Debug, Clone, serde::Serialize)]
pub struct ThicknessSummary {
    /// The least wall, see [`Thickness::least`]; `null` where no place has a wall.
    pub min: Option<f32>,
    /// The largest value of a sample.
    pub max: Option<f32>,
    /// The mean over the area, see [`Thickness::samples`].
    pub mean: Option<f32>,
    /// Half of the area is thinner.
    pub median: Option<f32>,
    /// The mean of the class of the histogram with the largest area: the usual wall.
    pub most_frequent: Option<f32>,
    /// Share of the vertices that belong to a face and have a value, 0 to 1.
    pub valid: f32,
    /// The area in each of [`CLASSES`] classes, in the square of the unit. The last class also
    /// holds what is thicker than its end.
    pub histogram: Vec<f64>,
    /// The end of the last class: the maximum, or a twentieth above the value that 99 of 100 parts
    /// of the area stay below, if that is less. So the rims of a plate, which are as thick as the
    /// plate is long, do not press the walls into one class.
    pub histogram_top: Option<f32>,
    /// The position of the least wall.
    pub thinnest: Option<[f32; 3]>,
    /// The position of the largest value.
    pub thickest: Option<[f32; 3]>,
    /// Vertices without a value, by the reason.
    pub missing: MissingCounts,
    /// Vertices on sharp edges, whose value follows the edge policy.
    pub edge_vertices: u64,
    /// See [`Thickness::error_bound`].
    pub error_bound: f32,
}

/// Vertices without a value, counted by the reason; see [`Reason`].
#[derive(Debug, Clone, Copy, Default, serde::Serialize)]
pub struct MissingCounts {
    /// No wall lies ahead.
    pub nothing_ahead: u64,
    /// The faces around the vertex cancel each other.
    pub no_normal: u64,
    /// The vertex belongs to no face of any area.
    pub no_face: u64,
    /// The vertex is on a sharp edge, and the policy is [`super::EdgePolicy::Neutral`].
    pub edge: u64,
}

/// The area beyond a limit, in the square of the unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeyondArea {
    /// The area.
    pub area: f64,
    /// The greatest error of `area`.
    pub error: f64,
    /// The area that has values.
    pub all: f64,
}

/// Over the area that has values; `None` where none has.
#[derive(Default)]
struct AreaStatistics {
    mean: Option<f32>,
    median: Option<f32>,
    /// 99 of 100 parts of the area are thinner.
    most: Option<f32>,
}

impl Thickness {
    /// Values of the welded vertices, each once, with their position.
    fn each(&self) -> impl Iterator<Item = (f32, Reason, Vec3)> + '_ {
        let mut seen = 0;
        self.surface.weld.iter().enumerate().filter_map(move |(i, &w)| {
            // Welded vertices are numbered by first appearance.
            if w != seen {
                return None;
            }
            seen += 1;
            Some((self.values[i], self.reasons[i], self.surface.positions[w as usize]))
        })
    }

    /// The statistics. Maximum, mean, median and histogram are over places spread evenly over the
    /// area, so that a finer mesh of the same part says the same.
    pub fn summary(&self) -> ThicknessSummary {
        let mut missing = MissingCounts::default();
        let (mut edge_vertices, mut known) = (0, 0u64);
        let mut least: Option<(f32, Vec3)> = None;
        for (value, reason, at) in self.each() {
            edge_vertices += (reason == Reason::Edge) as u64;
            if value.is_finite() {
                known += 1;
                if least.is_none_or(|l| value < l.0) {
                    least = Some((value, at));
                }
                continue;
            }
            match reason {
                Reason::NoNormal => missing.no_normal += 1,
                Reason::NoFace => missing.no_face += 1,
                Reason::Edge => missing.edge += 1,
                Reason::NothingAhead | Reason::Measured => missing.nothing_ahead += 1,
            }
        }
        let largest = |a: &&AreaSample, b: &&AreaSample| {
            a.value.total_cmp(&b.value).then(b.triangle.cmp(&a.triangle))
        };
        let thickest = self.samples.iter().filter(|s| s.value.is_finite()).max_by(largest);
        let AreaStatistics { mean, median, most } = self.by_area();
        let absent = missing.nothing_ahead + missing.no_normal + missing.edge;
        let max = thickest.map(|v| v.value);
        let top = max.map(|max| most.map_or(max, |most| (most * 1.05).min(max)));
        let mut histogram = vec![0.0f64; CLASSES];
        for s in &self.samples {
            histogram[class_of(s.value, top)] += self.sample_area;
        }
        let most_frequent = top.and_then(|top| self.usual(top, &histogram));
        // If every place belongs to an edge, the map's least value still indicates the size.
        let least = match self.least {
            Some(l) => Some((l.value as f32, l.place().as_vec3())),
            None => least,
        };
        ThicknessSummary {
            min: least.map(|v| v.0),
            max,
            mean,
            median,
            most_frequent,
            valid: known as f32 / (known as f32 + absent as f32).max(1.0),
            histogram,
            histogram_top: top,
            thinnest: least.map(|v| v.1.to_array()),
            thickest: thickest.map(|v| v.position.to_array()),
            missing,
            edge_vertices,
            error_bound: self.error_bound(),
        }
    }

    /// The mean of the class of the histogram with the largest area.
    fn usual(&self, top: f32, histogram: &[f64]) -> Option<f32> {
        let classes = histogram.iter().enumerate().skip(1);
        let (fullest, _) = classes.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0)))?;
        let own = self.samples.iter().filter(|s| class_of(s.value, Some(top)) == fullest);
        let (sum, n) = own.fold((0.0, 0.0), |(s, n), v| (s + f64::from(v.value), n + 1.0));
        (n > 0.0).then_some((sum / n) as f32)
    }

    fn by_area(&self) -> AreaStatistics {
        let values = self.samples.iter().map(|s| s.value);
        let mut known: Vec<f32> = values.filter(|v| v.is_finite()).collect();
        if known.is_empty() {
            return AreaStatistics::default();
        }
        known.sort_unstable_by(f32::total_cmp);
        let sum: f64 = known.iter().map(|&v| f64::from(v)).sum();
        let share = |share: f64| known[((known.len() - 1) as f64 * share) as usize];
        let mean = (sum / known.len() as f64) as f32;
        AreaStatistics { mean: Some(mean), median: Some(share(0.5)), most: Some(share(0.99)) }
    }

    /// Returns a bound on the error of every value that is not on a sharp edge, relative to the
    /// curved surface that the triangles approximate. It is the sum of four parts. The first is
    /// single precision. The second is the normal, uncertain by half of the spread of the faces at
    /// the vertex, which lengthens a ray by 1/cos of it. The third is the facets' distance from the
    /// curved surface. The fourth, for a cone, is the distance of its mean from the ray along the
    /// normal. A cone that is not corrected also carries the bias of its geometry, up to 32 % at
    /// 120 degrees, which is included.
    pub fn error_bound(&self) -> f32 {
        let s = &self.surface;
        let half = (self.settings.opening * 0.5).to_radians();
        // The mean length of the cone's rays through a slab, over its thickness: (int dz / z) /
        // (int dz).
        let long = if self.settings.rays_at_a_place() > 1 && half > 0.0 {
            -half.cos().ln() / (1.0 - half.cos())
        } else {
            1.0
        };
        let biased = self.settings.correction == Correction::None;
        let mut most = 4.0 * self.rounding;
        for (i, &w) in s.weld.iter().enumerate() {
            let (value, v) = (self.values[i], w as usize);
            if !value.is_finite() || s.sharp[v] || self.reasons[i] != Reason::Measured {
                continue;
            }
            let least = s
                .around(v)
                .iter()
                .map(|&t| s.face_normals[t as usize].dot(s.normals[v]))
                .fold(1.0f32, f32::min);
            let tilt = (least.clamp(-1.0, 1.0).acos() * 0.5).min(1.2);
            let mut bound = 4.0 * self.rounding + value * (1.0 / tilt.cos() - 1.0) + self.errors[i];
            if self.settings.method == ThicknessMethod::Sphere {
                // Touches up to 20 degrees beside the normal, and a facet's normal that is off by
                // twice `tilt`.
                bound += value * 0.37 * 2.0 * tilt;
            }
            if biased {
                bound += value * (1.0 - 1.0 / long);
            }
            most = most.max(bound);
        }
        // Places between the vertices are on facets, which deviate from the curved surface.
        let off = (0..s.triangles.len() as u32).map(|t| s.sagitta(t)).fold(0.0, f32::max);
        most + off
    }

    /// Welded vertex values, for walks over the surface.
    pub fn welded_values(&self) -> Vec<f32> {
        let mut out = vec![f32::NAN; self.surface.positions.len()];
        for (i, &w) in self.surface.weld.iter().enumerate() {
            out[w as usize] = self.values[i];
        }
        out
    }

    /// Area of the surface where the value is strictly below `limit` (or, with `above`, strictly
    /// over it), the area that has values at all, and the error of the first. Below the limit that
    /// was asked for, rays along the normal are integrated facet by facet; else the samples count.
    pub fn area_beyond(&self, limit: f32, above: bool) -> BeyondArea {
        let sign = if above { -1.0 } else { 1.0 };
        let known = self.samples.iter().filter(|s| s.value.is_finite()).count();
        let all = known as f64 * self.sample_area;
        let exact = self.thin.as_ref().filter(|t| !above && t.limit as f32 == limit);
        if let Some(thin) = exact {
            let (area, error) =
                thin.facets.iter().fold((0.0, 0.0), |(a, e), f| (a + f.area, e + f.error));
            return BeyondArea { area: area.min(all), error, all };
        }
        let room = 8.0 * self.rounding * sign;
        let beyond = |s: &&AreaSample| {
            (s.value - limit) * sign < 0.0 && (s.value - limit + room) * sign < 0.0
        };
        let count = self.samples.iter().filter(beyond).count();
        let share = count as f64 / known.max(1) as f64;
        // Twice the standard deviation of independent samples; evenly spread ones do better.
        let error = 2.0 * (share * (1.0 - share) / known.max(1) as f64).sqrt() * all;
        BeyondArea { area: count as f64 * self.sample_area, error: error + self.sample_area, all }
    }

    /// The largest ratio, either way, between the value at a vertex and those of the vertices
    /// within `reach` times its value along the edges (moulding: walls should change gently). 1
    /// where nothing differs, NaN without a value.
    pub fn neighbour_ratio(&self, reach: f32) -> Vec<f32> {
        use rayon::prelude::*;
        /// Vertices looked at around each: keeps the cost linear on dense meshes, whose neighbours
        /// differ little.
        const MOST: usize = 64;
        let (s, values) = (&self.surface, self.welded_values());
        let ratio = |v: usize| {
            let own = values[v];
            if !own.is_finite() || own <= 0.0 {
                return f32::NAN;
            }
            let (mut seen, mut next, mut beside) = (vec![v as u32], 0, Vec::new());
            let mut worst = 1.0f32;
            while next < seen.len() && seen.len() < MOST {
                s.neighbours(seen[next] as usize, &mut beside);
                next += 1;
                for &u in &beside {
                    let near = s.positions[u as usize].distance(s.positions[v]) <= reach * own;
                    if near && !seen.contains(&u) {
                        seen.push(u);
                        let other = values[u as usize];
                        if other.is_finite() && other > 0.0 {
                            worst = worst.max(other / own).max(own / other);
                        }
                    }
                }
            }
            worst
        };
        let welded: Vec<f32> = (0..s.positions.len()).into_par_iter().map(ratio).collect();
        s.weld.iter().map(|&w| welded[w as usize]).collect()
    }
}

pub(super) fn triangle_area([a, b, c]: [Vec3; 3]) -> f64 {
    (b - a).as_dvec3().cross((c - a).as_dvec3()).length() * 0.5
}

/// The class of the histogram that a value belongs to.
fn class_of(value: f32, top: Option<f32>) -> usize {
    let share = value / top.filter(|&m| m > 0.0).unwrap_or(1.0);
    if share.is_finite() { 1 + ((share * 100.0) as usize).min(99) } else { 0 }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::refine::refine;
    use super::super::{EdgePolicy, ThicknessMethod, ThicknessSettings, measure};
    use crate::job::Job;
    use crate::shapes::{cone, cuboid};

    #[test]
    fn statistics_do_not_depend_on_the_meshing() {
        let half = DVec3::new(50.0, 50.0, 1.5);
        let slab = cuboid(-half, half).triangulate().0;
        // Two faces of 100 by 100, 3 thick; four rims of 100 by 3, 100 thick.
        let mean = (20_000.0 * 3.0 + 1_200.0 * 100.0) / 21_200.0;
        for mesh in [slab.clone(), refine(&slab, 12.0).mesh, refine(&slab, 5.0).mesh] {
            let s = measure(&mesh, &ThicknessSettings::default(), &Job::default())
                .expect("measured")
                .summary();
            assert!((s.median.expect("walls") - 3.0).abs() < 1e-3, "{:?}", s.median);
            assert!((s.mean.expect("walls") / mean - 1.0).abs() < 0.01, "{:?}", s.mean);
            assert!((s.histogram.iter().sum::<f64>() - 21_200.0).abs() < 1.0);
            assert!(s.min <= s.median && s.median <= s.max && s.mean <= s.max, "{s:?}");
        }
    }

    #[test]
    fn no_wall_is_thicker_than_the_part() {
        let mesh = cone(30.0, 50.0, 48).triangulate().0;
        let settings = ThicknessSettings {
            method: ThicknessMethod::Cone,
            rays: 100,
            opening: 120.0,
            edges: EdgePolicy::Raw,
            ..Default::default()
        };
        let t = measure(&mesh, &settings, &Job::default()).expect("measured");
        let (lo, hi) = mesh.bounds();
        for (&value, normal) in t.values.iter().zip(&t.surface.normals) {
            let most = (hi - lo).dot(normal.abs()) * 1.001;
            assert!(value.is_nan() || value <= most, "{value} in {most}");
        }
    }
}
