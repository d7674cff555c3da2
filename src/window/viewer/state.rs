//! An open window: its surface, what it draws with, and what it has asked of others.

use std::sync::Arc;

use glam::{DVec3, Vec2};
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::keyboard::ModifiersState;
use winit::window::Window;

use super::camera_animation::CameraAnimation;
use super::check_task::CheckKey;
use super::clay_picture::ClayPicture;
use super::earlier_pictures::EarlierPictures;
use super::fingers::Fingers;
use super::goal_ghost::Ghost;
use super::gpu::{Gpu, NoViewer, choose_formats, instance_on};
use super::look_choice::LookChoice;
use super::look_files::LookFolders;
use super::overlay;
use super::overlay_mesh::Triangles;
use super::pacing::{FrameSum, Pacing};
use super::pages::MapValues;
use super::plate::PlateHeight;
use super::pointer::Pointer;
use super::preferences_file::PreferencesFile;
use super::preview::Preview;
use super::renderer::Renderer;
use super::snapshot_workers::SnapshotWorkers;
use super::step_pictures::StepPictures;
use super::tablet_map::Tablets;
use super::tasks::Tasks;
use super::thickness_task::AskedWalls;
use super::turntable::Turntable;
use super::version_pictures::VersionPictures;
use super::wall_probe::WallBall;
use super::wiring::Wiring;
use crate::language::{set_current, tr};
use crate::look::{CutPlane, material_index};
use crate::panels::hand_menu::MenuBall;
use crate::panels::state::{FrameFigures, KeyMap, ObjectVersion, UiState, Views};
use sculptd_camera::camera_thread::CameraPreview;
use sculptd_clay::Snapshot;
use sculptd_daemon::Published;
use sculptd_daemon::kiosk::View as KioskView;
use sculptd_daemon::kiosk::exhibit::score::{Goal, Score};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::hand::{MenuItem, Similarity};
use sculptd_engine::scene::{ObjectId, ObjectTransform};

/// A screen reader's request, sent from the screen reader's thread.
#[cfg(feature = "accessibility")]
pub(super) use egui_winit::accesskit_winit::Event as AccessibilityEvent;
/// No screen reader is connected in a build without the feature `accessibility`.
#[cfg(not(feature = "accessibility"))]
pub(super) type AccessibilityEvent = ();

/// Inputs of the mesh over the clay: the held object and its transform, the previewed Boolean, the
/// menu.
pub(super) type OverlayKey = (Option<(usize, Similarity)>, Option<MenuItem>, Vec<MenuBall>);

/// Time after which a world's camera that differs from the sent one counts as set by something
/// else.
const CAMERA_PATIENCE_US: u64 = 500_000;

/// Id of the clay, and its revision.
type ClayState = (u32, u64);

