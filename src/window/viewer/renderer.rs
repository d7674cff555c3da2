//! Drawing a frame: sky, clay, lines. The same for a window and for a picture.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use super::frame_uniform::{Frame, angle_numbers, in_view};
use super::gpu::{DEPTH, Gpu};
use super::objects::{ObjectBuffers, OtherObject, Stance, model};
use super::pages::{MapValues, Pages, VALUE_LAYOUT, VERTEX_LAYOUT};
use super::preview::Preview;
use super::provisional::ProvisionalDabs;
use super::shadow::{Shadow, light_matrix};
use super::surroundings::Surroundings;
use crate::look::{CutPlane, Light, Look, Map, linear};
use crate::viewer::overlay_mesh::{OverlayMesh, Triangles};
use crate::viewer::ssao::Ssao;
use sculptd_clay::{Page, Snapshot};
use sculptd_engine::camera::Camera;

/// An end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LineEnd {
    pub place: [f32; 3],
    pub colour: [u8; 4],
    /// Opacity of the colour behind other surfaces, 0 to 1.
    pub through: f32,
}

impl LineEnd {
    /// Creates an end that surfaces before it hide.
    pub fn new(place: Vec3, colour: [u8; 4]) -> LineEnd {
        LineEnd { place: place.to_array(), colour, through: 0.0 }
    }
}

/// Ends of lines a frame at most: a dozen rings, four hands and a held object.
const MAX_LINE_ENDS: usize = 16_384;

/// Content of a frame.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    pub mesh: &'a Snapshot,
    pub camera: &'a Camera,
    /// The brush's place and radius, for the falloff on the surface.
    pub brush: Option<(Vec3, f32)>,
    pub lines: &'a [LineEnd],
    pub look: Look,
    /// The map that `look` may ask for.
    pub values: Option<&'a MapValues>,
    pub beside: Beside<'a>,
}

/// Content drawn beside the clay.
#[derive(Debug, Clone, Copy, Default)]
pub struct Beside<'a> {
    /// Replaces the pages that it hides.
    pub preview: Option<&'a Arc<Preview>>,
    /// Over the clay, seen through.
    pub overlay: Option<&'a Triangles>,
    /// A form that shows through the clay.
    pub ghost: Option<&'a Triangles>,
    /// Transform of the object to which the clay belongs.
    pub stance: Stance,
    /// The other objects.
    pub others: &'a [OtherObject<'a>],
    /// Opacity of the reference picture behind the clay, 0 none to 1.
    pub backdrop: f32,
    /// Dabs that the pens will have raised when the frame is seen.
    pub led: Option<&'a ProvisionalDabs>,
}

/// Depth, samples where there are several a pixel, pixels.
type Targets = (wgpu::TextureView, Option<wgpu::TextureView>, (u32, u32));

#[derive(Debug)]
pub struct Renderer {
    shader: wgpu::ShaderModule,
    frame: wgpu::Buffer,
    group: wgpu::BindGroup,
    sky: wgpu::RenderPipeline,
    clay: wgpu::RenderPipeline,
    line: wgpu::RenderPipeline,
    /// The parts of lines that something hides, dim.
    behind: wgpu::RenderPipeline,
    edge: wgpu::RenderPipeline,
    overlay: wgpu::RenderPipeline,
    /// The parts of a form that the clay hides.
    ghost: wgpu::RenderPipeline,
    line_ends: wgpu::Buffer,
    pages: Option<Pages>,
    objects: ObjectBuffers,
    /// Lighting of the clay other than the studio's lights.
    pub(super) surroundings: Surroundings,
    samples: u32,
    format: wgpu::TextureFormat,
    targets: Option<Targets>,
    /// Those of another size: a window's and its small pictures' take turns.
    others: Option<Targets>,
    /// The preview that was sent last.
    previewed: Option<Arc<Preview>>,
    preview: OverlayMesh,
    overlay_mesh: OverlayMesh,
    ghost_mesh: OverlayMesh,
    /// True if the depth can be read here.
    shades: bool,
    /// Made when it is first asked for.
    shade: Option<Ssao>,
    /// Made when it is first asked for.
    shadow: Option<Shadow>,
    /// Bytes of pages sent with the last frame, and pages that still wait.
    pub uploaded: u64,
    pub waiting: usize,
    /// Pages that were in view, of all.
    pub drawn: (usize, usize),
    /// Number of the active object's pages drawn with fewer triangles, because they are small.
    pub coarse: usize,
    /// Pages of the active object of which the coarse triangles are still being made.
    pub coarse_waiting: usize,
    /// Far pages of a large object may be drawn with fewer triangles: in a window, not in a picture
    /// that is kept.
    pub coarsens: bool,
}

