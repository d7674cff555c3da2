//! The window: our own event loop on the main thread. The pointer is an adaptor like the others; panels send commands.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use arc_swap::ArcSwap;
use crossbeam_channel as cc;
use glam::Vec2;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{KeyCode, ModifiersState, PhysicalKey};
use winit::window::{Window, WindowId};

use super::gpu::{Gpu, NoViewer, instance};
use super::look::Look;
use super::overlay;
use super::renderer::{LineEnd, Renderer, Scene};
use crate::brush::{BrushKind, BrushSettings};
use crate::command::Command;
use crate::daemon::Published;
use crate::devices::queue::Sender;
use crate::devices::{Body, Clock, DeviceId, Pen, Sample, Tool};
use crate::panels::{self, View, hints};
use crate::stroke::Camera;

/// Everything that joins the window to the daemon.
pub struct Wiring {
    pub commands: cc::Sender<Command>,
    pub published: Arc<ArcSwap<Published>>,
    /// The pointer's own way into the channel.
    pub pointer: Sender,
    pub pointer_id: DeviceId,
    pub clock: Clock,
    /// Raised from outside, or by closing the window.
    pub stop: Arc<AtomicBool>,
    /// One line a device, asked for now and then.
    pub devices: Box<dyn Fn() -> Vec<String>>,
    pub session: Option<String>,
    /// On the clock, when the ghosts have ended; 0 without ghosts.
    pub ghosts_until_us: u64,
    pub full_screen: bool,
}

impl std::fmt::Debug for Wiring {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wiring").finish_non_exhaustive()
    }
}

/// How often the published state is looked at: 60 times a second on a card, 20 where a processor draws, which would
/// otherwise starve the loop.
const FRAME: [Duration; 2] = [Duration::from_micros(16_667), Duration::from_millis(50)];
/// Width of the panel, points.
const PANEL: f32 = 236.0;

/// Opens the window and runs until it is closed or `stop` is raised.
pub fn run(wiring: Wiring) -> Result<(), NoViewer> {
    let events = EventLoop::new().map_err(|e| NoViewer::Window(e.to_string()))?;
    let mut app = App { wiring, open: None, failed: None };
    events.run_app(&mut app).map_err(|e| NoViewer::Window(e.to_string()))?;
    app.failed.map_or(Ok(()), Err)
}

struct App {
    wiring: Wiring,
    open: Option<Open>,
    failed: Option<NoViewer>,
}

/// What a pressed button drags.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drag {
    None,
    Sculpt,
    Orbit,
    Pan,
}

struct Open {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    adapter: String,
    renderer: Renderer,
    egui: egui_winit::State,
    paint: egui_wgpu::Renderer,
    pointer: Vec2,
    drag: Drag,
    mods: ModifiersState,
    /// The camera as this window last wanted it; the world's own follows a tick later.
    camera: Camera,
    /// The brush as it was before Shift or Ctrl changed it for one stroke.
    lent: Option<BrushSettings>,
    done: hints::Done,
    devices: Vec<String>,
    asked_us: u64,
    shown: Option<(u64, u64)>,
    uploaded: u64,
    look: Look,
}

impl ApplicationHandler for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() {
            match Open::new(events, &self.wiring) {
                Ok(open) => self.open = Some(open),
                Err(e) => {
                    self.failed = Some(e);
                    events.exit();
                }
            }
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        let Some(open) = &mut self.open else { return };
        if self.wiring.stop.load(Relaxed) {
            events.exit();
            return;
        }
        let state = self.wiring.published.load();
        // Redraw when the clay or a ghost moved, and a few times a second for the figures.
        let now = (state.mesh.revision(), state.tick / 12);
        let ghosts = self.wiring.clock.now_us() < self.wiring.ghosts_until_us;
        if open.shown != Some(now) || ghosts {
            open.shown = Some(now);
            open.window.request_redraw();
        }
        let frame = FRAME[usize::from(open.gpu.software)];
        #[allow(clippy::disallowed_methods)] // winit takes its deadlines in the machine's own clock.
        let next = std::time::Instant::now() + frame;
        events.set_control_flow(ControlFlow::WaitUntil(next));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.egui.on_window_event(&open.window, &event);
        if response.repaint {
            open.window.request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => {
                self.wiring.stop.store(true, Relaxed);
                events.exit();
            }
            WindowEvent::Resized(size) => open.resize(size.width, size.height, &self.wiring),
            WindowEvent::RedrawRequested => open.redraw(&self.wiring),
            WindowEvent::ModifiersChanged(m) => open.mods = m.state(),
            WindowEvent::CursorMoved { position, .. } => {
                open.moved(Vec2::new(position.x as f32, position.y as f32), &mut self.wiring);
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let down = state == ElementState::Pressed;
                if !down || !response.consumed {
                    open.button(button, down, &mut self.wiring);
                }
            }
            WindowEvent::MouseWheel { delta, .. } if !response.consumed => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(_, y) => y,
                    MouseScrollDelta::PixelDelta(p) => p.y as f32 / 40.0,
                };
                open.camera.zoom(1.12f32.powf(steps));
                open.send_camera(&self.wiring);
            }
            WindowEvent::KeyboardInput { event, .. }
                if event.state == ElementState::Pressed && !response.consumed =>
            {
                if let PhysicalKey::Code(key) = event.physical_key {
                    open.key(key, &self.wiring);
                }
            }
            _ => {}
        }
    }
}

