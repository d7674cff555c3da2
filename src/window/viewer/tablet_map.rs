//! Where on the screen a desktop puts the pen of a tablet, learned from pairs: a share of the
//! tablet's area, and the desktop's pointer at that time.
//!
//! The desktop's map is affine (an area that is cropped, turned, laid over one screen or several),
//! so it is fitted by least squares. Two things make a pair worth less: the pointer follows the pen
//! some milliseconds later, which matters the more the faster the pen is, and a mouse may have
//! moved the pointer. The delay is found by trying several; pairs far from the map are left out of
//! a second fit (Rousseeuw and Leroy, Robust Regression and Outlier Detection, 1987, reweighting).
//! The map is accepted only if the motion distinguishes it from a delay: [`super::map_fit`].

use std::collections::VecDeque;

use glam::{DVec2, Vec2};

use super::map_fit::{self, DELAYS_US, LEAST, MapFit, ScreenMap};
use sculptd_devices::DeviceId;
use sculptd_devices::prediction::PenPredictor;
use sculptd_engine::desktop_layout::DesktopLayout;

/// Pairs that are remembered: some ten seconds of motion, so that they span much of the tablet.
const PAIRS: usize = 1024;
/// Microseconds between two pairs: closer ones say nothing new of the map.
const APART_US: u64 = 6_000;
/// Divisor of the pair count: the map is fitted again after that share of new pairs, and never
/// after fewer than half of [`LEAST`].
const FRESH: usize = 8;
/// The same once a map is known.
const KNOWN_FRESH: usize = 2;
/// Pen positions that are remembered, for looking back by the delay: half a minute at 250 Hz.
const TRAIL: usize = 8192;
/// Delays at which a known map is compared with the newest pairs, microseconds apart. A pen at a
/// thousand pixels a second is two pixels on in half a step.
const STEP_US: u64 = 4_000;
/// Of more pairs, as many are looked at as say enough.
const LOOKED_AT: usize = 96;
/// A map is believed while its pairs lie within so many pixels of it, in the median.
const BELIEVED: f64 = 3.0;
/// No map fits: the pointer does not follow the pen.
const WILD: f64 = 24.0;
/// A pen's pointer may be this far from where the map puts it, pixels: beyond, it is a mouse's.
const NEAR: f64 = 32.0;
/// Greatest delay of the pointer's events after the pen, in microseconds, in a window that takes
/// its events at once.
pub(super) const LATE_US: u64 = 250_000;
/// Greatest time between a touch of the pen and the desktop's press, in microseconds, on a busy
/// machine.
const PRESS_US: u64 = 2_000_000;
/// Greatest number of touches remembered without a press.
const TOUCHES: usize = 16;
/// A pen that has not moved for so long is where its pointer is, whatever the delay, microseconds.
const HALTED_US: u64 = 120_000;
/// Weight of a moving pen's pair relative to one of a pen that has halted.
const MOVING: f64 = 0.1;
/// Greatest number of the newest pairs that are tested for another map of the desktop.
const NEWEST: usize = 8 * LEAST;
/// Number of consecutive pairs that agree with the map and so end a contradiction.
const AGREE: usize = 3;
/// Another map must fit this part of its pairs, by what they are worth: a map through three places
/// fits more than half of them, even where the pointer was elsewhere at one of them.
const FITTED: f64 = 0.8;
/// A map is contradicted where its newest pairs lie so far from it, pixels in the median, whatever
/// the delay is taken to be.
const CONTRADICTED: f64 = 2.0 * BELIEVED;
/// Another map fits the newest pairs so many times better than the one that they contradict.
const BETTER: f64 = 3.0;
/// A map is doubted after so many pairs, which lie so far apart in time, microseconds: a desktop
/// that stands still for a moment contradicts nothing.
const DOUBTED: (usize, u64) = (LEAST / 2, 300_000);
/// A pen that moves by less than this share of its tablet rests in the hand.
const RESTS: f64 = 4e-3;

#[derive(Debug, Clone, Copy)]
struct Pair {
    t_us: u64,
    pointer: DVec2,
}

/// Position of the pen at one time.
#[derive(Debug, Clone, Copy)]
struct Place {
    t_us: u64,
    /// Shares of the area; `None` out of range.
    share: Option<DVec2>,
    tip: bool,
}

