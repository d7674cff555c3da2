//! The shade that forms throw into their own hollows, from the depth of the picture: three small
//! passes after the clay, none of which knows the mesh. What it costs follows the picture's size
//! alone.

use bytemuck::{Pod, Zeroable};

use super::gpu::Gpu;
use sculptd_engine::camera::Camera;

#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Uniform {
    lens: [f32; 4],
    reach: [f32; 4],
}

const SHADES: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Range of occlusion, as a share of the bounding radius.
const REACH: f32 = 0.30;

#[derive(Debug)]
pub struct Ssao {
    uniform: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    gather: wgpu::RenderPipeline,
    smooth: wgpu::RenderPipeline,
    lay: wgpu::RenderPipeline,
    sized: Option<Sized>,
    others: Option<Sized>,
}

/// Textures of the picture's size.
#[derive(Debug)]
struct Sized {
    rough: wgpu::TextureView,
    fine: wgpu::TextureView,
    /// Reads nothing, the rough, the fine shades.
    groups: [wgpu::BindGroup; 3],
}

impl Ssao {
    /// `format` and `samples` are those of the picture that is shaded.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, samples: u32) -> Ssao {
        let device = &gpu.device;
        let many = samples > 1;
        // Not as a depth texture: not every backend reads single texels of one.
        let kind = if many { "texture_multisampled_2d<f32>" } else { "texture_2d<f32>" };
        let source = include_str!("ssao.wgsl").replace("depths: DEPTH", &format!("depths: {kind}"));
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("shade"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let texture = |binding, multisampled| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("shade"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Buffer {
                        ty: wgpu::BufferBindingType::Uniform,
                        has_dynamic_offset: false,
                        min_binding_size: None,
                    },
                    count: None,
                },
                texture(1, many),
                texture(2, false),
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("shade"),
            bind_group_layouts: &[Some(&layout)],
            ..Default::default()
        });
        let pipeline = |name: &str, format, samples, blend| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(name),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("whole"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(name),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format,
                        blend,
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let times = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Dst,
            dst_factor: wgpu::BlendFactor::Zero,
            operation: wgpu::BlendOperation::Add,
        };
        let multiply = wgpu::BlendState { color: times, alpha: times };
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shade"),
            size: size_of::<Uniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Ssao {
            gather: pipeline("gather", SHADES, 1, None),
            smooth: pipeline("smooth_out", SHADES, 1, None),
            lay: pipeline("lay", format, samples, Some(multiply)),
            uniform,
            layout,
            sized: None,
            others: None,
        }
    }

    /// Another depth takes its turn.
    pub fn turn(&mut self) {
        std::mem::swap(&mut self.sized, &mut self.others);
    }

    /// The depth has another size now.
    pub fn forget(&mut self) {
        self.sized = None;
    }

    /// Shades `picture`, which was drawn with `depth`; both have `size` pixels. `extent` is the
    /// work's bounding radius, `(near, far)` what the depth runs between, `strength` 0 to 2.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (picture, depth, size): (&wgpu::TextureView, &wgpu::TextureView, (u32, u32)),
        camera: &Camera,
        (near, far): (f32, f32),
        (extent, strength): (f32, f32),
    ) {
        let high =
            if camera.orthographic { camera.distance } else { 1.0 } * (camera.fov_y * 0.5).tan();
        let uniform = Uniform {
            lens: [high * camera.aspect, high, near, far],
            reach: [f32::from(camera.orthographic), (extent * REACH).max(1e-9), strength, 0.0],
        };
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let sized =
            self.sized.get_or_insert_with(|| sized(gpu, &self.layout, &self.uniform, depth, size));
        let steps = [
            (&self.gather, &sized.rough, wgpu::LoadOp::Clear(wgpu::Color::WHITE)),
            (&self.smooth, &sized.fine, wgpu::LoadOp::Clear(wgpu::Color::WHITE)),
            (&self.lay, picture, wgpu::LoadOp::Load),
        ];
        for ((pipeline, view, load), group) in steps.into_iter().zip(&sized.groups) {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("shade"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
                })],
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

fn sized(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    uniform: &wgpu::Buffer,
    depth: &wgpu::TextureView,
    size: (u32, u32),
) -> Sized {
    let view = |size: (u32, u32)| {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shades"),
            size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: SHADES,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        texture.create_view(&Default::default())
    };
    let half = (size.0.div_ceil(2), size.1.div_ceil(2));
    let (rough, fine, none) = (view(half), view(half), view((1, 1)));
    let groups = [&none, &rough, &fine].map(|shades| {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shade"),
            layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(depth),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(shades),
                },
            ],
        })
    });
    Sized { rough, fine, groups }
}
