//! The window: our own event loop on the main thread. The pointer is an adaptor like the others;
//! panels send commands.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

use arc_swap::ArcSwap;
use egui_winit::accesskit_winit::WindowEvent as Heard;
use glam::{DVec3, Vec2};
use winit::application::ApplicationHandler;
use winit::event::{ElementState, MouseScrollDelta, Touch, TouchPhase, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::keyboard::ModifiersState;
use winit::window::{Window, WindowId};

use super::gpu::{Gpu, NoViewer, instance};
use super::pages::MapValues;
use super::pointer::Pointer;
use super::preview::Preview;
use super::remember::Remembered;
use super::renderer::Renderer;
use super::work::Work;
use crate::panels::hand_menu::Ball;
use crate::panels::{UiState, timing::FrameFigures};
use crate::viewer::camera_animation::CameraAnimation;
use crate::viewer::overlay_mesh::Triangles;
use sculptd_clay::Snapshot;
use sculptd_daemon::Published;
use sculptd_daemon::command_queue::CommandSender;
use sculptd_devices::queue::Sender;
use sculptd_devices::{Clock, DeviceId};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::{MenuItem, Similarity};
use sculptd_geometry::thickness::preset::Preset;

/// Everything that joins the window to the daemon.
pub struct Wiring {
    pub commands: CommandSender,
    pub published: Arc<ArcSwap<Published>>,
    /// The pointer's own way into the channel.
    pub pointer: Sender,
    pub pointer_id: DeviceId,
    /// What each brush begins with.
    pub presets: sculptd_clay::brush::Presets,
    pub clock: Clock,
    /// Raised from outside, or by closing the window.
    pub stop: Arc<AtomicBool>,
    /// One line a device, asked for now and then.
    pub devices: Box<dyn Fn() -> Vec<String>>,
    pub session: Option<String>,
    /// The session's history, and the ticks a second that its places are told in.
    pub history: Option<(sculptd_daemon::session::history::Handle, u32)>,
    /// On the clock, when the ghosts have ended; 0 without ghosts.
    pub ghosts_until_us: u64,
    pub full_screen: bool,
    /// Limits of wall thickness by process and material, for the panel of walls.
    pub presets: Vec<Preset>,
    /// The screen of an installation, in the place of the panels.
    pub kiosk: Option<sculptd_daemon::kiosk::keeper::Screen>,
}

impl std::fmt::Debug for Wiring {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Wiring").finish_non_exhaustive()
    }
}

/// How often the published state is looked at: 60 times a second on a card, 20 where a processor
/// draws, which would otherwise starve the loop.
const FRAME: [Duration; 2] = [Duration::from_micros(16_667), Duration::from_millis(50)];

/// Opens the window and runs until it is closed or `stop` is raised.
pub fn run(wiring: Wiring) -> Result<(), NoViewer> {
    let events = EventLoop::<Told>::with_user_event()
        .build()
        .map_err(|e| NoViewer::Window(e.to_string()))?;
    let mut app = App { wiring, told: events.create_proxy(), open: None, failed: None };
    events.run_app(&mut app).map_err(|e| NoViewer::Window(e.to_string()))?;
    if let Some(mut open) = app.open {
        open.remembered.keep(&open.desk);
    }
    app.failed.map_or(Ok(()), Err)
}

/// What a screen reader asks for, from its own thread.
type Told = egui_winit::accesskit_winit::Event;

struct App {
    wiring: Wiring,
    told: EventLoopProxy<Told>,
    open: Option<WindowState>,
    failed: Option<NoViewer>,
}

/// What the ghosts were made from: the thing and its place, whether a join is tried, the menu.
type GhostKey = (Option<(usize, Similarity)>, Option<MenuItem>, Vec<Ball>);

