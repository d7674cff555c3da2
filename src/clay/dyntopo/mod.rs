//! Topology while sculpting: the triangles within a ball are cut to a wanted size, and the pages
//! about them are built anew.
//!
//! 1. The pages that the ball touches and their neighbours become a [`patch::Patch`], where edges
//!    are split, collapsed, flipped.
//! 2. Pages with a changed vertex or triangle are *dirty*. They and their neighbours, whose halos
//!    name vertices by their place at home, are assembled anew. A page that grew beyond
//!    [`PAGE_VERTICES`] is parted; new pages are added at the end.
//! 3. They take the old ones' places. The old ones are the undo step, as of any dab; a page that
//!    was not there before was empty.
//!
//! The cost follows the pages that the ball touches, never the mesh. Vertices and triangles keep
//! the numbers that they had, so a ring that did not change keeps its order, and its normal its
//! bits.

mod patch;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec3, Vec4Swizzles};

use self::patch::Patch;
pub use self::patch::{Cuts, Detail};
use super::clay::Clay;
use super::page::Page;
use super::reach::Reach;
use crate::assembly::splice::remake;
use crate::assembly::{Cut, Grafted, Homes, PAGE_VERTICES, assemble, order};
use sculptd_geometry::flat::TriMesh;

/// Numbers are not used beyond this: what is left is for the pages' own arithmetic.
const LAST_NUMBER: u32 = u32::MAX - (1 << 24);

/// A part of the clay with its vertices in one row.
#[derive(Debug, Default)]
struct TopologyRegion {
    /// Where each page's vertices begin in the row.
    first: BTreeMap<u32, u32>,
    /// For each vertex its number in the clay, and its page; `u32::MAX` for a new one.
    ids: Vec<u32>,
    page: Vec<u32>,
    patch: Patch,
}

impl TopologyRegion {
    /// Takes in a page's vertices; `whole`: all about them will be here too.
    fn vertices(&mut self, number: u32, page: &Page, whole: bool) {
        let first = self.ids.len() as u32;
        self.first.insert(number, first);
        let p = &mut self.patch;
        for v in 0..page.own() {
            self.ids.push(page.topology.ids[v]);
            self.page.push(number);
            p.points.push(page.point(v));
            p.masks.push(page.mask(v));
            p.colours.push(page.colour(v));
            p.whole.push(whole);
            p.alive.push(true);
            p.touched.push(false);
            p.beside.push(u32::MAX);
            p.about.push(Vec::new());
        }
    }

    /// A page's own triangles, in the numbers of the row; `None` where a corner's page is not here.
    fn triangles<'a>(
        &'a self,
        number: u32,
        page: &'a Page,
    ) -> impl Iterator<Item = Option<([u32; 3], u32)>> + 'a {
        let t = &page.topology;
        t.triangles.iter().zip(&t.triangle_ids).map(move |(corners, &id)| {
            let mut row = [0u32; 3];
            for (to, &v) in row.iter_mut().zip(corners) {
                let (home, local) = match (v as usize).checked_sub(t.own) {
                    None => (number, v),
                    Some(k) => t.halo_home(k),
                };
                *to = self.first.get(&home)? + u32::from(local);
            }
            Some((row, id))
        })
    }
}

impl Clay {
    /// Cuts the triangles within the ball to the wanted size. Part of the open undo step, if there
    /// is one.
    pub fn adapt_topology(&mut self, detail: &Detail) -> Cuts {
        if self.next_vertex >= LAST_NUMBER
            || self.next_triangle >= LAST_NUMBER
            || !(detail.edge > 0.0)
        {
            return Cuts::default();
        }
        let mut inner = Vec::new();
        let reach = Reach::Sphere { centre: detail.centre, radius: detail.radius };
        self.each_page(&reach, |i, _| inner.push(i));
        let mut region = TopologyRegion::default();
        let mut near = self.with_neighbours(&inner);
        for &i in &near {
            region.vertices(i, &self.pages[i as usize], inner.binary_search(&i).is_ok());
        }
        let mut row = Vec::new();
        // Triangles that reach further out are of no concern to the inner vertices.
        for &i in &near {
            row.extend(region.triangles(i, &self.pages[i as usize]).flatten());
        }
        row.sort_unstable_by_key(|t| t.1);
        for (corners, id) in row {
            let at = region.patch.triangles.len() as u32;
            for v in corners {
                region.patch.about[v as usize].push(at);
            }
            region.patch.triangles.push(corners);
            region.patch.triangle_ids.push(id);
            region.patch.gone.push(false);
        }
        region.patch.next_triangle = self.next_triangle;
        let cuts = region.patch.cut(detail);
        if cuts == Cuts::default() {
            return cuts;
        }
        near.clear();
        self.rebuild(region);
        cuts
    }

