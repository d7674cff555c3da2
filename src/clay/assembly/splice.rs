//! Clay with some triangles removed and others added: only the pages around them are written, all
//! others are shared.
//!
//! A page is rewritten if one of its owned vertices lost or gained a triangle. Vertices that other
//! pages refer to keep their index, so those pages remain valid. The remaining vertices fill the
//! gaps, and any surplus makes new pages. A neighbouring page only receives the normals that
//! turned.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Vec3, Vec4};

use super::super::layers::PageLayers;
use super::super::page::Page;
use super::super::page_sets::PageSets;
use super::super::snapshot::Snapshot;
use super::cut::{Corner, Cut, Home, NewVertex, concerned, home_of, touched};
use super::{Homes, PAGE_VERTICES, assemble, order};
use sculptd_geometry::TriMesh;

/// Pages that a cut makes new, ascending; those beyond the last are added.
pub(crate) struct Remade {
    pub(crate) pages: Vec<(u32, Arc<Page>)>,
    pub(crate) next: [u32; 2],
}

struct SplicedRegion {
    tri: TriMesh,
    masks: Vec<f32>,
    /// In the new pages.
    homes: Homes,
    /// The numbers, in the whole clay, of the vertices that stay.
    ids: Vec<u32>,
    outer: BTreeMap<Home, u32>,
    /// The former places of the vertices that stay, one for each of them.
    from: Vec<Home>,
}

impl SplicedRegion {
    fn push(&mut self, place: Vec3, mask: f32, colour: [u8; 4], home: Home, id: u32) -> u32 {
        self.tri.positions.push(place);
        self.tri.colours.get_or_insert_default().push(colour);
        self.masks.push(mask);
        self.homes.page.push(home.0);
        self.homes.local.push(home.1);
        self.ids.push(id);
        self.masks.len() as u32 - 1
    }
}

impl Cut {
    /// Returns true if the cut applies to this clay: it fits, and the pages around can hold the
    /// result. Costs about as much as applying it.
    pub fn can_be_made(&self, clay: &Snapshot) -> bool {
        self.fits(clay) && remake(clay, self).is_some()
    }
}