/// State of one tablet.
#[derive(Debug, Default)]
pub struct TabletMap {
    trail: VecDeque<Place>,
    /// Times and pixels at which the pen touched by the map without a press of the pointer yet. The
    /// pen's samples sculpt there, regardless of later changes of the map.
    touches: VecDeque<(u64, DVec2)>,
    pairs: VecDeque<Pair>,
    /// Pairs taken since the last fit.
    fresh: usize,
    map: Option<ScreenMap>,
    /// The delay of the pointer behind the pen, microseconds, and the median distance of the pairs
    /// from the map, pixels.
    fit: (u64, f64),
    /// The pointer has moved while the pen was in range, in this visit.
    together: bool,
    /// The pointer goes where the pen does not: it is a mouse's.
    apart: bool,
    /// Time of the first pair that contradicts the map, in microseconds.
    contradicted_us: Option<u64>,
    /// Pairs in turn that agree with the map.
    agree: usize,
    /// Pairs since the map was doubted, while no other is known.
    doubts: usize,
    /// Time at which the map became known, in microseconds.
    since_us: u64,
    /// Prediction of the pen's path.
    predictor: PenPredictor,
}

/// The window's state of the tablets.
#[derive(Debug, Default)]
pub(super) struct Tablets {
    pub(super) known: Vec<(DeviceId, TabletMap)>,
    /// Those whose pen is in range.
    pub(super) in_range: Vec<DeviceId>,
    /// Position of the pointer when it was last paired with the pens.
    pub(super) paired: Option<Vec2>,
    pub(super) sent: DesktopLayout,
    /// Time at which all waiting events were last taken, in microseconds.
    pub(super) taken_us: u64,
    /// Time of a pad key's press that no press of the pointer has followed yet, in microseconds.
    pub(super) key_us: Option<u64>,
}

impl Tablets {
    /// Returns true if the desktop moves its pointer with the pen of a tablet, or may do so.
    pub(super) fn moves_pointer(&self, device: DeviceId) -> bool {
        let known = self.known.iter().find(|t| t.0 == device);
        known.is_some_and(|(_, map)| map.map().is_some() || map.is_undecided())
    }
}

impl TabletMap {
    /// The pen is here, in shares of its tablet's area, or out of range, and touches or not.
    pub fn pen(&mut self, t_us: u64, share: Option<DVec2>, tip: bool) {
        if self.trail.back().is_some_and(|last| last.t_us >= t_us) {
            return;
        }
        if share.is_none() {
            (self.together, self.apart) = (false, false);
        }
        let touched = self.trail.back().is_some_and(|last| last.tip);
        let begins = tip && !touched && t_us >= self.since_us;
        if let Some((share, map)) = share.zip(self.map()).filter(|_| begins) {
            let pixel = map.at(share);
            self.touches.push_back((t_us, pixel));
            if self.touches.len() > TOUCHES {
                self.touches.pop_front();
            }
        }
        self.trail.push_back(Place { t_us, share, tip });
        self.predictor.report(t_us, share);
        if self.trail.len() > TRAIL {
            self.trail.pop_front();
        }
    }

    /// The pointer has moved here, in pixels of the whole desktop, while the pen was in range.
    pub fn pointer(&mut self, t_us: u64, at: DVec2) {
        if self.trail.back().is_none_or(|p| p.share.is_none()) || self.rests_since_a_pair(t_us) {
            return;
        }
        self.together = true;
        if self.pairs.back().is_some_and(|p| t_us < p.t_us + APART_US) {
            return;
        }
        self.pairs.push_back(Pair { t_us, pointer: at });
        if self.pairs.len() > PAIRS {
            self.pairs.pop_front();
        }
        self.fresh += 1;
        self.look_for_another(t_us);
        let part = if self.map().is_some() { KNOWN_FRESH } else { FRESH };
        let enough = (self.pairs.len() / part).max(LEAST / 2);
        if self.fresh >= enough && self.pairs.len() >= LEAST {
            self.fresh = 0;
            self.learn(t_us);
        }
    }

    /// Returns the predictor of the pen's path after its last report.
    pub fn predictor(&self) -> &PenPredictor {
        &self.predictor
    }

    /// The map, once it is known; `None` while the newest pairs contradict it and none is known yet
    /// that they agree on.
    pub fn map(&self) -> Option<&ScreenMap> {
        self.map.as_ref().filter(|_| !self.is_doubted())
    }

    /// After as many pairs as show any map, none was found: a mouse moves the pointer, and the map
    /// is as good as before.
    fn is_doubted(&self) -> bool {
        (1..=NEWEST / 2).contains(&self.doubts)
    }

    /// The pointer's delay behind the pen, microseconds, and how far the pairs lie from the map,
    /// pixels, in the median.
    pub fn fit(&self) -> (u64, f64) {
        self.fit
    }

    /// Returns true if the pointer moves in this visit and the cause is not known yet.
    pub fn is_undecided(&self) -> bool {
        self.map().is_none() && self.together && !self.apart
    }