/// An open window and all that it draws with.
pub(super) struct WindowState {
    pub(super) window: Arc<Window>,
    pub(super) surface: wgpu::Surface<'static>,
    pub(super) config: wgpu::SurfaceConfiguration,
    /// Texture format of the clay: light adds up linearly in it, while the panels blend in the
    /// surface's format, where thin letters keep their weight.
    pub(super) clay_format: wgpu::TextureFormat,
    pub(super) gpu: Gpu,
    pub(super) adapter: String,
    pub(super) renderer: Renderer,
    pub(super) samples: u32,
    pub(super) egui: egui_winit::State,
    pub(super) paint: egui_wgpu::Renderer,
    pub(super) pointer: Pointer,
    pub(super) mods: ModifiersState,
    /// The camera as this window last wanted it; the world's own follows a tick later. That of the
    /// view in which is worked.
    pub(super) camera: Camera,
    pub(super) views: Views,
    /// The camera that was sent last and when, microseconds, until the world has it.
    pub(super) asked_camera: Option<(Camera, u64)>,
    /// The object is to be framed as soon as the panels are laid out.
    pub(super) unframed: bool,
    pub(super) camera_animation: Option<CameraAnimation>,
    pub(super) ui_state: UiState,
    pub(super) tasks: Tasks,
    pub(super) preferences_file: PreferencesFile,
    /// Folders of the person's pictures for the look; `None`: none are read.
    pub(super) look_folders: Option<LookFolders>,
    pub(super) look_choice: LookChoice,
    pub(super) values: Option<MapValues>,
    pub(super) wall_changes: Option<MapValues>,
    /// The ball in the wall that was under the pointer last.
    pub(super) ball: Option<WallBall>,
    /// The last question to the thread that measures walls.
    pub(super) asked_map: Option<AskedWalls>,
    pub(super) devices: Vec<String>,
    /// What the camera that watches hands saw last, while its page is open.
    pub(super) camera_preview: Option<Arc<CameraPreview>>,
    /// The lists of own brushes and pictures as they were shown, by their addresses.
    pub(super) shown_brushes: [usize; 2],
    /// Time of the last list of devices.
    pub(super) listed_us: u64,
    pub(super) uploaded: u64,
    pub(super) figures: FrameFigures,
    /// The keys, as the preferences have them.
    pub(super) key_map: KeyMap,
    /// The frames since the last line of the log.
    pub(super) since_listed: FrameSum,
    pub(super) workers: SnapshotWorkers,
    /// A mesh that was read while the clay is still made of it.
    pub(super) first_picture: Option<Arc<Preview>>,
    /// The newest preview; what was requested, and when.
    pub(super) preview: Option<Arc<Preview>>,
    pub(super) asked_preview: Option<((u64, Similarity, MenuItem), u64)>,
    /// Reference of distances, and the request that was sent last: the revision, that of `before`,
    /// the held object's transform.
    pub(super) before: Option<Snapshot>,
    /// The object that `before` is of.
    pub(super) before_of: Option<ObjectId>,
    pub(super) asked_distance: Option<(ClayState, ClayState, Option<Similarity>, ObjectTransform)>,
    pub(super) asked_sizes: Option<(ClayState, DVec3, ObjectTransform)>,
    pub(super) asked_section: Option<(ClayState, ObjectTransform, CutPlane)>,
    /// The check that was asked for last; the objects that one looks at, and since when they are
    /// so.
    pub(super) asked_check: Option<CheckKey>,
    pub(super) check_rested: (Vec<ObjectVersion>, u64),
    pub(super) plate: PlateHeight,
    /// The newest revision, and since when.
    pub(super) rested: (u64, u64),
    /// Time of loading a mesh that may not be published yet.
    pub(super) opened: Option<u64>,
    pub(super) distances: Option<MapValues>,
    pub(super) step_pictures: StepPictures,
    pub(super) version_pictures: VersionPictures,
    pub(super) earlier_pictures: Option<EarlierPictures>,
    /// State of the session's file that was last seen, see [`Wiring::session_state`].
    pub(super) shown_session: (Option<String>, u64),
    pub(super) overlay_mesh: Triangles,
    pub(super) overlay_key: OverlayKey,
    pub(super) ghost: Ghost,
    /// The goal that the distance map was last asked for.
    pub(super) goal_address: Option<*const Goal>,
    pub(super) drawn_score: Option<Score>,
    /// A turntable under way.
    pub(super) turning: Option<Turntable>,
    pub(super) screenshot: bool,
    pub(super) pacing: Pacing,
    /// State shown by the last frame.
    pub(super) drawn: Option<Arc<Published>>,
    pub(super) drawn_demo: bool,
    pub(super) drawn_kiosk: Option<KioskView>,
    /// Refused undo that was already reported.
    pub(super) told_refusal: Option<sculptd_engine::world::UndoRefusal>,
    /// The part of the window between the panels, points; all of it before the first frame.
    pub(super) free: Option<egui::Rect>,
    /// The picture of each view, where the surface takes copies.
    pub(super) clay_pictures: [ClayPicture; 4],
    /// Pages that the last frame shows are still to be sent.
    pub(super) clay_waits: bool,
    /// Counts the changes of the values of the maps.
    pub(super) map_changes: u64,
    /// Buttons and fingers that went down on a panel and are still down.
    pub(super) held_on_panels: u32,
    pub(super) tablets: Tablets,
    pub(super) fingers: Fingers,
}

