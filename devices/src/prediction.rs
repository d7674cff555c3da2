//! Predicts a pen's position when a frame is seen: a Kalman filter for each axis (Kalman 1960) over
//! place, speed and acceleration, driven by white noise of the jerk (the model of Singer 1970 in
//! its limit; Bar-Shalom, Li and Kirubarajan 2001, section 6.2.3). Google's ink-stroke-modeler
//! predicts strokes by such a filter as well.
//!
//! Predictions are only shown: none becomes a [`crate::Sample`].
//!
//! Laws kept here:
//! * The prediction for a braking pen ends where the pen would stop.
//! * An uncertain prediction is shortened, and a resting pen has none.
//! * A gap of [`STALE_US`] or a pen that left restarts the filter.

use glam::DVec2;

/// Gap, in microseconds, after which the filter restarts and nothing is predicted.
pub const STALE_US: u64 = 100_000;
/// Never further ahead than this, microseconds.
pub const FURTHEST_US: u64 = 60_000;
/// Reports before which nothing is predicted.
const FIRST: u32 = 5;
/// The noise of a report, as a share of the tablet's area: 0.05 mm on one 160 mm wide.
const NOISE: f64 = 3e-4;
/// The density of the jerk's noise, shares squared a second to the fifth: strokes of a hand at 1 to
/// 3 Hz over a third of a tablet have a tenth of the error that they have without prediction.
const JERK: f64 = 2e3;
/// Initial uncertainty of speed and acceleration, in shares per second and per second squared.
const AT_FIRST: (f64, f64) = (5.0, 50.0);
/// The share of the acceleration that is believed to last.
const LASTING: f64 = 0.6;
/// Least prediction, in its standard deviations, that is shown; a shorter one counts as none.
const SURE: f64 = 2.0;

/// The three numbers of one axis and how far they are trusted; the covariance is the same for both
/// axes and kept beside.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct AxisState {
    place: f64,
    speed: f64,
    acceleration: f64,
}

/// Motion of one pen, learned from its reports.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PenPredictor {
    axes: [AxisState; 2],
    /// Covariance of place, speed and acceleration; symmetric.
    covariance: [[f64; 3]; 3],
    /// Time of the last report, in microseconds; its position is `last`.
    last_us: Option<u64>,
    last: DVec2,
    reports: u32,
}

impl PenPredictor {
    /// A report: where the pen is, as shares of the tablet's area; `None`: it left the range.
    /// Reports that are not newer than the last one are ignored.
    pub fn report(&mut self, t_us: u64, at: Option<DVec2>) {
        let Some(at) = at.filter(|at| at.is_finite()) else {
            *self = PenPredictor::default();
            return;
        };
        let since = self.last_us.map(|last| t_us.saturating_sub(last));
        if since == Some(0) {
            return;
        }
        match since.filter(|us| *us <= STALE_US) {
            None => self.begin(at),
            Some(us) => self.update(us as f64 * 1e-6, at),
        }
        (self.last_us, self.last) = (Some(t_us), at);
        self.reports = self.reports.saturating_add(1);
    }

    fn begin(&mut self, at: DVec2) {
        let axis = |place| AxisState { place, ..AxisState::default() };
        let (speed, acceleration) = AT_FIRST;
        *self = PenPredictor {
            axes: at.to_array().map(axis),
            covariance: [
                [NOISE * NOISE, 0.0, 0.0],
                [0.0, speed * speed, 0.0],
                [0.0, 0.0, acceleration * acceleration],
            ],
            ..PenPredictor::default()
        };
    }

