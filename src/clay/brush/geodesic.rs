//! Over the clay from vertex to vertex, across pages, no further than the brush.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::Vec3;

use crate::page::BREAK;
use crate::{Clay, PAGE_VERTICES, Page, Reach};

/// A vertex by its page and its place in it.
pub type Key = (u32, u16);

/// The data of a vertex, kept together: a walk in charts reads most of it at every edge.
#[derive(Debug, Clone, Copy)]
struct Mark {
    /// Infinite where the walk did not come.
    distance: f32,
    /// The source that reached it, and the source of its coordinates; 0: none.
    owner: [u32; 2],
    /// The texture coordinates from its source, where it has them.
    place: [f32; 2],
    /// The reported coordinates, interpolated between those of two sources.
    told: [f32; 2],
    /// The surface's own directions carried along: `u` and normal.
    frame: [Vec3; 2],
}

impl Mark {
    const UNSEEN: Self = Self {
        distance: f32::INFINITY,
        owner: [0; 2],
        place: [f32::NAN; 2],
        told: [f32::NAN; 2],
        frame: [Vec3::ZERO; 2],
    };
}

/// The data of a visited page.
#[derive(Debug, Default)]
struct Block {
    page: u32,
    /// One mark for each owned vertex.
    marks: Vec<Mark>,
}

/// The share of an estimated distance below which another estimate is worth a new place in the
/// order of a walk.
const WORTH: f32 = 0.9;

/// The state of the surface that is walked over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalkedSurface {
    /// As it is.
    Now,
    /// As it was when the stroke began.
    Before,
}

/// One walk. Its memory is used again by the next.
#[derive(Debug, Default)]
pub struct Geodesic {
    /// For each page its block plus one, or 0.
    block_of: Vec<u32>,
    blocks: Vec<Block>,
    used: usize,
    heap: BinaryHeap<Reverse<(u32, u32, u16)>>,
    /// The vertices of a border, and their distances along it.
    border: Vec<(Key, f32)>,
}

impl Geodesic {
    /// Forgets everything.
    pub fn begin(&mut self, mesh: &Clay) {
        for b in &self.blocks[..self.used] {
            if let Some(slot) = self.block_of.get_mut(b.page as usize) {
                *slot = 0;
            }
        }
        self.used = 0;
        self.block_of.resize(mesh.page_count(), 0);
        self.heap.clear();
    }

    fn find(&self, page: u32) -> Option<&Block> {
        let slot = *self.block_of.get(page as usize)? as usize;
        self.blocks.get(slot.checked_sub(1)?)
    }

    #[inline]
    fn mark(&self, page: u32, v: usize) -> Option<&Mark> {
        self.find(page)?.marks.get(v)
    }

    #[inline]
    fn mark_mut(&mut self, mesh: &Clay, (page, v): Key) -> &mut Mark {
        &mut self.block(mesh, page).marks[v as usize]
    }

    #[inline]
    fn block(&mut self, mesh: &Clay, page: u32) -> &mut Block {
        let slot = self.block_of[page as usize] as usize;
        match slot {
            0 => self.new_block(mesh, page),
            _ => &mut self.blocks[slot - 1],
        }
    }

    #[cold]
    fn new_block(&mut self, mesh: &Clay, page: u32) -> &mut Block {
        if self.used == self.blocks.len() {
            // Room for any page at once: which block serves which page changes from walk to walk.
            self.blocks.push(Block { page: 0, marks: Vec::with_capacity(PAGE_VERTICES) });
        }
        let own = mesh.page(page).own();
        let block = &mut self.blocks[self.used];
        self.used += 1;
        self.block_of[page as usize] = self.used as u32;
        block.page = page;
        block.marks.clear();
        block.marks.resize(own, Mark::UNSEEN);
        block
    }

    /// Returns the distance of a vertex along the walk; `None` if the walk did not reach it.
    #[inline]
    pub fn distance(&self, page: u32, v: usize) -> Option<f32> {
        self.mark(page, v).map(|m| m.distance).filter(|d| d.is_finite())
    }

    /// The texture's coordinates at a vertex.
    #[inline]
    pub fn place(&self, page: u32, v: usize) -> Option<[f32; 2]> {
        self.mark(page, v).map(|m| m.told).filter(|p| !p[0].is_nan())
    }

    /// The directions carried to a vertex: along `u`, and the normal.
    pub fn frame(&self, (page, v): Key) -> Option<[Vec3; 2]> {
        self.mark(page, v as usize).map(|m| m.frame)
    }

    /// A vertex's place and the directions carried to it, where it has them from this source.
    #[inline]
    pub fn settled_by(&self, (page, v): Key, owner: u32) -> Option<([f32; 2], [Vec3; 2])> {
        let mark = self.mark(page, v as usize)?;
        (mark.owner[1] == owner).then_some((mark.place, mark.frame))
    }

