//! The clay on the card: every page has a slot of one large vertex buffer, and of the pages that
//! changed only the rows that did are sent again.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use super::coarse_pages::{CoarsePages, MANY, is_far};
use super::page_place::place;
use crate::look::with_set;
use sculptd_clay::{Page, Snapshot};

/// One vertex as the card has it, 24 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    place: [f32; 3],
    /// Normal and mask, 16 bits each, -1 to 1.
    normal: [i16; 4],
    colour: [u8; 4],
}

impl Vertex {
    pub fn new(place: Vec3, normal: Vec3, mask: f32, colour: [u8; 4]) -> Vertex {
        let n = (normal * 32767.0).to_array().map(|c| c as i16);
        Vertex {
            place: place.to_array(),
            normal: [n[0], n[1], n[2], (mask * 32767.0) as i16],
            colour,
        }
    }
}

pub const VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Unorm8x4],
};

/// One value per vertex, in a separate buffer: maps change while the clay stays.
pub const VALUE_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<f32>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![3 => Float32],
};

/// A number for each page's own vertices; a page that did not change is the same `Arc` as before.
/// NaN: not known.
#[derive(Debug, Clone, Default)]
pub struct MapValues {
    pub pages: Vec<Arc<[f32]>>,
}

/// Most bytes sent a frame; what is left follows with the next frames, so that a whole-mesh undo
/// does not stop the window.
const BUDGET: u64 = 24 << 20;

/// Rows between two changed ones that are sent with them: a call costs about as much as so many
/// bytes.
const GAP: usize = 8;

/// Rows of each page that are not on the card yet, one bit per row.
#[derive(Debug)]
struct Rows {
    bits: Vec<u64>,
    words: usize,
}

impl Rows {
    fn all(pages: usize, slot: usize) -> Rows {
        let words = slot.div_ceil(64);
        Rows { bits: vec![u64::MAX; pages * words], words }
    }

    fn of(&mut self, page: u32) -> &mut [u64] {
        let at = page as usize * self.words;
        &mut self.bits[at..at + self.words]
    }

    /// Marks the rows in which two states of a page differ.
    fn mark(&mut self, i: u32, old: &Page, new: &Page) {
        let bits = self.of(i);
        for v in 0..new.own() {
            let same = old.point(v) == new.point(v)
                && old.normal(v) == new.normal(v)
                && old.mask(v) == new.mask(v)
                && old.colour(v) == new.colour(v)
                && old.face_set(v) == new.face_set(v);
            bits[v / 64] |= u64::from(!same) << (v % 64);
        }
    }

    /// Takes the marked runs of a page with `own` rows, those near each other as one.
    fn take(&mut self, i: u32, own: usize, runs: &mut Vec<std::ops::Range<usize>>) {
        runs.clear();
        let bits = self.of(i);
        for v in (0..own).filter(|v| bits[v / 64] >> (v % 64) & 1 == 1) {
            match runs.last_mut() {
                Some(run) if v - run.end <= GAP => run.end = v + 1,
                _ => runs.push(v..v + 1),
            }
        }
        bits.fill(0);
    }
}

#[derive(Debug)]
pub struct Pages {
    vertices: wgpu::Buffer,
    values: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Ends of edges, made when a wireframe is first asked for, and the range of each page.
    edges: Option<(wgpu::Buffer, Vec<std::ops::Range<u32>>)>,
    /// The map that was sent last.
    map: Vec<Arc<[f32]>>,
    /// Index range of each page.
    ranges: Vec<std::ops::Range<u32>>,
    /// The newest clay that was looked at.
    seen: Option<Snapshot>,
    /// Pages that changed and are not sent yet, oldest first.
    queue: Vec<u32>,
    queued: Vec<bool>,
    rows: Rows,
    /// Face sets are shown by colours.
    tinted: bool,
    slot: usize,
    scratch: Vec<Vertex>,
    runs: Vec<std::ops::Range<usize>>,
    /// Of a large clay: what far pages are drawn with.
    coarse: Option<CoarsePages>,
    /// Bytes sent by the last [`Pages::update`].
    pub uploaded: u64,
}

