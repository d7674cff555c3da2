//! One frame of the window: the clay, what lies over it, the panels, and what they ask for.

use glam::{Vec2, Vec3};

use super::look::Map;
use super::overlay;
use super::pages::MapValues;
use super::pointer::Drag;
use super::renderer::{Beside, LineEnd, Renderer, Scene};
use super::window::{WindowState, Wiring};
use super::work::{Done, Purpose};
use crate::panels::action::Action;
use crate::panels::{self, UiRequest, View};
use crate::viewer::camera_animation::CameraAnimation;
use sculptd_daemon::Published;
use sculptd_daemon::session::history::Want;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;

impl WindowState {
    /// The ring under the newest pointer place and under every other pen, their mirror images,
    /// ghost hands.
    fn lines(&self, state: &Published) -> (Vec<LineEnd>, Option<(Vec3, f32)>) {
        let mut lines = Vec::new();
        let mut brush = None;
        if self.desk.look.grid {
            let floor = state.mesh.bounds().0.y;
            overlay::grid(&mut lines, state.middle, floor, state.extent, self.desk.look.pale);
        }
        let mut ring_at = |view: Vec2, pressure: f32, tilt: Option<Vec2>, down: bool| {
            let ray = self.camera.ray(view);
            let radius = state.brush_radius * state.brush.pressure_radius.factor(pressure);
            let ring = overlay::Ring { radius, carve: state.brush.negative, mirrored: false, down };
            if let Some(hit) = state.mesh.pick(ray) {
                overlay::ring(&mut lines, &state.mesh, hit.position, hit.normal, &ring);
                if let Some(tilt) = tilt {
                    overlay::barrel(&mut lines, &self.camera, hit.position, tilt, radius);
                }
                brush.get_or_insert((hit.position, radius));
            }
            for m in overlay::mirrors(state.brush.symmetry) {
                let origin = state.middle + (ray.origin - state.middle) * m;
                if let Some(hit) = state.mesh.pick(sculptd_clay::Ray { origin, dir: ray.dir * m }) {
                    let ring = overlay::Ring { mirrored: true, ..ring };
                    overlay::ring(&mut lines, &state.mesh, hit.position, hit.normal, &ring);
                }
            }
        };
        let p = &self.pointer;
        let scale = self.egui.egui_ctx().pixels_per_point();
        let over_panel = self.egui.egui_ctx().is_pointer_over_egui();
        if let Some(modal) = &self.desk.modal {
            let at = Vec2::new(modal.from.x, modal.from.y) * scale;
            ring_at(overlay::view_point(at, self.size()), 1.0, None, false);
        } else if p.inside && (p.drag == Drag::Sculpt || (p.drag == Drag::None && !over_panel)) {
            let felt = state
                .pens
                .iter()
                .flatten()
                .find(|(id, _)| *id == sculptd_daemon::adaptors::POINTER_ID);
            let down = p.drag == Drag::Sculpt;
            let pressure = if down { felt.map_or(1.0, |f| f.1.pressure) } else { 1.0 };
            ring_at(overlay::view_point(p.at, self.size()), pressure, None, down);
        }
        for (id, pen) in state.pens.iter().flatten() {
            if *id != sculptd_daemon::adaptors::POINTER_ID {
                let down = pen.pressure > 0.0;
                ring_at(pen.view, if down { pen.pressure } else { 1.0 }, pen.tilt, down);
            }
        }
        if let Some(thing) = &state.thing {
            overlay::thing(&mut lines, thing);
        }
        if let Some(hands) = &state.hands {
            overlay::hands(&mut lines, hands, &state.volume);
        }
        (lines, brush)
    }