impl Open {
    fn new(events: &ActiveEventLoop, wiring: &Wiring) -> Result<Open, NoViewer> {
        let no_window = |e: String| NoViewer::Window(e);
        let mut wanted = Window::default_attributes().with_title("sculptd");
        // A window manager may be absent (a kiosk): the size is set as well as the mode.
        let monitor = events.primary_monitor().or_else(|| events.available_monitors().next());
        wanted = match (wiring.full_screen, monitor) {
            (true, Some(m)) => wanted
                .with_inner_size(m.size())
                .with_fullscreen(Some(winit::window::Fullscreen::Borderless(Some(m)))),
            _ => wanted.with_inner_size(winit::dpi::LogicalSize::new(1280.0, 800.0)),
        };
        let window = Arc::new(events.create_window(wanted).map_err(|e| no_window(e.to_string()))?);
        let instance = instance();
        let surface = instance.create_surface(window.clone()).map_err(|e| no_window(e.to_string()))?;
        let gpu = Gpu::new(instance, Some(&surface))?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| no_window("the adapter cannot draw on this window".into()))?;
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        if let Some(srgb) = formats.iter().find(|f| f.is_srgb()) {
            config.format = *srgb;
        }
        surface.configure(&gpu.device, &config);
        let renderer = Renderer::new(&gpu, config.format);
        let context = egui::Context::default();
        panels::theme::apply(&context);
        let scale = window.scale_factor() as f32;
        let egui = egui_winit::State::new(context, egui::ViewportId::ROOT, &window, Some(scale), None, None);
        let paint = egui_wgpu::Renderer::new(&gpu.device, config.format, Default::default());
        let mut camera = wiring.published.load().camera;
        camera.aspect = size.width.max(1) as f32 / size.height.max(1) as f32;
        let open = Open {
            adapter: gpu.name(),
            window,
            surface,
            config,
            gpu,
            renderer,
            egui,
            paint,
            pointer: Vec2::ZERO,
            drag: Drag::None,
            mods: ModifiersState::empty(),
            camera,
            lent: None,
            done: hints::Done::default(),
            devices: Vec::new(),
            asked_us: 0,
            shown: None,
            uploaded: 0,
            look: Look::default(),
        };
        open.send_camera(wiring);
        Ok(open)
    }

    fn size(&self) -> Vec2 {
        Vec2::new(self.config.width as f32, self.config.height as f32)
    }

    fn send_camera(&self, wiring: &Wiring) {
        let _ = wiring.commands.try_send(Command::Camera(self.camera));
        self.window.request_redraw();
    }

    fn resize(&mut self, width: u32, height: u32, wiring: &Wiring) {
        (self.config.width, self.config.height) = (width.max(1), height.max(1));
        self.surface.configure(&self.gpu.device, &self.config);
        self.camera.aspect = self.config.width as f32 / self.config.height as f32;
        self.send_camera(wiring);
    }

    /// The pointer as a pen: it says all that a pen says.
    fn sample(&self, tip: bool, wiring: &mut Wiring) {
        let pen = Pen {
            tool: Tool::Touch,
            in_range: true,
            tip,
            pos_mm: self.pointer,
            area_mm: self.size(),
            raw: self.pointer.as_ivec2().to_array(),
            // A mouse has no pressure: two thirds, so that a pen can press harder and softer than it.
            pressure: Some(0.66),
            ..Default::default()
        };
        let sample = Sample {
            device: wiring.pointer_id,
            t_us: wiring.clock.now_us(),
            device_t_us: None,
            body: Body::Pen(pen),
        };
        wiring.pointer.push(sample);
        wiring.pointer.flush();
    }

    fn moved(&mut self, to: Vec2, wiring: &mut Wiring) {
        let by = (to - self.pointer) / self.size();
        self.pointer = to;
        match self.drag {
            Drag::Sculpt => self.sample(true, wiring),
            Drag::Orbit => {
                self.camera.orbit(by);
                self.done.turned = true;
                self.send_camera(wiring);
            }
            Drag::Pan => {
                self.camera.pan(by);
                self.send_camera(wiring);
            }
            Drag::None => self.sample(false, wiring),
        }
        self.window.request_redraw();
    }

    fn button(&mut self, button: MouseButton, down: bool, wiring: &mut Wiring) {
        if !down {
            if self.drag == Drag::Sculpt {
                self.sample(false, wiring);
                if let Some(brush) = self.lent.take() {
                    let _ = wiring.commands.try_send(Command::Brush(brush));
                }
            }
            self.drag = Drag::None;
            return;
        }
        let state = wiring.published.load();
        let on_clay =
            || state.mesh.pick(self.camera.ray(overlay::view_point(self.pointer, self.size()))).is_some();
        self.drag = match button {
            MouseButton::Left if !self.mods.alt_key() && on_clay() => Drag::Sculpt,
            MouseButton::Left | MouseButton::Right => Drag::Orbit,
            MouseButton::Middle if self.mods.shift_key() => Drag::Orbit,
            MouseButton::Middle => Drag::Pan,
            _ => Drag::None,
        };
        if self.drag == Drag::Sculpt {
            self.done.touched = true;
            let brush = state.brush;
            let mut now = brush;
            if self.mods.shift_key() {
                (now.kind, now.strength) = (BrushKind::Smooth, 0.6);
            }
            now.negative ^= self.mods.control_key();
            if now != brush {
                self.lent = Some(brush);
                let _ = wiring.commands.try_send(Command::Brush(now));
            }
            self.sample(true, wiring);
        }
    }

    fn key(&mut self, key: KeyCode, wiring: &Wiring) {
        let mut brush = wiring.published.load().brush;
        let before = brush;
        let (ctrl, shift) = (self.mods.control_key(), self.mods.shift_key());
        let command = match key {
            KeyCode::KeyZ if ctrl && shift => Some(Command::Redo),
            KeyCode::KeyY if ctrl => Some(Command::Redo),
            KeyCode::KeyZ if ctrl => {
                self.done.undone = true;
                Some(Command::Undo)
            }
            KeyCode::Digit1 => {
                brush.kind = BrushKind::Gaussian;
                None
            }
            KeyCode::Digit2 => {
                brush.kind = BrushKind::Smooth;
                None
            }
            KeyCode::BracketLeft if shift => {
                brush.strength *= 0.9;
                None
            }
            KeyCode::BracketRight if shift => {
                brush.strength *= 1.1;
                None
            }
            KeyCode::BracketLeft => {
                brush.radius *= 0.9;
                None
            }
            KeyCode::BracketRight => {
                brush.radius *= 1.1;
                None
            }
            KeyCode::KeyX => {
                brush.negative = !brush.negative;
                None
            }
            KeyCode::Home => {
                let mesh = &wiring.published.load().mesh;
                let (lo, hi) = mesh.bounds();
                self.camera.frame(lo, hi);
                self.send_camera(wiring);
                None
            }
            _ => return,
        };
        if let Some(command) = command.or((brush != before).then_some(Command::Brush(brush.clamped()))) {
            let _ = wiring.commands.try_send(command);
        }
        self.window.request_redraw();
    }

    /// The brush ring under the newest pointer place, its mirror images, and ghost hands.
    fn lines(&self, state: &Published) -> (Vec<LineEnd>, Option<(glam::Vec3, f32)>) {
        let mut lines = Vec::new();
        let mut brush = None;
        let mut ring_at = |view: Vec2, pressure: f32| {
            let ray = self.camera.ray(view);
            let radius = state.brush_radius * state.brush.pressure_radius.factor(pressure);
            if let Some(hit) = state.mesh.pick(ray) {
                overlay::ring(&mut lines, &state.mesh, hit.position, hit.normal, radius, false);
                brush.get_or_insert((hit.position, radius));
            }
            for m in overlay::mirrors(state.brush.symmetry) {
                let origin = state.middle + (ray.origin - state.middle) * m;
                if let Some(hit) = state.mesh.pick(crate::mesh::Ray { origin, dir: ray.dir * m }) {
                    overlay::ring(&mut lines, &state.mesh, hit.position, hit.normal, radius, true);
                }
            }
        };
        if matches!(self.drag, Drag::None | Drag::Sculpt) && self.pointer.x > PANEL {
            ring_at(overlay::view_point(self.pointer, self.size()), 0.66);
        }
        for (_, pen) in
            state.pens.iter().flatten().filter(|(id, _)| *id != crate::daemon::adaptors::POINTER_ID)
        {
            ring_at(pen.view, pen.pressure);
        }
        if let Some(hands) = &state.hands {
            overlay::hands(&mut lines, hands, &state.volume);
        }
        (lines, brush)
    }

    fn redraw(&mut self, wiring: &Wiring) {
        let texture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(t) | wgpu::CurrentSurfaceTexture::Suboptimal(t) => t,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.config);
                self.window.request_redraw();
                return;
            }
            _ => return,
        };
        let state = wiring.published.load_full();
        // Somebody else (a hand, the control socket) may have turned the work.
        if self.drag == Drag::None {
            self.camera = Camera { aspect: self.camera.aspect, ..state.camera };
        }
        let now = wiring.clock.now_us();
        if now.saturating_sub(self.asked_us) > 1_000_000 || self.asked_us == 0 {
            (self.devices, self.asked_us) = ((wiring.devices)(), now);
        }
        let (lines, brush) = self.lines(&state);
        let view = texture.texture.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let size = (self.config.width, self.config.height);
        let scene = Scene { mesh: &state.mesh, camera: &self.camera, brush, lines: &lines, look: self.look };
        self.renderer.draw(&self.gpu, &mut encoder, &view, size, &scene);
        self.uploaded = self.renderer.uploaded;
        let commands = self.panels(&state, wiring, &mut encoder, &view);
        self.gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
        for command in commands {
            self.done.undone |= matches!(command, Command::Undo);
            let _ = wiring.commands.try_send(command);
        }
        if self.renderer.waiting > 0 {
            self.window.request_redraw();
        }
    }

    fn panels(
        &mut self,
        state: &Published,
        wiring: &Wiring,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> Vec<Command> {
        let mut commands = Vec::new();
        let input = self.egui.take_egui_input(&self.window);
        let view = View {
            state,
            devices: &self.devices,
            session: wiring.session.as_deref(),
            uploaded: self.uploaded,
            adapter: &self.adapter,
        };
        let ghosts = wiring.clock.now_us() < wiring.ghosts_until_us;
        let done = self.done;
        let look = &mut self.look;
        let context = self.egui.egui_ctx().clone();
        let out = context.run_ui(input, |ui| {
            egui::Panel::left("side").exact_size(PANEL).show(ui, |ui| {
                panels::side(ui, &view, look, &mut commands);
            });
            hints::ui(ui.ctx(), &done, ghosts);
        });
        self.egui.handle_platform_output(&self.window, out.platform_output);
        let scale = out.pixels_per_point;
        let jobs = context.tessellate(out.shapes, scale);
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [self.config.width, self.config.height],
            pixels_per_point: scale,
        };
        for (id, deltas) in &out.textures_delta.set {
            for delta in deltas {
                self.paint.update_texture(&self.gpu.device, &self.gpu.queue, *id, delta);
            }
        }
        let mut buffers =
            self.paint.update_buffers(&self.gpu.device, &self.gpu.queue, encoder, &jobs, &screen);
        if !buffers.is_empty() {
            self.gpu.queue.submit(buffers.drain(..));
        }
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panels"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.paint.render(&mut pass.forget_lifetime(), &jobs, &screen);
        for id in &out.textures_delta.free {
            self.paint.free_texture(id);
        }
        commands
    }
}
