//! What the panels asked for.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use super::camera_animation::CameraAnimation;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::panels::state::{Action, FilePurpose, UiRequest};
use sculptd_daemon::Published;
use sculptd_daemon::session::history::Want;
use sculptd_engine::command::Command;
use sculptd_geometry::job::Job;

impl WindowState {
    pub(super) fn answer(&mut self, request: UiRequest, state: &Published, wiring: &Wiring) {
        match request {
            UiRequest::World(command) => {
                self.ui_state.prefs.hints.undone |= matches!(command, Command::Undo);
                let _ = wiring.commands.try_send(command);
            }
            UiRequest::Jump(node) => {
                self.ui_state.prefs.hints.undone = true;
                if let Some((history, _)) = &wiring.history {
                    history.want(Want::Node(node));
                }
            }
            UiRequest::Camera(camera) => {
                self.camera_animation = None;
                self.take_camera(camera);
                self.send_camera(wiring);
            }
            UiRequest::ShowView(kind) => self.show_view(kind, wiring),
            UiRequest::FlyTo(place) => {
                self.turn_freely();
                let (now, side) = (wiring.clock.now_us(), self.open_side(state, place));
                let from = self.camera;
                let flight = CameraAnimation::to_place(from, place, side, state.extent, now);
                self.camera_animation = Some(flight);
            }
            UiRequest::CancelCheck => self.cancel_check(),
            UiRequest::CheckAgain => self.check_again(),
            UiRequest::OpenMesh(path) => {
                self.tasks.load(path, wiring);
            }
            UiRequest::OpenNext(chosen) => {
                if let Ok(mut next) = wiring.open_next.lock() {
                    *next = Some(chosen);
                }
                wiring.stop.store(true, Relaxed);
            }
            UiRequest::ListFolder(folder) => self.tasks.list(folder),
            UiRequest::Export(path) => {
                let (factor, unit) = self.ui_state.files.factor(&path);
                self.tasks.export(path, state, factor, unit);
            }
            UiRequest::Join(choice) => {
                self.ui_state.joining = true;
                self.tasks.join(choice, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::AddPrimitive(primitive) => {
                self.tasks.primitive(primitive, None, wiring.commands.clone());
            }
            UiRequest::AddHeld => {
                if let Some(held) = &state.thing {
                    self.tasks.held(held.clone(), wiring.commands.clone());
                }
            }
            UiRequest::Reshape(id, primitive) => {
                self.tasks.primitive(primitive, Some(id), wiring.commands.clone());
            }
            UiRequest::BooleanWith(pairing) => {
                self.ui_state.joining = true;
                self.tasks.pair(pairing, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Mirror(id, axis) => {
                let to = (wiring.published.clone(), wiring.commands.clone());
                self.tasks.mirror(id, axis, to);
            }
            UiRequest::Trim(part) => {
                self.ui_state.joining = true;
                self.tasks.trim(part, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Level(finer) => {
                self.ui_state.joining = true;
                self.tasks.level(finer, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Remesh(wanted) => {
                self.ui_state.joining = true;
                self.tasks.remesh(wanted, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::RemeshLocal(asked) => {
                self.ui_state.joining = true;
                self.tasks.remesh_local(asked, wiring.commands.clone());
            }
            UiRequest::MakeSets(by) => {
                self.ui_state.joining = true;
                self.tasks.make_sets(by, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::MaskMeasured(by) => {
                self.ui_state.joining = true;
                self.tasks.mask_measured(by, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Extract(part, thickness) => {
                self.ui_state.joining = true;
                let of = (part, thickness);
                self.tasks.extract(of, wiring.published.clone(), wiring.commands.clone());
            }
            UiRequest::Quads(wanted) => {
                let (state, commands) = (wiring.published.clone(), wiring.commands.clone());
                let job = self.begin_change();
                self.tasks.quads(wanted, job, state, commands);
            }
            UiRequest::Decimate(wanted) => {
                let (state, commands) = (wiring.published.clone(), wiring.commands.clone());
                let job = self.begin_change();
                self.tasks.decimate(wanted, job, state, commands);
            }
            UiRequest::Symmetrise(wanted) => {
                let to = (wiring.published.clone(), wiring.commands.clone());
                self.tasks.symmetrise(wanted, to);
            }
            UiRequest::Repair(request) => {
                let to = (wiring.published.clone(), wiring.commands.clone());
                let job = self.begin_change();
                self.tasks.repair(request, job, to);
            }
            UiRequest::Reference => self.before = Some(state.mesh.clone()),
            UiRequest::Outline(path) => {
                if let Some(found) = &self.ui_state.sizes.found {
                    self.tasks.outline(path, &found.outline);
                }
            }
            UiRequest::TabletListen(listens) => wiring.controls.listen(listens),
            UiRequest::TabletBinding(control, binding) => {
                if let Err(e) = wiring.controls.bind(control, binding) {
                    self.ui_state.say(e, true);
                }
            }
            UiRequest::SampleColour(at) => self.sample_colour(at, state, wiring),
            UiRequest::SaveBrush { name, replace } => {
                if let Some(folder) = wiring.brushes.clone() {
                    let (commands, shown) = (wiring.commands.clone(), wiring.published.clone());
                    self.tasks.save_brush((folder, name, replace), shown, commands);
                }
            }
            UiRequest::Do(Action::OpenMesh) => {
                self.tasks.open_dialog(FilePurpose::Open, wiring.clock.clone());
            }
            UiRequest::Do(Action::Export) => {
                self.tasks.open_dialog(FilePurpose::Export, wiring.clock.clone());
            }
            UiRequest::Do(Action::Screenshot) => self.screenshot = true,
            UiRequest::Do(Action::FourViews) => self.turn_views(wiring),
            UiRequest::Do(Action::Turntable) => self.begin_turntable(),
            UiRequest::Do(_) => {}
        }
        self.pacing.want();
    }

    /// Marks a change that can be watched and cancelled as under way.
    fn begin_change(&mut self) -> Arc<Job> {
        let job = Arc::new(Job::default());
        self.ui_state.joining = true;
        self.ui_state.retopology.under_way = Some(job.clone());
        job
    }
}
