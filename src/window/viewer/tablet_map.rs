//! Where on the screen a desktop puts the pen of a tablet, learned from pairs: a share of the
//! tablet's area, and the desktop's pointer at that time.
//!
//! The desktop's map is affine (an area that is cropped, turned, laid over one screen or several),
//! so it is fitted by least squares. Two things make a pair worth less: the pointer follows the pen
//! some milliseconds later, which matters the more the faster the pen is, and a mouse may have
//! moved the pointer. The delay is found by trying several; pairs far from the map are left out of
//! a second fit (Rousseeuw and Leroy, Robust Regression and Outlier Detection, 1987, reweighting).

use std::collections::VecDeque;

use glam::{DMat3, DVec2, DVec3, Vec2};

use sculptd_devices::DeviceId;
use sculptd_devices::prediction::PenPredictor;
use sculptd_engine::desktop_layout::DesktopLayout;

/// Pairs that are remembered: some ten seconds of motion, so that they span much of the tablet.
const PAIRS: usize = 1024;
/// Microseconds between two pairs: closer ones say nothing new of the map.
const APART_US: u64 = 6_000;
/// A new fit is made after so large a part of the pairs has come anew, and never after fewer than
/// half of [`LEAST`].
const FRESH: usize = 16;
/// Pairs with which a first map is tried.
const LEAST: usize = 12;
/// Places of the pen that are remembered, for looking back by the delay: half a minute at 250 Hz.
const TRAIL: usize = 8192;
/// Delays of the pointer behind the pen that are tried: so many, by this step in microseconds. A
/// pen at a thousand pixels a second is two pixels on in half a step.
const DELAYS: (u64, u64) = (31, 4_000);
/// A map is believed while its pairs lie within so many pixels of it, in the median.
const BELIEVED: f64 = 3.0;
/// No map fits: the pointer does not follow the pen.
const WILD: f64 = 24.0;
/// Pairs beyond so many medians are not the pen's.
const OUTLIER: f64 = 4.0;
/// The part of the tablet, in shares, that the pairs must span in both directions: over less, the
/// map's far corners would be guessed.
const LEAST_SPAN: f64 = 0.02;
/// A pen's pointer may be this far from where the map puts it, pixels: beyond, it is a mouse's.
const NEAR: f64 = 32.0;
/// So long may the pointer's events lie behind the pen, microseconds, in a window that takes its
/// events at once.
const LATE_US: u64 = 250_000;
/// A pen that has not moved for so long is where its pointer is, whatever the delay, microseconds.
const HALTED_US: u64 = 120_000;
/// What a pair of another pen is worth beside one of a pen that has halted.
const MOVING: f64 = 0.1;
/// Pairs that are looked at for whether the desktop has another map than before.
const NEWEST: usize = 2 * LEAST;

/// From shares of a tablet's area to pixels of the whole desktop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenMap {
    /// Where the area's top left corner lies.
    pub origin: DVec2,
    /// The area's upper edge, from left to right.
    pub across: DVec2,
    /// The area's left edge, from top to bottom.
    pub down: DVec2,
}