/// Returns the pages that the cut rewrites, and the numbers of the next new vertex and triangle.
/// The cut must fit. Returns `None` if the pages around cannot hold the result; rebuild the whole
/// clay then.
pub(crate) fn remake(old: &Snapshot, cut: &Cut) -> Option<Remade> {
    let Cut { removed, added, new, .. } = cut;
    // As in a cut of the topology: numbers only run up.
    let [mut next_vertex, mut next_triangle] = old.totals.next;
    if u32::MAX - next_vertex.max(next_triangle) <= (new.len() + added.len()) as u32 {
        return None;
    }
    let mut removed = removed.clone();
    removed.sort_unstable();
    let dirty = touched(old, cut);
    let (inner, beside) = concerned(old, &dirty);
    let slot = |p: u32| inner.binary_search(&p).ok();

    // Triangles that stay, with a corner in a page to write.
    let mut stay: Vec<(u32, [Home; 3])> = Vec::new();
    for &p in inner.iter().chain(&beside) {
        let t = old.page(p).topology();
        let from = removed.partition_point(|r| r.0 < p);
        let gone = &removed[from..removed.partition_point(|r| r.0 <= p)];
        for (i, corners) in t.triangles.iter().enumerate() {
            if slot(p).is_none() && corners.iter().all(|&v| (v as usize) < t.own) {
                continue;
            }
            let homes = corners.map(|v| home_of(t, p, v));
            if homes.iter().any(|h| slot(h.0).is_some())
                && gone.binary_search_by_key(&(i as u32), |r| r.1).is_err()
            {
                stay.push((t.triangle_ids[i], homes));
            }
        }
    }
    stay.sort_unstable();

    // The vertices of the inner pages that stay, and those of them that must keep their index.
    let mut lives: Vec<Vec<bool>> = inner.iter().map(|&p| vec![true; old.page(p).own()]).collect();
    let mut fixed: Vec<Vec<bool>> = inner.iter().map(|&p| vec![false; old.page(p).own()]).collect();
    for h in &dirty {
        lives[slot(h.0)?][h.1 as usize] = false;
    }
    let kept_corners =
        stay.iter().flat_map(|s| s.1).chain(added.iter().flatten().filter_map(|c| match c {
            Corner::Old(h) => Some(*h),
            Corner::New(_) => None,
        }));
    for h in kept_corners {
        if let Some(s) = slot(h.0) {
            lives[s][h.1 as usize] = true;
        }
    }
    for &p in &beside {
        let t = old.page(p).topology();
        for (home, part) in t.halo_parts() {
            if let Some(s) = slot(home) {
                t.halo_sources[part].iter().for_each(|&l| fixed[s][l as usize] = true);
            }
        }
    }

    let mut region = SplicedRegion {
        tri: TriMesh::default(),
        masks: Vec::new(),
        homes: Homes { page: Vec::new(), local: Vec::new() },
        ids: Vec::new(),
        outer: BTreeMap::new(),
        from: Vec::new(),
    };
    // Numbers that fall free are given again; the rest is appended.
    let mut free_ids: Vec<u32> = Vec::new();
    let mut place: Vec<Vec<u32>> = Vec::new();
    for (s, &p) in inner.iter().enumerate() {
        let page = old.page(p);
        place.push(
            (0..page.own())
                .map(|v| {
                    let id = page.topology().ids[v];
                    if !lives[s][v] {
                        free_ids.push(id);
                        return u32::MAX;
                    }
                    region.from.push((p, v as u16));
                    region.push(page.point(v), page.mask(v), page.colour(v), (p, v as u16), id)
                })
                .collect(),
        );
    }
    free_ids.sort_unstable();
    let first_new = region.masks.len() as u32;
    for (i, v) in new.iter().enumerate() {
        let id = free_ids.get(i).copied().unwrap_or_else(|| {
            next_vertex += 1;
            next_vertex - 1
        });
        region.push(v.place, v.mask, v.colour, (u32::MAX, 0), id);
    }

    let layout = lay_out(old, &inner, &place, &fixed, &mut region, first_new, new)?;

    // Triangles over the region's vertices.
    let mut numbers: Vec<u32> = Vec::with_capacity(stay.len() + added.len());
    let reused: Vec<u32> =
        removed.iter().map(|&(p, t)| old.page(p).topology().triangle_ids[t as usize]).collect();
    for &(id, homes) in &stay {
        let corners = homes.map(|h| match slot(h.0) {
            Some(s) => place[s][h.1 as usize],
            None => region.outer.get(&h).copied().unwrap_or_else(|| {
                let page = old.page(h.0);
                let v = h.1 as usize;
                let made = region.push(
                    page.point(v),
                    page.mask(v),
                    page.colour(v),
                    h,
                    page.topology().ids[v],
                );
                region.outer.insert(h, made);
                made
            }),
        });
        region.tri.triangles.push(corners);
        numbers.push(id);
    }
    for (i, t) in added.iter().enumerate() {
        let corners = t.map(|c| match c {
            Corner::Old(h) => slot(h.0).map_or(u32::MAX, |s| place[s][h.1 as usize]),
            Corner::New(i) => first_new + i,
        });
        region.tri.triangles.push(corners);
        numbers.push(reused.get(i).copied().unwrap_or_else(|| {
            next_triangle += 1;
            next_triangle - 1
        }));
    }
    let mut pages: BTreeMap<u32, Arc<Page>> =
        write(&region, &layout, &numbers)?.into_iter().collect();
    normals(old, &mut pages, &layout, &beside);
    layers(old, &mut pages, &region, &layout, &inner);
    sets(old, &mut pages, &region, &layout, &beside);
    Some(Remade { pages: pages.into_iter().collect(), next: [next_vertex, next_triangle] })
}

