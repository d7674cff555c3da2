//! The adapter and its device, or one clear line why there is none.

/// Why nothing can be drawn here.
#[derive(Debug, thiserror::Error)]
pub enum NoViewer {
    #[error("no graphics adapter: {0}")]
    Adapter(String),
    #[error("the graphics device refused: {0}")]
    Device(String),
    #[error("no window: {0}")]
    Window(String),
    #[error("the picture could not be read back: {0}")]
    ReadBack(String),
}

/// The format of every picture of depths.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

#[derive(Debug)]
pub struct Gpu {
    pub instance: wgpu::Instance,
    pub adapter: wgpu::Adapter,
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    /// A software adapter: one sample a pixel unless asked, redraw only when something changed.
    pub software: bool,
}

/// A picture of clay that can be copied from.
pub(super) fn clay_target(
    device: &wgpu::Device,
    label: &str,
    (width, height): (u32, u32),
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// A picture of depths that can be compared with.
pub(super) fn depths(device: &wgpu::Device, side: u32) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadow"),
        size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

/// Of a window on this display. OpenGL needs to know the display before it is begun: without one it
/// draws into memory only, and no window takes its pictures.
pub fn instance_on(display: winit::event_loop::OwnedDisplayHandle) -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(
        display,
    )))
}

/// Without a window.
pub fn instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

impl Gpu {
    /// An adapter that can draw on `surface`, or with `None` into a texture.
    pub fn new(
        instance: wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
    ) -> Result<Gpu, NoViewer> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|e| NoViewer::Adapter(e.to_string()))?;
        let has = adapter.limits();
        let required_limits = wgpu::Limits {
            max_buffer_size: has.max_buffer_size,
            max_texture_dimension_2d: has.max_texture_dimension_2d,
            ..wgpu::Limits::downlevel_defaults()
        };
        let wanted = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&wanted))
            .map_err(|e| NoViewer::Device(e.to_string()))?;
        let software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        Ok(Gpu { instance, adapter, device, queue, software })
    }

    /// Samples a pixel: four, or one where a processor draws and nobody asked for more.
    pub fn samples(&self, smooth: bool) -> u32 {
        if self.software && !smooth { 1 } else { 4 }
    }

    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({:?})", info.name, info.backend)
    }
}

/// Sets the format of a surface that offers these, and returns that of the pictures of the clay
/// which go onto it. Light adds up linearly in an sRGB format; egui's letters keep their weight
/// where they are blended as stored. A copy between the two keeps every byte, so both are had where
/// the surface takes copies; elsewhere all is sRGB.
pub fn choose_formats(
    config: &mut wgpu::SurfaceConfiguration,
    offered: &[wgpu::TextureFormat],
) -> wgpu::TextureFormat {
    let copies = config.usage.contains(wgpu::TextureUsages::COPY_DST);
    let eight_bit = |f: &&wgpu::TextureFormat| {
        matches!(
            f.remove_srgb_suffix(),
            wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm
        )
    };
    if let Some(plain) = offered.iter().filter(eight_bit).find(|f| !f.is_srgb())
        && copies
    {
        config.format = *plain;
        return plain.add_srgb_suffix();
    }
    if let Some(srgb) = offered.iter().find(|f| f.is_srgb()) {
        config.format = *srgb;
    }
    config.format
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat::{
        Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba8UnormSrgb, Rgba16Float,
    };

    #[test]
    fn letters_are_blended_as_stored_where_the_surface_takes_copies() {
        let of = |usage, offered: &[wgpu::TextureFormat]| {
            let mut config = wgpu::SurfaceConfiguration {
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                format: offered[0],
                width: 1,
                height: 1,
                present_mode: wgpu::PresentMode::Fifo,
                desired_maximum_frame_latency: 2,
                alpha_mode: wgpu::CompositeAlphaMode::Auto,
                view_formats: Vec::new(),
                color_space: Default::default(),
            };
            let clay = choose_formats(&mut config, offered);
            (config.format, clay)
        };
        let (copies, none) = (wgpu::TextureUsages::COPY_DST, wgpu::TextureUsages::empty());
        let all = [Bgra8UnormSrgb, Rgba16Float, Bgra8Unorm];
        assert_eq!(of(copies, &all), (Bgra8Unorm, Bgra8UnormSrgb));
        assert_eq!(of(none, &all), (Bgra8UnormSrgb, Bgra8UnormSrgb));
        assert_eq!(of(copies, &[Rgba8Unorm]), (Rgba8Unorm, Rgba8UnormSrgb));
        assert_eq!(of(copies, &[Rgba8UnormSrgb]), (Rgba8UnormSrgb, Rgba8UnormSrgb));
    }
}
