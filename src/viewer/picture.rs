//! A picture without a window: the same renderer into a texture that is read back.

use std::sync::mpsc;

use image::RgbaImage;

use super::gpu::{Gpu, NoViewer, instance};
use super::renderer::{Renderer, Scene};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A renderer that draws pictures; keeps its adapter between them.
#[derive(Debug)]
pub struct Painter {
    gpu: Gpu,
    renderer: Renderer,
}

impl Painter {
    pub fn new() -> Result<Painter, NoViewer> {
        let gpu = Gpu::new(instance(), None)?;
        let renderer = Renderer::new(&gpu, FORMAT);
        Ok(Painter { gpu, renderer })
    }

    /// What draws here.
    pub fn adapter(&self) -> String {
        self.gpu.name()
    }

    pub fn paint(&mut self, scene: &Scene<'_>, width: u32, height: u32) -> Result<RgbaImage, NoViewer> {
        let device = &self.gpu.device;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        // Rows are padded to what copies need.
        let stride = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(stride) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let view = texture.create_view(&Default::default());
        loop {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            self.renderer.draw(&self.gpu, &mut encoder, &view, (width, height), scene);
            if self.renderer.waiting == 0 {
                encoder.copy_texture_to_buffer(
                    texture.as_image_copy(),
                    wgpu::TexelCopyBufferInfo {
                        buffer: &bytes,
                        layout: wgpu::TexelCopyBufferLayout {
                            offset: 0,
                            bytes_per_row: Some(stride),
                            rows_per_image: None,
                        },
                    },
                    size,
                );
                self.gpu.queue.submit([encoder.finish()]);
                break;
            }
            self.gpu.queue.submit([encoder.finish()]);
        }
        let (done, mapped) = mpsc::channel();
        bytes.slice(..).map_async(wgpu::MapMode::Read, move |r| {
            let _ = done.send(r);
        });
        let failed = |e: String| NoViewer::ReadBack(e);
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
        mapped.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
        let data = bytes.slice(..).get_mapped_range().map_err(|e| failed(e.to_string()))?;
        let rows = data.chunks_exact(stride as usize).flat_map(|row| &row[..width as usize * 4]);
        let pixels: Vec<u8> = rows.copied().collect();
        RgbaImage::from_raw(width, height, pixels).ok_or_else(|| failed("its size is wrong".into()))
    }
}
