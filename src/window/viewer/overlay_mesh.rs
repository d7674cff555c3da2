//! Triangles beside the clay: what a Boolean would make, a held object, the items of the hands'
//! menu, the goal of an exhibit.

use glam::Vec3;

use super::gpu::Gpu;
use super::pages::Vertex;
use sculptd_engine::hand::{HeldObject, Similarity};
use sculptd_geometry::TriMesh;

/// Triangles in the world, with a normal and a colour a vertex.
#[derive(Debug, Clone, Default)]
pub struct Triangles {
    pub vertices: Vec<Vertex>,
    pub triangles: Vec<[u32; 3]>,
    /// Changes with every change of the rest.
    pub stamp: u64,
}

/// Rings and corners of a ball: round to the eye at the size of a thumb.
const RINGS: u32 = 12;
const CORNERS: u32 = 20;
/// A held object of more triangles is shown by its edges alone: it is sent again whenever it moves.
const MOST: usize = 60_000;

impl Triangles {
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.triangles.clear();
        self.stamp += 1;
    }

    pub fn ball(&mut self, centre: Vec3, radius: f32, colour: [u8; 4]) {
        let first = self.vertices.len() as u32;
        self.stamp += 1;
        for ring in 0..=RINGS {
            let (sp, cp) = (ring as f32 / RINGS as f32 * std::f32::consts::PI).sin_cos();
            for k in 0..=CORNERS {
                let (s, c) = (k as f32 / CORNERS as f32 * std::f32::consts::TAU).sin_cos();
                let n = Vec3::new(sp * c, cp, sp * s);
                self.vertices.push(Vertex::new(centre + n * radius, n, 0.0, colour));
            }
        }
        let row = CORNERS + 1;
        for a in (0..RINGS).flat_map(|r| (0..CORNERS).map(move |k| first + r * row + k)) {
            self.triangles.extend([[a, a + 1, a + row], [a + 1, a + row + 1, a + row]]);
        }
    }

    /// A held object where it is, if it is not too large to be sent with every move.
    pub fn held_object(&mut self, thing: &HeldObject, colour: [u8; 4]) {
        if thing.plain.triangles.len() > MOST {
            return;
        }
        self.form(&thing.plain, &thing.place, colour);
    }

    /// A form at a place.
    pub fn form(&mut self, plain: &TriMesh, place: &Similarity, colour: [u8; 4]) {
        let first = self.vertices.len() as u32;
        self.stamp += 1;
        let places: Vec<Vec3> = plain.positions.iter().map(|p| place.apply(*p)).collect();
        let mut normals = vec![Vec3::ZERO; places.len()];
        for t in &plain.triangles {
            let [a, b, c] = t.map(|v| places[v as usize]);
            t.iter().for_each(|&v| normals[v as usize] += (b - a).cross(c - a));
        }
        let vertex = |(p, n): (&Vec3, &Vec3)| Vertex::new(*p, n.normalize_or_zero(), 0.0, colour);
        self.vertices.extend(places.iter().zip(&normals).map(vertex));
        self.triangles.extend(plain.triangles.iter().map(|t| t.map(|v| v + first)));
    }
}

/// Their buffers on the card; they grow and never shrink.
#[derive(Debug, Default)]
pub struct OverlayMesh {
    buffers: Option<[wgpu::Buffer; 3]>,
    count: u32,
    stamp: Option<u64>,
}

impl OverlayMesh {
    /// Sends what was not sent yet.
    pub fn keep(&mut self, gpu: &Gpu, all: &Triangles) {
        if self.stamp != Some(all.stamp) {
            self.stamp = Some(all.stamp);
            self.set(gpu, &all.vertices, &all.triangles);
        }
    }

    pub fn set(&mut self, gpu: &Gpu, vertices: &[Vertex], triangles: &[[u32; 3]]) {
        self.count = (triangles.len() * 3) as u32;
        if triangles.is_empty() {
            return;
        }
        let sizes =
            [size_of_val(vertices), vertices.len() * size_of::<f32>(), size_of_val(triangles)];
        let fits = |b: &[wgpu::Buffer; 3]| b.iter().zip(sizes).all(|(b, s)| b.size() >= s as u64);
        if !self.buffers.as_ref().is_some_and(fits) {
            let usages =
                [wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::INDEX];
            let buffers = [0, 1, 2].map(|i| {
                gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("overlay"),
                    size: (sizes[i] * 3 / 2).next_multiple_of(4) as u64,
                    usage: usages[i] | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            });
            // No map knows them.
            let room = vec![f32::NAN; buffers[1].size() as usize / size_of::<f32>()];
            gpu.queue.write_buffer(&buffers[1], 0, bytemuck::cast_slice(&room));
            self.buffers = Some(buffers);
        }
        if let Some([v, _, t]) = &self.buffers {
            gpu.queue.write_buffer(v, 0, bytemuck::cast_slice(vertices));
            gpu.queue.write_buffer(t, 0, bytemuck::cast_slice(triangles));
        }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some([vertices, values, triangles]) =
            self.buffers.as_ref().filter(|_| self.count > 0)
        {
            pass.set_vertex_buffer(0, vertices.slice(..));
            pass.set_vertex_buffer(1, values.slice(..));
            pass.set_index_buffer(triangles.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..self.count, 0, 0..1);
        }
    }
}
