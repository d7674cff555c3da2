//! From triangles to pages. Any triangle soup loads: open, non-manifold, with stray vertices.
//!
//! 1. Vertices into the balanced k-d order ([`order`]), cut into pages of equal size.
//! 2. For each page the triangles that touch it; within it the vertices of regular rings first,
//!    whose loops are the fastest.
//! 3. Each page by itself ([`assemble`]): halo, triangles, rings, normals, tree.
//!
//! All three run on all cores; the result does not depend on how many there are.

pub(super) mod assemble;
mod cut;
pub(super) mod order;
pub(super) mod splice;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering::Relaxed};

use rayon::prelude::*;

pub use cut::{Corner, Cut, Grafted, Home, NewVertex, home_of};

use super::page::{Page, Ring};
use sculptd_geometry::TriMesh;
use sculptd_geometry::job::Job;

/// Own vertices a page: small enough that a page's data stays in the first-level cache and a small
/// dab copies little, large enough that its border is not most of it.
pub const PAGE_VERTICES: usize = 512;

/// The reason why no clay can be built from a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The mesh has no triangles.
    #[error("there are no triangles")]
    Empty,
    /// A stored work is not whole.
    #[error("what was stored of the work is not whole")]
    Stored,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are {count}")]
    Index {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// A vertex has a coordinate that is infinite or not a number.
    #[error("vertex {vertex} is not a finite point")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// There are more vertices than `u32` can number.
    #[error("{vertices} vertices are more than 4,294,967,295 numbers can tell apart")]
    TooMany {
        /// The number of vertices.
        vertices: usize,
    },
    #[error(
        "the neighbourhood of vertex {vertex} is too tangled: {reason} around {PAGE_VERTICES} \
         neighbouring vertices, {limit} can be"
    )]
    /// A page cannot hold the triangles and neighbours around its vertices: its local indices
    /// have 15 bits.
    Tangled {
        /// A vertex of the page.
        vertex: u32,
        /// The quantity that exceeds its limit.
        reason: &'static str,
        /// The limit of that quantity.
        limit: usize,
    },
    /// The job was cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// The page of each vertex, and its local index there.
#[derive(Debug)]
pub(super) struct Homes {
    pub(super) page: Vec<u32>,
    pub(super) local: Vec<u16>,
}

/// Bytes that building clay of this size needs at its peak, the input included: about 330 a vertex
/// with two triangles each.
pub fn bytes_to_build(vertices: u64, triangles: u64) -> u64 {
    // Input; the order; homes; touching triangles; the pages themselves.
    vertices * (12 + 16 + 6 + 64) + triangles * (12 + 5 + 26)
}

pub(super) struct Built {
    pub(super) pages: Vec<Arc<Page>>,
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) warnings: Vec<String>,
    /// The numbers that the next new vertex and triangle get.
    pub(super) next: [u32; 2],
}

pub(super) fn build(tri: &TriMesh, job: &Job) -> Result<Built, BuildError> {
    let count = tri.positions.len();
    check(tri)?;
    let pages = count.div_ceil(PAGE_VERTICES);
    let start = |page: usize| (page as u64 * count as u64 / pages as u64) as usize;

    let mut items: Vec<order::Item> =
        tri.positions.par_iter().enumerate().map(|(i, &p)| (p, i as u32)).collect();
    order::order(&mut items, 0, pages, &start);
    job.progress(0.25);
    job.check().map_err(|_| BuildError::Cancelled)?;
    // Within a page as well: neighbours share cache lines.
    by_page(&mut items, pages, &start).into_par_iter().for_each(|own| order::order_runs(own, 8));
    let mut homes = Homes { page: vec![0; count], local: vec![0; count] };
    for p in 0..pages {
        for (local, item) in items[start(p)..start(p + 1)].iter().enumerate() {
            homes.page[item.1 as usize] = p as u32;
            homes.local[item.1 as usize] = local as u16;
        }
    }
    job.progress(0.35);
    job.check().map_err(|_| BuildError::Cancelled)?;

    let (starts, touching) = touching(tri, &homes, pages);
    by_page(&mut items, pages, &start).into_par_iter().enumerate().for_each(|(p, own)| {
        order::regular_first(tri, &homes, p as u32, own, &touching[starts[p]..starts[p + 1]]);
    });
    for p in 0..pages {
        for (local, item) in items[start(p)..start(p + 1)].iter().enumerate() {
            homes.local[item.1 as usize] = local as u16;
        }
    }
    job.progress(0.5);
    job.check().map_err(|_| BuildError::Cancelled)?;

    let done = AtomicUsize::new(0);
    let built: Result<Vec<Arc<Page>>, BuildError> = (0..pages)
        .into_par_iter()
        .map(|p| {
            let n = done.fetch_add(1, Relaxed);
            if n % 64 == 0 {
                job.check().map_err(|_| BuildError::Cancelled)?;
                job.progress(0.5 + 0.4 * n as f32 / pages as f32);
            }
            let own: Vec<u32> = items[start(p)..start(p + 1)].iter().map(|i| i.1).collect();
            let mine: Vec<u32> =
                touching[starts[p]..starts[p + 1]].iter().map(|t| t.load(Relaxed)).collect();
            assemble::assemble(tri, &homes, p as u32, own, &mine)
        })
        .collect();
    drop((items, touching, homes));
    let mut pages = built?;
    halo_normals(&mut pages);
    job.progress(1.0);
    let triangles = pages.iter().map(|p| p.topology.triangles.len()).sum();
    let warnings = warnings(tri, &pages, triangles);
    let next = [count as u32, tri.triangles.len() as u32];
    Ok(Built { pages, vertices: count, triangles, warnings, next })
}

