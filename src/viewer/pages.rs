//! The clay on the card: every page has a slot of one large vertex buffer, and only pages that changed are sent again.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};

use crate::mesh::{Page, Snapshot};

/// One vertex as the card has it, 24 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    place: [f32; 3],
    /// Normal and mask, 16 bits each, -1 to 1.
    normal: [i16; 4],
    colour: [u8; 4],
}

pub const VERTEX_LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x4, 2 => Unorm8x4],
};

/// Most bytes sent a frame; what is left follows with the next frames, so that a whole-mesh undo does not stop the window.
const BUDGET: u64 = 24 << 20;

#[derive(Debug)]
pub struct Pages {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    /// Index range of each page.
    ranges: Vec<std::ops::Range<u32>>,
    /// The pages as they were when they were sent.
    sent: Vec<Option<Page>>,
    slot: usize,
    revision: Option<u64>,
    scratch: Vec<Vertex>,
    /// Bytes sent by the last [`Pages::update`].
    pub uploaded: u64,
    /// Pages that changed and are not sent yet.
    pub waiting: usize,
}

impl Pages {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &Snapshot) -> Pages {
        let pages = mesh.pages();
        let slot = pages.iter().map(|p| p.topology.own).max().unwrap_or(1).max(1);
        let buffer = |size: usize, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pages"),
                size: size.max(4) as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let mut indices: Vec<u32> = Vec::with_capacity(mesh.triangle_count() * 3);
        let mut ranges = Vec::with_capacity(pages.len());
        for (p, page) in pages.iter().enumerate() {
            let start = indices.len() as u32;
            let t = &page.topology;
            indices.extend(t.triangles.iter().flatten().map(|&v| {
                let v = v as usize;
                let (page, local) = if v < t.own { (p, v) } else { (t.halo[v - t.own].0 as usize, t.halo[v - t.own].1 as usize) };
                (page * slot + local) as u32
            }));
            ranges.push(start..indices.len() as u32);
        }
        let index_buffer = buffer(indices.len() * 4, wgpu::BufferUsages::INDEX);
        queue.write_buffer(&index_buffer, 0, bytemuck::cast_slice(&indices));
        Pages {
            vertices: buffer(pages.len() * slot * size_of::<Vertex>(), wgpu::BufferUsages::VERTEX),
            indices: index_buffer,
            ranges,
            sent: vec![None; pages.len()],
            slot,
            revision: None,
            scratch: Vec::with_capacity(slot),
            uploaded: 0,
            waiting: 0,
        }
    }

    /// Whether this snapshot has the pages that the buffers were made for.
    pub fn fits(&self, mesh: &Snapshot) -> bool {
        let same = |(sent, now): (&Option<Page>, &Page)| {
            sent.as_ref().is_none_or(|s| Arc::ptr_eq(&s.topology, &now.topology))
        };
        self.sent.len() == mesh.pages().len() && self.sent.iter().zip(mesh.pages()).all(same)
    }

    /// Sends pages that changed since they were last sent, up to the budget.
    pub fn update(&mut self, queue: &wgpu::Queue, mesh: &Snapshot) {
        (self.uploaded, self.waiting) = (0, 0);
        for (i, page) in mesh.pages().iter().enumerate() {
            let unchanged = self.sent[i].as_ref().is_some_and(|s| {
                Arc::ptr_eq(&s.positions, &page.positions)
                    && Arc::ptr_eq(&s.normals, &page.normals)
                    && Arc::ptr_eq(&s.mask, &page.mask)
                    && Arc::ptr_eq(&s.colours, &page.colours)
            });
            if unchanged {
                continue;
            }
            if self.uploaded > BUDGET && self.revision.is_some() {
                self.waiting += 1;
                continue;
            }
            self.scratch.clear();
            self.scratch.extend((0..page.topology.own).map(|v| {
                let p = page.positions.get(v);
                let n = (page.normals.get(v) * 32767.0).to_array().map(|c| c as i16);
                Vertex {
                    place: p.to_array(),
                    normal: [n[0], n[1], n[2], (page.mask[v] * 32767.0) as i16],
                    colour: page.colours[v],
                }
            }));
            let bytes: &[u8] = bytemuck::cast_slice(&self.scratch);
            queue.write_buffer(&self.vertices, (i * self.slot * size_of::<Vertex>()) as u64, bytes);
            self.uploaded += bytes.len() as u64;
            self.sent[i] = Some(page.clone());
        }
        self.revision = Some(mesh.revision());
    }

    /// Draws every page whose bounds `visible` accepts.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, visible: impl Fn(&Page) -> bool) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        let mut run: Option<std::ops::Range<u32>> = None;
        for (range, page) in self.ranges.iter().zip(&self.sent) {
            let shown = page.as_ref().is_some_and(&visible);
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
    }
}
