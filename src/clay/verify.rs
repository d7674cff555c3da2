//! Whether everything in the clay agrees with everything else. For tests and simulation runs: costs
//! as much as the clay is large.

use super::boxtree::{BoxTree, LEAF};
use super::clay::Clay;
use super::normals;
use super::page::{BREAK, PageTopology};
use super::page_sets::PageSets;
use crate::assembly::PAGE_VERTICES;

impl Clay {
    /// Every halo says what its home says, every normal is what the positions give, every tree and
    /// bound fits, every triangle's corners exist.
    pub fn verify_invariants(&self) -> Result<(), String> {
        for (i, page) in self.pages.iter().enumerate() {
            let t = &page.topology;
            let rows = t.own + t.halo_sources.len();
            if t.own > PAGE_VERTICES {
                return Err(format!("page {i}: {} own vertices are too many", t.own));
            }
            if page.points.len() != rows || page.normals.len() != rows {
                return Err(format!(
                    "page {i}: {rows} rows expected, it has {}",
                    page.points.len()
                ));
            }
            if page.sets().is_some_and(|s| {
                s.rows().len() != rows || PageSets::shared(s.rows().to_vec()).as_deref() != Some(s)
            }) {
                return Err(format!("page {i}: its face sets are not those of its vertices"));
            }
            let corners = t.triangles.iter().flatten().chain(t.rings.iter()).chain(t.hexes.flat());
            if let Some(&v) = corners.into_iter().find(|&&v| (v & !BREAK) as usize >= rows) {
                return Err(format!("page {i}: local vertex {v} does not exist"));
            }
            let mut indexed = PageTopology::clone(t);
            if !indexed.index()
                || (&indexed.ring_blocks, &indexed.leaf_blocks, &indexed.loose)
                    != (&t.ring_blocks, &t.leaf_blocks, &t.loose)
            {
                return Err(format!("page {i}: its blocks are out of date"));
            }
            for k in 0..t.halo_sources.len() {
                let (home, local) = t.halo_home(k);
                let Some(other) =
                    self.pages.get(home as usize).filter(|o| (local as usize) < o.own())
                else {
                    return Err(format!("page {i}: halo vertex {k} has no home"));
                };
                let same = |a: glam::Vec4, b: glam::Vec4| {
                    a.to_array().map(f32::to_bits) == b.to_array().map(f32::to_bits)
                };
                if !same(page.points[t.own + k], other.points[local as usize]) {
                    return Err(format!(
                        "page {i}: halo vertex {k} is not where page {home} has it"
                    ));
                }
                if page.set_bits(t.own + k) != other.set_bits(local as usize) {
                    return Err(format!("page {i}: halo vertex {k} is in another set at home"));
                }
                if !same(page.normals[t.own + k], other.normals[local as usize]) {
                    let (here, there) = (page.normals[t.own + k], other.normals[local as usize]);
                    return Err(format!(
                        "page {i}: halo normal {k} is {here}, page {home} has {there}"
                    ));
                }
            }
            for v in 0..t.own {
                let p = page.point(v);
                if !p.is_finite() {
                    return Err(format!("page {i}: vertex {v} is at {p}"));
                }
                if !(0.0..=1.0).contains(&page.mask(v)) {
                    return Err(format!("page {i}: vertex {v} has mask {}", page.mask(v)));
                }
                if normals::of_vertex(t, &page.points, v) != page.normal(v) {
                    return Err(format!("page {i}: the normal of vertex {v} is out of date"));
                }
            }
            let mut fresh = BoxTree::default();
            fresh.reset(page.tree.leaves());
            fresh.refit_leaves(&t.leaves, &page.points, |_| true);
            for (i, eight) in t.triangles.chunks(LEAF).enumerate() {
                let own = t.leaves.corners(i);
                if eight.iter().flatten().any(|v| !own.contains(v)) {
                    return Err(format!("page {i}: a leaf does not know its triangles' vertices"));
                }
            }
            if !fresh.same(&page.tree) {
                return Err(format!("page {i}: its tree is out of date"));
            }
        }
        let sum = |of: &dyn Fn(&PageTopology) -> usize| {
            self.pages.iter().map(|p| of(p.topology())).sum::<usize>()
        };
        if (sum(&|t| t.own), sum(&|t| t.triangles.len()))
            != (self.vertex_count(), self.triangle_count())
        {
            return Err("the totals are out of date".into());
        }
        let mut top = BoxTree::default();
        top.reset(self.top.leaves());
        for (i, page) in self.pages.iter().enumerate() {
            top.set_leaf(i, page.lo, page.hi);
        }
        top.refit_all();
        if !top.same(&self.top) {
            return Err("the tree over the pages is out of date".into());
        }
        Ok(())
    }
}