impl Renderer {
    /// As [`Renderer::new`], for what is seen and not kept.
    pub fn of_window(gpu: &Gpu, format: wgpu::TextureFormat, samples: u32) -> Renderer {
        Renderer { coarsens: true, ..Renderer::new(gpu, format, samples) }
    }

    /// `samples` a pixel: 1 or 4.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, samples: u32) -> Renderer {
        let device = &gpu.device;
        let shader = device.create_shader_module(wgpu::include_wgsl!("clay.wgsl"));
        let buffer = |label, size, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        let frame = buffer("frame", size_of::<Frame>() as u64, wgpu::BufferUsages::UNIFORM);
        let line_ends = buffer(
            "lines",
            (MAX_LINE_ENDS * size_of::<LineEnd>()) as u64,
            wgpu::BufferUsages::VERTEX,
        );
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("frame"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("frame"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() }],
        });
        let surroundings = Surroundings::new(gpu);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("clay"),
            bind_group_layouts: &[Some(&layout), Some(&surroundings.layout)],
            ..Default::default()
        });
        let line_layout = wgpu::VertexBufferLayout {
            array_stride: size_of::<LineEnd>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4, 2 => Float32],
        };
        let pipeline = |name: &str,
                        buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
                        lines: bool,
                        depth: bool| {
            let ghost = name == "ghost";
            let overlay = name == "overlay" || ghost;
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(name),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(&format!("{name}_vertex")),
                    compilation_options: Default::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState {
                    topology: if lines {
                        wgpu::PrimitiveTopology::LineList
                    } else {
                        wgpu::PrimitiveTopology::TriangleList
                    },
                    // The transparent overlay shows only its near side.
                    cull_mode: overlay.then_some(wgpu::Face::Back),
                    ..Default::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(depth && !lines && !overlay),
                    depth_compare: Some(match depth {
                        _ if name == "behind" || ghost => wgpu::CompareFunction::Greater,
                        true => wgpu::CompareFunction::LessEqual,
                        false => wgpu::CompareFunction::Always,
                    }),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(&format!("{name}_fragment")),
                    compilation_options: Default::default(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format,
                        blend: (lines || overlay).then_some(wgpu::BlendState::ALPHA_BLENDING),
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Renderer {
            sky: pipeline("sky", &[], false, false),
            clay: pipeline("clay", &[Some(VERTEX_LAYOUT), Some(VALUE_LAYOUT)], false, true),
            line: pipeline("line", &[Some(line_layout.clone())], true, true),
            behind: pipeline("behind", &[Some(line_layout)], true, true),
            edge: pipeline("edge", &[Some(VERTEX_LAYOUT), Some(VALUE_LAYOUT)], true, true),
            overlay: pipeline("overlay", &[Some(VERTEX_LAYOUT), Some(VALUE_LAYOUT)], false, true),
            ghost: pipeline("ghost", &[Some(VERTEX_LAYOUT), Some(VALUE_LAYOUT)], false, true),
            shader,
            frame,
            group,
            line_ends,
            pages: None,
            objects: ObjectBuffers::new(layout),
            surroundings,
            samples,
            format,
            targets: None,
            others: None,
            previewed: None,
            preview: OverlayMesh::default(),
            overlay_mesh: OverlayMesh::default(),
            ghost_mesh: OverlayMesh::default(),
            // OpenGL draws nothing at all with a depth of several samples that is to be read.
            shades: samples == 1 || gpu.adapter.get_info().backend != wgpu::Backend::Gl,
            shade: None,
            shadow: None,
            uploaded: 0,
            waiting: 0,
            drawn: (0, 0),
            coarse: 0,
            coarse_waiting: 0,
            coarsens: false,
        }
    }

    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Depth and multisampling targets of the right size.
    fn targets(&mut self, device: &wgpu::Device, size: (u32, u32)) {
        if self.targets.as_ref().is_some_and(|t| t.2 == size) {
            return;
        }
        std::mem::swap(&mut self.targets, &mut self.others);
        if let Some(shade) = &mut self.shade {
            shade.turn();
        }
        if self.targets.as_ref().is_some_and(|t| t.2 == size) {
            return;
        }
        let view = |format, more| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("target"),
                size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: self.samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | more,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        let none = wgpu::TextureUsages::empty();
        let read = if self.shades { wgpu::TextureUsages::TEXTURE_BINDING } else { none };
        if let Some(shade) = &mut self.shade {
            shade.forget();
        }
        self.targets =
            Some((view(DEPTH, read), (self.samples > 1).then(|| view(self.format, none)), size));
    }

    /// Draws into `target`, which has `size` pixels.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size: (u32, u32),
        scene: &Scene<'_>,
    ) {
        self.targets(&gpu.device, size);
        let (stance, others) = (scene.beside.stance, scene.beside.others);
        self.objects.activate(stance.id, &mut self.pages);
        if self.pages.as_ref().is_none_or(|p| !p.fits(scene.mesh)) {
            self.pages = Some(Pages::new(&gpu.device, &gpu.queue, scene.mesh));
        }
        let framed = scene.beside.preview.and_then(|p| p.bounds);
        let all = || {
            let own = stance.transform.bounds(scene.mesh.bounds());
            others.iter().fold(own, |(lo, hi), o| {
                let (a, b) = o.transform.bounds(o.clay.bounds());
                (lo.min(a), hi.max(b))
            })
        };
        let (lo, hi) = framed.unwrap_or_else(all);
        let radius = if lo.cmple(hi).all() {
            (hi - scene.camera.target).abs().max((lo - scene.camera.target).abs()).length()
        } else {
            1.0
        };
        let matrix = scene.camera.view_projection(radius);
        let (right, up) = scene.camera.axes();
        let m = scene.look.material();
        let main_light = scene.look.main_light();
        let sun = light_matrix(scene.camera, main_light, (lo, hi));
        let cast = sun.map_or(0.0, |_| scene.look.cast());
        let [x, y, z] = main_light;
        let kind = match (scene.look.map, scene.values) {
            (Map::Mask, _) => 1.0,
            (Map::Overhang, _) => 3.0,
            (Map::Draft, _) => 4.0,
            (Map::None, _) | (_, None) => 0.0,
            _ => 2.0,
        };
        let [angle_up, angle_ends] = angle_numbers(&scene.look);
        // A highlight would whiten the dark end of a scale of angles.
        let [shine, rim] = if kind > 2.5 { [0.0; 2] } else { [m.shine, m.rim] };
        let (low, high) = if kind == 1.0 { (0.0, 1.0) } else { scene.look.scale };
        // The ground: a quiet dusk, or paper.
        let ground = if scene.look.pale {
            [[196, 199, 205], [228, 230, 234]]
        } else {
            [[28, 29, 33], [63, 65, 71]]
        };
        // A picture of a ball has its colour in it.
        let base = if scene.look.light == Light::Matcap { [1.0; 3] } else { m.base };
        let frame = Frame {
            view_projection: matrix.to_cols_array_2d(),
            right: right.extend(0.0).to_array(),
            up: up.extend(0.0).to_array(),
            back: scene.camera.backward().extend(0.0).to_array(),
            brush: scene.brush.map_or([0.0; 4], |(p, r)| p.extend(r).to_array()),
            base: [base[0], base[1], base[2], f32::from(scene.look.flat)],
            finish: [shine, m.power, rim, scene.look.cavity.clamp(0.0, 2.0)],
            map: [low, 1.0 / (high - low).max(1e-12), kind, nearer(scene.camera, radius)],
            scale: scene.look.card_scale(),
            low: linear(ground[0]),
            high: linear(ground[1]),
            light: light(&scene.look),
            backdrop: self.surroundings.backdrop(size, scene.beside.backdrop),
            main_light: [x, y, z, cast],
            shadow: sun.unwrap_or_default().to_cols_array_2d(),
            angle_up,
            angle_ends,
            cut: scene.look.cut.map_or([0.0; 4], CutPlane::numbers),
            led: scene.beside.led.copied().unwrap_or_default(),
        };
        gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        self.objects.send(gpu, &frame, &matrix, &stance, others);
        let lines = &scene.lines[..scene.lines.len().min(MAX_LINE_ENDS)];
        gpu.queue.write_buffer(&self.line_ends, 0, bytemuck::cast_slice(lines));
        if let Some(pages) = &mut self.pages {
            if self.coarsens {
                pages.coarsen(&gpu.device, scene.mesh);
            }
            pages.update(&gpu.queue, scene.mesh, scene.look.sets);
            (self.uploaded, self.waiting) = (pages.uploaded, pages.waiting());
            self.coarse_waiting = pages.coarse_waiting();
            if let Some(values) = scene.values.filter(|_| kind == 2.0) {
                pages.set_map(&gpu.queue, values);
            }
            if scene.look.wireframe {
                pages.need_edges(&gpu.device, &gpu.queue);
            }
        }
        self.uploaded += self.objects.uploaded;
        self.waiting += self.objects.waiting;
        let preview = self.beside(gpu, scene);
        let hidden = |i: u32| {
            preview.is_some_and(|p| p.hidden.as_ref().is_none_or(|h| h.binary_search(&i).is_ok()))
        };
        let own = matrix * model(&stance.transform);
        let shown = |i: u32, page: &Page| stance.visible && !hidden(i) && in_view(&own, page);
        if let Some(sun) = sun.filter(|_| cast > 0.0) {
            self.cast(gpu, encoder, &sun, scene, &hidden);
        }
        let Some((depth, smooth, _)) = &self.targets else { return };
        let view = smooth.as_ref().unwrap_or(target);
        let resolve = smooth.as_ref().map(|_| target);
        // Over a map a little: its colours are to be read beside its scale.
        let shade = scene.look.shade.clamp(0.0, 2.0) * if kind > 0.0 { 0.5 } else { 1.0 };
        let shaded = self.shades && shade > 0.0 && lo.cmple(hi).all();
        {
            // A shaded picture is not finished yet: lines and the mean of its samples come after.
            let resolve = if shaded { None } else { resolve };
            let mut pass = begin(encoder, view, resolve, depth, (true, shaded));
            pass.set_bind_group(0, &self.group, &[]);
            pass.set_bind_group(1, &self.surroundings.group, &[]);
            pass.set_pipeline(&self.sky);
            pass.draw(0..3, 0..1);
            if let Some(pages) = &self.pages {
                pass.set_pipeline(&self.clay);
                pass.set_bind_group(0, self.objects.active_group(), &[]);
                let (drawn, coarse) = pages.draw_by_size(&mut pass, (&own, size.1), shown);
                self.coarse = coarse;
                let all = others.iter().map(|o| o.clay.page_count()).sum::<usize>();
                self.drawn = (drawn, scene.mesh.page_count() + all);
                if preview.is_some() {
                    self.preview.draw(&mut pass);
                }
                if scene.look.wireframe {
                    pass.set_pipeline(&self.edge);
                    pages.draw_edges(&mut pass, shown);
                    pass.set_pipeline(&self.clay);
                }
                self.drawn.0 += self.objects.draw(&mut pass, &matrix, others);
                pass.set_bind_group(0, &self.group, &[]);
            }
            if !shaded {
                self.over(scene, &mut pass, lines.len() as u32);
                return;
            }
        }
        let extent = (hi - lo).length() * 0.5;
        let between = scene.camera.depth_range(radius);
        let size_of = (view, depth, size);
        let passes = self.shade.get_or_insert_with(|| Ssao::new(gpu, self.format, self.samples));
        passes.draw(gpu, encoder, size_of, scene.camera, between, (extent, shade));
        if resolve.is_some() || !lines.is_empty() || scene.beside.overlay.is_some() {
            let mut pass = begin(encoder, view, resolve, depth, (false, false));
            pass.set_bind_group(0, &self.group, &[]);
            pass.set_bind_group(1, &self.surroundings.group, &[]);
            self.over(scene, &mut pass, lines.len() as u32);
        }
    }

    /// Draws what the main light sees: where it does not come, shadows are.
    fn cast(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        sun: &Mat4,
        scene: &Scene<'_>,
        hidden: &dyn Fn(u32) -> bool,
    ) {
        let Some(pages) = &self.pages else { return };
        let shadow = self.shadow.get_or_insert_with(|| {
            let made = Shadow::new(gpu, &self.shader, self.objects.layout());
            self.surroundings.set_depths(gpu, &made.depths);
            made
        });
        let stance = scene.beside.stance;
        let own = *sun * model(&stance.transform);
        let mut pass = shadow.begin(encoder);
        pass.set_bind_group(0, self.objects.active_group(), &[]);
        let seen = |i: u32, page: &Page| stance.visible && !hidden(i) && in_view(&own, page);
        pages.draw(&mut pass, seen);
        if scene.beside.preview.is_some() {
            self.preview.draw(&mut pass);
        }
        self.objects.draw(&mut pass, sun, scene.beside.others);
    }

    /// Sends what is beside the clay and is not there yet; a preview of another object is none.
    fn beside<'s>(&mut self, gpu: &Gpu, scene: &Scene<'s>) -> Option<&'s Arc<Preview>> {
        if let Some(overlay) = scene.beside.overlay {
            self.overlay_mesh.keep(gpu, overlay);
        }
        if let Some(ghost) = scene.beside.ghost {
            self.ghost_mesh.keep(gpu, ghost);
        }
        let preview = scene.beside.preview.filter(|p| p.pages == scene.mesh.page_count());
        if let Some(new) = preview
            && !self.previewed.as_ref().is_some_and(|old| Arc::ptr_eq(old, new))
        {
            self.preview.set(gpu, &new.vertices, &new.triangles);
            self.previewed = Some(new.clone());
        }
        // A whole mesh is large, and shown once.
        if preview.is_none() && self.previewed.as_ref().is_some_and(|p| p.bounds.is_some()) {
            self.preview = OverlayMesh::default();
            self.previewed = None;
        }
        preview
    }

    /// Draws the content over the clay.
    fn over(&self, scene: &Scene<'_>, pass: &mut wgpu::RenderPass<'_>, ends: u32) {
        if scene.beside.overlay.is_some() {
            pass.set_pipeline(&self.overlay);
            self.overlay_mesh.draw(pass);
        }
        if scene.beside.ghost.is_some() {
            pass.set_pipeline(&self.ghost);
            self.ghost_mesh.draw(pass);
            pass.set_pipeline(&self.overlay);
            self.ghost_mesh.draw(pass);
        }
        if ends > 0 {
            pass.set_pipeline(&self.line);
            pass.set_vertex_buffer(0, self.line_ends.slice(..));
            pass.draw(0..ends, 0..1);
            if scene.lines.iter().any(|end| end.through > 0.0) {
                pass.set_pipeline(&self.behind);
                pass.draw(0..ends, 0..1);
            }
        }
    }
}

