//! Resampling: a stroke is a chain of dabs one *spacing* apart, however slow the frame or fast the pen.
//!
//! After Cipollini 2020 ("Fast Digital Sculpting on CPU"), a stroke is sampled every 20 % of the radius, the missing points
//! are placed along the **screen** path, and each is picked anew on the surface. Here the next point is the one on the screen
//! segment whose picked position is one spacing away from the last dab *as it stands now* (the last dab's own view point is
//! picked again after it was applied), found by a guarded bisection, so that perspective, foreshortening and the relief just
//! raised are all accounted for.
//!
//! Laws: dabs of one unbroken run over the surface are never further apart than the spacing (plus the tolerance); where the
//! surface jumps (a silhouette, a hole) the run ends and a new one begins at the first point beyond.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::mesh::Hit;

/// A pen at an instant, mapped to the view.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PenPoint {
    /// View coordinates, (0, 0) top left to (1, 1) bottom right.
    pub view: Vec2,
    /// 0 to 1.
    pub pressure: f32,
    /// Radians, as in [`crate::devices::Pen`].
    pub tilt: Option<Vec2>,
    /// The other end of the pen: what the brush does, the other way round.
    pub inverted: bool,
}

impl PenPoint {
    pub fn lerp(&self, to: &PenPoint, t: f32) -> PenPoint {
        PenPoint {
            view: self.view.lerp(to.view, t),
            pressure: self.pressure + (to.pressure - self.pressure) * t,
            tilt: match (self.tilt, to.tilt) {
                (Some(a), Some(b)) => Some(a.lerp(b, t)),
                (a, b) => b.or(a),
            },
            inverted: to.inverted,
        }
    }
}

/// Whether the budget of this tick allows another dab.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    Go,
    /// Stop here; the rest of the path is walked in the next tick.
    Pause,
}

/// How a pen's path becomes dabs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// One a spacing.
    Spaced,
    /// One a report.
    Each,
    /// The brush is told where the pen is, and does the rest.
    Held,
    /// A straight line, once the pen lifts.
    Line,
    /// A fair curve through what was drawn, once the pen lifts.
    Curve,
}

/// What a stroke is drawn on.
pub trait Surface {
    fn pick(&mut self, view: Vec2) -> Option<Hit>;
    /// The wanted distance between dabs here, mesh units, > 0.
    fn spacing(&self, at: &PenPoint) -> f32;
    /// World length of a step of one view height at the hit's depth.
    fn world_per_view(&self, hit: &Hit) -> f32;
    /// How the pen's path becomes dabs.
    fn way(&self) -> Way {
        Way::Spaced
    }
    /// A held brush: the pen came down here, or is here now.
    fn hold(&mut self, _at: &PenPoint, _began: bool) -> Flow {
        Flow::Go
    }
    /// Applies a dab; `along` is the direction of the stroke on the surface where it has one.
    fn dab(&mut self, at: &PenPoint, hit: &Hit, along: Option<Vec3>) -> Flow;
}

/// A dab is accepted between these shares of the spacing: never above one, so that the law holds with room for rounding.
const ACCEPT: std::ops::RangeInclusive<f32> = 0.94..=1.0;
/// Bisection steps for one dab: 2^-12 of the segment is far below a pixel.
const MAX_BISECTIONS: u32 = 12;
/// Steps over a stretch with no surface are this share of the view: a tenth of a percent finds any visible wall.
const BLIND_STEP: f32 = 0.004;

/// Where a stroke stands between two pen points.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Spacer {
    /// The last dab: its view point and where the surface stood after it.
    last: Option<(Vec2, Vec3)>,
    /// Height and width of the view in the same unit: x is multiplied by this before lengths are taken.
    aspect: f32,
}

impl Spacer {
    pub fn new(aspect: f32) -> Self {
        Spacer { last: None, aspect }
    }

    fn view_length(&self, d: Vec2) -> f32 {
        Vec2::new(d.x * self.aspect, d.y).length()
    }

    /// The pen touches: a dab at once.
    pub fn begin(&mut self, at: &PenPoint, on: &mut dyn Surface) -> Flow {
        self.last = None;
        match on.pick(at.view) {
            Some(hit) => self.place(at, &hit, on),
            None => Flow::Go,
        }
    }