    /// Returns true if a pointer at this pixel belongs to this pen. `since_us`: the window has
    /// taken no event since then, so that the pointer may have been here at any time after it.
    pub fn owns(&self, now_us: u64, since_us: u64, pointer: DVec2) -> bool {
        let Some(map) = self.map() else { return false };
        let oldest = now_us.saturating_sub(LATE_US).min(since_us.saturating_sub(LATE_US));
        // A resting pen sends nothing: the position before the oldest holds until the next.
        let from = self.trail.partition_point(|p| p.t_us < oldest).saturating_sub(1);
        let places = self.trail.iter().skip(from).filter_map(|p| p.share);
        places.into_iter().any(|share| map.at(share).distance(pointer) <= NEAR)
    }

    /// Returns true if a press of the pointer at this pixel belongs to this pen. That is a pixel
    /// which it touched recently without a press yet, or its current position.
    pub fn takes_press(&mut self, now_us: u64, since_us: u64, pointer: DVec2) -> bool {
        let oldest = now_us.min(since_us).saturating_sub(PRESS_US);
        self.touches.retain(|t| t.0 >= oldest);
        let touch = self.touches.iter().position(|t| t.1.distance(pointer) <= NEAR);
        if let Some(touch) = touch {
            self.touches.drain(..=touch);
        }
        touch.is_some() || self.owns(now_us, since_us, pointer) && !self.touched_unknown()
    }

    /// Returns true if the newest touch of the pen began before the map was known. The pen did
    /// nothing then, and the pointer sculpts instead, however late its press arrives.
    fn touched_unknown(&self) -> bool {
        let newest = self.trail.iter().rposition(|p| p.tip);
        let Some(end) = newest else { return false };
        let begin = self.trail.iter().take(end).rposition(|p| !p.tip).map_or(0, |i| i + 1);
        self.trail[begin].t_us < self.since_us
    }

    /// Returns the pen's position at a time, interpolated; `None` before the trail and out of
    /// range.
    fn share_at(&self, t_us: u64) -> Option<DVec2> {
        let after = self.trail.partition_point(|p| p.t_us <= t_us);
        let before = self.trail.get(after.checked_sub(1)?)?;
        let at = before.share?;
        Some(match self.trail.get(after).and_then(|next| Some((next.t_us, next.share?))) {
            Some((next_us, next)) => {
                let part = (t_us - before.t_us) as f64 / (next_us - before.t_us) as f64;
                at.lerp(next, part)
            }
            None => at,
        })
    }

    /// Returns true if the pen has rested since some time before the last pair: the pointer has
    /// received its position, and only a mouse can move it now.
    fn rests_since_a_pair(&self, t_us: u64) -> bool {
        let from = self.pairs.back().map(|p| p.t_us.saturating_sub(LATE_US));
        let Some((from, at)) = from.and_then(|from| Some((from, self.share_at(from)?))) else {
            return false;
        };
        let after = self.trail.partition_point(|p| p.t_us <= from);
        let mut since = self.trail.iter().skip(after).take_while(|p| p.t_us <= t_us);
        since.all(|p| p.share.is_some_and(|share| share.distance(at) < RESTS))
    }

    fn learn(&mut self, now_us: u64) {
        let oldest = self.trail.front().map_or(0, |p| p.t_us);
        self.pairs.retain(|p| p.t_us >= oldest);
        let all = self.pairs.len();
        let Some(fit) = self.best_map(all) else { return };
        let (map, error) = (fit.map, fit.off);
        // If the newest pairs contradict the known map, it may have been guessed from few pairs.
        // Otherwise the pairs are of two maps, most of them of the older one.
        let newest = self.contradicting();
        let of_two_maps = newest > 0
            && self.least_quantile(&map, newest, FITTED).is_none_or(|off| off > BELIEVED);
        if of_two_maps {
            return;
        }
        if error <= BELIEVED {
            if fit.certain {
                self.believe(now_us, &fit);
            }
        } else if all >= 2 * LEAST && error > WILD {
            // A mouse moves the pointer: the map that was known goes only when it is contradicted
            // for long.
            self.apart = true;
            let off = self.map.and_then(|known| self.least_quantile(&known, all, 0.5));
            if all >= PAIRS / 2 && off.is_some_and(|e| e > WILD) {
                (self.map, self.doubts) = (None, 0);
            }
        }
    }

    fn believe(&mut self, now_us: u64, fit: &MapFit) {
        if self.map().is_none() {
            self.since_us = now_us;
        }
        (self.map, self.fit) = (Some(fit.map), (fit.delay_us, fit.off));
        (self.apart, self.doubts) = (false, 0);
        self.contradicted_us = None;
    }