/// A pass over the picture and its depth; `first` clears both, `keep` leaves the depth for others
/// to read.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    view: &wgpu::TextureView,
    resolve_target: Option<&wgpu::TextureView>,
    depth: &wgpu::TextureView,
    (first, keep): (bool, bool),
) -> wgpu::RenderPass<'e> {
    let colour = if first { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
    let load = if first { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
    let store = if keep { wgpu::StoreOp::Store } else { wgpu::StoreOp::Discard };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("clay"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target,
            ops: wgpu::Operations { load: colour, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load, store }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}

/// Returns the light of the clay, as the shader has it: kind, rotation, brightness, metal. A map
/// always uses the studio's lights.
fn light(look: &Look) -> [f32; 4] {
    let kind = match look.light {
        _ if look.map != Map::None => 0.0,
        Light::Studio => 0.0,
        Light::Matcap => 1.0,
        Light::Room | Light::Environment => 2.0,
    };
    let metal = look.material().metal && look.map == Map::None;
    let bright = if look.bright.is_finite() { look.bright.clamp(0.0, 4.0) } else { 1.0 };
    let turned = if look.turned.is_finite() { look.turned.to_radians() } else { 0.0 };
    [kind, turned, bright, f32::from(metal)]
}

/// Returns the loss of clip depth for two thousandths of the distance to the eye: with depth `a - b
/// / d`, that is `b` times the share.
fn nearer(camera: &Camera, radius: f32) -> f32 {
    if camera.orthographic {
        return 4e-4;
    }
    let far = (camera.distance + radius * 2.0).max(1e-3);
    let near = (camera.distance - radius * 2.0).max(far * 1e-4);
    2e-3 * far * near / (far - near)
}
