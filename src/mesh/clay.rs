//! The clay: the one mutable mesh.

use std::sync::Arc;

use glam::Vec3;

use super::TriMesh;
use super::build::{BuildError, build};
use super::page::{Page, Points};
use super::ray::{Hit, PreparedRay, Ray};
use super::snapshot::Snapshot;
use super::undo::History;
use crate::analysis::cancel::Job;

/// What part of space a dab may change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    Sphere { centre: Vec3, radius: f32 },
    Capsule { from: Vec3, to: Vec3, radius: f32 },
}

impl Reach {
    /// Whether the reach may touch a box (never wrongly "no").
    pub fn touches(&self, lo: Vec3, hi: Vec3) -> bool {
        match *self {
            Reach::Sphere { centre, radius } => {
                (centre - centre.clamp(lo, hi)).length_squared() <= radius * radius
            }
            Reach::Capsule { from, to, radius } => {
                (from.min(to) - radius).cmple(hi).all() && (from.max(to) + radius).cmpge(lo).all()
            }
        }
    }
}

/// A page as a kernel reads it: the state before the dab, halo included.
#[derive(Debug)]
pub struct PageIn<'a> {
    page: &'a Page,
    pub positions: &'a Points,
    pub normals: &'a Points,
    pub mask: &'a [f32],
    pub colours: &'a [[u8; 4]],
}

impl PageIn<'_> {
    pub fn own(&self) -> usize {
        self.page.topology.own
    }

    /// An own or a halo vertex by local index.
    pub fn point(&self, local: u16) -> Vec3 {
        self.page.point(local as usize)
    }

    /// The two other corners of each triangle about own vertex `v`.
    pub fn wedges(&self, v: usize) -> &[[u16; 2]] {
        let t = &self.page.topology;
        &t.wedges[t.wedge_starts[v] as usize..t.wedge_starts[v + 1] as usize]
    }
}

/// Where a kernel writes.
#[derive(Debug)]
pub struct PageOut<'a> {
    moved: &'a mut Vec<(u16, Vec3)>,
    affected: &'a mut usize,
}

impl PageOut<'_> {
    /// Counts a vertex within the reach.
    pub fn visit(&mut self) {
        *self.affected += 1;
    }

    /// Gives own vertex `v` a new place. Each vertex at most once a dab.
    pub fn set(&mut self, v: usize, p: Vec3) {
        if p.is_finite() {
            self.moved.push((v as u16, p));
        }
    }
}

/// What a brush does to one page.
pub trait Kernel: Sync {
    fn page(&self, page: &PageIn<'_>, out: &mut PageOut<'_>);
}

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DabReport {
    pub affected: usize,
    pub moved: usize,
}

/// Threads that help with a dab.
#[derive(Debug, Clone)]
pub struct Workers {
    count: usize,
}

impl Workers {
    pub fn new(count: usize) -> Self {
        Workers { count: count.max(1) }
    }

    pub fn count(&self) -> usize {
        self.count
    }
}

#[derive(Debug)]
pub struct Mesh {
    pub(super) pages: Vec<Page>,
    vertices: usize,
    triangles: usize,
    revision: u64,
    pub(super) history: History,
    warnings: Vec<String>,
}

impl Mesh {
    pub fn build(tri: &TriMesh, job: &Job) -> Result<Mesh, BuildError> {
        build(tri, job)
    }

    pub(super) fn of_pages(pages: Vec<Page>, vertices: usize, triangles: usize) -> Mesh {
        Mesh { pages, vertices, triangles, revision: 0, history: History::default(), warnings: vec![] }
    }

    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub fn bounds(&self) -> (Vec3, Vec3) {
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        self.pages.iter().fold(none, |(lo, hi), p| (lo.min(p.lo), hi.max(p.hi)))
    }

    pub fn snapshot(&mut self) -> Snapshot {
        Snapshot::of(&self.pages, self.revision, self.vertices, self.triangles)
    }

    pub fn pick(&self, ray: Ray) -> Option<Hit> {
        pick(&self.pages, ray)
    }

    pub fn dab<K: Kernel>(&mut self, reach: &Reach, kernel: &K, _workers: &Workers) -> DabReport {
        let mut report = DabReport::default();
        let mut changed: Vec<(u32, Vec<(u16, Vec3)>)> = Vec::new();
        for (i, page) in self.pages.iter().enumerate() {
            if !reach.touches(page.lo, page.hi) {
                continue;
            }
            let mut moved = Vec::new();
            let input = PageIn {
                page,
                positions: &page.positions,
                normals: &page.normals,
                mask: &page.mask,
                colours: &page.colours,
            };
            kernel.page(&input, &mut PageOut { moved: &mut moved, affected: &mut report.affected });
            moved.retain(|&(v, p)| p != page.positions.get(v as usize));
            if !moved.is_empty() {
                changed.push((i as u32, moved));
            }
        }
        if changed.is_empty() {
            return report;
        }
        let mut dirty: Vec<u32> = changed.iter().map(|c| c.0).collect();
        for &(i, _) in &changed {
            dirty.extend_from_slice(&self.pages[i as usize].topology.neighbours);
        }
        dirty.sort_unstable();
        dirty.dedup();
        for &i in &dirty {
            self.history.keep(i, &self.pages[i as usize]);
        }
        for (i, moved) in &changed {
            report.moved += moved.len();
            let points = Arc::make_mut(&mut self.pages[*i as usize].positions);
            for &(v, p) in moved {
                points.set(v as usize, p);
            }
        }
        self.refresh(&dirty);
        report
    }

