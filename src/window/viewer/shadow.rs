//! Shadows of the studio's main light: what the light sees is drawn into a picture of depths, and
//! what lies deeper is in shadow (Williams, "Casting curved shadows on curved surfaces", 1978); the
//! edges are softened by the mean of several looks (Reeves, Salesin and Cook, "Rendering
//! antialiased shadows with depth maps", 1987).
//!
//! The light is as far as the sun: its rays are parallel. Its picture covers what the eye sees, and
//! its depth all objects, so that what is out of view casts its shadow into the view.

use glam::{Mat4, Vec3, camera::rh};

use super::gpu::{DEPTH, Gpu, depths};
use super::pages::{VALUE_LAYOUT, VERTEX_LAYOUT};
use sculptd_engine::camera::Camera;

/// Texels along a side of the light's picture.
const SIDE: u32 = 2048;

/// Width of the light's picture relative to the view's height at its target, so that it contains
/// nearer and farther surfaces, and the sides.
const WIDER: f32 = 1.5;

#[derive(Debug)]
pub(super) struct Shadow {
    pub depths: wgpu::TextureView,
    pipeline: wgpu::RenderPipeline,
}

/// From the world to the clip space of the light: `towards` it in the eye's own frame, and the box
/// of all that is drawn. `None` where nothing is.
pub(super) fn light_matrix(
    camera: &Camera,
    towards: [f32; 3],
    (lo, hi): (Vec3, Vec3),
) -> Option<Mat4> {
    let (right, up) = camera.axes();
    let [x, y, z] = towards;
    let towards = right * x + up * y + camera.backward() * z;
    let middle = camera.target;
    // The farthest corner of the box from the target.
    let reach = (hi - middle).abs().max((lo - middle).abs()).length();
    let seen = camera.world_per_view(camera.distance) * camera.aspect.max(1.0) * WIDER;
    let wide = reach.min(seen);
    // Any direction across the light's will do; the one that is farther from it is safe.
    let across = if towards.dot(up).abs() < 0.9 { up } else { right };
    let sane = lo.cmple(hi).all() && wide > 0.0 && reach.is_finite() && wide.is_finite();
    sane.then(|| {
        let view = rh::view::look_at_mat4(middle + towards * reach, middle, across);
        rh::proj::directx::orthographic(-wide, wide, -wide, wide, 0.0, 2.0 * reach) * view
    })
}

impl Shadow {
    pub fn new(gpu: &Gpu, shader: &wgpu::ShaderModule, frame: &wgpu::BindGroupLayout) -> Shadow {
        let device = &gpu.device;
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("shadow"),
            bind_group_layouts: &[Some(frame)],
            ..Default::default()
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("shadow"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: shader,
                entry_point: Some("shadow_vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(VERTEX_LAYOUT), Some(VALUE_LAYOUT)],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Less),
                stencil: Default::default(),
                // A surface must not shade itself: each look reaches two texels to the side, and
                // the surface is as much deeper there as it is steep.
                bias: wgpu::DepthBiasState { constant: 16, slope_scale: 3.0, clamp: 0.0 },
            }),
            multisample: Default::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        Shadow { depths: depths(device, SIDE), pipeline }
    }

    /// A pass that draws depths as the light sees them.
    pub fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow"),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depths,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nearer_the_light_is_less_deep_and_all_is_in_its_picture() {
        let camera = Camera { yaw: 0.7, pitch: 0.4, aspect: 1.5, ..Camera::default() };
        let (lo, hi) = (Vec3::splat(-1.0), Vec3::splat(1.0));
        let mut whole = camera;
        whole.frame(lo, hi);
        let light = [-0.45, 0.65, 0.62];
        let matrix = light_matrix(&whole, light, (lo, hi)).expect("a matrix");
        let (right, up) = whole.axes();
        let towards = right * light[0] + up * light[1] + whole.backward() * light[2];
        let depth = |p: Vec3| matrix.project_point3(p).z;
        assert!(depth(towards * 0.5) < depth(Vec3::ZERO) && depth(Vec3::ZERO) < depth(-towards));
        for corner in 0..8 {
            let pick = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let p = matrix.project_point3(Vec3::new(pick(0), pick(1), pick(2)));
            assert!(p.x.abs() <= 1.001 && p.y.abs() <= 1.001, "{p}");
            assert!((-0.001..=1.001).contains(&p.z), "{p}");
        }
        assert!(light_matrix(&whole, light, (hi, lo)).is_none(), "an empty box");
        // A light straight above uses another up vector.
        let above = light_matrix(&whole, [0.0, 1.0, 0.0], (lo, hi)).expect("a matrix");
        assert!(above.is_finite());
    }
}