    /// One step of the filter over `dt` seconds.
    fn update(&mut self, dt: f64, at: DVec2) {
        let step = [[1.0, dt, dt * dt / 2.0], [0.0, 1.0, dt], [0.0, 0.0, 1.0]];
        let p = &self.covariance;
        // step * p * step^T + noise
        let mut ahead = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                for k in 0..3 {
                    for l in 0..3 {
                        ahead[i][j] += step[i][k] * p[k][l] * step[j][l];
                    }
                }
                // Of white jerk: dt^n / (n (2 - i)! (2 - j)!) with n = 5 - i - j.
                let power = 5 - i - j;
                let halves = [2.0, 1.0, 1.0];
                ahead[i][j] +=
                    JERK * dt.powi(power as i32) / (power as f64 * halves[i] * halves[j]);
            }
        }
        let gain = [0, 1, 2].map(|i| ahead[i][0] / (ahead[0][0] + NOISE * NOISE));
        for (axis, seen) in self.axes.iter_mut().zip(at.to_array()) {
            let place = axis.place + (axis.speed + axis.acceleration * dt / 2.0) * dt;
            let off = seen - place;
            axis.place = place + gain[0] * off;
            axis.speed += axis.acceleration * dt + gain[1] * off;
            axis.acceleration += gain[2] * off;
        }
        for i in 0..3 {
            for j in 0..3 {
                self.covariance[i][j] = ahead[i][j] - gain[i] * ahead[0][j];
            }
        }
    }

    /// Returns the predicted position at a time, in shares of the tablet's area; `None` out of
    /// range.
    pub fn place_at(&self, t_us: u64) -> Option<DVec2> {
        self.last_us.map(|_| self.last + self.ahead(t_us))
    }

    /// Returns the predicted movement since the last report, in shares of the tablet's area; zero
    /// if it is unknown.
    pub fn ahead(&self, t_us: u64) -> DVec2 {
        let Some(last) = self.last_us.filter(|_| self.reports > FIRST) else { return DVec2::ZERO };
        let by = t_us.saturating_sub(last);
        if by > STALE_US {
            return DVec2::ZERO;
        }
        let whole = by.min(FURTHEST_US) as f64 * 1e-6;
        let [x, y] = &self.axes;
        let speed = DVec2::new(x.speed, y.speed);
        let acceleration = DVec2::new(x.acceleration, y.acceleration) * LASTING;
        let quick = speed.length();
        // Braking: no further than to where it stands.
        let braking = if quick > 0.0 { -speed.dot(acceleration) / quick } else { 0.0 };
        let time = if braking * whole > quick { quick / braking } else { whole };
        let way = (speed + acceleration * (time / 2.0)) * time;
        let [_, [_, of_speed, both], [_, _, of_acceleration]] = self.covariance;
        let half = whole / 2.0;
        let variance = of_speed + 2.0 * half * both + half * half * of_acceleration;
        let unsure = SURE * variance.max(0.0).sqrt() * whole;
        let length = way.length();
        if length > unsure { way * (1.0 - (unsure / length).powi(2)) } else { DVec2::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number from -1 to 1 that only `i` decides.
    fn noise(i: u64) -> f64 {
        let mut x = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678;
        x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Root mean square distances from where the pen is `ahead_us` later, without and with
    /// prediction, and the greatest of the latter.
    fn errors(path: &dyn Fn(f64) -> DVec2, rate: u64, ahead_us: u64) -> [f64; 3] {
        let mut pen = PenPredictor::default();
        let (mut plain, mut led, mut most, mut count) = (0.0, 0.0, 0.0f64, 0.0);
        for i in 0..2 * rate {
            // Reports come at uneven times.
            let t = i * 1_000_000 / rate + ((noise(i) + 1.0) * 1000.0) as u64;
            let s = |t: u64| path(t as f64 * 1e-6);
            let at = s(t) + DVec2::new(noise(3 * i + 1), noise(3 * i + 2)) * 1e-4;
            pen.report(t, Some(at));
            if i > 10 {
                let there = s(t + ahead_us);
                let off = (at + pen.ahead(t + ahead_us)).distance(there);
                plain += at.distance_squared(there);
                led += off * off;
                most = most.max(off);
                count += 1.0;
            }
        }
        [(plain / count).sqrt(), (led / count).sqrt(), most]
    }

    #[test]
    fn a_stroke_is_led_by_the_latency() {
        let tau = std::f64::consts::TAU;
        let curve = |t: f64| {
            DVec2::new(0.3 + 0.15 * (tau * 2.0 * t).sin(), 0.5 + 0.1 * (tau * 1.3 * t).sin())
        };
        for rate in [60, 133, 266, 1000] {
            let [plain, led, _] = errors(&curve, rate, 30_000);
            println!("{rate} Hz: {led:.5} of {plain:.5}");
            assert!(led < 0.25 * plain, "{rate} Hz: {led} of {plain}");
        }
    }

    #[test]
    fn a_pen_that_halts_is_hardly_led_past_its_place_and_one_that_rests_not_at_all() {
        // A smooth step to a place and a halt there.
        let halt = |t: f64| {
            let s = ((t - 0.3) / 1.0).clamp(0.0, 1.0);
            DVec2::new(0.2 + 0.6 * s * s * (3.0 - 2.0 * s), 0.3)
        };
        let [plain, led, most] = errors(&halt, 133, 30_000);
        println!("{led:.5} of {plain:.5}, {most:.5} at most");
        assert!(led < 0.3 * plain && most < 0.012);
        let mut rests = PenPredictor::default();
        for i in 0..200u64 {
            let tremble = DVec2::new(noise(2 * i), noise(2 * i + 1)) * 1e-4;
            rests.report(i * 7500, Some(DVec2::splat(0.4) + tremble));
            assert!(rests.ahead(i * 7500 + 30_000).length() < 2e-3, "report {i}");
        }
    }

    #[test]
    fn a_pen_that_left_or_fell_silent_is_not_led() {
        let mut pen = PenPredictor::default();
        let at = |i: u64| Some(DVec2::new(0.2 + 0.005 * i as f64, 0.5));
        (0..20).for_each(|i| pen.report(i * 5000, at(i)));
        let last = 19 * 5000;
        assert!(pen.ahead(last + 20_000).x > 0.015, "{:?}", pen.ahead(last + 20_000));
        assert_eq!(pen.ahead(last + STALE_US + 1), DVec2::ZERO);
        let mut gone = pen;
        gone.report(last + 5000, None);
        assert_eq!(gone.ahead(last + 10_000), DVec2::ZERO);
        // After a gap it knows nothing of its speed.
        pen.report(last + STALE_US + 1, at(40));
        assert_eq!(pen.ahead(last + STALE_US + 20_000), DVec2::ZERO);
        // The same report twice, and one from before.
        let mut twice = pen;
        twice.report(last + STALE_US + 1, at(90));
        assert_eq!(twice, pen);
    }
}