/// Returns the vertices that each written page owns, in order.
fn lay_out(
    old: &Snapshot,
    inner: &[u32],
    place: &[Vec<u32>],
    fixed: &[Vec<bool>],
    region: &mut SplicedRegion,
    first_new: u32,
    new: &[NewVertex],
) -> Option<Vec<(u32, Vec<u32>)>> {
    // New vertices in an order that keeps neighbours together.
    let mut items: Vec<order::Item> =
        new.iter().enumerate().map(|(i, v)| (v.place, first_new + i as u32)).collect();
    order::order_runs(&mut items, 64);
    let mut fresh: std::collections::VecDeque<u32> = items.into_iter().map(|i| i.1).collect();
    let mut layout: Vec<(u32, Vec<u32>)> = Vec::new();
    let mut short: Vec<(usize, usize)> = Vec::new();
    for (s, &p) in inner.iter().enumerate() {
        let keep = |v: usize| fixed[s][v] && place[s][v] != u32::MAX;
        let mut loose: std::collections::VecDeque<u32> = (0..place[s].len())
            .filter(|&v| !keep(v))
            .map(|v| place[s][v])
            .filter(|&r| r != u32::MAX)
            .collect();
        let last = (0..place[s].len()).rev().find(|&v| keep(v)).map_or(0, |v| v + 1);
        let mut own: Vec<u32> = Vec::with_capacity(PAGE_VERTICES);
        for v in 0..last {
            own.push(if keep(v) { place[s][v] } else { loose.pop_front().unwrap_or(u32::MAX) });
        }
        own.extend(loose);
        while own.len() < PAGE_VERTICES.min(place[s].len()) && !fresh.is_empty() {
            own.extend(fresh.pop_front());
        }
        for (k, r) in own.iter_mut().enumerate() {
            if *r == u32::MAX {
                match fresh.pop_front() {
                    Some(f) => *r = f,
                    None => short.push((s, k)),
                }
            }
        }
        layout.push((p, own));
    }
    // Places that nothing new fills take loose vertices from the ends of other pages.
    for (s, k) in short {
        let donor = (0..layout.len()).find(|&d| {
            let own = &layout[d].1;
            own.last().is_some_and(|&r| {
                r != u32::MAX
                    && (r >= first_new || {
                        let (page, local) =
                            (region.homes.page[r as usize], region.homes.local[r as usize]);
                        page != inner[d] || !fixed[d][local as usize]
                    })
                    && (d != s || own.len() > k + 1)
            })
        })?;
        let moved = layout[donor].1.pop()?;
        layout[s].1[k] = moved;
    }
    let mut next = old.page_count() as u32;
    while !fresh.is_empty() {
        // As even as can be: no page of a few.
        let count = fresh.len().div_ceil(fresh.len().div_ceil(PAGE_VERTICES));
        layout.push((next, fresh.drain(..count).collect()));
        next += 1;
    }
    for (p, own) in &layout {
        if own.is_empty() || own.len() > PAGE_VERTICES {
            return None;
        }
        for (l, &r) in own.iter().enumerate() {
            region.homes.page[r as usize] = *p;
            region.homes.local[r as usize] = l as u16;
        }
    }
    Some(layout)
}

fn write(
    region: &SplicedRegion,
    layout: &[(u32, Vec<u32>)],
    numbers: &[u32],
) -> Option<Vec<(u32, Arc<Page>)>> {
    let mut touching: BTreeMap<u32, Vec<u32>> = layout.iter().map(|l| (l.0, Vec::new())).collect();
    for (t, corners) in region.tri.triangles.iter().enumerate() {
        let mut last = [u32::MAX; 3];
        for (k, &v) in corners.iter().enumerate() {
            let p = *region.homes.page.get(v as usize)?;
            if !last.contains(&p)
                && let Some(list) = touching.get_mut(&p)
            {
                list.push(t as u32);
            }
            last[k] = p;
        }
    }
    let mut lookup: BTreeMap<Home, u32> = region.outer.clone();
    for (p, own) in layout {
        lookup.extend(own.iter().enumerate().map(|(l, &r)| ((*p, l as u16), r)));
    }
    layout
        .iter()
        .map(|(p, own)| {
            let mut page =
                assemble::assemble(&region.tri, &region.homes, *p, own.clone(), &touching[p])
                    .ok()?;
            let one = Arc::get_mut(&mut page)?;
            let topology = Arc::get_mut(&mut one.topology)?;
            topology.ids = own.iter().map(|&r| region.ids[r as usize]).collect();
            topology.triangle_ids =
                topology.triangle_ids.iter().map(|&t| numbers[t as usize]).collect();
            for (v, &r) in own.iter().enumerate() {
                one.points[v].w = region.masks[r as usize];
            }
            for k in 0..topology.halo_sources.len() {
                let r = *lookup.get(&topology.halo_home(k))?;
                one.points[own.len() + k].w = region.masks[r as usize];
            }
            Some((*p, page))
        })
        .collect()
}

