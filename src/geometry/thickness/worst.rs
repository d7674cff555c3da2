//! The worst spots: connected regions beyond a limit, the thinnest first.

use super::summary::triangle_area;
use super::{Thickness, ThinFacet, ThinFacets};
use crate::disjoint_sets::DisjointSets;

/// A connected region below the limit.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct ThinRegion {
    /// Of its thinnest vertex.
    pub position: [f32; 3],
    /// The outward normal there.
    pub normal: [f32; 3],
    /// At its thinnest vertex.
    pub thickness: f32,
    /// A third of each triangle for each of its corners in the region.
    pub area: f64,
    /// Welded vertices in the region.
    pub vertices: u32,
}

impl Thickness {
    /// At most `count` regions of values strictly below `limit` and of at least `minimum_area`, the
    /// thinnest first.
    pub fn worst(&self, limit: f32, minimum_area: f64, count: usize) -> Vec<ThinRegion> {
        if let Some(thin) = self.thin.as_ref().filter(|t| t.limit as f32 == limit) {
            return thin.regions(minimum_area, count);
        }
        let (s, values) = (&self.surface, self.welded_values());
        let mut area = vec![0.0f64; s.positions.len()];
        for t in 0..s.triangles.len() {
            if let Some(p) = s.corners(t) {
                s.triangles[t].iter().for_each(|&v| area[v as usize] += triangle_area(p) / 3.0);
            }
        }
        let mut seen = vec![false; values.len()];
        let mut beside = Vec::new();
        let mut spots = Vec::new();
        for start in 0..values.len() {
            if seen[start] || !below(values[start], limit) {
                continue;
            }
            seen[start] = true;
            let mut todo = vec![start as u32];
            let (mut thinnest, mut sum, mut n) = (start, 0.0, 0);
            while let Some(v) = todo.pop() {
                let v = v as usize;
                sum += area[v];
                n += 1;
                if values[v].total_cmp(&values[thinnest]).then(v.cmp(&thinnest)).is_lt() {
                    thinnest = v;
                }
                s.neighbours(v, &mut beside);
                for &u in &beside {
                    if !seen[u as usize] && below(values[u as usize], limit) {
                        seen[u as usize] = true;
                        todo.push(u);
                    }
                }
            }
            if sum >= minimum_area {
                spots.push(ThinRegion {
                    position: s.positions[thinnest].to_array(),
                    normal: (s.normals[thinnest] * if s.faults.inside_out { -1.0 } else { 1.0 })
                        .to_array(),
                    thickness: values[thinnest],
                    area: sum,
                    vertices: n,
                });
            }
        }
        spots.sort_by(|a, b| a.thickness.total_cmp(&b.thickness).then(b.area.total_cmp(&a.area)));
        spots.truncate(count);
        spots
    }

    /// The limit below which the thinnest `share` of the vertices lies: for the worst spots where
    /// no limit was given.
    pub fn quantile(&self, share: f32) -> Option<f32> {
        let mut known: Vec<f32> = self.values.iter().copied().filter(|v| v.is_finite()).collect();
        if known.is_empty() {
            return None;
        }
        let at = ((known.len() - 1) as f32 * share) as usize;
        Some(*known.select_nth_unstable_by(at, f32::total_cmp).1)
    }
}

impl ThinFacets {
    /// At most `count` regions of facets that share corners, of at least `minimum_area`, the
    /// thinnest first.
    pub fn regions(&self, minimum_area: f64, count: usize) -> Vec<ThinRegion> {
        let mut corners: Vec<u32> = self.facets.iter().flat_map(|f| f.corners).collect();
        corners.sort_unstable();
        corners.dedup();
        let place = |v: u32| corners.partition_point(|&c| c < v) as u32;
        let mut sets = DisjointSets::new(corners.len());
        for f in &self.facets {
            let [a, b, c] = f.corners.map(place);
            sets.join(a, b);
            sets.join(b, c);
        }
        let mut regions: Vec<(u32, &ThinFacet)> =
            self.facets.iter().map(|f| (sets.root(place(f.corners[0])), f)).collect();
        regions.sort_by_key(|r| r.0);
        let mut spots = Vec::new();
        for region in regions.chunk_by(|a, b| a.0 == b.0) {
            let area: f64 = region.iter().map(|r| r.1.area).sum();
            let thinnest = region.iter().min_by(|a, b| a.1.least.total_cmp(&b.1.least));
            let Some((_, thinnest)) =
                thinnest.filter(|f| area >= minimum_area && f.1.least.is_finite())
            else {
                continue;
            };
            let mut own: Vec<u32> = region.iter().flat_map(|r| r.1.corners).collect();
            own.sort_unstable();
            own.dedup();
            spots.push(ThinRegion {
                position: thinnest.position.as_vec3().to_array(),
                normal: thinnest.normal.as_vec3().to_array(),
                thickness: thinnest.least as f32,
                area,
                vertices: own.len() as u32,
            });
        }
        spots.sort_by(|a, b| a.thickness.total_cmp(&b.thickness).then(b.area.total_cmp(&a.area)));
        spots.truncate(count);
        spots
    }
}

fn below(value: f32, limit: f32) -> bool {
    value.is_finite() && value < limit
}