    pub(super) fn redraw(&mut self, wiring: &Wiring) {
        let texture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(t)
            | wgpu::CurrentSurfaceTexture::Suboptimal(t) => t,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.config);
                self.window.request_redraw();
                return;
            }
            _ => return,
        };
        let begun_ns = wiring.clock.now_ns();
        let state = wiring.published.load_full();
        let now = wiring.clock.now_us();
        self.hear(&state, wiring);
        if let Some(flight) = self.flight {
            let (camera, arrived) = flight.at(now);
            self.camera = Camera { aspect: self.camera.aspect, ..camera };
            self.send_camera(wiring);
            if arrived {
                self.flight = None;
            }
        } else if self.pointer.drag == Drag::None {
            // Somebody else (a hand, the control socket) may have turned the work.
            self.camera = Camera { aspect: self.camera.aspect, ..state.camera };
        }
        if now.saturating_sub(self.asked_us) > 1_000_000 || self.asked_us == 0 {
            (self.devices, self.asked_us) = ((wiring.devices)(), now);
            self.remembered.keep(&self.desk);
        }
        if let Some((history, rate_hz)) = wiring.history.as_ref().filter(|_| wiring.kiosk.is_none())
        {
            self.places(history, *rate_hz);
        }
        let samples = self.gpu.samples(self.desk.prefs.smooth_edges);
        if samples != self.samples {
            self.renderer = Renderer::new(&self.gpu, self.config.format, samples);
            self.samples = samples;
        }
        self.wish(&state, wiring);
        self.ghosts(&state);
        self.shots(&state);
        let (lines, brush) = self.lines(&state);
        let view = texture.texture.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let size = (self.config.width, self.config.height);
        let scene = Scene {
            mesh: &state.mesh,
            camera: &self.camera,
            brush,
            lines: &lines,
            look: self.desk.look,
            values: shown(&self.desk, &self.values, &self.distances),
            beside: Beside { preview: self.preview.as_ref(), ghosts: Some(&self.ghosts) },
        };
        self.renderer.draw(&self.gpu, &mut encoder, &view, size, &scene);
        self.uploaded = self.renderer.uploaded;
        let asks = self.panels(&state, wiring, &mut encoder, &view);
        let own_ms = (wiring.clock.now_ns() - begun_ns) as f64 / 1e6;
        self.gpu.queue.submit([encoder.finish()]);
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
        self.measure(&state, own_ms, wiring);
        // With a session the history has pictures of its own.
        if wiring.kiosk.is_none() && wiring.history.is_none() {
            self.thumb(&state, now);
        }
        for ask in asks {
            self.answer(ask, &state, wiring);
        }
        if self.renderer.waiting > 0 {
            self.window.request_redraw();
        }
    }

    fn measure(&mut self, state: &Published, own_ms: f64, wiring: &Wiring) {
        let f = &mut self.figures;
        f.cpu_ms += (own_ms - f.cpu_ms) * 0.1;
        f.worst_cpu_ms = f.worst_cpu_ms.max(own_ms);
        f.drawn = self.renderer.drawn;
        f.input_to_snapshot_ms = state.figures.input_to_snapshot_ms;
        let newest_us = state.figures.newest_us;
        if newest_us != 0 && newest_us != f.newest_us {
            f.newest_us = newest_us;
            f.input_to_submit_ms = wiring.clock.now_us().saturating_sub(newest_us) as f64 / 1e3;
        }
    }

    /// What slow work has said since the last frame, and what it is asked next.
    fn hear(&mut self, state: &Published, wiring: &Wiring) {
        while let Ok(done) = self.work.done.try_recv() {
            match done {
                Done::Said(text, wrong) => self.desk.say(text, wrong),
                Done::Joined => self.desk.joining = false,
                Done::Used(path) => self.desk.prefs.used(path),
                Done::Map(values, about) => {
                    self.values = Some(values);
                    self.desk.walls.found = Some(about);
                }
                Done::Opened => self.opened = Some(wiring.clock.now_us()),
                Done::Preview(done) => self.previewed(done),
                Done::Distances(values, about) => {
                    self.desk.sizes.distances = Some(about);
                    self.distances = Some(values);
                }
                Done::Measured(found) => self.desk.sizes.found = Some(found),
                Done::Chosen(Purpose::WindowState, path) => {
                    self.work.load(path, wiring.commands.clone())
                }
                Done::Chosen(Purpose::Export, path) => {
                    self.desk.files.export = path.display().to_string();
                    self.answer(UiRequest::Export(path), state, wiring);
                }
            }
        }
        // The loop takes a work that was sent a tick or two later.
        let now = wiring.clock.now_us();
        if self.opened.is_some_and(|since| now.saturating_sub(since) > 100_000) {
            self.opened = None;
            self.before = Some(state.mesh.clone());
        }
        if self.distances.as_ref().is_some_and(|v| v.pages.len() != state.mesh.page_count()) {
            self.distances = None;
        }
        if self.values.as_ref().is_some_and(|v| v.pages.len() != state.mesh.page_count()) {
            self.values = None;
        }
        self.desk.look.scale =
            match (self.desk.look.map, &self.desk.walls.found, self.desk.sizes.distances) {
                (Map::Thickness, Some(found), _) => (found.min, found.high),
                // Both ends as far from nothing; a work that did not change is pale all over.
                (Map::Distance, _, Some(d)) => {
                    let most = d.max.max(-d.min).max(state.extent * 1e-5);
                    (-most, most)
                }
                _ => (0.0, 1.0),
            };
        if self.desk.look.map == Map::Thickness {
            let wanted = (state.mesh.revision(), self.desk.walls.limit);
            if self.asked_map != Some(wanted) || self.values.is_none() && self.asked_map.is_none() {
                self.asked_map = Some(wanted);
                self.work.thickness(&state.mesh, self.camera.target, wanted.1);
            }
        }
    }

    fn answer(&mut self, ask: UiRequest, state: &Published, wiring: &Wiring) {
        match ask {
            UiRequest::World(command) => {
                self.desk.prefs.done.undone |= matches!(command, Command::Undo);
                let _ = wiring.commands.try_send(command);
            }
            UiRequest::Jump(node) => {
                self.desk.prefs.done.undone = true;
                if let Some((history, _)) = &wiring.history {
                    history.want(Want::Node(node));
                }
            }
            UiRequest::Camera(camera) => {
                self.flight = None;
                self.camera = camera;
                self.send_camera(wiring);
            }
            UiRequest::FlyTo(place) => {
                let now = wiring.clock.now_us();
                self.flight = Some(CameraAnimation::to_place(
                    self.camera,
                    place,
                    state.middle,
                    state.extent,
                    now,
                ));
            }
            UiRequest::WindowState(path) => self.work.load(path, wiring.commands.clone()),
            UiRequest::Export(path) => {
                let (factor, unit) = self.desk.files.factor();
                self.work.export(path, state.mesh.clone(), factor, unit);
            }
            UiRequest::Join(choice) => {
                self.desk.joining = true;
                self.work.join(choice, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Trim(part) => {
                self.desk.joining = true;
                self.work.trim(part, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Level(finer) => {
                self.desk.joining = true;
                self.work.level(finer, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Reference => self.before = Some(state.mesh.clone()),
            UiRequest::Outline(path) => {
                if let Some(found) = &self.desk.sizes.found {
                    self.work.outline(path, &found.outline);
                }
            }
            UiRequest::Do(Action::WindowState) => self.work.ask(Purpose::WindowState),
            UiRequest::Do(Action::Export) => self.work.ask(Purpose::Export),
            UiRequest::Do(Action::Screenshot) => self.screenshot = true,
            UiRequest::Do(Action::Turntable) => self.begin_turntable(),
            UiRequest::Do(_) => {}
        }
        self.window.request_redraw();
    }

    fn panels(
        &mut self,
        state: &Published,
        wiring: &Wiring,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> Vec<UiRequest> {
        let mut asks = Vec::new();
        let input = self.egui.take_egui_input(&self.window);
        let view = View {
            state,
            presets: &wiring.presets,
            camera: self.camera,
            devices: &self.devices,
            session: wiring.session.as_deref(),
            uploaded: self.uploaded,
            adapter: &self.adapter,
            frame: self.figures,
            ghosts: wiring.clock.now_us() < wiring.ghosts_until_us,
        };
        let desk = &mut self.desk;
        let context = self.egui.egui_ctx().clone();
        let out = context.run_ui(input, |ui| match &wiring.kiosk {
            Some(screen) => {
                panels::kiosk::ui(ui, &view, screen, desk, &mut asks);
                panels::hand_menu::ui(ui.ctx(), &view, ui.ctx().content_rect());
            }
            None => panels::all(ui, &view, desk, &mut asks),
        });
        self.egui.handle_platform_output(&self.window, out.platform_output);
        if out.viewport_output.values().any(|v| v.repaint_delay.is_zero()) {
            self.window.request_redraw();
        }
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
        asks
    }
}

/// The values of the map that is shown.
pub(super) fn shown<'a>(
    desk: &panels::UiState,
    thickness: &'a Option<MapValues>,
    distances: &'a Option<MapValues>,
) -> Option<&'a MapValues> {
    if desk.look.map == Map::Distance { distances.as_ref() } else { thickness.as_ref() }
}
