//! Clay whose vertices differ from the mesh that it was built from: strokes that were made while
//! that mesh was computed.
//!
//! The pages stay those of the mesh. Everything else of a page follows from its vertices alone, so
//! the same states give the same bits wherever they are set.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Clay;
use super::normals;
use super::page::Page;
use crate::assembly::Built;

/// A vertex as it is to be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VertexState {
    /// Its number in the mesh.
    pub vertex: u32,
    /// Its position; every coordinate must be finite.
    pub position: Vec3,
    /// 0 free to 1 protected.
    pub mask: f32,
    /// RGBA, sRGB.
    pub colour: [u8; 4],
}

impl Clay {
    /// Returns this clay with some of its vertices in another state, and without steps of undo.
    /// States of vertices that do not exist, and positions that are not finite, are left out. The
    /// cost is that of the pages that change, and a little for each vertex.
    pub fn with_vertices(&self, states: &[VertexState]) -> Clay {
        const NONE: u32 = u32::MAX;
        let mut at = vec![NONE; self.next_vertex as usize];
        for (i, state) in states.iter().enumerate().filter(|(_, s)| s.position.is_finite()) {
            if let Some(at) = at.get_mut(state.vertex as usize) {
                *at = i as u32;
            }
        }
        let differs = |page: &Page| page.topology.ids.iter().any(|&id| at[id as usize] != NONE);
        let own: Vec<u32> =
            (0..self.pages.len() as u32).filter(|&p| differs(&self.pages[p as usize])).collect();
        let mut pages = self.pages.clone();
        for &p in &own {
            let mut page = pages[p as usize].copy();
            for v in 0..page.topology.own {
                let i = at[page.topology.ids[v] as usize];
                if i != NONE {
                    let VertexState { position, mask, colour, .. } = states[i as usize];
                    page.points[v] = position.extend(mask.max(0.0).min(1.0));
                    page.normals[v].w = f32::from_bits(u32::from_le_bytes(colour));
                }
            }
            pages[p as usize] = Arc::new(page);
        }
        let near = with_neighbours(&pages, &own);
        replace(&mut pages, &near, |pages, page| {
            let from_home = halo(page).map(|(p, l)| pages[p as usize].points[l as usize]);
            let from_home: Vec<_> = from_home.collect();
            let own = page.topology.own;
            page.points[own..].copy_from_slice(&from_home);
            normals::all(page);
            page.refit(u32::MAX);
        });
        let beside = with_neighbours(&pages, &near);
        replace(&mut pages, &beside, |pages, page| {
            let from_home = halo(page).map(|(p, l)| pages[p as usize].normals[l as usize]);
            let from_home: Vec<_> = from_home.collect();
            let own = page.topology.own;
            page.normals[own..].copy_from_slice(&from_home);
        });
        let built = Built {
            pages,
            vertices: self.vertices,
            triangles: self.triangles,
            warnings: self.warnings().to_vec(),
            next: [self.next_vertex, self.next_triangle],
        };
        let mut clay = Clay::of(built, self.revision);
        clay.object_id = self.object_id;
        clay.empty.clone_from(&self.empty);
        clay.set_levels(self.levels().cloned());
        clay
    }
}

/// The home page and local index there of each halo vertex.
fn halo(page: &Page) -> impl Iterator<Item = (u32, u16)> + use<> {
    let t = page.topology.clone();
    let homes: Vec<(u32, u16)> = t
        .halo_parts()
        .flat_map(|(home, part)| t.halo_sources[part].iter().map(move |&l| (home, l)))
        .collect();
    homes.into_iter()
}

/// These pages and those beside them, ascending.
fn with_neighbours(pages: &[Arc<Page>], some: &[u32]) -> Vec<u32> {
    let beside = |p: &u32| pages[*p as usize].topology.neighbours.iter().map(|n| n.page);
    let mut all: Vec<u32> = some.iter().copied().chain(some.iter().flat_map(beside)).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Puts changed copies in the place of some pages; each change sees all pages as they were.
fn replace(pages: &mut [Arc<Page>], some: &[u32], change: impl Fn(&[Arc<Page>], &mut Page) + Sync) {
    let old = &*pages;
    let changed = |p: &u32| {
        let mut page = old[*p as usize].copy();
        change(old, &mut page);
        Arc::new(page)
    };
    let new: Vec<Arc<Page>> = some.par_iter().map(changed).collect();
    for (p, page) in some.iter().zip(new) {
        pages[*p as usize] = page;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes;

    #[test]
    fn states_give_sound_pages_and_the_same_bits_in_one_step_or_two() {
        let plain = shapes::icosphere(1.0, 40);
        let clay = Clay::build(&plain, &Job::default()).expect("a ball");
        let state = |(v, p): (usize, &Vec3)| VertexState {
            vertex: v as u32,
            position: *p * (1.0 + 0.1 * p.z),
            mask: p.x.max(0.0),
            colour: [v as u8, 7, 9, 255],
        };
        let upper = plain.positions.iter().enumerate().filter(|(_, p)| p.z > 0.4);
        let states: Vec<VertexState> = upper.map(state).collect();
        let (first, _) = states.split_at(states.len() / 3);
        let once = clay.with_vertices(&states);
        let twice = clay.with_vertices(first).with_vertices(&states);
        once.verify_invariants().expect("sound");
        assert_eq!(once.hash(), twice.hash());
        for (a, b) in once.pages.iter().zip(&twice.pages) {
            assert!(a.points == b.points && (a.lo, a.hi) == (b.lo, b.hi));
            let bits =
                |p: &Page| p.normals.iter().map(|n| n.to_array().map(f32::to_bits)).collect();
            let (a, b): (Vec<_>, Vec<_>) = (bits(a), bits(b));
            assert_eq!(a, b);
        }
        // The same surface as that of a mesh with these vertices; only the pages are others.
        let mut moved = plain.clone();
        let mut colours = vec![[255; 4]; plain.positions.len()];
        for s in &states {
            moved.positions[s.vertex as usize] = s.position;
            colours[s.vertex as usize] = s.colour;
        }
        moved.colours = Some(colours);
        assert!(once.to_tri() == moved);
        // None, and some that cannot be.
        let odd = VertexState { vertex: u32::MAX, ..states[0] };
        let wild = VertexState { position: Vec3::NAN, ..states[0] };
        assert_eq!(clay.with_vertices(&[odd, wild]).hash(), clay.hash());
    }
}