    /// Sets the distance of a vertex, if that is nearer than before, and continues the walk from
    /// it. Returns true if it was nearer.
    #[inline(always)]
    pub fn offer(&mut self, mesh: &Clay, key: Key, distance: f32, owner: u32) -> bool {
        let mark = self.mark_mut(mesh, key);
        let nearer = distance < mark.distance;
        if nearer {
            mark.distance = distance;
            mark.owner[0] = owner;
            // Distances are not negative: their bits order as they do.
            self.heap.push(Reverse((distance.to_bits(), key.0, key.1)));
        }
        nearer
    }

    /// Offers a vertex to a source that makes a chart, at a distance that is only estimated: it
    /// goes to the nearest source, or to the next one where it lies ahead of a source, beyond `u`
    /// there. The distance is what `distance` says or the straight one, whichever is longer; it is
    /// asked for only where the straight one would do.
    pub fn offer_ahead(
        &mut self,
        mesh: &Clay,
        key: Key,
        (owner, u): (u32, f32),
        straight: f32,
        distance: impl FnOnce() -> f32,
        most: f32,
    ) {
        let mark = self.mark_mut(mesh, key);
        let [reached, source] = mark.owner;
        if source == owner {
            return;
        }
        let ahead = source + 1 == owner && mark.place[0] > u;
        let limit = match reached == owner {
            true => mark.distance * WORTH,
            false if ahead => f32::INFINITY,
            false => mark.distance,
        };
        if !(straight < limit && straight < most) {
            return;
        }
        let d = distance().max(straight);
        if d < limit && d < most {
            mark.distance = d;
            mark.owner[0] = owner;
            self.heap.push(Reverse((d.to_bits(), key.0, key.1)));
        }
    }

    /// A vertex that was taken is not as far as the way to it told.
    pub fn set_distance(&mut self, mesh: &Clay, key: Key, distance: f32) {
        self.mark_mut(mesh, key).distance = distance;
    }

    /// Lets the walk go on from a vertex again, from where it is now.
    pub fn requeue(&mut self, key: Key) {
        if let Some(d) = self.distance(key.0, key.1 as usize) {
            self.heap.push(Reverse((d.to_bits(), key.0, key.1)));
        }
    }

    /// A vertex that has its source's coordinates passes them to others.
    pub fn tell(&mut self, mesh: &Clay, key: Key, place: [f32; 2]) {
        self.mark_mut(mesh, key).told = place;
    }

    /// The source that a vertex has its coordinates from (0: none), and these.
    pub fn source(&self, (page, v): Key) -> (u32, [f32; 2]) {
        self.mark(page, v as usize).map_or((0, [f32::NAN; 2]), |m| (m.owner[1], m.place))
    }

    /// Returns true if the number of pages changed since the walk began.
    pub fn is_stale(&self, mesh: &Clay) -> bool {
        self.block_of.len() != mesh.page_count()
    }

    /// Returns the source that reached a vertex; 0: none.
    pub fn owner(&self, page: u32, v: usize) -> u32 {
        self.mark(page, v).map_or(0, |m| m.owner[0])
    }

    /// Returns true if a vertex has its coordinates from this source.
    pub fn is_settled(&self, (page, v): Key, owner: u32) -> bool {
        self.mark(page, v as usize).is_some_and(|m| m.owner[1] == owner)
    }

    /// Gives a vertex its coordinates and directions from the source that reached it.
    pub fn settle(&mut self, mesh: &Clay, key: Key, place: [f32; 2], frame: [Vec3; 2]) {
        let mark = self.mark_mut(mesh, key);
        (mark.place, mark.told, mark.frame) = (place, place, frame);
        mark.owner[1] = mark.owner[0];
    }

    /// The nearest vertex that was offered and not yet taken.
    pub fn take(&mut self) -> Option<(Key, f32)> {
        while let Some(Reverse((bits, page, v))) = self.heap.pop() {
            let d = f32::from_bits(bits);
            if self.distance(page, v as usize) == Some(d) {
                return Some(((page, v), d));
            }
        }
        None
    }