impl Pages {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &Snapshot) -> Pages {
        let slot = mesh.pages().map(|p| p.own()).max().unwrap_or(1).max(1);
        let buffer = |size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pages"),
                size: size.max(4) as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let mut indices: Vec<u32> = Vec::with_capacity(mesh.triangle_count() * 3);
        let mut ranges = Vec::with_capacity(mesh.page_count());
        for (p, page) in mesh.pages().enumerate() {
            let start = indices.len() as u32;
            corners(page, p, slot, &mut indices);
            ranges.push(start..indices.len() as u32);
        }
        let index_buffer = buffer(indices.len() * 4, wgpu::BufferUsages::INDEX);
        queue.write_buffer(&index_buffer, 0, bytemuck::cast_slice(&indices));
        let count = mesh.page_count();
        Pages {
            vertices: buffer(count * slot * size_of::<Vertex>(), wgpu::BufferUsages::VERTEX),
            values: buffer(count * slot * size_of::<f32>(), wgpu::BufferUsages::VERTEX),
            indices: index_buffer,
            edges: None,
            map: Vec::new(),
            ranges,
            seen: None,
            queue: (0..count as u32).collect(),
            queued: vec![true; count],
            rows: Rows::all(count, slot),
            tinted: false,
            slot,
            scratch: Vec::with_capacity(slot),
            runs: Vec::with_capacity(slot.div_ceil(GAP)),
            coarse: None,
            uploaded: 0,
        }
    }

    /// Pages that changed and are not sent yet.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// Pages of which the coarse triangles are still being made.
    pub fn coarse_waiting(&self) -> usize {
        self.coarse.as_ref().map_or(0, CoarsePages::waiting)
    }

    /// From now on far pages of a large clay are drawn with fewer triangles, as these are made.
    pub fn coarsen(&mut self, device: &wgpu::Device, mesh: &Snapshot) {
        let count = mesh.triangle_count();
        if count >= MANY && self.coarse.is_none() {
            self.coarse = Some(CoarsePages::new(device, mesh, &self.ranges, self.slot));
        }
    }

    /// Returns true if this snapshot has the topology that the buffers were built for.
    pub fn fits(&self, mesh: &Snapshot) -> bool {
        let Some(seen) = &self.seen else { return self.ranges.len() == mesh.page_count() };
        let mut same = seen.page_count() == mesh.page_count();
        if same {
            mesh.each_changed(seen, |i, page| {
                same &= Arc::ptr_eq(page.topology(), seen.page(i).topology())
            });
        }
        same
    }

    /// Sends what changed of the pages since they were last sent, up to the budget; the first time
    /// all of them. `tinted`: face sets are shown by colours.
    pub fn update(&mut self, queue: &wgpu::Queue, mesh: &Snapshot, tinted: bool) {
        let first = self.seen.is_none();
        if std::mem::replace(&mut self.tinted, tinted) != tinted
            && mesh.pages().any(|p| p.sets().is_some())
        {
            let count = self.ranges.len();
            self.rows = Rows::all(count, self.slot);
            self.queue = (0..count as u32).collect();
            self.queued.fill(true);
        }
        if let Some(seen) = &self.seen {
            let (waiting, queued, rows) = (&mut self.queue, &mut self.queued, &mut self.rows);
            let (slot, ranges, indices) = (self.slot, &self.ranges, &self.indices);
            let mut fresh: Vec<u32> = Vec::new();
            mesh.each_changed(seen, |i, page| {
                let old = seen.page(i);
                rows.mark(i, old, page);
                let differs = old.sets() != page.sets();
                let mut all = 0..page.triangles().len();
                if differs && all.any(|t| old.is_triangle_hidden(t) != page.is_triangle_hidden(t)) {
                    fresh.clear();
                    corners(page, i as usize, slot, &mut fresh);
                    let at = u64::from(ranges[i as usize].start) * size_of::<u32>() as u64;
                    queue.write_buffer(indices, at, bytemuck::cast_slice(&fresh));
                    // They are made again without those of hidden triangles.
                    self.edges = None;
                }
                if !std::mem::replace(&mut queued[i as usize], true) {
                    waiting.push(i);
                }
            });
        }
        self.seen = Some(mesh.clone());
        self.uploaded = 0;
        let mut sent = 0;
        while sent < self.queue.len() && (first || self.uploaded < BUDGET) {
            let i = self.queue[sent];
            sent += 1;
            self.queued[i as usize] = false;
            let page = mesh.page(i);
            self.rows.take(i, page.own(), &mut self.runs);
            for run in &self.runs {
                self.scratch.clear();
                let vertex = |v| {
                    let colour = match page.face_set(v) {
                        set if tinted => with_set(page.colour(v), set),
                        _ => page.colour(v),
                    };
                    Vertex::new(page.point(v), page.normal(v), page.mask(v), colour)
                };
                self.scratch.extend(run.clone().map(vertex));
                let bytes: &[u8] = bytemuck::cast_slice(&self.scratch);
                let at = (i as usize * self.slot + run.start) * size_of::<Vertex>();
                queue.write_buffer(&self.vertices, at as u64, bytes);
                self.uploaded += bytes.len() as u64;
            }
        }
        self.queue.drain(..sent);
        if let Some(coarse) = &mut self.coarse {
            coarse.advance(queue);
        }
    }

    /// Sends the values of pages whose map changed; returns the bytes.
    pub fn set_map(&mut self, queue: &wgpu::Queue, map: &MapValues) -> u64 {
        let mut sent = 0;
        for (i, values) in map.pages.iter().enumerate().take(self.ranges.len()) {
            if values.len() > self.slot
                || self.map.get(i).is_some_and(|old| Arc::ptr_eq(old, values))
            {
                continue;
            }
            let at = (i * self.slot * size_of::<f32>()) as u64;
            queue.write_buffer(&self.values, at, bytemuck::cast_slice(values));
            sent += (values.len() * size_of::<f32>()) as u64;
        }
        self.map.clone_from(&map.pages);
        sent
    }

    /// Makes the edges for [`Pages::draw_edges`]; costs as much as the clay is large, once.
    pub fn need_edges(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) {
        let Some(mesh) = self.seen.as_ref().filter(|_| self.edges.is_none()) else { return };
        let mut ends: Vec<u32> = Vec::with_capacity(mesh.triangle_count() * 3);
        let mut ranges = Vec::with_capacity(mesh.page_count());
        for (p, page) in mesh.pages().enumerate() {
            let start = ends.len() as u32;
            let shown = (0..page.triangles().len()).filter(|&t| !page.is_triangle_hidden(t));
            for t in shown.map(|t| page.triangles()[t]) {
                let [a, b, c] = t.map(|v| place(page, p, self.slot, v));
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    // The other triangle has the edge the other way; a border's edge may be left
                    // out by this, which a sculptor does not miss.
                    if from < to {
                        ends.extend([from, to]);
                    }
                }
            }
            ranges.push(start..ends.len() as u32);
        }
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("edges"),
            size: (ends.len().max(1) * 4) as u64,
            usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&ends));
        self.edges = Some((buffer, ranges));
    }

    /// Draws every page whose bounds `visible` accepts; returns how many.
    pub fn draw(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        visible: impl Fn(u32, &Page) -> bool,
    ) -> usize {
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        self.runs(pass, &self.ranges, visible)
    }

    /// As [`Pages::draw`]; what takes few pixels of a screen of that height is drawn with fewer
    /// triangles, where there are many. `matrix` leads from the clay to the screen. How many were
    /// drawn, and how many of them so.
    pub fn draw_by_size(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        (matrix, height): (&Mat4, u32),
        visible: impl Fn(u32, &Page) -> bool,
    ) -> (usize, usize) {
        let Some(coarse) = &self.coarse else { return (self.draw(pass, visible), 0) };
        let few = |i: u32, page: &Page| coarse.range(i).is_some() && is_far(matrix, height, page);
        let drawn = self.draw(pass, |i, page| visible(i, page) && !few(i, page));
        pass.set_index_buffer(coarse.buffer().slice(..), wgpu::IndexFormat::Uint32);
        let range = |i: usize| coarse.range(i as u32).unwrap_or_default();
        let ranges: Vec<std::ops::Range<u32>> = (0..self.ranges.len()).map(range).collect();
        let coarse = self.runs(pass, &ranges, |i, page| visible(i, page) && few(i, page));
        (drawn + coarse, coarse)
    }

    /// The edges of every page whose bounds `visible` accepts, if there are edges.
    pub fn draw_edges(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        visible: impl Fn(u32, &Page) -> bool,
    ) {
        if let Some((edges, ranges)) = &self.edges {
            pass.set_index_buffer(edges.slice(..), wgpu::IndexFormat::Uint32);
            self.runs(pass, ranges, visible);
        }
    }

    /// Neighbouring visible pages are drawn by one call.
    fn runs(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        ranges: &[std::ops::Range<u32>],
        visible: impl Fn(u32, &Page) -> bool,
    ) -> usize {
        let Some(mesh) = &self.seen else { return 0 };
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.values.slice(..));
        let mut drawn = 0;
        let mut run: Option<std::ops::Range<u32>> = None;
        for (i, (range, page)) in ranges.iter().zip(mesh.pages()).enumerate() {
            let shown = visible(i as u32, page);
            drawn += usize::from(shown);
            run = match run {
                Some(r) if shown => Some(r.start..range.end),
                Some(r) => {
                    pass.draw_indexed(r, 0, 0..1);
                    None
                }
                None => shown.then(|| range.clone()),
            };
        }
        if let Some(r) = run {
            pass.draw_indexed(r, 0, 0..1);
        }
        drawn
    }
}

/// The corners of a page's triangles on the card; a hidden triangle is one of no size.
fn corners(page: &Page, p: usize, slot: usize, out: &mut Vec<u32>) {
    for (i, t) in page.triangles().iter().enumerate() {
        let corners = t.map(|v| place(page, p, slot, v));
        out.extend(if page.is_triangle_hidden(i) { [corners[0]; 3] } else { corners });
    }
}
