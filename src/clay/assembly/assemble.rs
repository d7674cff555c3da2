//! One page from the triangles that touch it.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::super::boxtree::{BoxTree, LEAF};
use super::super::normals;
use super::super::page::{BREAK, Neighbour, Page, PageTopology, Ring};
use super::{BuildError, Homes, order};
use sculptd_geometry::TriMesh;
use sculptd_geometry::simd::rings::Hexes;

/// Opaque white.
const WHITE: [u8; 4] = [255; 4];

/// Whether `page` is home to a triangle: where two of its corners are at home, or else the first
/// page of three.
fn owns(homes: &Homes, corners: [u32; 3], page: u32) -> bool {
    let [a, b, c] = corners.map(|v| homes.page[v as usize]);
    let home = if b == c {
        b
    } else if a == b || a == c {
        a
    } else {
        a.min(b).min(c)
    };
    home == page
}

/// `own`: the page's vertices; `touching`: the triangles that have at least one of them, ascending.
pub(crate) fn assemble(
    tri: &TriMesh,
    homes: &Homes,
    page: u32,
    own: Vec<u32>,
    touching: &[u32],
) -> Result<Arc<Page>, BuildError> {
    let count = own.len();
    let place = |v: u32| (homes.page[v as usize], homes.local[v as usize]);
    let corners = |t: u32| tri.triangles[t as usize];
    let first = own[0];
    let tangled = |reason, limit| BuildError::Tangled { vertex: first, reason, limit };

    // The halo, by home.
    let mut halo: Vec<(u32, u16, u32)> = touching
        .iter()
        .flat_map(|&t| corners(t))
        .filter(|&v| homes.page[v as usize] != page)
        .map(|v| {
            let (p, l) = place(v);
            (p, l, v)
        })
        .collect();
    halo.sort_unstable();
    halo.dedup();
    if count + halo.len() >= BREAK as usize {
        return Err(tangled("too many neighbours", BREAK as usize));
    }
    let mut neighbours: Vec<Neighbour> = Vec::new();
    for (k, h) in halo.iter().enumerate() {
        if neighbours.last().is_none_or(|n| n.page != h.0) {
            neighbours.push(Neighbour { page: h.0, first: k as u32 });
        }
    }
    let local = |v: u32| {
        let (p, l) = place(v);
        if p == page {
            l
        } else {
            // The list was made from the same triangles, so the vertex is in it.
            (count + halo.binary_search(&(p, l, v)).unwrap_or(0)) as u16
        }
    };

    // Opposite edges about each own vertex, triangles in ascending order.
    let locals: Vec<[u16; 3]> = touching.iter().map(|&t| corners(t).map(local)).collect();
    let mut starts = vec![0u32; count + 1];
    for l in &locals {
        for &v in l.iter().filter(|&&v| (v as usize) < count) {
            starts[v as usize + 1] += 1;
        }
    }
    for v in 0..count {
        starts[v + 1] += starts[v];
    }
    let mut edges = vec![[0u16; 2]; starts[count] as usize];
    let mut next = starts.clone();
    for l in &locals {
        for k in 0..3 {
            let v = l[k] as usize;
            if v < count {
                edges[next[v] as usize] = [l[(k + 1) % 3], l[(k + 2) % 3]];
                next[v] += 1;
            }
        }
    }
    let mut rings = Vec::with_capacity(edges.len() + 8);
    let mut ring_starts = Vec::with_capacity(count + 1);
    let mut kinds = Vec::with_capacity(count);
    let mut hexes = Vec::with_capacity(count);
    for v in 0..count {
        let start = rings.len();
        let kind = fans(&mut edges[starts[v] as usize..starts[v + 1] as usize], &mut rings);
        kinds.push(kind);
        match (kind, &rings[start..]) {
            (Ring::Closed, &[a, b, c, d, e, f]) if hexes.len() == v => {
                hexes.push([a, b, c, d, e, f]);
                rings.clear();
            }
            _ => ring_starts.push(start.min(u16::MAX as usize) as u16),
        }
    }
    if rings.len() > u16::MAX as usize {
        return Err(tangled("too many edges", u16::MAX as usize));
    }
    ring_starts.push(rings.len() as u16);

    // The page's own triangles, in the order of its tree.
    let mut mine: Vec<order::Item> = Vec::new();
    for (k, &t) in touching.iter().enumerate() {
        let c = corners(t);
        if owns(homes, c, page) {
            let [a, b, c] = c.map(|v| tri.positions[v as usize]);
            let middle = a.min(b).min(c) * 0.5 + a.max(b).max(c) * 0.5;
            mine.push((middle, k as u32));
        }
    }
    order::order_runs(&mut mine, LEAF);
    let triangles: Vec<[u16; 3]> = mine.iter().map(|m| locals[m.1 as usize]).collect();

    let everyone = || own.iter().copied().chain(halo.iter().map(|h| h.2));
    let points: Vec<Vec4> = everyone().map(|v| tri.positions[v as usize].extend(0.0)).collect();
    let normals: Vec<Vec4> = everyone()
        .map(|v| {
            let colour =
                tri.colours.as_ref().and_then(|c| c.get(v as usize)).copied().unwrap_or(WHITE);
            Vec3::ZERO.extend(f32::from_bits(u32::from_le_bytes(colour)))
        })
        .collect();
    let mut tree = BoxTree::default();
    tree.reset(triangles.len().div_ceil(LEAF));
    let mut topology = PageTopology {
        own: count,
        ids: own,
        triangle_ids: mine.iter().map(|m| touching[m.1 as usize]).collect(),
        triangles,
        hexes: Hexes::new(hexes),
        ring_starts,
        rings,
        kinds,
        halo_sources: halo.iter().map(|h| h.1).collect(),
        neighbours,
        ..PageTopology::default()
    };
    if !topology.index() {
        return Err(tangled("too many corners", u16::MAX as usize));
    }
    let mut out = Page {
        topology: Arc::new(topology),
        points,
        normals,
        tree,
        lo: Vec3::ZERO,
        hi: Vec3::ZERO,
        revision: 0,
        layers: None,
        sets: None,
    };
    normals::all(&mut out);
    out.refit(u32::MAX);
    Ok(Arc::new(out))
}

