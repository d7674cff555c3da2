//! Where on the screen a desktop puts the pen of a tablet, learned from pairs: a share of the
//! tablet's area, and the desktop's pointer at that time.
//!
//! The desktop's map is affine (an area that is cropped, turned, laid over one screen or several),
//! so it is fitted by least squares. Two things make a pair worth less: the pointer follows the pen
//! some milliseconds later, which matters the more the faster the pen is, and a mouse may have
//! moved the pointer. The delay is found by trying several; pairs far from the map are left out of
//! a second fit (Rousseeuw and Leroy, Robust Regression and Outlier Detection, 1987, reweighting).
//! A map is believed only where the motion tells it from a delay: [`super::map_fit`].

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
/// A new fit is made after so large a part of the pairs has come anew, and never after fewer than
/// half of [`LEAST`].
const FRESH: usize = 8;
/// The same once a map is known.
const KNOWN_FRESH: usize = 2;
/// Places of the pen that are remembered, for looking back by the delay: half a minute at 250 Hz.
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
/// So long may the pointer's events lie behind the pen, microseconds, in a window that takes its
/// events at once.
pub(super) const LATE_US: u64 = 250_000;
/// A touch of the pen and the press that the desktop makes of it may lie so far apart on a machine
/// that is busy, microseconds.
const PRESS_US: u64 = 2_000_000;
/// Touches that no press has followed yet are remembered up to so many.
const TOUCHES: usize = 16;
/// A pen that has not moved for so long is where its pointer is, whatever the delay, microseconds.
const HALTED_US: u64 = 120_000;
/// What a pair of another pen is worth beside one of a pen that has halted.
const MOVING: f64 = 0.1;
/// At most so many of the newest pairs are looked at for whether the desktop has another map than
/// before.
const NEWEST: usize = 8 * LEAST;
/// So many pairs in turn that agree with the map end a contradiction.
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

/// Where the pen was at one time.
#[derive(Debug, Clone, Copy)]
struct Place {
    t_us: u64,
    /// Shares of the area; `None` out of range.
    share: Option<DVec2>,
    tip: bool,
}

/// What is known of one tablet.
#[derive(Debug, Default)]
pub struct TabletMap {
    trail: VecDeque<Place>,
    /// When and at which pixel the pen has touched by the map, before a press of the pointer has
    /// followed. The pen's own samples sculpt there, whatever becomes of the map.
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
    /// When the first of the pairs was taken that contradict the map, microseconds.
    contradicted_us: Option<u64>,
    /// Pairs in turn that agree with the map.
    agree: usize,
    /// Pairs since the map was doubted, while no other is known.
    doubts: usize,
    /// When the map became known, microseconds.
    since_us: u64,
    /// Where the pen goes.
    predictor: PenPredictor,
}

/// What the window knows of the tablets.
#[derive(Debug, Default)]
pub(super) struct Tablets {
    pub(super) known: Vec<(DeviceId, TabletMap)>,
    /// Those whose pen is in range.
    pub(super) in_range: Vec<DeviceId>,
    /// Where the pointer was when it was last paired with the pens.
    pub(super) paired: Option<Vec2>,
    pub(super) sent: DesktopLayout,
    /// When every event that waited was last taken, microseconds.
    pub(super) taken_us: u64,
    /// When a key of a pad was pressed that no press of the pointer has followed yet, microseconds.
    pub(super) key_us: Option<u64>,
}

impl Tablets {
    /// Whether the desktop moves its pointer by the pen of a tablet, or may do so.
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

    /// Where the pen goes from its last report.
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

    /// Whether the pointer moves in this visit and nothing is known yet of why.
    pub fn is_undecided(&self) -> bool {
        self.map().is_none() && self.together && !self.apart
    }

    /// Whether a pointer at this pixel is this pen's. `since_us`: the window has taken no event
    /// since then, so that the pointer may have been here at any time after it.
    pub fn owns(&self, now_us: u64, since_us: u64, pointer: DVec2) -> bool {
        let Some(map) = self.map() else { return false };
        let oldest = now_us.saturating_sub(LATE_US).min(since_us.saturating_sub(LATE_US));
        // A pen that rests sends nothing: the place before the oldest holds until the next.
        let from = self.trail.partition_point(|p| p.t_us < oldest).saturating_sub(1);
        let places = self.trail.iter().skip(from).filter_map(|p| p.share);
        places.into_iter().any(|share| map.at(share).distance(pointer) <= NEAR)
    }

    /// Whether a press of the pointer at this pixel is this pen's: where it touched a while ago,
    /// and no press has followed yet, or where it is.
    pub fn takes_press(&mut self, now_us: u64, since_us: u64, pointer: DVec2) -> bool {
        let oldest = now_us.min(since_us).saturating_sub(PRESS_US);
        self.touches.retain(|t| t.0 >= oldest);
        let touch = self.touches.iter().position(|t| t.1.distance(pointer) <= NEAR);
        if let Some(touch) = touch {
            self.touches.drain(..=touch);
        }
        touch.is_some() || self.owns(now_us, since_us, pointer) && !self.touched_unknown()
    }

    /// Whether the newest touch of the pen began before the map was known: the pen did nothing
    /// then, and the pointer sculpts in its place, however late its press is heard of.
    fn touched_unknown(&self) -> bool {
        let newest = self.trail.iter().rposition(|p| p.tip);
        let Some(end) = newest else { return false };
        let begin = self.trail.iter().take(end).rposition(|p| !p.tip).map_or(0, |i| i + 1);
        self.trail[begin].t_us < self.since_us
    }

    /// Where the pen was at a time, between two places; `None` before the trail and out of range.
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

    /// Whether the pen has rested since some time before the last pair: the pointer was told where
    /// it is, and what moves it now is a mouse.
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
        // Where the newest pairs contradict the map that was known, they may do so because it was
        // guessed from few; or else the pairs are of two maps, the older ones the more.
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

    /// Where the newest pairs contradict the map and agree on another one, the desktop has another
    /// map than before (its area was turned or cropped, or a screen was added): the older pairs are
    /// dropped. Where they agree on none yet the map is doubted. A stroke goes on by the map with
    /// which it began.
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

    /// How many of the newest pairs there are since the map was contradicted.
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

    /// Whether the newest pairs lie far from a map, whatever the delay is taken to be.
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