    /// The map of the newest pairs with the delay that fits best.
    fn best_map(&self, newest: usize) -> Option<MapFit> {
        map_fit::best_fit(&|delay_us| self.samples(newest, delay_us))
    }

    /// Drops the older pairs if the newest contradict the map and agree on another one: the desktop
    /// has another map than before (its area was turned or cropped, or a screen was added). If they
    /// agree on none yet, the map is in doubt. A stroke keeps the map with which it began.
    fn look_for_another(&mut self, now_us: u64) {
        let Some(known) = self.map else { return };
        let agrees = self.least_quantile(&known, 1, 0.5).is_none_or(|off| off <= CONTRADICTED);
        if agrees || self.trail.back().is_some_and(|p| p.tip) {
            self.agree += usize::from(agrees);
            if self.agree >= AGREE {
                self.contradicted_us = None;
            }
            return self.trust_again(now_us);
        }
        self.agree = 0;
        self.contradicted_us.get_or_insert(now_us);
        let newest = self.contradicting();
        let off = self.least_quantile(&known, newest, 0.5).filter(|off| *off > CONTRADICTED);
        let best = self.best_map(newest).zip(off).filter(|(fit, off)| {
            let fits = self.least_quantile(&fit.map, newest, FITTED);
            fit.alone && fits.is_some_and(|fits| fits <= BELIEVED && fits * BETTER < *off)
        });
        if let Some((fit, _)) = best {
            self.pairs.drain(..self.pairs.len() - newest);
            self.fresh = 0;
            return self.believe(now_us, &fit);
        }
        let early = now_us.saturating_sub(DOUBTED.1);
        let lately = self.pairs.iter().rev().position(|p| p.t_us < early).map_or(0, |i| i + 1);
        let lately = lately.max(DOUBTED.0);
        if self.doubts > 0 || lately <= self.pairs.len() && self.is_contradicted(&known, lately) {
            self.doubts = self.doubts.saturating_add(1);
        }
    }

    /// Returns the number of pairs since the map was contradicted, of the newest ones.
    fn contradicting(&self) -> usize {
        let Some(since) = self.contradicted_us else { return 0 };
        self.pairs.iter().rev().take(NEWEST).take_while(|p| p.t_us >= since).count()
    }

    /// The newest pairs agree with the map again, or a stroke is drawn by it.
    fn trust_again(&mut self, now_us: u64) {
        let Some(known) = self.map.filter(|_| self.doubts > 0) else { return };
        if self.pairs.len() >= DOUBTED.0 && !self.is_contradicted(&known, DOUBTED.0) {
            if self.is_doubted() {
                self.since_us = now_us;
            }
            self.doubts = 0;
        }
    }

    /// Returns true if the newest pairs are far from a map at every delay.
    fn is_contradicted(&self, map: &ScreenMap, newest: usize) -> bool {
        self.least_quantile(map, newest, 0.5).is_some_and(|off| off > WILD)
    }

    /// Within which distance of a map this part of the newest pairs lies, with the delay that suits
    /// it best.
    fn least_quantile(&self, map: &ScreenMap, newest: usize, part: f64) -> Option<f64> {
        let delays = (0..=DELAYS_US.0 / STEP_US).map(|i| self.samples(newest, i * STEP_US));
        let all =
            delays.filter_map(|samples| map_fit::quantile(map_fit::distances(map, &samples), part));
        all.min_by(f64::total_cmp)
    }

    fn samples(&self, newest: usize, delay_us: u64) -> Vec<(DVec2, DVec2, f64)> {
        let newest = newest.min(self.pairs.len());
        self.pairs
            .iter()
            .skip(self.pairs.len() - newest)
            .step_by(newest.div_ceil(LOOKED_AT).max(1))
            .filter_map(|p| {
                let t = p.t_us.checked_sub(delay_us)?;
                let share = self.share_at(t)?;
                let moved = |before_us: u64| {
                    let before = self.share_at(t.checked_sub(before_us)?)?;
                    Some(share.distance(before) * 1000.0)
                };
                // A pixel is a thousandth of a tablet, more or less: a pen that moves by that in
                // a tick counts half. Of one that has just halted the pointer may not have heard
                // yet; but one that never halts teaches the map, too.
                let halted = moved(HALTED_US).is_some_and(|by| by < 1.0);
                let worth = if halted { 1.0 } else { MOVING };
                let slow = 1.0 + moved(8_000).unwrap_or(0.0).powi(2);
                Some((share, p.pointer, worth / slow))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
