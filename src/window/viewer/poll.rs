//! Polling of the window between frames, at a separate pace: the published state, background tasks,
//! the session's history, the devices. A frame follows only after a change.

use std::path::PathBuf;
use std::sync::Arc;

use super::earlier_pictures::EarlierPictures;
use super::state::WindowState;
use super::tasks::TaskReport;
use super::thickness_task::WallReport;
use super::wiring::Wiring;
use crate::language::tr;
use crate::look::Map;
use crate::panels::state::{EarlierWork, FileChooser, FilePurpose, Tab, UiRequest};
use sculptd_camera::camera_thread::CameraPreview;
use sculptd_daemon::Published;
use sculptd_engine::hand::HeldObject;

/// Interval at which devices are listed, preferences saved and the Loop page refreshed.
const SECOND_US: u64 = 1_000_000;

/// Returns true if two states look the same: everything that the window shows of them, except the
/// figures of the Loop page.
fn looks_the_same(a: &Published, b: &Published) -> bool {
    let held =
        |t: &Option<HeldObject>| t.as_ref().map(|t| (Arc::as_ptr(&t.plain) as usize, t.place));
    a.mesh.revision() == b.mesh.revision()
        && a.camera == b.camera
        && a.brush == b.brush
        && a.brush_radius == b.brush_radius
        && a.pens == b.pens
        && a.draft == b.draft
        && a.hands == b.hands
        && a.poses == b.poses
        && (a.others, a.hands_of) == (b.others, b.hands_of)
        && a.people == b.people
        && held(&a.thing) == held(&b.thing)
        && a.menu == b.menu
        && a.fatigue == b.fatigue
        && a.calibrating == b.calibrating
        && (a.undo_steps, a.redo_steps) == (b.undo_steps, b.redo_steps)
        && (a.extent, a.middle, a.volume) == (b.extent, b.middle, b.volume)
}

impl WindowState {
    /// Looks at everything that may have changed; asks for a frame where something did.
    pub(super) fn poll(&mut self, wiring: &Wiring) {
        let state = wiring.published.load_full();
        let now = wiring.clock.now_us();
        self.follow_tablets(&state, wiring);
        let mut changed = self.drawn.as_ref().is_none_or(|d| !looks_the_same(d, &state));
        changed |= self.tell_refused_undo(&state);
        if let Some(count) = self.ui_state.layers.baked(&state) {
            self.ui_state.say(tr!("task-layers-baked", count = count), false);
        }
        if self.ui_state.face_sets.dropped(&state) {
            self.ui_state.say(tr!("task-sets-dropped"), false);
        }
        changed |= self.drawn_demo != (now < wiring.demo_until_us);
        changed |= self.asked_camera.is_some()
            || self.camera_animation.is_some()
            || self.turning.is_some();
        changed |= self.follow_look();
        changed |= self.take_reports(&state, wiring);
        changed |= self.follow(&state, wiring);
        wiring.link.show_walls(self.ui_state.look.map == Map::Thickness);
        changed |= self.follow_check(&state, wiring);
        changed |= self.follow_angles(&state);
        if now.saturating_sub(self.listed_us) > SECOND_US || self.listed_us == 0 {
            let mut devices = (wiring.devices)();
            devices.extend(self.tablet_lines());
            // The status bar counts them on every page.
            changed |= devices.len() != self.devices.len();
            changed |= self.ui_state.tab == Tab::Devices && devices != self.devices;
            changed |= self.follow_session(wiring);
            changed |= self.ui_state.tab == Tab::Loop && !self.ui_state.hidden;
            (self.devices, self.listed_us) = (devices, now);
            let (own, pictures) = (wiring.presets.own(), wiring.presets.pictures());
            let brushes = [own.as_ptr() as usize, pictures.as_ptr() as usize];
            changed |= brushes != self.shown_brushes;
            self.shown_brushes = brushes;
            self.since_listed.tell(self.figures.drawn);
            if let Some(wrong) = self.preferences_file.keep(&self.ui_state) {
                self.ui_state.say(wrong, true);
                changed = true;
            }
        }
        changed |= self.follow_hand_camera(wiring);
        match &wiring.kiosk {
            Some(screen) => {
                let view = screen.desk.view.lock().ok().and_then(|v| *v);
                let score = screen.desk.score.lock().ok().and_then(|score| *score);
                changed |= view != self.drawn_kiosk || score != self.drawn_score;
                (self.drawn_kiosk, self.drawn_score) = (view, score);
            }
            None => {
                changed |= self.poll_history(&state, now, wiring);
                changed |= self.poll_earlier(wiring);
            }
        }
        if changed {
            self.pacing.want();
        }
    }

