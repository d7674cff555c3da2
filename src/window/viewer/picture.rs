//! A picture without a window: the same renderer into a texture that is read back.

use std::sync::mpsc;

use image::RgbaImage;

use super::environment::Environment;
use super::gpu::{Gpu, NoViewer, clay_target, instance};
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
        // A picture may take its time: smooth edges everywhere.
        let renderer = Renderer::new(&gpu, FORMAT, 4);
        Ok(Painter { gpu, renderer })
    }

    /// Returns the name of the graphics adapter.
    pub fn adapter(&self) -> String {
        self.gpu.name()
    }

    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Lights the clay with a picture of a lit ball, if the look requests one.
    pub fn set_matcap(&mut self, picture: &RgbaImage) {
        self.renderer.surroundings.set_matcap(&self.gpu, picture);
    }

    /// Shows a picture behind the clay, if the scene requests one.
    pub fn set_reference(&mut self, picture: &RgbaImage) {
        self.renderer.surroundings.set_reference(&self.gpu, picture);
    }

    /// Lights the clay from all around, if the look requests it.
    pub fn set_environment(&mut self, environment: &Environment) {
        self.renderer.surroundings.set_environment(&self.gpu, environment);
    }

    /// Far pages of large objects may be drawn with fewer triangles, as in a window.
    pub fn set_coarsens(&mut self, on: bool) {
        self.renderer.coarsens = on;
    }

    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    pub fn paint(
        &mut self,
        scene: &Scene<'_>,
        width: u32,
        height: u32,
    ) -> Result<RgbaImage, NoViewer> {
        paint(&self.gpu, &mut self.renderer, scene, width, height)
    }
}

/// Draws with a renderer of any eight-bit format, and waits for the pixels.
pub fn paint(
    gpu: &Gpu,
    renderer: &mut Renderer,
    scene: &Scene<'_>,
    width: u32,
    height: u32,
) -> Result<RgbaImage, NoViewer> {
    let format = renderer.format();
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = clay_target(&gpu.device, "picture", (width, height), format);
    // Rows are padded to what copies need.
    let stride = (width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: u64::from(stride) * u64::from(height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let view = texture.create_view(&Default::default());
    loop {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.draw(gpu, &mut encoder, &view, (width, height), scene);
        if renderer.waiting == 0 {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(stride),
                rows_per_image: None,
            };
            let to = wgpu::TexelCopyBufferInfo { buffer: &bytes, layout };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), to, size);
            gpu.queue.submit([encoder.finish()]);
            break;
        }
        gpu.queue.submit([encoder.finish()]);
    }
    let (done, mapped) = mpsc::channel();
    bytes.slice(..).map_async(wgpu::MapMode::Read, move |r| {
        let _ = done.send(r);
    });
    let failed = |e: String| NoViewer::ReadBack(e);
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(e.to_string()))?;
    mapped.recv().map_err(|e| failed(e.to_string()))?.map_err(|e| failed(e.to_string()))?;
    let data = bytes.slice(..).get_mapped_range().map_err(|e| failed(e.to_string()))?;
    let rows = data.chunks_exact(stride as usize).flat_map(|row| &row[..width as usize * 4]);
    let mut pixels: Vec<u8> = rows.copied().collect();
    if matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb) {
        pixels.chunks_exact_mut(4).for_each(|p| p.swap(0, 2));
    }
    RgbaImage::from_raw(width, height, pixels).ok_or_else(|| failed("its size is wrong".into()))
}

/// Writes a PNG, beside and then renamed.
pub fn write_png(path: &std::path::Path, picture: &RgbaImage) -> std::io::Result<()> {
    use image::ImageEncoder;
    sculptd_geometry::io::write_beside(path, |out| {
        image::codecs::png::PngEncoder::new(out)
            .write_image(
                picture.as_raw(),
                picture.width(),
                picture.height(),
                image::ExtendedColorType::Rgba8,
            )
            .map_err(std::io::Error::other)
    })
}