impl WindowState {
    pub(super) fn new(
        events: &ActiveEventLoop,
        wiring: &Wiring,
        #[cfg_attr(not(feature = "accessibility"), allow(unused_variables))]
        accessibility: &EventLoopProxy<AccessibilityEvent>,
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
        let instance = instance_on(events.owned_display_handle());
        let surface =
            instance.create_surface(window.clone()).map_err(|e| no_window(e.to_string()))?;
        let gpu = Gpu::new(instance, Some(&surface))?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| no_window("the adapter cannot draw on this window".into()))?;
        let capabilities = surface.get_capabilities(&gpu.adapter);
        config.usage |= capabilities.usages & wgpu::TextureUsages::COPY_DST;
        let clay_format = choose_formats(&mut config, &capabilities.formats);
        // Frames come by this window's own pace: presenting must not block the event loop, which
        // first-in-first-out does for seconds on a screen without a vertical blank.
        let modes = surface.get_capabilities(&gpu.adapter).present_modes;
        let wanted = [wgpu::PresentMode::Mailbox, wgpu::PresentMode::Immediate];
        let usable = |m: &&wgpu::PresentMode| {
            modes.contains(m) && (gpu.software || **m == wgpu::PresentMode::Mailbox)
        };
        config.present_mode =
            wanted.iter().find(usable).copied().unwrap_or(wgpu::PresentMode::Fifo);
        surface.configure(&gpu.device, &config);
        let (preferences_file, mut ui_state) = match wiring.kiosk {
            None => PreferencesFile::load(),
            // Nothing of yesterday's visitors.
            Some(_) => PreferencesFile::nothing(),
        };
        if let Some(kiosk) = &wiring.kiosk {
            ui_state.look.material = material_index(&kiosk.show.material).unwrap_or(0);
        }
        set_current(wiring.translations.choose(&ui_state.prefs.language));
        for (path, error) in &wiring.translations.wrong {
            let path = path.display().to_string();
            ui_state.say(tr!("language-unreadable", path = path, error = error.as_str()), true);
        }
        ui_state.brush_panel.saves = wiring.brushes.is_some();
        ui_state.walls.presets.clone_from(&wiring.check_presets.walls);
        ui_state.check.library.clone_from(&wiring.check_presets);
        let samples = gpu.samples(ui_state.prefs.smooth_edges);
        let renderer = Renderer::of_window(&gpu, clay_format, samples);
        let context = egui::Context::default();
        let scale = window.scale_factor() as f32;
        #[cfg_attr(not(feature = "accessibility"), allow(unused_mut))]
        let mut egui = egui_winit::State::new(
            context,
            egui::ViewportId::ROOT,
            &window,
            Some(scale),
            None,
            None,
        );
        // A screen reader meets a window that is not shown yet, else it would miss its first state.
        #[cfg(feature = "accessibility")]
        egui.init_accesskit(events, &window, accessibility.clone());
        window.set_visible(true);
        if wiring.full_screen {
            // Without a window manager nobody else gives it the keyboard.
            window.focus_window();
        }
        let rate = window.current_monitor().and_then(|m| m.refresh_rate_millihertz());
        let pacing = Pacing::new(gpu.software, rate);
        pacing.listen(egui.egui_ctx(), &wiring.clock);
        let paint = egui_wgpu::Renderer::new(&gpu.device, config.format, Default::default());
        let state = wiring.published.load();
        let mut camera = state.camera;
        // A new object is seen from the front: from the side a mirrored stroke looks lopsided.
        let from_front = wiring.fresh && wiring.demo_until_us == 0 && wiring.kiosk.is_none();
        if from_front {
            (camera.yaw, camera.pitch) = (0.0, 0.0);
        }
        camera.aspect = size.width.max(1) as f32 / size.height.max(1) as f32;
        let mut open = WindowState {
            adapter: gpu.name(),
            window,
            surface,
            config,
            clay_format,
            gpu,
            renderer,
            samples,
            egui,
            paint,
            pointer: Pointer::default(),
            mods: ModifiersState::empty(),
            camera,
            views: Views::default(),
            asked_camera: None,
            unframed: from_front,
            camera_animation: None,
            ui_state,
            tasks: Tasks::default(),
            preferences_file,
            look_folders: wiring.kiosk.is_none().then(LookFolders::usual).flatten(),
            look_choice: LookChoice::default(),
            values: None,
            asked_map: None,
            devices: Vec::new(),
            camera_preview: None,
            shown_brushes: [0; 2],
            listed_us: 0,
            uploaded: 0,
            figures: FrameFigures::default(),
            key_map: KeyMap::default(),
            since_listed: FrameSum::default(),
            workers: Default::default(),
            first_picture: None,
            preview: None,
            asked_preview: None,
            before: None,
            before_of: None,
            asked_distance: None,
            asked_sizes: None,
            asked_section: None,
            asked_check: None,
            check_rested: Default::default(),
            plate: PlateHeight::default(),
            rested: (0, 0),
            opened: None,
            distances: None,
            wall_changes: None,
            ball: None,
            step_pictures: Default::default(),
            version_pictures: Default::default(),
            earlier_pictures: None,
            shown_session: (None, 0),
            overlay_mesh: Triangles::default(),
            overlay_key: Default::default(),
            ghost: Ghost::default(),
            goal_address: None,
            drawn_score: None,
            turning: None,
            screenshot: false,
            pacing,
            drawn: None,
            drawn_demo: false,
            drawn_kiosk: None,
            told_refusal: None,
            free: None,
            clay_pictures: Default::default(),
            clay_waits: false,
            map_changes: 0,
            held_on_panels: 0,
            tablets: Tablets::default(),
            fingers: Fingers::default(),
        };
        open.send_camera(wiring);
        if let Some(path) = &wiring.open_first {
            open.tasks.load(path.clone(), wiring);
        }
        Ok(open)
    }

    /// The part of the window that shows the clay, pixels: its top left corner and its size.
    pub(super) fn clay_rect(&self) -> (Vec2, Vec2) {
        let whole = Vec2::new(self.config.width as f32, self.config.height as f32);
        let Some(free) = self.free.filter(|_| self.takes_copies()) else {
            return (Vec2::ZERO, whole);
        };
        let scale = self.egui.egui_ctx().pixels_per_point();
        let corner = |p: egui::Pos2| (Vec2::new(p.x, p.y) * scale).round().clamp(Vec2::ZERO, whole);
        let (min, max) = (corner(free.min), corner(free.max));
        if (max - min).min_element() < 1.0 { (Vec2::ZERO, whole) } else { (min, max - min) }
    }

    /// Returns true if the picture of the clay can be copied into a part of the window.
    pub(super) fn takes_copies(&self) -> bool {
        self.config.usage.contains(wgpu::TextureUsages::COPY_DST)
    }

    /// The view point of a place in the window, pixels; 0 to 1 within the view.
    pub(super) fn view_point(&self, at: Vec2) -> Vec2 {
        let (min, size) = self.view_rect();
        overlay::view_point(at - min, size)
    }

    pub(super) fn send_camera(&mut self, wiring: &Wiring) {
        let _ = wiring.commands.try_send(Command::Camera(self.camera));
        self.asked_camera = Some((self.camera, wiring.clock.now_us()));
        self.pacing.want();
    }

    /// Takes over the world's camera, which a hand or the control socket may have turned, but not
    /// one that is older than what this window has asked for.
    pub(super) fn follow_camera(&mut self, now_us: u64, worlds: &Camera) {
        let waits = |(asked, since): (Camera, u64)| {
            asked != *worlds && now_us.saturating_sub(since) < CAMERA_PATIENCE_US
        };
        if self.asked_camera.is_some_and(waits) {
            return;
        }
        self.asked_camera = None;
        self.take_camera(Camera { aspect: self.camera.aspect, ..*worlds });
    }

    /// Gives the camera the proportions of the view.
    pub(super) fn fit_camera(&mut self, wiring: &Wiring) {
        let (_, size) = self.view_rect();
        let aspect = (size.x / size.y).clamp(0.05, 20.0);
        // The first frame has laid out the panels: from here on the view has its proportions.
        let frame = self.unframed && self.free.is_some();
        if frame || (self.camera.aspect - aspect).abs() > 1e-4 {
            self.camera.aspect = aspect;
            let (lo, hi) = wiring.published.load().world_bounds();
            if frame && lo.cmple(hi).all() {
                self.camera.frame(lo, hi);
            }
            self.unframed &= !frame;
            self.send_camera(wiring);
        }
    }

    pub(super) fn resize(&mut self, width: u32, height: u32, wiring: &Wiring) {
        (self.config.width, self.config.height) = (width.max(1), height.max(1));
        self.surface.configure(&self.gpu.device, &self.config);
        // Until the next frame has laid out the panels.
        self.free = None;
        self.fit_camera(wiring);
        self.pacing.want();
    }
}
