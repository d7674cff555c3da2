//! What the clay is lit by beside the studio's own lights, on the card: a picture of a lit ball
//! (matcap), an environment, and a
//! reference picture behind it; and what the studio's main light reaches. One bind group for all
//! objects.

use image::RgbaImage;

use super::environment::Environment;
use super::gpu::{Gpu, depths};

/// The textures and their sampler.
#[derive(Debug)]
pub struct Surroundings {
    pub layout: wgpu::BindGroupLayout,
    pub group: wgpu::BindGroup,
    sampler: wgpu::Sampler,
    matcap: wgpu::TextureView,
    diffuse: wgpu::TextureView,
    glossy: wgpu::TextureView,
    reference: wgpu::TextureView,
    /// Depths seen by the main light, with the comparison sampler.
    depths: wgpu::TextureView,
    compare: wgpu::Sampler,
    /// Width over height of the reference picture.
    aspect: f32,
}

impl Surroundings {
    /// A white ball, and the room that comes with the program.
    pub fn new(gpu: &Gpu) -> Surroundings {
        let device = &gpu.device;
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: true },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("surroundings"),
            entries: &[
                texture(0),
                texture(1),
                texture(2),
                wgpu::BindGroupLayoutEntry {
                    binding: 3,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
                texture(4),
                wgpu::BindGroupLayoutEntry {
                    binding: 5,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Depth,
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 6,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison),
                    count: None,
                },
            ],
        });
        let linear = wgpu::FilterMode::Linear;
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("surroundings"),
            // Once around; a matcap's reads stay within its ball.
            address_mode_u: wgpu::AddressMode::Repeat,
            mag_filter: linear,
            min_filter: linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let matcap = flat(gpu, &RgbaImage::from_pixel(1, 1, image::Rgba([255; 4])));
        let room = Environment::room();
        let (diffuse, glossy) = around(gpu, &room);
        let reference = flat(gpu, &RgbaImage::new(1, 1));
        let compare = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow"),
            mag_filter: linear,
            min_filter: linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        let depths = depths(device, 1);
        let group = group(
            gpu,
            &layout,
            [&sampler, &compare],
            [&matcap, &diffuse, &glossy, &reference, &depths],
        );
        Surroundings {
            layout,
            group,
            sampler,
            matcap,
            diffuse,
            glossy,
            reference,
            depths,
            compare,
            aspect: 1.0,
        }
    }

    /// Takes what the main light sees.
    pub fn set_depths(&mut self, gpu: &Gpu, depths: &wgpu::TextureView) {
        self.depths = depths.clone();
        self.regroup(gpu);
    }

    /// Takes another reference picture.
    pub fn set_reference(&mut self, gpu: &Gpu, picture: &RgbaImage) {
        self.reference = flat(gpu, picture);
        self.aspect = picture.width() as f32 / picture.height().max(1) as f32;
        self.regroup(gpu);
    }

    /// The reference picture's share of a view of so many pixels, whole in it, and how dense it is.
    pub fn backdrop(&self, (width, height): (u32, u32), opacity: f32) -> [f32; 4] {
        let wide = self.aspect * height as f32 / width.max(1) as f32;
        let [x, y] = if wide > 1.0 { [1.0, 1.0 / wide] } else { [wide, 1.0] };
        [x, y, opacity.clamp(0.0, 1.0), 0.0]
    }

    /// Takes another picture of a lit ball.
    pub fn set_matcap(&mut self, gpu: &Gpu, picture: &RgbaImage) {
        self.matcap = flat(gpu, picture);
        self.regroup(gpu);
    }

    /// Takes another environment.
    pub fn set_environment(&mut self, gpu: &Gpu, environment: &Environment) {
        (self.diffuse, self.glossy) = around(gpu, environment);
        self.regroup(gpu);
    }

    /// Takes the room that comes with the program.
    pub fn set_room(&mut self, gpu: &Gpu) {
        self.set_environment(gpu, &Environment::room());
    }

    fn regroup(&mut self, gpu: &Gpu) {
        let views = [&self.matcap, &self.diffuse, &self.glossy, &self.reference, &self.depths];
        self.group = group(gpu, &self.layout, [&self.sampler, &self.compare], views);
    }
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    samplers: [&wgpu::Sampler; 2],
    views: [&wgpu::TextureView; 5],
) -> wgpu::BindGroup {
    let view = |binding: u32, i: usize| wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::TextureView(views[i]),
    };
    let sampler = |binding: u32, i: usize| wgpu::BindGroupEntry {
        binding,
        resource: wgpu::BindingResource::Sampler(samplers[i]),
    };
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("surroundings"),
        layout,
        entries: &[
            view(0, 0),
            view(1, 1),
            view(2, 2),
            sampler(3, 0),
            view(4, 3),
            view(5, 4),
            sampler(6, 1),
        ],
    })
}

/// A texture of levels, each half as large as the one before; four bytes a texel.
fn texture(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    (width, height): (u32, u32),
    levels: &[&[u8]],
) -> wgpu::TextureView {
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("surroundings"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, bytes) in levels.iter().enumerate() {
        let (width, height) = ((width >> level).max(1), (height >> level).max(1));
        let to = wgpu::TexelCopyTextureInfo { mip_level: level as u32, ..texture.as_image_copy() };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        gpu.queue.write_texture(to, bytes, layout, size);
    }
    texture.create_view(&Default::default())
}

/// A picture of sRGB values.
fn flat(gpu: &Gpu, picture: &RgbaImage) -> wgpu::TextureView {
    texture(gpu, wgpu::TextureFormat::Rgba8UnormSrgb, picture.dimensions(), &[picture.as_raw()])
}

fn around(gpu: &Gpu, environment: &Environment) -> (wgpu::TextureView, wgpu::TextureView) {
    let format = wgpu::TextureFormat::Rgb9e5Ufloat;
    let (width, texels) = &environment.diffuse;
    let diffuse = texture(gpu, format, (*width, width / 2), &[bytemuck::cast_slice(texels)]);
    let levels: Vec<&[u8]> =
        environment.glossy.iter().map(|(_, texels)| bytemuck::cast_slice(texels)).collect();
    let width = environment.glossy.first().map_or(1, |l| l.0);
    (diffuse, texture(gpu, format, (width, (width / 2).max(1)), &levels))
}