/// Chains the edges opposite a vertex into fans and appends them to `rings`.
fn fans(edges: &mut [[u16; 2]], rings: &mut Vec<u16>) -> Ring {
    let mut fans = 0;
    let mut kind = Ring::Open;
    let mut left = edges;
    while !left.is_empty() {
        // An edge that no other leads to begins an open fan; without one, the first begins a closed
        // fan.
        let start = if left.len() > 64 {
            first_start_sorted(left)
        } else {
            left.iter().position(|e| left.iter().all(|f| f[1] != e[0]))
        };
        left.swap(0, start.unwrap_or(0));
        let mut used = 1;
        while let Some(k) = left[used..].iter().position(|e| e[0] == left[used - 1][1]) {
            left.swap(used, used + k);
            used += 1;
        }
        let closed = used > 2 && left[used - 1][1] == left[0][0];
        let all = used == left.len() && fans == 0;
        rings.push(left[0][0] | if fans > 0 { BREAK } else { 0 });
        rings.extend(left[..used - 1].iter().map(|e| e[1]));
        if !(closed && all) {
            rings.push(left[used - 1][1]);
        }
        kind = if !all {
            Ring::ManyFans
        } else if closed {
            Ring::Closed
        } else {
            Ring::Open
        };
        fans += 1;
        left = &mut left[used..];
    }
    if fans > 1 {
        kind = Ring::ManyFans;
    }
    kind
}

/// As the short search, for vertices of very many triangles.
fn first_start_sorted(edges: &[[u16; 2]]) -> Option<usize> {
    let mut ends: Vec<u16> = edges.iter().map(|e| e[1]).collect();
    ends.sort_unstable();
    edges.iter().position(|e| ends.binary_search(&e[0]).is_err())
}