    /// Takes the camera's newest picture while the page that shows it is open.
    fn follow_hand_camera(&mut self, wiring: &Wiring) -> bool {
        let open = self.ui_state.tab == Tab::Devices && !self.ui_state.hidden;
        let newest = open.then(|| (wiring.camera)()).flatten();
        let address = |p: &Option<Arc<CameraPreview>>| p.as_ref().map(Arc::as_ptr);
        let changed = address(&newest) != address(&self.camera_preview);
        self.camera_preview = newest;
        changed
    }

    /// Says whose step is in the way of an undo that was refused since the last look.
    fn tell_refused_undo(&mut self, state: &Published) -> bool {
        if self.told_refusal == state.undo_refused {
            return false;
        }
        self.told_refusal = state.undo_refused;
        let Some(refused) = state.undo_refused else { return false };
        let name = state.people.as_ref().map_or("?", |p| p.name(refused.by));
        let text = match refused.redo {
            false => tr!("undo-in-the-way", name = name),
            true => tr!("redo-in-the-way", name = name),
        };
        self.ui_state.say(text, true);
        true
    }

    /// Takes the state of the session's file, so that the status bar never tells an older one while
    /// nothing else changes.
    fn follow_session(&mut self, wiring: &Wiring) -> bool {
        let state = wiring.session_state();
        let changed = state != self.shown_session;
        self.shown_session = state;
        changed
    }

    /// The pictures of earlier sculptures, read once.
    fn poll_earlier(&mut self, wiring: &Wiring) -> bool {
        let shown = &mut self.ui_state.earlier.all;
        if shown.is_empty() && !wiring.recent.is_empty() {
            let work =
                |path: &PathBuf| EarlierWork { path: path.clone(), picture: None, told: None };
            *shown = wiring.recent.iter().map(work).collect();
            let context = self.egui.egui_ctx().clone();
            self.earlier_pictures = EarlierPictures::read(wiring.recent.clone(), context);
        }
        let reader = self.earlier_pictures.as_ref();
        reader.is_some_and(|reader| reader.update(shown, self.egui.egui_ctx()))
    }

    /// The versions of the session, or the pictures of the steps where there is none.
    fn poll_history(&mut self, state: &Published, now: u64, wiring: &Wiring) -> bool {
        match &wiring.history {
            Some((history, rate_hz)) => {
                let context = self.egui.egui_ctx().clone();
                let shown = &mut self.ui_state.versions;
                self.version_pictures.update(shown, &context, (history, *rate_hz))
            }
            None => self.take_step_pictures(state, now),
        }
    }

    /// Returns the first folder of a file chooser: beside the last used file, or the documents.
    fn usual_folder(&self) -> PathBuf {
        let recent = self.ui_state.prefs.recent.first().and_then(|p| p.parent());
        let dirs = directories::UserDirs::new();
        let own = dirs.as_ref().map(|d| d.document_dir().unwrap_or(d.home_dir()));
        let known = [recent, own].into_iter().flatten().find(|p| p.is_dir());
        known.map_or_else(|| "/".into(), std::path::Path::to_path_buf)
    }

    /// Shows why the world refused what a panel, a key or the pointer asked for; `true` when it
    /// refused anything.
    fn take_answers(&mut self, wiring: &Wiring) -> bool {
        let mut refused: Vec<String> = wiring
            .answers
            .try_iter()
            .filter_map(|a| a.result.err())
            .map(|e| e.to_string())
            .collect();
        // A drag over a locked object is refused many times over.
        refused.dedup();
        let any = !refused.is_empty();
        refused.into_iter().for_each(|text| self.ui_state.say(text, true));
        any
    }