    fn place(&mut self, at: &PenPoint, hit: &Hit, on: &mut dyn Surface) -> Flow {
        let along = self.last.and_then(|(_, p)| (hit.position - p).try_normalize());
        let flow = on.dab(at, hit, along);
        // Where the dab's own point stands now; if the dab folded it out of sight, where it stood.
        let now = on.pick(at.view).map_or(hit.position, |h| {
            let jumped = (h.position - hit.position).length() > 4.0 * on.spacing(at) + 1e-30;
            if jumped { hit.position } else { h.position }
        });
        self.last = Some((at.view, now));
        flow
    }

    /// Walks the segment from `from` to `to`, starting at the share `start` of it. Returns 1 when the whole segment was
    /// walked, else the share at which the budget ended.
    pub fn walk(&mut self, from: &PenPoint, to: &PenPoint, start: f32, on: &mut dyn Surface) -> f32 {
        let length = self.view_length(to.view - from.view);
        let mut t = start;
        if length <= 0.0 || !length.is_finite() {
            return 1.0;
        }
        while t < 1.0 {
            let flow = match self.last {
                Some((_, last)) => match self.next_on_surface(from, to, t, length, last, on) {
                    Step::Dab(at, hit) => {
                        t = at;
                        self.place(&from.lerp(to, at), &hit, on)
                    }
                    Step::Lost(at) => {
                        t = at;
                        self.last = None;
                        Flow::Go
                    }
                    Step::End => return 1.0,
                },
                None => match self.next_after_gap(from, to, t, length, on) {
                    Some((at, hit)) => {
                        t = at;
                        self.place(&from.lerp(to, at), &hit, on)
                    }
                    None => return 1.0,
                },
            };
            if flow == Flow::Pause && t < 1.0 {
                return t;
            }
        }
        1.0
    }

    /// The next point one spacing from `last`, by advancing and bisecting.
    fn next_on_surface(
        &self,
        from: &PenPoint,
        to: &PenPoint,
        start: f32,
        length: f32,
        last: Vec3,
        on: &mut dyn Surface,
    ) -> Step {
        let mut low = start;
        let mut step = {
            let here = from.lerp(to, start);
            let scale = on.pick(here.view).map(|h| on.world_per_view(&h));
            match scale {
                Some(scale) => on.spacing(&here) / (scale * length).max(1e-20),
                None => BLIND_STEP / length,
            }
        };
        loop {
            let mut high = (low + step.max(1e-5)).min(1.0);
            let mut hit = on.pick(from.lerp(to, high).view);
            let reached = |t: f32, hit: &Option<Hit>, on: &mut dyn Surface| match hit {
                Some(h) => (h.position - last).length() / on.spacing(&from.lerp(to, t)),
                None => f32::INFINITY,
            };
            let mut ratio = reached(high, &hit, on);
            if ratio < *ACCEPT.start() {
                if high >= 1.0 {
                    return Step::End;
                }
                // Onward by what is missing, at least a tenth of a step, so that the walk always ends.
                step *= (1.0 - ratio).clamp(0.1, 1.0);
                low = high;
                continue;
            }
            for _ in 0..MAX_BISECTIONS {
                if ACCEPT.contains(&ratio) {
                    break;
                }
                let mid = 0.5 * (low + high);
                let mid_hit = on.pick(from.lerp(to, mid).view);
                let mid_ratio = reached(mid, &mid_hit, on);
                if mid_ratio < *ACCEPT.start() {
                    low = mid;
                } else {
                    (high, hit, ratio) = (mid, mid_hit, mid_ratio);
                }
            }
            return match hit {
                Some(hit) if ratio <= *ACCEPT.end() => Step::Dab(high, hit),
                // The surface jumps here: the run ends at the brink.
                _ => Step::Lost(high),
            };
        }
    }

    /// The first point of the surface at or after `start`.
    fn next_after_gap(
        &self,
        from: &PenPoint,
        to: &PenPoint,
        start: f32,
        length: f32,
        on: &mut dyn Surface,
    ) -> Option<(f32, Hit)> {
        let step = (BLIND_STEP / length).max(1e-4);
        let (mut low, mut high) = (start, start);
        loop {
            if let Some(mut hit) = on.pick(from.lerp(to, high).view) {
                for _ in 0..6 {
                    let mid = 0.5 * (low + high);
                    if let Some(nearer) = on.pick(from.lerp(to, mid).view) {
                        (high, hit) = (mid, nearer);
                    } else {
                        low = mid;
                    }
                }
                return Some((high, hit));
            }
            if high >= 1.0 {
                return None;
            }
            low = high;
            high = (high + step).min(1.0);
        }
    }
}

