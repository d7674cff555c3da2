//! From triangles to pages: vertices in Morton order, cut into runs; triangles with their first corner's page.

use std::sync::Arc;

use glam::Vec3;

use super::page::{Page, Points, Topology};
use super::{Mesh, TriMesh};
use crate::analysis::cancel::Job;

/// Own vertices a page: small enough that a page's data stays in the first-level cache, large enough that its border is not
/// most of it.
pub const PAGE_VERTICES: usize = 768;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    #[error("there are no triangles")]
    Empty,
    #[error("triangle {triangle} names vertex {vertex}, but there are {count}")]
    Index { triangle: usize, vertex: u32, count: usize },
    #[error("vertex {vertex} is not a finite point")]
    NotFinite { vertex: usize },
    #[error("cancelled")]
    Cancelled,
}

/// Interleaves the low 21 bits of three numbers.
fn morton(q: [u32; 3]) -> u64 {
    let spread = |v: u32| {
        let mut x = u64::from(v) & 0x1f_ffff;
        x = (x | x << 32) & 0x1f_0000_0000_ffff;
        x = (x | x << 16) & 0x1f_0000_ff00_00ff;
        x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    spread(q[0]) | spread(q[1]) << 1 | spread(q[2]) << 2
}

pub fn build(tri: &TriMesh, job: &Job) -> Result<Mesh, BuildError> {
    let count = tri.positions.len();
    if tri.triangles.is_empty() {
        return Err(BuildError::Empty);
    }
    for (triangle, corners) in tri.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= count) {
            return Err(BuildError::Index { triangle, vertex, count });
        }
    }
    if let Some(vertex) = tri.positions.iter().position(|p| !p.is_finite()) {
        return Err(BuildError::NotFinite { vertex });
    }
    let (lo, hi) = tri.bounds();
    let scale = (hi - lo).max_element().max(f32::MIN_POSITIVE).recip() * 2_097_151.0;
    let mut order: Vec<(u64, u32)> = tri
        .positions
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let q = ((*p - lo) * scale).to_array().map(|v| v as u32);
            (morton(q), i as u32)
        })
        .collect();
    order.sort_unstable();
    job.progress(0.3);
    job.check().map_err(|_| BuildError::Cancelled)?;
    let mut home = vec![0u32; count];
    for (rank, &(_, v)) in order.iter().enumerate() {
        home[v as usize] = rank as u32;
    }
    let place = |v: u32| {
        let rank = home[v as usize] as usize;
        ((rank / PAGE_VERTICES) as u32, (rank % PAGE_VERTICES) as u16)
    };
    let pages = count.div_ceil(PAGE_VERTICES);
    let mut of_page: Vec<Vec<u32>> = vec![Vec::new(); pages];
    for (t, corners) in tri.triangles.iter().enumerate() {
        let mut seen = [u32::MAX; 3];
        for (k, &v) in corners.iter().enumerate() {
            let page = place(v).0;
            if !seen.contains(&page) {
                of_page[page as usize].push(t as u32);
            }
            seen[k] = page;
        }
    }
    let mut out = Vec::with_capacity(pages);
    for (page, touching) in of_page.iter().enumerate() {
        if page % 256 == 0 {
            job.check().map_err(|_| BuildError::Cancelled)?;
            job.progress(0.3 + 0.6 * page as f32 / pages as f32);
        }
        let ids: Vec<u32> = order[page * PAGE_VERTICES..((page + 1) * PAGE_VERTICES).min(count)]
            .iter()
            .map(|&(_, v)| v)
            .collect();
        out.push(one_page(tri, page as u32, ids, touching, &place));
    }
    for page in 0..out.len() {
        let sources: Vec<u32> = out[page].topology.halo.iter().map(|h| h.0).collect();
        for source in sources {
            if let Some(t) = Arc::get_mut(&mut out[source as usize].topology) {
                if t.neighbours.last() != Some(&(page as u32)) {
                    t.neighbours.push(page as u32);
                }
            }
        }
    }
    for page in &mut out {
        let own = page.topology.own;
        page.normals = Arc::new(Points::of((0..own).map(|v| page.normal_of(v))));
        page.measure();
    }
    job.progress(1.0);
    Ok(Mesh::of_pages(out, count, tri.triangles.len()))
}

fn one_page(
    tri: &TriMesh,
    page: u32,
    ids: Vec<u32>,
    touching: &[u32],
    place: &dyn Fn(u32) -> (u32, u16),
) -> Page {
    let own = ids.len();
    let mut halo: Vec<u32> =
        touching.iter().flat_map(|&t| tri.triangles[t as usize]).filter(|&v| place(v).0 != page).collect();
    halo.sort_unstable_by_key(|&v| place(v));
    halo.dedup();
    let local = |v: u32| {
        let (p, l) = place(v);
        if p == page {
            l
        } else {
            // The list was made from the same triangles, so the vertex is in it.
            (own + halo.binary_search_by_key(&(p, l), |&h| place(h)).unwrap_or(0)) as u16
        }
    };
    let mut triangles = Vec::new();
    let mut triangle_ids = Vec::new();
    let mut wedges_of: Vec<Vec<[u16; 2]>> = vec![Vec::new(); own];
    for &t in touching {
        let corners = tri.triangles[t as usize];
        let l = corners.map(local);
        if place(corners[0]).0 == page {
            triangles.push(l);
            triangle_ids.push(t);
        }
        for k in 0..3 {
            if (l[k] as usize) < own {
                wedges_of[l[k] as usize].push([l[(k + 1) % 3], l[(k + 2) % 3]]);
            }
        }
    }
    let mut wedge_starts = vec![0u16];
    let mut wedges = Vec::new();
    for w in wedges_of {
        wedges.extend(w);
        wedge_starts.push(wedges.len().min(u16::MAX as usize) as u16);
    }
    let point = |v: u32| tri.positions[v as usize];
    Page {
        positions: Arc::new(Points::of(ids.iter().map(|&v| point(v)))),
        halo: Arc::new(Points::of(halo.iter().map(|&v| point(v)))),
        normals: Arc::default(),
        mask: Arc::new(vec![0.0; own]),
        colours: Arc::new(
            ids.iter().map(|&v| tri.colours.as_ref().map_or([255; 4], |c| c[v as usize])).collect(),
        ),
        lo: Vec3::ZERO,
        hi: Vec3::ZERO,
        topology: Arc::new(Topology {
            own,
            halo: halo.iter().map(|&v| place(v)).collect(),
            neighbours: Vec::new(),
            triangles,
            triangle_ids,
            ids,
            wedge_starts,
            wedges,
        }),
    }
}