/// Vertices that stay keep what layers do to them; what is new belongs to the base.
fn layers(
    old: &Snapshot,
    pages: &mut BTreeMap<u32, Arc<Page>>,
    region: &SplicedRegion,
    layout: &[(u32, Vec<u32>)],
    inner: &[u32],
) {
    let layered = |p: &u32| old.page(*p).layers().is_some_and(|l| !l.rows().is_empty());
    if !inner.iter().any(layered) {
        return;
    }
    for (p, own) in layout {
        let Some(page) = pages.get_mut(p).and_then(Arc::get_mut) else { continue };
        page.layers = PageLayers::gathered(own.iter().enumerate().map(|(v, &r)| {
            let from = region.from.get(r as usize);
            let from = from.and_then(|h| Some((old.page(h.0).layers()?, h.1 as usize)));
            (page.points[v].truncate(), from)
        }));
    }
}

/// Vertices that stay keep their face sets; what is new is in none, and shown.
fn sets(
    old: &Snapshot,
    pages: &mut BTreeMap<u32, Arc<Page>>,
    region: &SplicedRegion,
    layout: &[(u32, Vec<u32>)],
    beside: &[u32],
) {
    let before = layout.iter().map(|l| l.0).filter(|p| (*p as usize) < old.page_count());
    if !before.chain(beside.iter().copied()).any(|p| old.page(p).sets().is_some()) {
        return;
    }
    let stayed = |r: &u32| region.from.get(*r as usize);
    let kept = |r| stayed(r).map_or(0, |h| old.page(h.0).set_bits(h.1 as usize));
    let own: BTreeMap<u32, Vec<u16>> =
        layout.iter().map(|(p, own)| (*p, own.iter().map(kept).collect())).collect();
    for p in layout.iter().map(|l| l.0).chain(beside.iter().copied()) {
        let page = pages.get(&p).unwrap_or_else(|| old.page(p));
        let at = |home: u32, local: usize| match own.get(&home) {
            Some(sets) => sets[local],
            None => old.page(home).set_bits(local),
        };
        let t = &page.topology;
        let halo = (0..t.halo_sources.len()).map(|k| t.halo_home(k));
        let everyone = (0..t.own).map(|v| (p, v)).chain(halo.map(|(h, l)| (h, l as usize)));
        let rows = PageSets::shared(everyone.map(|(home, local)| at(home, local)).collect());
        if rows != page.sets {
            let mut copy = page.copy();
            copy.sets = rows;
            pages.insert(p, Arc::new(copy));
        }
    }
}

/// Every copy of a normal is what its home says.
fn normals(
    old: &Snapshot,
    pages: &mut BTreeMap<u32, Arc<Page>>,
    layout: &[(u32, Vec<u32>)],
    beside: &[u32],
) {
    for &p in layout.iter().map(|l| &l.0).chain(beside) {
        let now = |p: u32| pages.get(&p).unwrap_or_else(|| old.page(p));
        let page = now(p);
        let t = page.topology.clone();
        let fresh: Vec<Vec4> = (0..t.halo_sources.len())
            .map(|k| {
                let (home, local) = t.halo_home(k);
                now(home).normals[local as usize]
            })
            .collect();
        let bits = |n: &Vec4| n.to_array().map(f32::to_bits);
        if !page.normals[t.own..].iter().map(bits).eq(fresh.iter().map(bits)) {
            let mut copy = page.copy();
            copy.normals[t.own..].copy_from_slice(&fresh);
            pages.insert(p, Arc::new(copy));
        }
    }
}