/// The items of each page.
fn by_page<'a>(
    items: &'a mut [order::Item],
    pages: usize,
    start: &impl Fn(usize) -> usize,
) -> Vec<&'a mut [order::Item]> {
    let mut cuts = Vec::with_capacity(pages);
    let mut rest = items;
    for p in 0..pages {
        let (one, after) = rest.split_at_mut(start(p + 1) - start(p));
        cuts.push(one);
        rest = after;
    }
    cuts
}

fn check(tri: &TriMesh) -> Result<(), BuildError> {
    let count = tri.positions.len();
    if count >= u32::MAX as usize || tri.triangles.len() >= u32::MAX as usize {
        return Err(BuildError::TooMany { vertices: count.max(tri.triangles.len()) });
    }
    if tri.triangles.is_empty() || count == 0 {
        return Err(BuildError::Empty);
    }
    let wrong = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= count);
    if let Some(triangle) = tri.triangles.par_iter().position_first(wrong) {
        let vertex =
            tri.triangles[triangle].into_iter().find(|&v| v as usize >= count).unwrap_or(0);
        return Err(BuildError::Index { triangle, vertex, count });
    }
    match tri.positions.par_iter().position_first(|p| !p.is_finite()) {
        Some(vertex) => Err(BuildError::NotFinite { vertex }),
        None => Ok(()),
    }
}

/// A triangle with a corner twice has no side: it is left out.
fn degenerate([a, b, c]: [u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// For each page the triangles with a corner in it, ascending; `starts` has one entry more than
/// pages.
fn touching(tri: &TriMesh, homes: &Homes, pages: usize) -> (Vec<usize>, Vec<AtomicU32>) {
    let each = |corners: &[u32; 3], visit: &mut dyn FnMut(usize)| {
        if degenerate(*corners) {
            return;
        }
        let [a, b, c] = corners.map(|v| homes.page[v as usize]);
        visit(a as usize);
        if b != a {
            visit(b as usize);
        }
        if c != a && c != b {
            visit(c as usize);
        }
    };
    // Each part counts for itself, so that each knows where to write: the order is that of one
    // thread.
    let part = tri.triangles.len().div_ceil(rayon::current_num_threads() * 2).max(65_536);
    let mut counts: Vec<Vec<u32>> = tri
        .triangles
        .par_chunks(part)
        .map(|chunk| {
            let mut counts = vec![0u32; pages];
            chunk.iter().for_each(|t| each(t, &mut |p| counts[p] += 1));
            counts
        })
        .collect();
    let mut starts = Vec::with_capacity(pages + 1);
    let mut total = 0usize;
    for p in 0..pages {
        starts.push(total);
        let mut within = 0;
        for c in &mut counts {
            within += std::mem::replace(&mut c[p], within);
        }
        total += within as usize;
    }
    starts.push(total);
    let mut out = Vec::new();
    out.resize_with(total, AtomicU32::default);
    tri.triangles.par_chunks(part).zip(counts).enumerate().for_each(|(i, (chunk, mut next))| {
        for (k, t) in chunk.iter().enumerate() {
            each(t, &mut |p| {
                out[starts[p] + next[p] as usize].store((i * part + k) as u32, Relaxed);
                next[p] += 1;
            });
        }
    });
    (starts, out)
}

/// Copies each halo vertex's normal and colour from its home, once all pages have theirs.
fn halo_normals(pages: &mut [Arc<Page>]) {
    let copies: Vec<Vec<glam::Vec4>> = pages
        .par_iter()
        .map(|page| {
            let t = &page.topology;
            let from = |(home, part): (u32, std::ops::Range<usize>)| {
                t.halo_sources[part].iter().map(move |&l| (home, l))
            };
            t.halo_parts()
                .flat_map(from)
                .map(|(p, l)| pages[p as usize].normals[l as usize])
                .collect()
        })
        .collect();
    pages.par_iter_mut().zip(copies).for_each(|(page, halo)| {
        if let Some(page) = Arc::get_mut(page) {
            let own = page.topology.own;
            page.normals[own..].copy_from_slice(&halo);
        }
    });
}

fn warnings(tri: &TriMesh, pages: &[Arc<Page>], triangles: usize) -> Vec<String> {
    let mut out = Vec::new();
    let dropped = tri.triangles.len() - triangles;
    if dropped > 0 {
        out.push(format!("{dropped} triangles name one vertex twice and were left out"));
    }
    let (mut several, mut open, mut stray) = (0usize, 0usize, 0usize);
    for page in pages {
        let t = &page.topology;
        for v in 0..t.own {
            several += usize::from(t.kinds[v] == Ring::ManyFans);
            let lonely = t.ring(v).is_empty();
            stray += usize::from(lonely);
            open += usize::from(t.kinds[v] == Ring::Open && !lonely);
        }
    }
    if several > 0 {
        out.push(format!(
            "{several} vertices are non-manifold: their triangles form several fans, or are turned \
             against each other"
        ));
    }
    if open > 0 {
        out.push(format!("{open} vertices lie on an open border"));
    }
    if stray > 0 {
        out.push(format!("{stray} vertices belong to no triangle"));
    }
    out
}
