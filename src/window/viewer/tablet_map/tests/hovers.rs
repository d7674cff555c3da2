//! A thousand hovers: circles, lines, spirals, trembling, wandering, at any speed, seen by windows
//! of 5 to 144 frames a second over delays of up to 400 ms. No map that is believed is wrong.

use std::f64::consts::TAU;

use super::*;

/// Greatest error of a map, in pixels, over the tablet area around the pen.
const MOST_OFF: f64 = 2.0;

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

type Path = Box<dyn Fn(f64) -> DVec2>;

/// Returns a path of a pen: its position at a time in seconds.
fn path(kind: usize, r: &mut Random) -> (&'static str, Path) {
    let middle = DVec2::new(r.within(0.35, 0.65), r.within(0.35, 0.65));
    let (w, phase) = (r.within(0.5, 14.0), r.within(0.0, TAU));
    let size = DVec2::new(r.within(0.03, 0.3), r.within(0.03, 0.3));
    let at = move |x: f64, y: f64| middle + size * DVec2::new(x, y);
    match kind % 6 {
        0 => ("circle", Box::new(move |t| at((w * t + phase).cos(), (w * t + phase).sin()))),
        1 => {
            let turn = r.within(0.0, TAU);
            (
                "line",
                Box::new(move |t| at(turn.cos(), turn.sin()).lerp(middle, (w * t).sin() + 1.0)),
            )
        }
        2 => (
            "spiral",
            Box::new(move |t| {
                let grown = 0.2 + 0.8 * (0.5 - 0.5 * (t * 0.7).cos());
                at(grown * (w * t + phase).cos(), grown * (w * t + phase).sin())
            }),
        ),
        3 => (
            "trembling",
            Box::new(move |t| {
                middle
                    + DVec2::new(
                        (9.0 * t).sin() + (23.0 * t).cos(),
                        (11.0 * t).cos() + (29.0 * t).sin(),
                    ) * 0.004
            }),
        ),
        4 => {
            let (a, b) = (r.within(0.4, 3.0), r.within(0.4, 3.0));
            (
                "wandering",
                Box::new(move |t| {
                    at(
                        0.7 * (a * t + phase).sin() + 0.3 * (2.7 * b * t).cos(),
                        0.7 * (1.3 * b * t).cos() + 0.3 * (3.1 * a * t).sin(),
                    )
                }),
            )
        }
        _ => {
            let places: Vec<DVec2> =
                (0..12).map(|_| at(r.within(-1.0, 1.0), r.within(-1.0, 1.0))).collect();
            let pace = r.within(0.3, 1.5);
            (
                "stops",
                Box::new(move |t| {
                    let (i, part) = ((t / pace) as usize, (t / pace).fract());
                    let s = (part / 0.6).min(1.0);
                    places[i % 12].lerp(places[(i + 1) % 12], s * s * (3.0 - 2.0 * s))
                }),
            )
        }
    }
}

/// Returns the error of a map around the pen's positions, in pixels.
fn off(map: &ScreenMap, truth: &ScreenMap, shares: &[DVec2]) -> f64 {
    let least = shares.iter().copied().fold(DVec2::MAX, DVec2::min);
    let most = shares.iter().copied().fold(DVec2::MIN, DVec2::max);
    let (middle, half) = ((least + most) * 0.5, (most - least).max(DVec2::splat(0.1)));
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    let at = |(x, y): (f64, f64)| (middle + half * DVec2::new(x, y)).clamp(DVec2::ZERO, DVec2::ONE);
    corners.into_iter().map(at).map(|c| map.at(c).distance(truth.at(c))).fold(0.0, f64::max)
}

#[test]
fn no_map_that_is_believed_is_wrong() {
    let trials = if std::env::var_os("SCULPTD_LONG").is_some() { 1000 } else { 36 };
    let maps = [
        whole_desktop(),
        ScreenMap {
            origin: DVec2::new(3840.0, 1080.0),
            across: DVec2::new(-1920.0, 0.0),
            down: DVec2::new(0.0, -1080.0),
        },
        ScreenMap {
            origin: DVec2::new(1200.0, 30.0),
            across: DVec2::new(0.0, 700.0),
            down: DVec2::new(-900.0, 0.0),
        },
        ScreenMap {
            origin: DVec2::new(256.0, 108.0),
            across: DVec2::new(768.0, 0.0),
            down: DVec2::new(0.0, 504.0),
        },
    ];
    let mut r = Random(7);
    let mut wrong = Vec::new();
    let mut known: std::collections::BTreeMap<(&str, u32), Vec<Option<f64>>> = Default::default();
    let mut worst = 0.0f64;
    for trial in 0..trials {
        let (name, place) = path(trial, &mut r);
        let rate = [5.0, 10.0, 30.0, 60.0, 144.0][trial / 6 % 5];
        let delay = [0.0, 0.008, 0.03, 0.1, 0.2, 0.4][trial / 30 % 6];
        let jitter = r.within(0.0, 0.006);
        let truth = maps[trial % maps.len()];
        let mut map = TabletMap::default();
        let (mut next, mut shares, mut first) = (1.5, Vec::new(), None);
        let seconds = if rate < 20.0 { 30.0 } else { 12.0 };
        for i in 0..(seconds * 133.0) as u64 {
            let t = 1.0 + i as f64 / 133.0;
            let share = place(t);
            map.pen((t * 1e6) as u64, Some(share), false);
            if t < next {
                continue;
            }
            next += 1.0 / rate;
            shares.push(place(t - delay));
            let seen = truth.at(place(t - delay - r.within(-jitter, jitter))).round();
            map.pointer((t * 1e6) as u64, seen);
            if let Some(found) = map.map() {
                first.get_or_insert(t - 1.5);
                let far = off(found, &truth, &shares);
                worst = worst.max(far);
                if far > MOST_OFF {
                    wrong.push(format!("{name} at {rate}/s, {delay} s late: {far:.1} at {t:.2} s"));
                    break;
                }
            }
        }
        known.entry((name, rate as u32)).or_default().push(first);
    }
    for ((name, rate), all) in &known {
        let mut times: Vec<f64> = all.iter().flatten().copied().collect();
        times.sort_by(f64::total_cmp);
        let middle = times.get(times.len() / 2).copied().unwrap_or(f64::NAN);
        println!(
            "{name:10} {rate:3}/s: {}/{} known, median after {middle:.2} s",
            times.len(),
            all.len()
        );
    }
    println!("{trials} hovers, the worst believed map {worst:.2} pixels off");
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
}
