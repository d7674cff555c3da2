//! Keeps the Check page up to date: asks for a check when the hand rests, takes its result, marks
//! the chosen finding, and gives the maps of angles their direction and limit.

use glam::Vec3;

use super::check_task::{CheckKey, CheckReport, CheckWork};
use super::overlay;
use super::plate::PlateHeight;
use super::renderer::LineEnd;
use super::state::WindowState;
use super::wiring::Wiring;
use crate::look::{AngleMap, Map};
use crate::panels::state::{CheckStop, CheckUnderWay, ObjectVersion, Tab};
use sculptd_check::preset::BuildMethod;
use sculptd_daemon::Published;
use sculptd_engine::camera::Camera;

/// A check waits until the objects have not changed for so long.
const REST_US: u64 = 500_000;
/// A mark follows its finding over this share of the object's size, from one check to the next.
const SAME_PLACE: f64 = 0.15;

impl WindowState {
    /// Returns true while the Check page is open.
    pub(super) fn is_check_open(&self) -> bool {
        self.ui_state.tab == Tab::Check && !self.ui_state.hidden
    }

    /// Asks for a check where the result is not of the present objects and choice; `true` when that
    /// is to be seen. Once a poll.
    pub(super) fn follow_check(&mut self, state: &Published, wiring: &Wiring) -> bool {
        if wiring.kiosk.is_some() {
            return false;
        }
        let now_us = wiring.clock.now_us();
        if !self.is_check_open() {
            return self.drop_check();
        }
        let page = &mut self.ui_state.check;
        let versions = ObjectVersion::of_choice(state, page.choice.visible);
        if self.check_rested.0 != versions {
            self.check_rested = (versions.clone(), now_us);
        }
        let key = CheckKey { versions, choice: page.choice.clone(), search: page.searches };
        let asked = self.asked_check.as_ref();
        if asked == Some(&key) {
            return false;
        }
        let found = page.found.as_ref().filter(|f| f.choice == key.choice);
        if !key.search && found.is_some_and(|f| f.versions == key.versions) {
            let stopped = page.stopped.take().is_some();
            return self.drop_check() || stopped;
        }
        // Another choice is checked at once, other clay when the hand rests.
        let chosen = asked.is_none_or(|a| (&a.choice, a.search) != (&key.choice, key.search));
        if page.stopped == Some(CheckStop::Cancelled) && !chosen {
            return false;
        }
        if !chosen && now_us.saturating_sub(self.check_rested.1) < REST_US {
            // Its result would be of clay that is gone.
            let was = page.under_way.take().is_some();
            self.workers.no_check();
            return was;
        }
        (page.stopped, page.under_way) = (None, None);
        match key.choice.settings(&page.library) {
            Ok(settings) => {
                let work = CheckWork::new(key.clone(), settings, state, wiring.clock.clone());
                let progress = work.progress.clone();
                let job = self.workers.check(work, &self.tasks);
                page.under_way = Some(CheckUnderWay { job, progress });
            }
            Err(e) => page.stop(CheckStop::Failed(e.to_string())),
        }
        self.asked_check = Some(key);
        true
    }

    /// Stops a check that nobody waits for; `true` when one was running.
    fn drop_check(&mut self) -> bool {
        let was = self.ui_state.check.under_way.take().is_some();
        if was {
            self.workers.no_check();
            self.asked_check = None;
        }
        was
    }

    /// Stops the running check because a person asked for it.
    pub(super) fn cancel_check(&mut self) {
        self.workers.no_check();
        self.stop_check(CheckStop::Cancelled);
    }

    /// Notes why the check that was asked for has no result; it is not asked for again by itself.
    fn stop_check(&mut self, why: CheckStop) {
        self.ui_state.check.stop(why);
        if let Some(asked) = &mut self.asked_check {
            asked.search = false;
        }
    }

    /// Checks again, whatever was found or stopped before.
    pub(super) fn check_again(&mut self) {
        (self.asked_check, self.ui_state.check.stopped) = (None, None);
        self.ui_state.check.found = None;
    }

    /// Takes the result of a check, if it is the one that was asked for last.
    pub(super) fn checked(&mut self, (key, done): CheckReport, state: &Published) {
        let page = &mut self.ui_state.check;
        if self.asked_check.as_ref() != Some(&key) || page.under_way.is_none() {
            return;
        }
        match done {
            Ok(found) => {
                if key.search && page.choice == key.choice {
                    // The best direction is the person's choice from now on.
                    page.choice.up = found.choice.up;
                    page.searches = false;
                    let choice = page.choice.clone();
                    self.asked_check = Some(CheckKey { choice, search: false, ..key });
                }
                page.take(found, f64::from(state.extent) * SAME_PLACE);
            }
            Err(why) => self.stop_check(CheckStop::Failed(why)),
        }
    }

    /// The ring around the marked finding, in a view of this camera.
    pub(super) fn check_lines(&self, lines: &mut Vec<LineEnd>, camera: &Camera) {
        let marked = self.ui_state.check.marked.filter(|_| self.is_check_open());
        if let Some(marked) = marked {
            overlay::finding_mark(lines, camera, marked.place.as_vec3());
        }
    }

    /// Gives the look the direction, limit and plate of the map of angles that is shown; `true`
    /// when they changed.
    pub(super) fn follow_angles(&mut self, state: &Published) -> bool {
        let (page, map) = (&self.ui_state.check, self.ui_state.look.map);
        let limit = page.angle_limit(map);
        let angles = limit.map_or_else(AngleMap::default, |(degrees, process)| {
            let up = page.choice.up.as_vec3();
            let layers = process.method == BuildMethod::Layers;
            let plate = (map == Map::Overhang && layers).then(|| {
                let layer = process.layer_height.unwrap_or(0.01) as f32;
                self.plate.height(&state.mesh, &state.transform(), up, layer)
            });
            AngleMap { up: up.to_array(), limit: degrees as f32, plate: plate.flatten() }
        });
        if map != Map::Overhang {
            // Nothing old is kept alive.
            self.plate = PlateHeight::default();
        }
        let changed = self.ui_state.look.angles != angles;
        self.ui_state.look.angles = angles;
        changed
    }

    /// A direction from which nothing of the active object hides a place, as far as there is one;
    /// else from the middle of the object outwards.
    pub(super) fn open_side(&self, state: &Published, place: Vec3) -> Vec3 {
        let out = (place - state.middle).normalize_or(self.camera.backward());
        let corners = [-1.0, 1.0].map(|x| [-1.0, 1.0].map(|y| [-1.0, 1.0].map(|z| [x, y, z])));
        let corners = corners.into_iter().flatten().flatten().map(Vec3::from);
        let mut sides: Vec<Vec3> = corners
            .chain([Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z])
            .map(Vec3::normalize)
            .collect();
        sides.sort_by(|a, b| b.dot(out).total_cmp(&a.dot(out)));
        let far = state.extent * 4.0;
        let open = |side: &Vec3| {
            let ray = sculptd_clay::Ray { origin: place + *side * far, dir: -*side };
            state.pick(ray).is_none_or(|hit| hit.t > far - state.extent * 0.01)
        };
        std::iter::once(out).chain(sides).find(open).unwrap_or(out)
    }
}
