//! The clay at one moment, immutable and shared.

use glam::Vec3;

use super::TriMesh;
use super::clay::pick;
use super::page::Page;
use super::ray::{Hit, Ray};

#[derive(Debug, Clone)]
pub struct Snapshot {
    pages: Vec<Page>,
    revision: u64,
    vertices: usize,
    triangles: usize,
}

impl Snapshot {
    pub(super) fn of(pages: &[Page], revision: u64, vertices: usize, triangles: usize) -> Self {
        Snapshot { pages: pages.to_vec(), revision, vertices, triangles }
    }

    pub fn pages(&self) -> &[Page] {
        &self.pages
    }

    pub fn revision(&self) -> u64 {
        self.revision
    }

    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    pub fn triangle_count(&self) -> usize {
        self.triangles
    }

    pub fn pick(&self, ray: Ray) -> Option<Hit> {
        pick(&self.pages, ray)
    }

    pub fn to_tri(&self) -> TriMesh {
        to_tri(&self.pages, self.vertices, self.triangles)
    }

    pub fn hash(&self) -> u64 {
        hash(&self.pages, self.vertices)
    }
}

/// In the order of the mesh that was loaded.
pub(super) fn to_tri(pages: &[Page], vertices: usize, triangles: usize) -> TriMesh {
    let mut out = TriMesh {
        positions: vec![Vec3::ZERO; vertices],
        triangles: vec![[0; 3]; triangles],
        colours: Some(vec![[255; 4]; vertices]),
    };
    let mut white = true;
    for page in pages {
        let t = &page.topology;
        for (v, &id) in t.ids.iter().enumerate() {
            out.positions[id as usize] = page.positions.get(v);
            if let Some(colours) = &mut out.colours {
                colours[id as usize] = page.colours[v];
                white &= page.colours[v] == [255; 4];
            }
        }
        for (corners, &id) in t.triangles.iter().zip(&t.triangle_ids) {
            out.triangles[id as usize] = corners.map(|v| {
                let v = v as usize;
                if v < t.own {
                    t.ids[v]
                } else {
                    let (p, l) = t.halo[v - t.own];
                    pages[p as usize].topology.ids[l as usize]
                }
            });
        }
    }
    if white {
        out.colours = None;
    }
    out
}

/// FNV-1a, 64 bits, over positions, mask and colours in the loaded order.
pub(super) fn hash(pages: &[Page], vertices: usize) -> u64 {
    let mut order = vec![(0u32, 0u16); vertices];
    for (p, page) in pages.iter().enumerate() {
        for (v, &id) in page.topology.ids.iter().enumerate() {
            order[id as usize] = (p as u32, v as u16);
        }
    }
    let mut h = 0xcbf2_9ce4_8422_2325u64;
    let mut eat = |bits: u32| h = (h ^ u64::from(bits)).wrapping_mul(0x0000_0100_0000_01b3);
    for (p, v) in order {
        let (page, v) = (&pages[p as usize], v as usize);
        eat(page.positions.x[v].to_bits());
        eat(page.positions.y[v].to_bits());
        eat(page.positions.z[v].to_bits());
        eat(page.mask[v].to_bits());
        eat(u32::from_le_bytes(page.colours[v]));
    }
    h
}