/// An open window and all that it draws with.
pub(super) struct WindowState {
    pub(super) window: Arc<Window>,
    pub(super) surface: wgpu::Surface<'static>,
    pub(super) config: wgpu::SurfaceConfiguration,
    pub(super) gpu: Gpu,
    pub(super) adapter: String,
    pub(super) renderer: Renderer,
    pub(super) samples: u32,
    pub(super) egui: egui_winit::State,
    pub(super) paint: egui_wgpu::Renderer,
    pub(super) pointer: Pointer,
    pub(super) mods: ModifiersState,
    /// The camera as this window last wanted it; the world's own follows a tick later.
    pub(super) camera: Camera,
    pub(super) flight: Option<CameraAnimation>,
    pub(super) desk: UiState,
    pub(super) work: Work,
    pub(super) remembered: Remembered,
    pub(super) values: Option<MapValues>,
    /// The revision and limit that a thickness map was last asked for.
    pub(super) asked_map: Option<(u64, f32)>,
    pub(super) devices: Vec<String>,
    pub(super) asked_us: u64,
    pub(super) shown: Option<(u64, u64)>,
    pub(super) uploaded: u64,
    pub(super) figures: FrameFigures,
    pub(super) wishes: crate::viewer::background::Wishes,
    /// The newest preview, and what was asked for, when.
    pub(super) preview: Option<Arc<Preview>>,
    pub(super) asked_preview: Option<((u64, Similarity, MenuItem), u64)>,
    /// What distances are to; the revision, its revision and the thing's place that they were last
    /// asked for.
    pub(super) before: Option<Snapshot>,
    pub(super) asked_distance: Option<(u64, u64, Option<Similarity>)>,
    pub(super) asked_sizes: Option<(u64, DVec3)>,
    /// The newest revision, and since when.
    pub(super) rested: (u64, u64),
    /// When a work was opened that may not be shown yet.
    pub(super) opened: Option<u64>,
    pub(super) distances: Option<MapValues>,
    pub(super) thumbs: super::thumbs::Thumbs,
    pub(super) places: crate::viewer::history_tree::Places,
    pub(super) ghosts: Triangles,
    pub(super) ghost_key: GhostKey,
    /// A turntable under way.
    pub(super) turning: Option<super::shots::Turntable>,
    pub(super) screenshot: bool,
}

impl ApplicationHandler<Told> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() {
            match WindowState::new(events, &self.wiring, &self.told) {
                Ok(open) => self.open = Some(open),
                Err(e) => {
                    self.failed = Some(e);
                    events.exit();
                }
            }
        }
    }

    fn user_event(&mut self, _: &ActiveEventLoop, told: Told) {
        let Some(open) = &mut self.open else { return };
        let context = open.egui.egui_ctx();
        match told.window_event {
            Heard::InitialTreeRequested => context.enable_accesskit(),
            Heard::ActionRequested(request) => open.egui.on_accesskit_action_request(request),
            Heard::AccessibilityDeactivated => context.disable_accesskit(),
        }
        open.window.request_redraw();
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
        if open.shown != Some(now) || ghosts || open.flight.is_some() || !open.work.done.is_empty()
        {
            open.shown = Some(now);
            open.window.request_redraw();
        }
        let frame = FRAME[usize::from(open.gpu.software)];
        #[allow(clippy::disallowed_methods)]
        // winit takes its deadlines in the machine's own clock.
        let next = std::time::Instant::now() + frame;
        events.set_control_flow(ControlFlow::WaitUntil(next));
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.egui.on_window_event(&open.window, &event);
        if response.repaint {
            open.window.request_redraw();
        }
        let wiring = &mut self.wiring;
        match event {
            // Visitors do not end an installation that staff ends by a number.
            WindowEvent::CloseRequested if wiring.kiosk.as_ref().is_some_and(|k| k.staff) => {}
            WindowEvent::CloseRequested => {
                wiring.stop.store(true, Relaxed);
                events.exit();
            }
            WindowEvent::Resized(size) => open.resize(size.width, size.height, wiring),
            WindowEvent::RedrawRequested => open.redraw(wiring),
            WindowEvent::ModifiersChanged(m) => open.mods = m.state(),
            WindowEvent::CursorMoved { position, .. } => {
                open.moved(Vec2::new(position.x as f32, position.y as f32), wiring);
            }
            WindowEvent::CursorLeft { .. } => open.left(wiring),
            WindowEvent::MouseInput { state, button, .. } => {
                let down = state == ElementState::Pressed;
                if !down || !response.consumed {
                    open.button(button, down, wiring);
                }
            }
            WindowEvent::Touch(touch)
                if !response.consumed || touch.phase != TouchPhase::Started =>
            {
                open.touched(&touch, wiring);
            }
            WindowEvent::MouseWheel { delta, .. } if !response.consumed => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(_, y) => y,
                    MouseScrollDelta::PixelDelta(p) => p.y as f32 / 40.0,
                };
                open.camera.zoom(1.12f32.powf(steps));
                open.send_camera(wiring);
            }
            WindowEvent::PinchGesture { delta, .. } => {
                open.camera.zoom(1.0 + delta as f32);
                open.send_camera(wiring);
            }
            WindowEvent::DroppedFile(path) if wiring.kiosk.is_none() => {
                open.work.load(path, wiring.commands.clone())
            }
            _ => {}
        }
    }
}

