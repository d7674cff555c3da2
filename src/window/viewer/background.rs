//! What follows the newest clay off to the side: previews of joins, distances, measures. Each has a
//! thread of its own, made when it is first asked for, that drops what is no longer wanted.

use glam::DVec3;

use super::field::{self, Field};
use super::preview;
use super::window::{WindowState, Wiring};
use super::work::{Done, Work};
use crate::panels::measure::Against;
use crate::panels::scene::Said;
use crate::panels::{Tab, hand_menu};
use crate::viewer::latest_wins::Newest;
use crate::viewer::look::Map;
use sculptd_clay::Snapshot;
use sculptd_daemon::Published;

/// A preview that is not done after so long is given up for a newer one; before that it is shown
/// late rather than never.
const PATIENCE_US: u64 = 300_000;
/// The work rests once it has not changed for so long.
const REST_US: u64 = 500_000;

#[derive(Debug, Default)]
pub struct Wishes {
    preview: Option<Newest<preview::Wanted>>,
    field: Option<Newest<field::Wanted>>,
    sizes: Option<Newest<(Snapshot, DVec3)>>,
}

impl Wishes {
    pub fn preview(&mut self, wanted: preview::Wanted, work: &Work) {
        let say = work.said();
        let thread = self.preview.get_or_insert_with(|| {
            Newest::start("sculptd-preview", move |wanted: preview::Wanted, job| {
                let done = preview::compute(&wanted, job).map_err(|e| e.to_string());
                job.cancelled() || say.send(Done::Preview(done.map(|p| p.map(Into::into)))).is_ok()
            })
        });
        thread.wish(wanted);
    }

    pub fn distances(&mut self, wanted: field::Wanted, work: &Work) {
        let say = work.said();
        let thread = self.field.get_or_insert_with(|| {
            let mut field = Field::default();
            // One worker is left to the loop.
            let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
            let pool = rayon::ThreadPoolBuilder::new().num_threads((cores - 1).max(1)).build().ok();
            Newest::start("sculptd-distance", move |wanted, job| match &pool {
                Some(pool) => pool.install(|| field.follow(wanted, job, &say)),
                None => field.follow(wanted, job, &say),
            })
        });
        thread.wish(wanted);
    }

    pub fn sizes(&mut self, wanted: (Snapshot, DVec3), work: &Work) {
        let say = work.said();
        let thread = self.sizes.get_or_insert_with(|| {
            Newest::start("sculptd-measure", move |(mesh, direction): (Snapshot, DVec3), job| {
                match field::measure(&mesh, direction, job) {
                    Ok(found) => say.send(Done::Measured(Box::new(found))).is_ok(),
                    Err(_) => true,
                }
            })
        });
        thread.wish(wanted);
    }

    pub fn no_preview(&self) {
        if let Some(thread) = &self.preview {
            thread.cancel();
        }
    }
}

impl WindowState {
    /// Asks for what the newest state makes stale. Once a frame.
    pub(super) fn wish(&mut self, state: &Published, wiring: &Wiring) {
        let now = wiring.clock.now_us();
        let revision = state.mesh.revision();
        if self.rested.0 != revision {
            self.rested = (revision, now);
        }
        // Visitors of an installation compare nothing: old works are not kept.
        if wiring.kiosk.is_none() {
            self.before.get_or_insert_with(|| state.mesh.clone());
        }
        self.wish_preview(state, now);
        if self.desk.look.map == Map::Distance {
            let to = match (&state.thing, self.desk.sizes.against, &self.before) {
                (Some(thing), Against::HeldObject, _) => {
                    Some(field::Reference::HeldObject(thing.clone()))
                }
                (_, _, before) => before.clone().map(field::Reference::Before),
            };
            let place =
                state.thing.as_ref().filter(|_| self.desk.sizes.against == Against::HeldObject);
            let base = self.before.as_ref().map_or(0, Snapshot::revision);
            let key = (revision, base, place.map(|t| t.place));
            if let Some(to) = to.filter(|_| self.asked_distance != Some(key)) {
                self.asked_distance = Some(key);
                self.wishes.distances(field::Wanted { mesh: state.mesh.clone(), to }, &self.work);
            }
        }
        let direction = self.desk.sizes.direction;
        let rests = now.saturating_sub(self.rested.1) > REST_US;
        if self.desk.tab == Tab::Measure
            && !self.desk.hidden
            && self.asked_sizes != Some((revision, direction))
        {
            // Another direction of a work at rest is measured at once.
            let turned = self.asked_sizes.is_some_and(|(r, _)| r == revision);
            if rests || turned || self.desk.sizes.found.is_none() {
                self.asked_sizes = Some((revision, direction));
                self.wishes.sizes((state.mesh.clone(), direction), &self.work);
            }
        }
    }

    fn wish_preview(&mut self, state: &Published, now: u64) {
        let wanted = self.desk.trial.choice.zip(state.thing.as_ref());
        let Some((choice, thing)) = wanted else {
            if self.asked_preview.take().is_some() {
                self.wishes.no_preview();
            }
            self.preview = None;
            self.desk.trial.said = Said::Nothing;
            if state.thing.is_none() {
                self.desk.trial.choice = None;
            }
            return;
        };
        let key = (state.mesh.revision(), thing.place, choice);
        if self.asked_preview.as_ref().is_some_and(|(asked, _)| *asked == key) {
            return;
        }
        let busy = self.desk.trial.said == Said::UnderWay;
        let begun = self.asked_preview.as_ref().map_or(0, |a| a.1);
        if busy && now.saturating_sub(begun) < PATIENCE_US {
            return;
        }
        self.asked_preview = Some((key, now));
        self.desk.trial.said = Said::UnderWay;
        let wanted = preview::Wanted { mesh: state.mesh.clone(), thing: thing.clone(), choice };
        self.wishes.preview(wanted, &self.work);
    }

    /// A preview has come, or why there is none.
    pub(super) fn previewed(
        &mut self,
        done: Result<Option<std::sync::Arc<preview::Preview>>, String>,
    ) {
        match done {
            // It was dismissed while it was computed.
            _ if self.desk.trial.choice.is_none() => {}
            Ok(preview) => {
                self.desk.trial.said = Said::Shown(preview.as_ref().map_or(0, |p| p.made));
                self.preview = preview;
            }
            Err(why) => {
                self.desk.trial.said = Said::Wrong(why);
                self.preview = None;
            }
        }
    }

    /// What is seen through: the thing in the hands, the balls of their menu.
    pub(super) fn ghosts(&mut self, state: &Published) {
        let balls = hand_menu::balls(state);
        let thing =
            state.thing.as_ref().map(|t| (std::sync::Arc::as_ptr(&t.plain) as usize, t.place));
        let trial = self.desk.trial.choice;
        let key = (thing, trial, balls.clone());
        if self.ghost_key == key {
            return;
        }
        self.ghosts.clear();
        if let Some(thing) = &state.thing {
            // Where its cut is shown, the thing itself steps back.
            let colour = if trial.is_some() { [255, 214, 140, 26] } else { [255, 214, 140, 90] };
            self.ghosts.thing(thing, colour);
        }
        for ball in &balls {
            let (colour, grown) = match ball.ring {
                Some(_) => ([255, 190, 70, 225], 1.12),
                None => ([120, 165, 225, 120], 1.0),
            };
            self.ghosts.ball(ball.place, ball.radius * grown, colour);
        }
        self.ghost_key = key;
    }
}
