//! The event loop, on the main thread. The pointer is an adaptor like the others; panels send
//! commands.

use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

#[cfg(feature = "accessibility")]
use egui_winit::accesskit_winit::WindowEvent as AccessibilityRequest;
use glam::Vec2;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::WindowId;

use super::event_times::EventTimes;
use super::gpu::NoViewer;
use super::look_files::LookFolders;
use super::state::{AccessibilityEvent, WindowState};
use super::wiring::Wiring;

/// Opens the window and runs until it is closed or `stop` is raised.
///
/// # Errors
/// [`NoViewer`] where there is no display or nothing that can draw on it.
pub fn run(wiring: Wiring) -> Result<(), NoViewer> {
    let events = EventLoop::<AccessibilityEvent>::with_user_event()
        .build()
        .map_err(|e| NoViewer::Window(e.to_string()))?;
    let accessibility = events.create_proxy();
    let times = EventTimes::default();
    let mut app = App { wiring, accessibility, open: None, failed: None, times };
    events.run_app(&mut app).map_err(|e| NoViewer::Window(e.to_string()))?;
    if let Some(mut open) = app.open
        && let Some(wrong) = open.preferences_file.keep(&open.ui_state)
    {
        tracing::warn!("{wrong}");
    }
    app.failed.map_or(Ok(()), Err)
}

struct App {
    wiring: Wiring,
    accessibility: EventLoopProxy<AccessibilityEvent>,
    open: Option<WindowState>,
    failed: Option<NoViewer>,
    /// Pointer events on their way to the window.
    times: EventTimes,
}

impl ApplicationHandler<AccessibilityEvent> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.open.is_none() {
            match WindowState::new(events, &self.wiring, &self.accessibility) {
                Ok(open) => self.open = Some(open),
                Err(e) => {
                    self.failed = Some(e);
                    events.exit();
                }
            }
        }
    }

    #[cfg(feature = "accessibility")]
    fn user_event(&mut self, _: &ActiveEventLoop, event: AccessibilityEvent) {
        let Some(open) = &mut self.open else { return };
        let context = open.egui.egui_ctx();
        match event.window_event {
            AccessibilityRequest::InitialTreeRequested => context.enable_accesskit(),
            AccessibilityRequest::ActionRequested(request) => {
                open.egui.on_accesskit_action_request(request);
            }
            AccessibilityRequest::AccessibilityDeactivated => context.disable_accesskit(),
        }
        open.pacing.want();
    }

    fn new_events(&mut self, _: &ActiveEventLoop, _: StartCause) {
        self.times.wake(self.wiring.clock.now_us());
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        self.take_events();
        let Some(open) = &mut self.open else { return };
        if self.wiring.stop.load(Relaxed) {
            events.exit();
            return;
        }
        let now = self.wiring.clock.now_us();
        if open.fingers.is_waiting() {
            open.tick_fingers(&mut self.wiring);
        }
        if open.pacing.poll_is_due(now) {
            open.poll(&self.wiring);
        } else if open.pointer_is_unpaired() {
            // Every event that waited was taken: the pointer is where it is now, and each such
            // place is worth as much as those of a poll.
            let state = self.wiring.published.load_full();
            open.follow_tablets(&state, &self.wiring);
        }
        open.events_taken(&self.wiring);
        if open.pacing.frame_is_due(now) {
            open.window.request_redraw();
        }
        let wait = Duration::from_micros(open.pacing.wait_us(now));
        #[allow(clippy::disallowed_methods)]
        // winit takes its deadlines in the machine's own clock.
        let next = std::time::Instant::now() + wait;
        events.set_control_flow(ControlFlow::WaitUntil(next));
        self.times.rest(self.wiring.clock.now_us());
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if matches!(event, WindowEvent::RedrawRequested) {
            self.take_events();
        }
        let Some(open) = &mut self.open else { return };
        let wiring = &mut self.wiring;
        if matches!(event, WindowEvent::RedrawRequested) {
            open.redraw(wiring);
            return;
        }
        if open.egui.on_window_event(&open.window, &event).repaint {
            open.pacing.want();
        }
        let Some(event) = self.times.keep(event) else { return };
        match event {
            // Visitors do not end an installation that staff ends by a number.
            WindowEvent::CloseRequested if wiring.kiosk.as_ref().is_some_and(|k| k.staff) => {}
            WindowEvent::CloseRequested => {
                wiring.stop.store(true, Relaxed);
                events.exit();
            }
            WindowEvent::Resized(size) => open.resize(size.width, size.height, wiring),
            WindowEvent::DroppedFile(path) if wiring.kiosk.is_none() => {
                match open.look_folders.clone().filter(|_| LookFolders::takes(&path)) {
                    Some(folders) => open.tasks.keep_picture(path, folders),
                    None => open.tasks.load(path, wiring),
                }
            }
            _ => {}
        }
    }
}

impl App {
    /// Handles the events of the pointer that waited, each at its own time.
    fn take_events(&mut self) {
        let App { wiring, open: Some(open), times, .. } = self else { return };
        for (t_us, event) in times.take(wiring.clock.now_us()) {
            wiring.events.set_event(Some(t_us));
            pointer_event(open, &event, wiring);
        }
        wiring.events.set_event(None);
    }
}

fn pointer_event(open: &mut WindowState, event: &WindowEvent, wiring: &mut Wiring) {
    match event {
        WindowEvent::ModifiersChanged(m) => {
            open.mods = m.state();
            open.lend_to_pens(wiring);
        }
        WindowEvent::CursorMoved { position, .. } if !open.fingers.is_down() => {
            open.moved(Vec2::new(position.x as f32, position.y as f32), wiring);
        }
        WindowEvent::CursorLeft { .. } => open.left(wiring),
        WindowEvent::MouseInput { state, button, .. } => {
            open.mouse_button(*button, *state == ElementState::Pressed, wiring);
        }
        WindowEvent::Touch(touch) => open.touched(touch, wiring),
        WindowEvent::MouseWheel { delta, .. }
            if !open.over_panel(open.pointer.at) || open.over_region(open.pointer.at) =>
        {
            let steps = match delta {
                MouseScrollDelta::LineDelta(_, y) => *y,
                MouseScrollDelta::PixelDelta(p) => p.y as f32 / 40.0,
            };
            open.zoom_to_pointer(1.12f32.powf(steps), wiring);
        }
        WindowEvent::PinchGesture { delta, .. } => {
            open.zoom_to_pointer(1.0 + *delta as f32, wiring);
        }
        _ => {}
    }
}