impl WindowState {
    fn new(
        events: &ActiveEventLoop,
        wiring: &Wiring,
        told: &EventLoopProxy<Told>,
    ) -> Result<WindowState, NoViewer> {
        let no_window = |e: String| NoViewer::Window(e);
        let mut wanted = Window::default_attributes().with_title("sculptd").with_visible(false);
        // A window manager may be absent (a kiosk): the size is set as well as the mode.
        let monitor = events.primary_monitor().or_else(|| events.available_monitors().next());
        wanted = match (wiring.full_screen, monitor) {
            (true, Some(m)) => wanted
                .with_inner_size(m.size())
                .with_fullscreen(Some(winit::window::Fullscreen::Borderless(Some(m)))),
            // Never larger than the screen.
            (false, Some(m)) => {
                let screen = m.size().to_logical::<f64>(m.scale_factor());
                let size = (screen.width.clamp(320.0, 1440.0), screen.height.clamp(240.0, 900.0));
                wanted.with_inner_size(winit::dpi::LogicalSize::new(size.0, size.1))
            }
            _ => wanted.with_inner_size(winit::dpi::LogicalSize::new(1280.0, 720.0)),
        };
        let window = Arc::new(events.create_window(wanted).map_err(|e| no_window(e.to_string()))?);
        let instance = instance();
        let surface =
            instance.create_surface(window.clone()).map_err(|e| no_window(e.to_string()))?;
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
        let (remembered, mut desk) = match wiring.kiosk {
            None => Remembered::load(),
            // Nothing of yesterday's visitors.
            Some(_) => Remembered::nothing(),
        };
        desk.walls.presets.clone_from(&wiring.presets);
        let samples = gpu.samples(desk.prefs.smooth_edges);
        let renderer = Renderer::new(&gpu, config.format, samples);
        let context = egui::Context::default();
        let scale = window.scale_factor() as f32;
        let mut egui = egui_winit::State::new(
            context,
            egui::ViewportId::ROOT,
            &window,
            Some(scale),
            None,
            None,
        );
        // A screen reader meets a window that is not shown yet, else it would miss its first state.
        egui.init_accesskit(events, &window, told.clone());
        window.set_visible(true);
        if wiring.full_screen {
            // Without a window manager nobody else gives it the keyboard.
            window.focus_window();
        }
        let paint = egui_wgpu::Renderer::new(&gpu.device, config.format, Default::default());
        let mut camera = wiring.published.load().camera;
        camera.aspect = size.width.max(1) as f32 / size.height.max(1) as f32;
        let open = WindowState {
            adapter: gpu.name(),
            window,
            surface,
            config,
            gpu,
            renderer,
            samples,
            egui,
            paint,
            pointer: Pointer::default(),
            mods: ModifiersState::empty(),
            camera,
            flight: None,
            desk,
            work: Work::default(),
            remembered,
            values: None,
            asked_map: None,
            devices: Vec::new(),
            asked_us: 0,
            shown: None,
            uploaded: 0,
            figures: FrameFigures::default(),
            wishes: Default::default(),
            preview: None,
            asked_preview: None,
            before: None,
            asked_distance: None,
            asked_sizes: None,
            rested: (0, 0),
            opened: None,
            distances: None,
            thumbs: Default::default(),
            places: Default::default(),
            ghosts: Triangles::default(),
            ghost_key: Default::default(),
            turning: None,
            screenshot: false,
        };
        open.send_camera(wiring);
        Ok(open)
    }

    pub(super) fn size(&self) -> Vec2 {
        Vec2::new(self.config.width as f32, self.config.height as f32)
    }

    pub(super) fn send_camera(&self, wiring: &Wiring) {
        let _ = wiring.commands.try_send(Command::Camera(self.camera));
        self.window.request_redraw();
    }

    fn resize(&mut self, width: u32, height: u32, wiring: &Wiring) {
        (self.config.width, self.config.height) = (width.max(1), height.max(1));
        self.surface.configure(&self.gpu.device, &self.config);
        self.camera.aspect = self.config.width as f32 / self.config.height as f32;
        self.send_camera(wiring);
    }

    /// A finger is a pointer that is in range only while it touches, and may know how hard.
    fn touched(&mut self, touch: &Touch, wiring: &mut Wiring) {
        let to = Vec2::new(touch.location.x as f32, touch.location.y as f32);
        if self.pointer.finger.is_some_and(|f| f != touch.id) {
            return;
        }
        self.pointer.force = touch.force.map(|f| f.normalized() as f32);
        match touch.phase {
            TouchPhase::Started => {
                self.pointer.finger = Some(touch.id);
                self.pointer.at = to;
                self.button(winit::event::MouseButton::Left, true, wiring);
            }
            TouchPhase::Moved => self.moved(to, wiring),
            TouchPhase::Ended | TouchPhase::Cancelled => {
                self.button(winit::event::MouseButton::Left, false, wiring);
                (self.pointer.finger, self.pointer.force) = (None, None);
                self.left(wiring);
            }
        }
    }
}