    /// Brings halos, normals and bounds of these pages up to date.
    fn refresh(&mut self, dirty: &[u32]) {
        for &i in dirty {
            let page = &self.pages[i as usize];
            let topology = page.topology.clone();
            let fresh = Points::of(
                topology.halo.iter().map(|&(p, v)| self.pages[p as usize].positions.get(v as usize)),
            );
            self.pages[i as usize].halo = Arc::new(fresh);
        }
        for &i in dirty {
            let page = &mut self.pages[i as usize];
            page.normals = Arc::new(Points::of((0..page.topology.own).map(|v| page.normal_of(v))));
            page.measure();
        }
        self.revision += 1;
    }

    /// Opens an undo step, unless one is open.
    pub fn begin_step(&mut self) {
        self.history.begin();
    }

    /// Closes the open undo step; one that changed nothing is forgotten.
    pub fn end_step(&mut self) {
        self.history.end();
    }

    pub fn undo(&mut self) -> bool {
        self.history.end();
        let done = self.history.undo(&mut self.pages);
        self.revision += u64::from(done);
        done
    }

    pub fn redo(&mut self) -> bool {
        self.history.end();
        let done = self.history.redo(&mut self.pages);
        self.revision += u64::from(done);
        done
    }

    pub fn undo_steps(&self) -> usize {
        self.history.undo_steps()
    }

    pub fn redo_steps(&self) -> usize {
        self.history.redo_steps()
    }

    pub fn set_undo_bytes(&mut self, bytes: u64) {
        self.history.limit = bytes;
    }

    pub fn to_tri(&self) -> TriMesh {
        super::snapshot::to_tri(&self.pages, self.vertices, self.triangles)
    }

    pub fn hash(&self) -> u64 {
        super::snapshot::hash(&self.pages, self.vertices)
    }

    /// Whether every page, halo and bound says the same.
    pub fn verify_invariants(&self) -> Result<(), String> {
        for (i, page) in self.pages.iter().enumerate() {
            let t = &page.topology;
            for (k, &(p, v)) in t.halo.iter().enumerate() {
                if page.halo.get(k) != self.pages[p as usize].positions.get(v as usize) {
                    return Err(format!("page {i}: halo vertex {k} is not where page {p} has it"));
                }
            }
            for v in 0..t.own {
                let p = page.positions.get(v);
                if !p.is_finite() {
                    return Err(format!("page {i}: vertex {v} is at {p}"));
                }
                if page.normals.get(v) != page.normal_of(v) {
                    return Err(format!("page {i}: the normal of vertex {v} is out of date"));
                }
            }
            let mut measured = page.clone();
            measured.measure();
            if (measured.lo, measured.hi) != (page.lo, page.hi) {
                return Err(format!("page {i}: its bounds are out of date"));
            }
        }
        Ok(())
    }
}

/// The nearest hit over all pages.
pub(super) fn pick(pages: &[Page], ray: Ray) -> Option<Hit> {
    let prepared = PreparedRay::new(ray);
    let mut best: Option<(f32, [f32; 3], u32, u32)> = None;
    for (i, page) in pages.iter().enumerate() {
        let far = best.map_or(f32::INFINITY, |b| b.0);
        if prepared.enters(page.lo, page.hi, far).is_none() {
            continue;
        }
        for t in 0..page.topology.triangles.len() {
            if let Some((at, weights)) = prepared.triangle(page.corners(t)) {
                if best.is_none_or(|b| at < b.0) {
                    best = Some((at, weights, i as u32, t as u32));
                }
            }
        }
    }
    let (t, weights, page, triangle) = best?;
    let home = &pages[page as usize];
    let normal = home.topology.triangles[triangle as usize]
        .iter()
        .zip(weights)
        .map(|(&v, w)| {
            let own = home.topology.own;
            if (v as usize) < own {
                home.normals.get(v as usize) * w
            } else {
                let (p, l) = home.topology.halo[v as usize - own];
                pages[p as usize].normals.get(l as usize) * w
            }
        })
        .sum::<Vec3>()
        .normalize_or(-ray.dir);
    Some(Hit { t, position: ray.origin + ray.dir * t, normal, page, triangle, barycentric: weights })
}
