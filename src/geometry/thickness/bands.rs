//! A surface cut into bands by the distance along it from a tip, for the medial curve.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::partition::{SharedEdge, median_by_area};
use super::summary::triangle_area;
use super::surface::{DROPPED, WeldedSurface};
use crate::disjoint_sets::DisjointSets;
use crate::job::{Cancelled, Job};

/// The width of a band, of the usual wall of the shell.
const BAND: f64 = 0.5;
/// Bands are at least this many mean edges wide.
const EDGES: f64 = 1.5;
/// A piece of a band smaller than this share of a band's width squared joins its neighbour.
const SPECK: f64 = 0.25;

/// The surface in connected pieces of bands.
pub(super) struct BandPieces {
    /// The piece of each triangle, named by its lowest triangle.
    pub(super) of: Vec<u32>,
    /// The band of each triangle.
    pub(super) band: Vec<u32>,
}

impl BandPieces {
    pub(super) fn cut(
        surface: &WeldedSurface,
        values: &[f32],
        edges: &[SharedEdge],
        job: &Job,
    ) -> Result<BandPieces, Cancelled> {
        let n = surface.triangles.len();
        let ways = Ways::new(surface, edges);
        let width = band_widths(surface, values, edges);
        let mut away = vec![f64::INFINITY; surface.positions.len()];
        let mut first = away.clone();
        let lower = |kept: &mut f64, now: f64| {
            let nearer = now < *kept;
            if nearer {
                *kept = now;
            }
            nearer
        };
        let mut band = vec![0u32; n];
        for t in 0..n {
            let [a, ..] = surface.triangles[t];
            if a == DROPPED || away[a as usize].is_finite() {
                continue;
            }
            // The farthest from any vertex is a tip.
            let tip = ways.measure(a, job, |v, d| lower(&mut first[v as usize], d))?;
            ways.measure(tip, job, |v, d| lower(&mut away[v as usize], d))?;
        }
        for (t, corners) in surface.triangles.iter().enumerate().filter(|t| t.1[0] != DROPPED) {
            let mean = corners.iter().map(|&v| away[v as usize]).sum::<f64>() / 3.0;
            band[t] = (mean / width[t]).min(1e9) as u32;
        }
        let mut joined = DisjointSets::new(n);
        for e in edges {
            let [a, b] = e.triangles;
            if band[a as usize] == band[b as usize] {
                joined.join(a, b);
            }
        }
        let mut of: Vec<u32> = (0..n as u32).map(|t| joined.root(t)).collect();
        join_specks(surface, values, edges, &width, &mut of);
        Ok(BandPieces { of, band })
    }
}

/// 0 for a triangle that is left out.
pub(super) fn area_of(surface: &WeldedSurface, t: u32) -> f64 {
    surface.corners(t as usize).map_or(0.0, triangle_area)
}

/// The width of the bands at each triangle: one for each shell.
fn band_widths(surface: &WeldedSurface, values: &[f32], edges: &[SharedEdge]) -> Vec<f64> {
    let n = surface.triangles.len();
    let mut shells = DisjointSets::new(n);
    edges.iter().for_each(|e| shells.join(e.triangles[0], e.triangles[1]));
    let mut members: Vec<(u32, u32)> = (0..n as u32).map(|t| (shells.root(t), t)).collect();
    members.sort_unstable();
    let mut length = vec![(0.0f64, 0u32); n];
    for e in edges {
        let [a, b] = e.ends.map(|v| surface.positions[v as usize]);
        let of = &mut length[shells.root(e.triangles[0]) as usize];
        *of = (of.0 + f64::from(a.distance(b)), of.1 + 1);
    }
    let mut width = vec![f64::INFINITY; n];
    for shell in members.chunk_by(|a, b| a.0 == b.0) {
        let mut walls: Vec<(f32, f64)> = shell
            .iter()
            .map(|m| (values[m.1 as usize], area_of(surface, m.1)))
            .filter(|w| w.0.is_finite())
            .collect();
        let usual = median_by_area(&mut walls);
        let (sum, count) = length[shell[0].0 as usize];
        let edge = if count > 0 { sum / f64::from(count) } else { 0.0 };
        let wide = usual.map_or(f64::INFINITY, |u| (BAND * f64::from(u)).max(EDGES * edge));
        shell.iter().for_each(|m| width[m.1 as usize] = wide.max(f64::MIN_POSITIVE));
    }
    width
}