impl ScreenMap {
    /// Where a share of the area lies, pixels.
    pub fn at(&self, share: DVec2) -> DVec2 {
        self.origin + self.across * share.x + self.down * share.y
    }
}

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
    /// Another window has the keyboard.
    pub(super) unfocused: bool,
    /// When every event that waited was last taken, microseconds.
    pub(super) taken_us: u64,
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
        self.trail.push_back(Place { t_us, share, tip });
        self.predictor.report(t_us, share);
        if self.trail.len() > TRAIL {
            self.trail.pop_front();
        }
    }

    /// The pointer has moved here, in pixels of the whole desktop, while the pen was in range.
    pub fn pointer(&mut self, t_us: u64, at: DVec2) {
        if self.trail.back().is_none_or(|p| p.share.is_none()) {
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
        let enough = (self.pairs.len() / FRESH).max(LEAST / 2);
        if self.fresh >= enough && self.pairs.len() >= LEAST {
            self.fresh = 0;
            self.learn(t_us);
        }
    }

    /// Where the pen goes from its last report.
    pub fn predictor(&self) -> &PenPredictor {
        &self.predictor
    }

    /// The map, once it is known.
    pub fn map(&self) -> Option<&ScreenMap> {
        self.map.as_ref()
    }

    /// The pointer's delay behind the pen, microseconds, and how far the pairs lie from the map,
    /// pixels, in the median.
    pub fn fit(&self) -> (u64, f64) {
        self.fit
    }

    /// Whether the pointer moves in this visit and nothing is known yet of why.
    pub fn is_undecided(&self) -> bool {
        self.map.is_none() && self.together && !self.apart
    }

    /// Whether a pointer at this pixel is this pen's. `since_us`: the window has taken no event
    /// since then, so that the pointer may have been here at any time after it.
    pub fn owns(&self, now_us: u64, since_us: u64, pointer: DVec2) -> bool {
        let Some(map) = &self.map else { return false };
        let oldest = now_us.saturating_sub(LATE_US).min(since_us.saturating_sub(LATE_US));
        // A pen that rests sends nothing: the place before the oldest holds until the next.
        let from = self.trail.partition_point(|p| p.t_us < oldest).saturating_sub(1);
        let places = self.trail.iter().skip(from).filter_map(|p| p.share);
        places.into_iter().any(|share| map.at(share).distance(pointer) <= NEAR)
    }

    /// Whether the newest touch of the pen began before the map was known: the pen did nothing
    /// then, and the pointer sculpts in its place, however late its press is heard of.
    pub fn touched_unknown(&self) -> bool {
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

    fn learn(&mut self, now_us: u64) {
        let oldest = self.trail.front().map_or(0, |p| p.t_us);
        self.pairs.retain(|p| p.t_us >= oldest);
        self.forget_another_map();
        let Some((delay, map, error)) = self.best_map() else { return };
        if error <= BELIEVED {
            if self.map.is_none() {
                self.since_us = now_us;
            }
            (self.map, self.fit, self.apart) = (Some(map), (delay, error), false);
        } else if self.pairs.len() >= 2 * LEAST && error > WILD {
            // A mouse moves the pointer: the map that was known goes only when it is contradicted
            // for long.
            self.apart = true;
            let off = self.map.and_then(|known| self.median(&known, self.fit.0));
            if self.pairs.len() >= PAIRS / 2 && off.is_some_and(|e| e > WILD) {
                self.map = None;
            }
        }
    }

    /// The map with the delay that fits best, that delay, and the median distance of the pairs.
    fn best_map(&self) -> Option<(u64, ScreenMap, f64)> {
        let all = (0..DELAYS.0).filter_map(|i| self.try_delay(i * DELAYS.1));
        let best = all.min_by(|a, b| a.3.total_cmp(&b.3))?;
        Some((best.0, best.1, best.2))
    }

    /// Where the newest pairs contradict the map and agree on another one, the desktop has another
    /// map than before (its area was turned, or a screen was added): the older pairs are dropped.
    fn forget_another_map(&mut self) {
        let Some(known) = self.map.filter(|_| self.pairs.len() > NEWEST) else { return };
        let older = self.pairs.len() - NEWEST;
        let kept: Vec<Pair> = self.pairs.drain(..older).collect();
        let contradicted = self.median(&known, self.fit.0).is_some_and(|e| e > WILD);
        let another = contradicted && self.best_map().is_some_and(|best| best.2 <= BELIEVED);
        if !another {
            kept.into_iter().rev().for_each(|p| self.pairs.push_front(p));
        }
    }

    fn samples(&self, delay_us: u64) -> Vec<(DVec2, DVec2, f64)> {
        self.pairs
            .iter()
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

    fn median(&self, map: &ScreenMap, delay_us: u64) -> Option<f64> {
        median(distances(map, &self.samples(delay_us)))
    }

    /// The map with this delay, and the median and the mean distance of the pairs from it. The mean
    /// tells delays apart: while the pen rests all of them fit.
    fn try_delay(&self, delay_us: u64) -> Option<(u64, ScreenMap, f64, f64)> {
        let all = self.samples(delay_us);
        let first = least_squares(&all)?;
        let middle = median(distances(&first, &all))?;
        let limit = (middle * OUTLIER).max(1.0);
        let kept: Vec<_> =
            all.into_iter().filter(|s| first.at(s.0).distance(s.1) <= limit).collect();
        let map = least_squares(&kept)?;
        let errors = distances(&map, &kept);
        let mean = errors.iter().map(|e| e.0).sum::<f64>() / errors.len() as f64;
        Some((delay_us, map, median(errors)?, mean))
    }
}

/// How far each pair lies from the map, pixels, and what the pair is worth.
fn distances(map: &ScreenMap, pairs: &[(DVec2, DVec2, f64)]) -> Vec<(f64, f64)> {
    pairs
        .iter()
        .map(|(share, pointer, weight)| (map.at(*share).distance(*pointer), *weight))
        .collect()
}

/// The weighted median: pairs of a quick pen say little of a map where the pointer's delay varies,
/// and a few of a pen that rests say much.
fn median(mut all: Vec<(f64, f64)>) -> Option<f64> {
    all.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let half = all.iter().map(|p| p.1).sum::<f64>() / 2.0;
    let mut seen = 0.0;
    let reached = |p: &&(f64, f64)| {
        seen += p.1;
        seen >= half
    };
    all.iter().find(reached).map(|p| p.0)
}

/// The affine map with the least sum of weighted squares; `None` where the places span too little.
fn least_squares(all: &[(DVec2, DVec2, f64)]) -> Option<ScreenMap> {
    if all.len() < LEAST {
        return None;
    }
    let lo = all.iter().fold(DVec2::INFINITY, |m, s| m.min(s.0));
    let hi = all.iter().fold(DVec2::NEG_INFINITY, |m, s| m.max(s.0));
    if (hi - lo).min_element() < LEAST_SPAN {
        return None;
    }
    let middle = (lo + hi) * 0.5;
    let (mut normal, mut x, mut y) = (DMat3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for (share, pointer, weight) in all {
        let row = (*share - middle).extend(1.0);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z) * *weight;
        x += row * (pointer.x * weight);
        y += row * (pointer.y * weight);
    }
    let inverse = normal.inverse();
    if !inverse.is_finite() {
        return None;
    }
    let (x, y) = (inverse * x, inverse * y);
    let (across, down) = (DVec2::new(x.x, y.x), DVec2::new(x.y, y.y));
    let origin = DVec2::new(x.z, y.z) - across * middle.x - down * middle.y;
    Some(ScreenMap { origin, across, down })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The greatest distance between the corners of two maps, pixels.
    fn differs(a: &ScreenMap, b: &ScreenMap) -> f64 {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        corners.into_iter().map(|c| a.at(c).distance(b.at(c))).fold(0.0, f64::max)
    }

    /// A pen that goes from place to place over its tablet for a second at 133 Hz and halts at
    /// each, as hands do, and a desktop that follows it `delay_us` later in whole pixels.
    fn hover(truth: &ScreenMap, delay_us: u64, mouse: bool) -> TabletMap {
        let stops = [[0.3, 0.4], [0.55, 0.45], [0.5, 0.62], [0.28, 0.6], [0.42, 0.5], [0.5, 0.4]];
        let place = |t_us: u64| {
            let t = (t_us as f64 * 1e-6 - 0.9).max(0.0) * 4.0;
            let (i, part) = ((t as usize).min(stops.len() - 2), t.fract());
            let s = (part / 0.6).min(1.0);
            let [a, b] = [stops[i], stops[i + 1]].map(|p| DVec2::new(p[0], p[1]));
            a.lerp(b, s * s * (3.0 - 2.0 * s))
        };
        let mut map = TabletMap::default();
        for i in 0..133u64 {
            let t_us = 1_000_000 + i * 7_500;
            map.pen(t_us, Some(place(t_us)), false);
            let mut at = truth.at(place(t_us - delay_us)).round();
            if mouse && i % 9 == 0 {
                at += DVec2::new(300.0, -120.0);
            }
            map.pointer(t_us, at);
        }
        map
    }

    /// The tablet's area covers a desktop of 1280 by 720 pixels.
    fn whole() -> ScreenMap {
        ScreenMap {
            origin: DVec2::ZERO,
            across: DVec2::new(1280.0, 0.0),
            down: DVec2::new(0.0, 720.0),
        }
    }

    #[test]
    fn the_map_is_right_to_two_pixels_after_a_second() {
        let plain = ScreenMap {
            origin: DVec2::ZERO,
            across: DVec2::new(1920.0, 0.0),
            down: DVec2::new(0.0, 1080.0),
        };
        // The right one of two screens, and a tablet that lies upside down.
        let turned = ScreenMap {
            origin: DVec2::new(3840.0, 1080.0),
            across: DVec2::new(-1920.0, 0.0),
            down: DVec2::new(0.0, -1080.0),
        };
        let portrait = ScreenMap {
            origin: DVec2::new(1200.0, 30.0),
            across: DVec2::new(0.0, 700.0),
            down: DVec2::new(-900.0, 0.0),
        };
        for truth in [plain, turned, portrait] {
            for delay_us in [0, 5_000, 16_000, 40_000] {
                for mouse in [false, true] {
                    let learned = hover(&truth, delay_us, mouse);
                    let map = learned.map().expect("a map");
                    // Where the pen has been; and the far corners, which it has not seen.
                    for share in [DVec2::new(0.3, 0.4), DVec2::new(0.55, 0.6)] {
                        let off = map.at(share).distance(truth.at(share));
                        assert!(off < 2.0, "{off} pixels with {delay_us} us, mouse {mouse}");
                    }
                    let far = differs(map, &truth);
                    assert!(far < 12.0, "{far} pixels at the corners");
                }
            }
        }
    }

    #[test]
    fn a_mouse_beside_a_pen_teaches_nothing_and_is_not_the_pen() {
        let mut map = TabletMap::default();
        for i in 0..200u64 {
            let t = i as f64 * 0.03;
            map.pen(i * 8_000, Some(DVec2::new(0.5 + 0.2 * t.sin(), 0.5 + 0.2 * t.cos())), false);
            let mouse = DVec2::new((i * 37 % 900) as f64, (i * 61 % 700) as f64);
            map.pointer(i * 8_000, mouse);
        }
        assert!(map.map().is_none() && !map.is_undecided(), "{:?}", map.fit());
        assert!(!map.owns(1_600_000, 1_600_000, DVec2::new(500.0, 400.0)));
    }

    #[test]
    fn the_pointer_is_the_pens_only_near_where_the_map_puts_it() {
        let truth = ScreenMap {
            origin: DVec2::new(10.0, 20.0),
            across: DVec2::new(1500.0, 0.0),
            down: DVec2::new(0.0, 900.0),
        };
        let map = hover(&truth, 8_000, false);
        let Some(&Place { t_us: now, share: Some(last), .. }) = map.trail.back() else { panic!() };
        assert!(map.owns(now, now, truth.at(last) + DVec2::new(5.0, 5.0)));
        // It rests for a minute and is still there.
        assert!(map.owns(now + 60_000_000, now + 60_000_000, truth.at(last)));
        assert!(!map.owns(now, now, truth.at(last) + DVec2::new(400.0, 0.0)));
        // The window has taken no event for half a second: the pointer is where the pen was.
        let early = map.share_at(now - 500_000).expect("a place");
        assert!(truth.at(early).distance(truth.at(last)) > 2.0 * NEAR);
        assert!(!map.owns(now, now, truth.at(early)));
        assert!(map.owns(now, now - 500_000, truth.at(early)));
    }

    #[test]
    fn a_slow_window_learns_the_map_from_the_pens_every_place() {
        let truth = ScreenMap {
            origin: DVec2::new(-40.0, 12.0),
            across: DVec2::new(1300.0, 0.0),
            down: DVec2::new(0.0, 740.0),
        };
        let place = |t_us: u64| {
            let t = t_us as f64 * 1e-6;
            DVec2::new(0.5 + 0.2 * (2.1 * t).sin(), 0.5 + 0.2 * (3.3 * t).cos())
        };
        let mut map = TabletMap::default();
        for i in 0..600u64 {
            let t_us = i * 8_000;
            map.pen(t_us, Some(place(t_us)), false);
            // A frame takes a quarter of a second, and the pointer is 48 ms late.
            if i % 31 == 30 {
                map.pointer(t_us, truth.at(place(t_us - 48_000)).round());
            }
        }
        let off = differs(map.map().expect("a map"), &truth);
        assert!(off < 3.0, "{off} pixels at the corners");
    }

    #[test]
    fn a_pen_that_rests_now_and_then_teaches_the_map_though_the_delay_varies() {
        let truth = ScreenMap {
            origin: DVec2::new(-40.0, 12.0),
            across: DVec2::new(1300.0, 0.0),
            down: DVec2::new(0.0, 740.0),
        };
        let stops = [[0.3, 0.4], [0.6, 0.45], [0.5, 0.65]].map(|p| DVec2::new(p[0], p[1]));
        let place = |t_us: u64| {
            let (i, part) = ((t_us / 500_000) as usize, (t_us % 500_000) as f64 / 500_000.0);
            stops[i % 3].lerp(stops[(i + 1) % 3], (part / 0.5).min(1.0))
        };
        let mut map = TabletMap::default();
        for i in 0..1000u64 {
            let t_us = 1_000_000 + i * 8_000;
            map.pen(t_us, Some(place(t_us)), false);
            if i % 23 == 22 {
                // From nothing to 120 ms, without any order.
                let late_us = i * 7919 % 120 * 1000;
                map.pointer(t_us, truth.at(place(t_us - late_us)).round());
            }
        }
        let off = differs(map.map().expect("a map"), &truth);
        assert!(off < 4.0, "{off} pixels at the corners");
    }

    #[test]
    fn another_map_of_the_desktop_is_learned_within_a_second_of_hovering() {
        let before = whole();
        let after = ScreenMap {
            origin: DVec2::new(1280.0, 720.0),
            across: DVec2::new(-1280.0, 0.0),
            down: DVec2::new(0.0, -720.0),
        };
        let place = |t_us: u64| {
            let t = t_us as f64 * 1e-6;
            DVec2::new(0.5 + 0.2 * (3.1 * t).sin(), 0.5 + 0.2 * (4.3 * t).cos())
        };
        let mut map = TabletMap::default();
        for i in 0..1200u64 {
            let t_us = i * 8_000;
            map.pen(t_us, Some(place(t_us)), false);
            let truth = if i < 1075 { &before } else { &after };
            map.pointer(t_us, truth.at(place(t_us - 16_000)).round());
        }
        let off = differs(map.map().expect("a map"), &after);
        assert!(off < 3.0, "{off} pixels at the corners after a second");
    }

    #[test]
    fn a_touch_before_the_map_was_known_is_the_pointers() {
        let truth = whole();
        let mut map = hover(&truth, 8_000, false);
        let now = map.trail.back().expect("a place").t_us;
        assert!(!map.touched_unknown(), "it has not touched");
        let share = Some(DVec2::splat(0.5));
        map.pen(now + 8_000, share, true);
        assert!(!map.touched_unknown());
        map.since_us = now + 20_000;
        assert!(map.touched_unknown());
        map.pen(now + 30_000, share, false);
        map.pen(now + 40_000, share, true);
        assert!(!map.touched_unknown(), "the next one is the pen's");
    }
}
