use super::*;

mod hovers;

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
fn whole_desktop() -> ScreenMap {
    ScreenMap { origin: DVec2::ZERO, across: DVec2::new(1280.0, 0.0), down: DVec2::new(0.0, 720.0) }
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
                // Positions the pen has visited; and the far corners, which it has not seen.
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
    for i in 0..2000u64 {
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
    let before = whole_desktop();
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
        map.pointer(t_us, truth.at(place(t_us.saturating_sub(16_000))).round());
    }
    let off = differs(map.map().expect("a map"), &after);
    assert!(off < 3.0, "{off} pixels at the corners after a second");
}

#[test]
fn a_touch_before_the_map_was_known_is_the_pointers() {
    let truth = whole_desktop();
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

/// A desktop that moves its pointer by a pen which goes about a place of the tablet and rests for a
/// quarter of a second at each of five places, seen by a window that takes a third of a second for
/// a frame.
struct SlowDesktop {
    map: TabletMap,
    t_us: u64,
    noise: u64,
}

impl SlowDesktop {
    const REPORT_US: u64 = 8_000;

    fn place(t_us: u64) -> DVec2 {
        let stops = [[0.42, 0.36], [0.57, 0.42], [0.56, 0.61], [0.45, 0.55], [0.5, 0.4]];
        let [from, to] = [0, 1].map(|i| DVec2::from(stops[((t_us / 500_000) as usize + i) % 5]));
        let part = (t_us % 500_000) as f64 / 500_000.0;
        from.lerp(to, (part / 0.5).min(1.0))
    }

    fn random(&mut self, below: u64) -> u64 {
        self.noise = self.noise.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.noise >> 33) % below
    }

    /// Shows so many frames with the pen hovering.
    fn frames(&mut self, truth: &ScreenMap, frames: u64) {
        for _ in 0..frames {
            let frame_us = 250_000 + self.random(150_000);
            for _ in 0..frame_us / Self::REPORT_US {
                self.t_us += Self::REPORT_US;
                self.map.pen(self.t_us, Some(Self::place(self.t_us)), false);
            }
            // The pointer is seen where the server had it a while ago.
            let late_us = 8_000 + self.random(90_000);
            self.map.pointer(self.t_us, truth.at(Self::place(self.t_us - late_us)).round());
        }
    }

    /// Returns the error of the map in the hovered area, in pixels; `None` while no map is known.
    fn off(&self, truth: &ScreenMap) -> Option<f64> {
        let map = self.map.map()?;
        let shares = [[0.42, 0.36], [0.57, 0.42], [0.56, 0.61], [0.5, 0.5]];
        let off = shares.map(DVec2::from).map(|s| map.at(s).distance(truth.at(s)));
        Some(off.into_iter().fold(0.0, f64::max))
    }
}

#[test]
fn a_slow_window_learns_a_turned_and_then_a_cropped_area_and_believes_neither_wrongly() {
    let turned = ScreenMap {
        origin: DVec2::new(1280.0, 720.0),
        across: DVec2::new(-1280.0, 0.0),
        down: DVec2::new(0.0, -720.0),
    };
    let cropped = ScreenMap {
        origin: DVec2::new(256.0, 108.0),
        across: DVec2::new(768.0, 0.0),
        down: DVec2::new(0.0, 504.0),
    };
    // By so little that the pointer is still near the pen.
    let shifted = ScreenMap { origin: DVec2::new(268.0, 97.0), ..cropped };
    for noise in 0..20 {
        let mut desktop = SlowDesktop { map: TabletMap::default(), t_us: 1_000_000, noise };
        // Minutes of it, so that many pairs speak for what was before.
        desktop.frames(&whole_desktop(), 600);
        for (name, truth) in [
            ("turned", turned),
            ("cropped", cropped),
            ("shifted", shifted),
            ("whole", whole_desktop()),
        ] {
            let before = desktop.map.map;
            let mut wrong = 0;
            // As many frames as a window of sixty a second shows in one second.
            for _ in 0..60 {
                desktop.frames(&truth, 1);
                wrong += usize::from(desktop.off(&truth).is_some_and(|off| off > 20.0));
            }
            assert!(before.is_some() && wrong <= 20, "{name}: {wrong} frames by the old map");
            let off = desktop.off(&truth).expect("a map");
            assert!(off < 2.0, "{name}, noise {noise}: {off} pixels");
        }
    }
}

#[test]
fn a_mouse_beside_a_pen_that_rests_leaves_the_map_as_it_is() {
    let mut map = hover(&whole_desktop(), 8_000, false);
    let before = *map.map().expect("a map");
    let now = map.trail.back().expect("a place").t_us;
    let rests = DVec2::new(0.5, 0.4);
    for i in 0..400u64 {
        // A hand trembles.
        let share = rests + DVec2::splat((i % 5) as f64 * 4e-4);
        map.pen(now + 8_000 * (i + 1), Some(share), false);
        let mouse = DVec2::new((i * 37 % 900) as f64, (i * 3) as f64);
        // The other hand goes to the mouse.
        let at = if i < 40 { whole_desktop().at(share).round() } else { mouse };
        map.pointer(now + 8_000 * (i + 1), at);
        let off = differs(map.map().expect("a map"), &before);
        assert!(off < 2.0, "{off} pixels");
    }
}

#[test]
fn a_map_is_not_guessed_beside_a_line() {
    let truth = whole_desktop();
    let mut map = TabletMap::default();
    for i in 0..400u64 {
        let share = DVec2::new(0.3, 0.4) + DVec2::new(0.3, 0.2) * (i as f64 / 400.0);
        map.pen(i * 8_000, Some(share), false);
        map.pointer(i * 8_000, truth.at(share).round());
    }
    assert_eq!(map.map(), None);
}

#[test]
fn a_press_that_comes_long_after_the_touch_is_the_pens_once() {
    let mut map = hover(&whole_desktop(), 8_000, false);
    let now = map.trail.back().expect("a place").t_us;
    let touch = DVec2::new(0.3, 0.3);
    for (i, tip) in [(1, false), (2, true), (3, true), (4, false)] {
        map.pen(now + i * 8_000, Some(touch), tip);
    }
    // The pen has gone on before the busy server makes a press of it.
    for i in 5..125 {
        map.pen(now + i * 8_000, Some(DVec2::new(0.7, 0.6)), false);
    }
    let late = now + 125 * 8_000;
    let press = whole_desktop().at(touch);
    assert!(!map.owns(late, late, press));
    assert!(!map.takes_press(late, late, press + DVec2::new(200.0, 0.0)), "a mouse's elsewhere");
    assert!(map.takes_press(late, late, press));
    assert!(!map.takes_press(late, late, press), "a mouse's");
    map.pen(late + 8_000, Some(touch), true);
    map.pen(late + 16_000, None, false);
    assert!(!map.takes_press(late + 3_000_000, late + 3_000_000, press), "a mouse's, later");
}