/// Joins pieces that are too small to be a ring, or that have no value, to the neighbour with the
/// longest common border.
fn join_specks(
    surface: &WeldedSurface,
    values: &[f32],
    edges: &[SharedEdge],
    width: &[f64],
    of: &mut [u32],
) {
    // Of each piece the area with values.
    let mut area: BTreeMap<u32, f64> = BTreeMap::new();
    for (t, &piece) in of.iter().enumerate() {
        let known = if values[t].is_finite() { area_of(surface, t as u32) } else { 0.0 };
        *area.entry(piece).or_default() += known;
    }
    let mut borders: BTreeMap<u32, BTreeMap<u32, f64>> = BTreeMap::new();
    for e in edges {
        let [a, b] = e.triangles.map(|t| of[t as usize]);
        if a != b {
            let [p, q] = e.ends.map(|v| surface.positions[v as usize]);
            let length = f64::from(p.distance(q));
            *borders.entry(a).or_default().entry(b).or_default() += length;
            *borders.entry(b).or_default().entry(a).or_default() += length;
        }
    }
    let mut joined = DisjointSets::new(of.len());
    for (&piece, &own) in &area {
        let wide = width[piece as usize];
        if own > SPECK * wide * wide && own > 0.0 {
            continue;
        }
        let longest = borders.get(&piece).and_then(|b| b.iter().max_by(|x, y| x.1.total_cmp(y.1)));
        if let Some((&other, _)) = longest {
            joined.join(piece, other);
        }
    }
    of.iter_mut().for_each(|piece| *piece = joined.root(*piece));
}

/// The ways from vertex to vertex: along edges, and across each edge from corner to corner.
struct Ways {
    starts: Vec<u32>,
    to: Vec<(u32, f32)>,
}

impl Ways {
    fn new(surface: &WeldedSurface, edges: &[SharedEdge]) -> Ways {
        let n = surface.positions.len();
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(8 * edges.len());
        for t in surface.triangles.iter().filter(|t| t[0] != DROPPED) {
            pairs.extend([(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
        }
        for e in edges {
            let across = e.triangles.map(|t| {
                let corners = surface.triangles[t as usize];
                corners.into_iter().find(|v| !e.ends.contains(v))
            });
            if let [Some(a), Some(b)] = across {
                pairs.push((a, b));
            }
        }
        pairs = pairs.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0u32; n + 1];
        pairs.iter().for_each(|p| starts[p.0 as usize + 1] += 1);
        for v in 0..n {
            starts[v + 1] += starts[v];
        }
        let long = |(a, b): (u32, u32)| {
            surface.positions[a as usize].distance(surface.positions[b as usize])
        };
        Ways { starts, to: pairs.into_iter().map(|p| (p.1, long(p))).collect() }
    }

    /// Dijkstra's distances from `from`. `nearer` takes a vertex and a distance, keeps it if it is
    /// the least so far, and says whether it was. Returns the farthest vertex.
    fn measure(
        &self,
        from: u32,
        job: &Job,
        mut nearer: impl FnMut(u32, f64) -> bool,
    ) -> Result<u32, Cancelled> {
        // Distances are not negative, so their bits are in their order.
        let mut open = BinaryHeap::from([Reverse((0u64, from))]);
        nearer(from, 0.0);
        let mut farthest = (0u64, Reverse(from));
        while let Some(Reverse((bits, v))) = open.pop() {
            job.check()?;
            farthest = farthest.max((bits, Reverse(v)));
            let own = self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize;
            for &(to, long) in &self.to[own] {
                let distance = f64::from_bits(bits) + f64::from(long);
                if nearer(to, distance) {
                    open.push(Reverse((distance.to_bits(), to)));
                }
            }
        }
        Ok(farthest.1.0)
    }
}
