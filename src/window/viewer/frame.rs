//! One frame of the window: the clay, what lies over it, the panels, and what they ask for.

use super::pointer::Drag;
use super::renderer::Renderer;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::panels;
use crate::panels::state::{KeyMap, SessionView, TabletKeys, UiRequest, View};
use sculptd_daemon::Published;
use sculptd_daemon::present_latency::PresentedFrame;
use sculptd_daemon::window_link::WindowStanding;
use sculptd_engine::camera::Camera;

impl WindowState {
    pub(super) fn redraw(&mut self, wiring: &Wiring) {
        let texture = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(t)
            | wgpu::CurrentSurfaceTexture::Suboptimal(t) => t,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.config);
                self.pacing.want();
                return;
            }
            // Not now, or nobody sees it: tried again at the next poll.
            _ => {
                self.drawn = None;
                return;
            }
        };
        let begun_ns = wiring.clock.now_ns();
        let state = wiring.published.load_full();
        let now = wiring.clock.now_us();
        self.pacing.begin_frame(now);
        if let Some(animation) = self.camera_animation {
            let (camera, arrived) = animation.at(now);
            self.camera = Camera { aspect: self.camera.aspect, ..camera };
            self.send_camera(wiring);
            if arrived {
                self.camera_animation = None;
            }
        } else if self.pointer.drag == Drag::None {
            self.follow_camera(now, &state.camera);
        }
        let samples = self.gpu.samples(self.ui_state.prefs.smooth_edges);
        if samples != self.samples {
            self.renderer = Renderer::of_window(&self.gpu, self.clay_format, samples);
            self.samples = samples;
            self.look_again();
            self.forget_clay();
        }
        self.update_overlay_mesh(&state);
        self.show_goal(wiring);
        self.shots(&state);
        let over = self.over_view(&state, wiring);
        let view = texture.texture.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.draw_clay(&state, over, &mut encoder, &texture.texture);
        let requests = self.panels(&state, wiring, &mut encoder, &view);
        let own_ms = (wiring.clock.now_ns() - begun_ns) as f64 / 1e6;
        self.gpu.queue.submit([encoder.finish()]);
        let submitted_us = wiring.clock.now_us();
        self.window.pre_present_notify();
        self.gpu.queue.present(texture);
        self.measure(&state, own_ms, (begun_ns / 1000, submitted_us), wiring);
        if self.drawn.replace(state.clone()).is_none() {
            wiring.link.set_standing(WindowStanding::Open);
        }
        for request in requests {
            self.answer(request, &state, wiring);
        }
        self.fit_camera(wiring);
        if self.clay_waits || self.leads_a_pen(wiring) {
            self.pacing.want();
        }
    }

    fn measure(
        &mut self,
        state: &Published,
        own_ms: f64,
        (begun_us, submitted_us): (u64, u64),
        wiring: &Wiring,
    ) {
        let f = &mut self.figures;
        f.cpu_ms += (own_ms - f.cpu_ms) * 0.1;
        f.worst_cpu_ms = f.worst_cpu_ms.max(own_ms);
        self.since_listed.take(own_ms);
        f.drawn = self.renderer.drawn;
        f.frames_a_second = self.pacing.frames_a_second();
        f.input_to_snapshot_ms = state.figures.input_to_snapshot_ms;
        let newest_us = state.figures.newest_us;
        if newest_us != 0 && newest_us != f.newest_us {
            f.newest_us = newest_us;
            let presented_us = wiring.clock.now_us();
            f.input_to_submit_ms = presented_us.saturating_sub(newest_us) as f64 / 1e3;
            wiring.link.record_presented(&PresentedFrame {
                sampled_us: newest_us,
                ticked_us: newest_us + (f.input_to_snapshot_ms * 1e3) as u64,
                begun_us,
                submitted_us,
                presented_us,
            });
        }
    }

    fn panels(
        &mut self,
        state: &Published,
        wiring: &Wiring,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> Vec<UiRequest> {
        let mut requests = Vec::new();
        let input = self.egui.take_egui_input(&self.window);
        // The effect of a click or a key shows in the frame after: the clay of this one is drawn.
        let moved = |e: &egui::Event| matches!(e, egui::Event::PointerMoved(_));
        if !input.events.iter().all(moved) {
            self.pacing.want();
        }
        if !self.key_map.is_of(&self.ui_state.prefs.keys) {
            self.key_map = KeyMap::new(&self.ui_state.prefs.keys);
        }
        let view = View {
            state,
            translations: &wiring.translations,
            keys: &self.key_map,
            presets: &wiring.presets,
            camera: self.camera,
            views: &self.views,
            devices: &self.devices,
            camera_preview: self.camera_preview.as_ref(),
            tablet: wiring
                .kiosk
                .is_none()
                .then(|| TabletKeys { own: wiring.controls.own(), last: wiring.controls.last() }),
            session: wiring.session.as_deref().map(|path| {
                let (fault, lost) = wiring.session_state();
                SessionView { path, fault, lost }
            }),
            uploaded: self.uploaded,
            adapter: &self.adapter,
            frame: self.figures,
            latency: wiring.link.present_latency(),
            invitation: wiring.invitation.as_ref(),
            demo_runs: wiring.clock.now_us() < wiring.demo_until_us,
        };
        let side = self.config.width.min(self.config.height) as f32;
        self.ui_state.screen_scale = side / self.window.scale_factor() as f32 / 1080.0;
        let ui_state = &mut self.ui_state;
        let context = self.egui.egui_ctx().clone();
        self.drawn_demo = view.demo_runs;
        let mut free = egui::Rect::NOTHING;
        let mut show = |ui: &mut egui::Ui| match &wiring.kiosk {
            Some(screen) => {
                free = ui.ctx().content_rect();
                panels::kiosk::ui(ui, &view, screen, ui_state, &mut requests);
                panels::hand_menu::ui(ui.ctx(), &view, free);
            }
            None => free = panels::all(ui, &view, ui_state, &mut requests),
        };
        let mut passes = by_press(input).into_iter();
        let mut out = context.run_ui(passes.next().unwrap_or_default(), &mut show);
        for input in passes {
            out.append(context.run_ui(input, &mut show));
        }
        if self.free != Some(free) {
            self.free = Some(free);
            self.pacing.want();
        }
        self.egui.handle_platform_output(&self.window, out.platform_output);
        if let Some(delay) = out.viewport_output.values().map(|v| v.repaint_delay).min() {
            self.pacing.egui_wants(wiring.clock.now_us(), delay);
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
        requests
    }
}

/// Splits the events of a frame after each press and each release. egui looks up the widget under
/// the pointer once per pass, at the last position of that pass. Without the split, a press
/// followed by a move within one frame would go to the second position.
fn by_press(mut input: egui::RawInput) -> Vec<egui::RawInput> {
    let pressed = |e: &egui::Event| matches!(e, egui::Event::PointerButton { .. });
    let mut events = std::mem::take(&mut input.events);
    let mut passes = Vec::new();
    while let Some(end) = events.iter().position(pressed).filter(|i| i + 1 < events.len()) {
        let rest = events.split_off(end + 1);
        passes.push(egui::RawInput { events, ..input.clone() });
        // Dropped files belong to one pass only.
        input.dropped_files.clear();
        events = rest;
    }
    passes.push(egui::RawInput { events, ..input });
    passes
}

#[cfg(test)]
mod tests {
    use egui::{Event, Modifiers, PointerButton, RawInput, pos2};

    use super::by_press;

    #[test]
    fn each_press_is_seen_where_it_was() {
        let button = |x: f32, pressed| Event::PointerButton {
            pos: pos2(x, 0.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let to = |x: f32| Event::PointerMoved(pos2(x, 0.0));
        let events = vec![
            to(1.0),
            button(1.0, true),
            button(1.0, false),
            to(2.0),
            button(2.0, true),
            to(3.0),
        ];
        let passes = by_press(RawInput { events: events.clone(), ..Default::default() });
        assert_eq!(passes.iter().map(|p| p.events.len()).collect::<Vec<_>>(), [2, 1, 2, 1]);
        let all: Vec<Event> = passes.into_iter().flat_map(|p| p.events).collect();
        assert_eq!(all, events);
        assert_eq!(by_press(RawInput::default()).len(), 1);
    }
}