    /// Takes the reports of background tasks; `true` when there were any.
    fn take_reports(&mut self, state: &Published, wiring: &Wiring) -> bool {
        // Before the reports: a load that has ended since has reported.
        let loading = self.tasks.progress();
        let mut changed = loading != self.ui_state.loading;
        changed |= self.take_answers(wiring);
        while let Ok(done) = self.tasks.done.try_recv() {
            changed = true;
            self.map_changes += 1;
            match done {
                TaskReport::Message(text, wrong) => self.ui_state.say(text, wrong),
                TaskReport::Joined => {
                    self.ui_state.joining = false;
                    self.ui_state.retopology.under_way = None;
                }
                TaskReport::Used(path) => self.ui_state.prefs.used(path),
                TaskReport::Walls(WallReport::Map(side, ..))
                    if self.asked_map.is_some_and(|asked| asked.side != side) => {}
                TaskReport::Walls(WallReport::Map(_, values, about)) => {
                    self.values = Some(values);
                    self.ui_state.walls.found = Some(about);
                }
                TaskReport::Walls(WallReport::Changes(values, about)) => {
                    self.wall_changes = Some(values);
                    self.ui_state.walls.changes = Some(about);
                }
                TaskReport::Walls(WallReport::Ball(ball)) => self.ball = ball,
                TaskReport::Look(found) => self.look_read(*found),
                TaskReport::KeptPicture(name) => {
                    self.look_again();
                    self.ui_state.say(tr!("task-picture-kept", path = name), false);
                }
                TaskReport::Read(picture) => self.first_picture = Some(picture),
                TaskReport::Opened => self.opened = Some(wiring.clock.now_us()),
                TaskReport::Preview(done) => self.previewed(done),
                TaskReport::Distances(values, about) => {
                    self.ui_state.sizes.distances = Some(about);
                    self.distances = Some(values);
                }
                TaskReport::Checked(report) => self.checked(*report, state),
                TaskReport::Measured(found) => self.ui_state.sizes.found = Some(found),
                TaskReport::Section(found) => self.ui_state.sizes.section = Some(found),
                TaskReport::NoDialog(purpose) => {
                    let folder = self.usual_folder();
                    self.ui_state.chooser = Some(FileChooser::new(purpose, folder.clone()));
                    self.tasks.list(folder);
                }
                TaskReport::Listed(folder, listing) => {
                    let open = self.ui_state.chooser.as_mut();
                    if let Some(chooser) = open.filter(|c| c.folder == folder) {
                        chooser.listing = Some(listing);
                    }
                }
                TaskReport::Chosen(FilePurpose::Open, path) => {
                    self.tasks.load(path, wiring);
                }
                TaskReport::Chosen(FilePurpose::Export, path) => {
                    self.ui_state.files.export = path.display().to_string();
                    self.answer(UiRequest::Export(path), state, wiring);
                }
            }
        }
        if loading.is_none() && self.opened.is_none() {
            changed |= self.first_picture.take().is_some();
        }
        self.ui_state.loading = loading;
        // The tick loop takes a mesh that was sent a tick or two later.
        let now = wiring.clock.now_us();
        if self.opened.is_some_and(|since| now.saturating_sub(since) > 100_000) {
            self.opened = None;
            self.first_picture = None;
            changed = true;
            self.before = Some(state.mesh.clone());
        }
        if self.distances.as_ref().is_some_and(|v| v.pages.len() != state.mesh.page_count()) {
            self.distances = None;
        }
        for values in [&mut self.values, &mut self.wall_changes] {
            if values.as_ref().is_some_and(|v| v.pages.len() != state.mesh.page_count()) {
                *values = None;
            }
        }
        let goal_scale =
            self.goal_scale(wiring).filter(|_| self.ui_state.look.map == Map::Distance);
        let scale = goal_scale.unwrap_or(
            match (
                self.ui_state.look.map,
                &self.ui_state.walls.found,
                self.ui_state.sizes.distances,
            ) {
                (Map::Thickness | Map::Gap, Some(found), _) => {
                    self.ui_state.walls.scale.unwrap_or((found.min, found.high))
                }
                (Map::WallChange, ..) => {
                    let found = self.ui_state.walls.changes.as_ref();
                    let most = found.map_or(0.0, |c| c.thickened.max(-c.thinned));
                    // As in the report: a rim's change does not press that of the walls together.
                    let usual = self.ui_state.walls.found.as_ref().map_or(most, |w| w.median);
                    let most = most.min(usual).max(state.extent * 1e-5);
                    (-most, most)
                }
                // Both ends as far from nothing; an object that did not change is pale all over.
                (Map::Distance, _, Some(d)) => {
                    let most = d.max.max(-d.min).max(state.extent * 1e-5);
                    (-most, most)
                }
                _ => (0.0, 1.0),
            },
        );
        changed |= self.ui_state.look.scale != scale;
        self.ui_state.look.scale = scale;
        self.follow_walls(state) || changed
    }
}