    /// The pages and those that share a triangle with them, ascending.
    fn with_neighbours(&self, of: &[u32]) -> Vec<u32> {
        let own = of.iter().copied();
        let beyond = of
            .iter()
            .flat_map(|&i| self.pages[i as usize].topology.neighbours.iter().map(|n| n.page));
        let mut all: Vec<u32> = own.chain(beyond).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn rebuild(&mut self, mut region: TopologyRegion) {
        let old_count = region.ids.len();
        // New vertices live where the ones live that they were made beside.
        for v in old_count..region.patch.points.len() {
            let home = region.page[region.patch.beside[v] as usize];
            region.page.push(home);
            region.ids.push(self.next_vertex);
            self.next_vertex += 1;
        }
        self.next_triangle = region.patch.next_triangle;
        let mut dirty: Vec<u32> = (0..region.ids.len())
            .filter(|&v| region.patch.touched[v])
            .map(|v| region.page[v])
            .collect();
        dirty.sort_unstable();
        dirty.dedup();
        let anew = self.with_neighbours(&dirty);
        let around = self.with_neighbours(&anew);
        // What was not needed to cut, but is needed to build.
        let had: Vec<u32> = region.first.keys().copied().collect();
        for &i in &around {
            if !region.first.contains_key(&i) {
                region.vertices(i, &self.pages[i as usize], false);
            }
        }
        let mut triangles: Vec<([u32; 3], u32)> = Vec::new();
        let p = &region.patch;
        for (t, corners) in p.triangles.iter().enumerate() {
            if !p.gone[t] {
                triangles.push((*corners, p.triangle_ids[t]));
            }
        }
        let cut: std::collections::BTreeSet<u32> = p.triangle_ids.iter().copied().collect();
        for &i in around.iter().chain(&had) {
            let all = region.triangles(i, &self.pages[i as usize]).flatten();
            triangles.extend(all.filter(|(_, id)| !cut.contains(id)));
        }
        triangles.sort_unstable_by_key(|t| t.1);
        triangles.dedup_by_key(|t| t.1);

        let mut owners = self.share_out(&mut region, &anew);
        owners.sort_unstable_by_key(|o| o.0);
        let homes = self.homes(&region, &owners);
        self.assemble_all(&region, &homes, &triangles, &owners);
    }

    /// Who owns what from now on: each page to be built, with its vertices. Pages that grew too
    /// large are parted.
    fn share_out(&mut self, region: &mut TopologyRegion, anew: &[u32]) -> Vec<(u32, Vec<u32>)> {
        let mut own: BTreeMap<u32, Vec<u32>> = anew.iter().map(|&i| (i, Vec::new())).collect();
        for v in 0..region.ids.len() {
            if region.patch.alive[v]
                && let Some(list) = own.get_mut(&region.page[v])
            {
                list.push(v as u32);
            }
        }
        let mut owners = Vec::with_capacity(own.len() + 1);
        for (number, list) in own {
            let parts = list.len().div_ceil(PAGE_VERTICES);
            if parts <= 1 {
                owners.push((number, list));
                continue;
            }
            // Room to grow: the next split is not the next dab's.
            let parts = list.len().div_ceil(PAGE_VERTICES * 3 / 4);
            let mut items: Vec<order::Item> =
                list.iter().map(|&v| (region.patch.points[v as usize], v)).collect();
            let count = items.len();
            let start = |c: usize| c * count / parts;
            order::order(&mut items, 0, parts, &start);
            for part in 0..parts {
                let some: Vec<u32> =
                    items[start(part)..start(part + 1)].iter().map(|i| i.1).collect();
                let number = if part == 0 { number } else { self.empty_page() };
                for &v in &some {
                    region.page[v as usize] = number;
                }
                owners.push((number, some));
            }
        }
        owners
    }

    pub(super) fn push_empty(&mut self) {
        self.pages.push(Arc::new(Page::nothing()));
    }

    /// Makes a cut where the clay is, around it, as it was when the cut was computed: part of the
    /// open undo step, if there is one, at a cost of the pages around the cut. None, and nothing
    /// changed, where it is not so.
    pub fn graft(&mut self, cut: &Cut) -> Option<Grafted> {
        let old = self.snapshot();
        let made = cut.fits(&old).then(|| remake(&old, cut)).flatten()?;
        drop(old);
        let count = made.pages.last().map_or(0, |p| p.0 as usize + 1);
        if count > self.pages.len() {
            while self.pages.len() < count {
                self.push_empty();
            }
            self.grow();
        }
        [self.next_vertex, self.next_triangle] = made.next;
        let written = made.pages.len();
        self.replace_pages(made.pages);
        Some(Grafted { written, shared: self.pages.len() - written })
    }

    /// The number of a page without vertices: one that was emptied, or a new one.
    fn empty_page(&mut self) -> u32 {
        while let Some(i) = self.empty.pop() {
            if self.pages[i as usize].own() == 0 {
                // Emptied, filled again by undo, emptied again: then it is noted twice, and must
                // not be given twice.
                self.empty.retain(|&other| other != i);
                return i;
            }
        }
        let i = self.pages.len() as u32;
        self.push_empty();
        self.grow();
        i
    }

    fn homes(&self, region: &TopologyRegion, owners: &[(u32, Vec<u32>)]) -> Homes {
        let n = region.ids.len();
        let mut homes = Homes { page: region.page.clone(), local: vec![0; n] };
        // Those that are not built anew are where they were.
        for (&number, &first) in &region.first {
            for local in 0..self.pages[number as usize].own() {
                homes.local[first as usize + local] = local as u16;
            }
        }
        for (_, list) in owners {
            for (local, &v) in list.iter().enumerate() {
                homes.local[v as usize] = local as u16;
            }
        }
        homes
    }

    fn assemble_all(
        &mut self,
        region: &TopologyRegion,
        homes: &Homes,
        triangles: &[([u32; 3], u32)],
        owners: &[(u32, Vec<u32>)],
    ) {
        let p = &region.patch;
        let flat = TriMesh {
            positions: p.points.clone(),
            triangles: triangles.iter().map(|t| t.0).collect(),
            colours: Some(p.colours.clone()),
        };
        let slot: BTreeMap<u32, usize> = owners.iter().enumerate().map(|(k, o)| (o.0, k)).collect();
        let mut touching: Vec<Vec<u32>> = vec![Vec::new(); owners.len()];
        for (t, corners) in flat.triangles.iter().enumerate() {
            let mut last = [usize::MAX; 3];
            for (k, &v) in corners.iter().enumerate() {
                if let Some(&s) = slot.get(&homes.page[v as usize])
                    && !last.contains(&s)
                {
                    last[k] = s;
                    touching[s].push(t as u32);
                }
            }
        }
        let mut built = Vec::with_capacity(owners.len());
        for ((number, own), touching) in owners.iter().zip(&touching) {
            let made = assemble::assemble(&flat, homes, *number, own.clone(), touching);
            // Too tangled a neighbourhood for one page: the cut is not made. Nothing was changed
            // yet.
            let Ok(mut page) = made else { return };
            if let Some(page) = Arc::get_mut(&mut page)
                && let Some(t) = Arc::get_mut(&mut page.topology)
            {
                for (v, &row) in own.iter().enumerate() {
                    page.points[v].w = p.masks[row as usize];
                }
                t.ids.iter_mut().for_each(|id| *id = region.ids[*id as usize]);
                t.triangle_ids.iter_mut().for_each(|id| *id = triangles[*id as usize].1);
                if page.topology.own == 0 {
                    (page.lo, page.hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
                }
            }
            built.push((*number, page));
        }
        // Halos take over what their homes say.
        let copies: Vec<Vec<(glam::Vec4, glam::Vec4)>> = built
            .iter()
            .map(|(_, page)| {
                let t = &page.topology;
                let from = |(home, part): (u32, std::ops::Range<usize>)| {
                    let page = match slot.get(&home) {
                        Some(&s) => &built[s].1,
                        None => &self.pages[home as usize],
                    };
                    let rows = t.halo_sources[part].iter().map(|&l| l as usize);
                    rows.map(|l| (page.points[l], page.normals[l])).collect::<Vec<_>>()
                };
                t.halo_parts().flat_map(from).collect()
            })
            .collect();
        for ((_, page), halo) in built.iter_mut().zip(copies) {
            if let Some(page) = Arc::get_mut(page) {
                let own = page.topology.own;
                for (k, (point, normal)) in halo.into_iter().enumerate() {
                    debug_assert_eq!(page.points[own + k].xyz(), point.xyz());
                    page.points[own + k] = point;
                    page.normals[own + k] = normal;
                }
            }
        }
        self.replace_pages(built);
    }

    /// New pages take the old ones' places, as after a dab.
    fn replace_pages(&mut self, built: Vec<(u32, Arc<Page>)>) {
        self.revision += 1;
        for (number, mut page) in built {
            if let Some(page) = Arc::get_mut(&mut page) {
                page.revision = self.revision;
            }
            if page.own() == 0 {
                self.empty.push(number);
            }
            self.top.set_leaf(number as usize, page.lo, page.hi);
            self.stale.add(number);
            let old = std::mem::replace(&mut self.pages[number as usize], page);
            self.recount(number, &old);
            if let Some(old) = self.history.keep(number, old) {
                self.pool.retire(old);
            }
        }
        for &leaf in self.stale.paths() {
            self.top.refit_path(leaf as usize);
        }
        self.stale.clear_paths();
        self.history.trim();
    }
}