enum Step {
    Dab(f32, Hit),
    Lost(f32),
    End,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A height field seen from straight above: view (x, y) is world (x, h(x), y).
    struct Field<F: Fn(f32) -> Option<f32>> {
        height: F,
        dabs: Vec<Vec3>,
        budget: usize,
    }

    impl<F: Fn(f32) -> Option<f32>> Surface for Field<F> {
        fn pick(&mut self, view: Vec2) -> Option<Hit> {
            (self.height)(view.x).map(|h| Hit {
                t: 1.0,
                position: Vec3::new(view.x, h, view.y),
                normal: Vec3::Y,
                page: 0,
                triangle: 0,
                barycentric: [1.0, 0.0, 0.0],
            })
        }
        fn spacing(&self, _: &PenPoint) -> f32 {
            0.02
        }
        fn world_per_view(&self, _: &Hit) -> f32 {
            1.0
        }
        fn dab(&mut self, _: &PenPoint, hit: &Hit, _: Option<Vec3>) -> Flow {
            self.dabs.push(hit.position);
            self.budget -= 1;
            if self.budget == 0 { Flow::Pause } else { Flow::Go }
        }
    }

    fn point(x: f32) -> PenPoint {
        PenPoint { view: Vec2::new(x, 0.5), pressure: 1.0, tilt: None, inverted: false }
    }

    fn widest(dabs: &[Vec3]) -> f32 {
        dabs.windows(2).map(|w| (w[1] - w[0]).length()).fold(0.0, f32::max)
    }

    #[test]
    fn one_fast_move_leaves_no_gap_on_flat_steep_or_wavy_ground() {
        for height in [|_: f32| Some(0.0), |x: f32| Some(4.0 * x), |x: f32| Some((x * 20.0).sin() * 0.1)] {
            let mut field = Field { height, dabs: vec![], budget: usize::MAX };
            let mut spacer = Spacer::new(1.0);
            spacer.begin(&point(0.05), &mut field);
            assert_eq!(spacer.walk(&point(0.05), &point(0.95), 0.0, &mut field), 1.0);
            assert!(widest(&field.dabs) <= 1.05 * 0.02, "gap of {}", widest(&field.dabs));
            assert!(field.dabs.len() >= 45);
            assert!((field.dabs[field.dabs.len() - 1].x - 0.95).abs() < 0.021);
        }
    }

    #[test]
    fn the_same_path_in_one_move_or_in_many_gives_the_same_count_of_dabs() {
        let run = |pieces: usize| {
            let mut field = Field { height: |_| Some(0.0), dabs: vec![], budget: usize::MAX };
            let mut spacer = Spacer::new(1.0);
            spacer.begin(&point(0.0), &mut field);
            for i in 0..pieces {
                let at = |k: usize| point(k as f32 / pieces as f32);
                spacer.walk(&at(i), &at(i + 1), 0.0, &mut field);
            }
            field.dabs.len() as i64
        };
        assert!((run(1) - run(77)).abs() <= 2 && (run(1) - run(1000)).abs() <= 3);
    }

    #[test]
    fn a_gap_in_the_surface_is_crossed_and_the_far_side_begins_at_its_edge() {
        let height = |x: f32| if (0.4..0.6).contains(&x) { None } else { Some(0.0) };
        let mut field = Field { height, dabs: vec![], budget: usize::MAX };
        let mut spacer = Spacer::new(1.0);
        spacer.begin(&point(0.1), &mut field);
        spacer.walk(&point(0.1), &point(0.9), 0.0, &mut field);
        let before = field.dabs.iter().rfind(|p| p.x < 0.5).expect("dabs before the gap").x;
        let after = field.dabs.iter().find(|p| p.x > 0.5).expect("dabs after the gap").x;
        assert!(before > 0.375 && (0.6..0.601).contains(&after), "{before} {after}");
    }

    #[test]
    fn a_paused_walk_goes_on_where_it_stopped() {
        let mut field = Field { height: |_| Some(0.0), dabs: vec![], budget: 10 };
        let mut spacer = Spacer::new(1.0);
        spacer.begin(&point(0.0), &mut field);
        let mut t = spacer.walk(&point(0.0), &point(1.0), 0.0, &mut field);
        while t < 1.0 {
            field.budget = 10;
            t = spacer.walk(&point(0.0), &point(1.0), t, &mut field);
        }
        assert!(widest(&field.dabs) <= 1.05 * 0.02 && field.dabs.len() >= 50);
    }
}