    /// Distances over the edges from a point on the surface, where the normal is as given, as far
    /// as `radius`. The first ring about the point is measured straight.
    pub fn measure(
        &mut self,
        mesh: &Clay,
        (centre, normal): (Vec3, Vec3),
        radius: f32,
        surface: WalkedSurface,
    ) {
        self.begin(mesh);
        let at = |i: u32| match surface {
            WalkedSurface::Now => mesh.page(i),
            WalkedSurface::Before => mesh.before(i),
        };
        let mut seed: Option<(f32, Key)> = None;
        let mut look = |number: u32, page: &Page| {
            for v in 0..page.own() {
                let d2 = (page.point(v) - centre).length_squared();
                if page.normal(v).dot(normal) > 0.0 && seed.is_none_or(|s| d2 < s.0) {
                    seed = Some((d2, (number, v as u16)));
                }
            }
        };
        let near = Reach::Sphere { centre, radius };
        match surface {
            WalkedSurface::Now => mesh.each_page(&near, |number, page| look(number, page)),
            WalkedSurface::Before => {
                mesh.each_page_before(&near, |number, page| look(number, page));
            }
        }
        let Some((d2, key)) = seed else { return };
        self.offer(mesh, key, d2.sqrt(), 1);
        ring(at, key, |to, p| {
            self.offer(mesh, to, (p - centre).length(), 1);
        });
        while let Some((key, d)) = self.take() {
            let from = at(key.0).point(key.1 as usize);
            ring(at, key, |to, p| {
                let d = d + (p - from).length();
                if d < radius {
                    self.offer(mesh, to, d, 1);
                }
            });
        }
    }

    /// Measures distances over the edges from the border of the surface, up to `radius`, on the
    /// surface at the start of the stroke. The border extends `radius` along itself from its vertex
    /// nearest to `centre`, which is within `radius` of `centre`. Each vertex's place is `[distance
    /// of its border along the border, 0]`.
    pub fn measure_from_border(&mut self, mesh: &Clay, centre: Vec3, radius: f32) {
        self.begin(mesh);
        let mut seed: Option<(f32, Key)> = None;
        mesh.each_page_before(&Reach::Sphere { centre, radius }, |number, page| {
            for v in (0..page.own()).filter(|v| page.is_border(*v)) {
                let d2 = (page.point(v) - centre).length_squared();
                if d2 < radius * radius && seed.is_none_or(|s| d2 < s.0) {
                    seed = Some((d2, (number, v as u16)));
                }
            }
        });
        let Some((_, key)) = seed else { return };
        let mut border = std::mem::take(&mut self.border);
        border.clear();
        self.offer(mesh, key, 0.0, 1);
        while let Some((key, d)) = self.take() {
            border.push((key, d));
            let from = mesh.before(key.0).point(key.1 as usize);
            ring(
                |i| mesh.before(i),
                key,
                |to, p| {
                    let d = d + (p - from).length();
                    if d < radius && mesh.before(to.0).is_border(to.1 as usize) {
                        self.offer(mesh, to, d, 1);
                    }
                },
            );
        }
        self.begin(mesh);
        for &(key, along) in &border {
            self.offer(mesh, key, 0.0, 1);
            self.settle(mesh, key, [along, 0.0], [Vec3::ZERO; 2]);
        }
        self.border = border;
        while let Some((key, d)) = self.take() {
            let from = mesh.before(key.0).point(key.1 as usize);
            let Some(place) = self.place(key.0, key.1 as usize) else { continue };
            ring(
                |i| mesh.before(i),
                key,
                |to, p| {
                    let d = d + (p - from).length();
                    if d < radius && self.offer(mesh, to, d, 1) {
                        self.settle(mesh, to, place, [Vec3::ZERO; 2]);
                    }
                },
            );
        }
    }

    /// Marks what hangs together, within `radius` of `centre`, with the nearest vertex that faces
    /// as `normal` does.
    pub fn flood(&mut self, mesh: &Clay, centre: Vec3, normal: Vec3, radius: f32) {
        self.begin(mesh);
        let mut seed: Option<(f32, Key)> = None;
        mesh.each_page(&Reach::Sphere { centre, radius }, |number, page| {
            for v in 0..page.own() {
                let d2 = (page.point(v) - centre).length_squared();
                if page.normal(v).dot(normal) > 0.0 && seed.is_none_or(|s| d2 < s.0) {
                    seed = Some((d2, (number, v as u16)));
                }
            }
        });
        let Some((d2, key)) = seed else { return };
        self.offer(mesh, key, d2.sqrt(), 1);
        while let Some((key, _)) = self.take() {
            ring(
                |i| mesh.page(i),
                key,
                |to, p| {
                    let d = (p - centre).length();
                    if d <= radius {
                        self.offer(mesh, to, d, 1);
                    }
                },
            );
        }
    }
}

/// Calls `visit` with each neighbour of a vertex and where it is.
#[inline(always)]
pub fn ring<'a>(
    at: impl Fn(u32) -> &'a Arc<Page>,
    (page, v): Key,
    mut visit: impl FnMut(Key, Vec3),
) {
    let one = at(page);
    let t = one.topology();
    for &k in t.ring(v as usize) {
        let k = (k & !BREAK) as usize;
        let home = match k.checked_sub(t.own) {
            None => (page, k as u16),
            Some(halo) => t.halo_home(halo),
        };
        visit(home, one.point(k));
    }
}
