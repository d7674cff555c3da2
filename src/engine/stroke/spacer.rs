//! Resampling: a stroke is a chain of dabs one *spacing* apart, however slow the frame or fast the
//! pen.
//!
//! After Cipollini 2020 ("Fast Digital Sculpting on CPU"), a stroke is sampled every 20 % of the
//! radius, the missing points are placed along the **screen** path, and each is picked again on the
//! surface. Here the next point is the one on the screen segment whose picked position is one
//! spacing away from the last dab *at its current position* (the last dab's view point is picked
//! again after it was applied). A guarded bisection finds it, so that perspective, foreshortening
//! and the relief just raised are all accounted for.
//!
//! The law: **within a run, a dab is never further than the spacing from the one before it.** A run
//! goes on
//! * where the surface is seen without a break along the path: the next dab lies 0.97 of the
//!   spacing on, or 0.94 to 1 of it where the surface is too broken to aim;
//! * where it leaps, and what is hidden by a crest is at most [`BRIDGED`] spacings wide, brink to
//!   far side: one more dab is laid on the brink, and if the far side is still too far, others on
//!   the hidden clay between, found straight below the line of sight over it, until it is not.
//!
//! A run ends, and the first dab beyond begins another (marked by [`Laid::first`]), in three cases.
//! The path leaves the surface; the leap is wider (another limb, or clay behind); or no unbroken
//! surface leads across (the brink overhangs). A dab on a brink has a share of the strength for the
//! path that led to it. So the effect of a stroke depends on its path and not on how often the
//! surface leapt, nor on how the path was cut into frames.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::surface::{Flow, Laid, PenPoint, Surface};
use sculptd_clay::{Hit, Ray};
use sculptd_geometry::portable::PortableMath;

/// A dab is accepted between these shares of the spacing: never above one, so that the law holds
/// with room for rounding.
const ACCEPT: std::ops::RangeInclusive<f32> = 0.94..=1.0;
/// Range of steps for a path without breaks. The steps have one length, because the effect of a dab
/// represents the step before it, and alternating lengths would make waves.
const EVEN: std::ops::RangeInclusive<f32> = 0.965..=0.975;
/// The share of the spacing that is aimed at.
const AIM: f32 = 0.97;
/// So many steps of the search look for [`EVEN`] by linear interpolation.
const AIMED: u32 = 6;
/// Hidden clay up to so many spacings from brink to far side is crossed within a run.
pub const BRIDGED: f32 = 2.0;
/// No dab on a brink that is nearer to the last one than this share of the spacing.
const ON_BRINK: f32 = 0.1;
/// Dabs on hidden clay at a leap: a slope of five times its width is the steepest that is gone
/// down.
const MOST_HIDDEN: usize = 10;
/// No dab at the end of a stroke that is nearer to the last one than this share of the spacing.
const ON_END: f32 = 0.02;
/// A stroke none of whose dabs had this share of its greatest pressure is a tap.
const FAINT: f32 = 0.5;
/// Distance in spacings from which on the surface at a dab's view point counts as another one than
/// the dab was laid on.
const JUMPED: f32 = 4.0;
/// Bisection steps for one dab: 2^-20 of a spacing as it is seen, or what single precision can tell
/// apart.
const MAX_BISECTIONS: u32 = AIMED + 20;
/// Steps over a stretch with no surface, in heights of the view.
const BLIND_STEP: f32 = 0.004;

/// State of a stroke between two pen points.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Spacer {
    /// Surface point of the last dab, after the dab.
    last: Option<Vec3>,
    /// The last dab made its surface leap away from under the pen: the next run begins a step
    /// further.
    leapt: bool,
    /// Height and width of the view in the same unit: x is multiplied by this before lengths are
    /// taken.
    aspect: f32,
    /// Dabs since the pen touched, and the greatest pressure of one.
    #[serde(default)]
    dabs: u32,
    #[serde(default)]
    firmest: f32,
}

/// From one report of the pen to the next.
#[derive(Clone, Copy)]
struct Segment<'a> {
    from: &'a PenPoint,
    to: &'a PenPoint,
    /// In heights of the view, above 0.
    length: f32,
}

impl Segment<'_> {
    fn at(&self, t: f32) -> PenPoint {
        self.from.lerp(self.to, t)
    }

    /// The share of the segment that a spacing takes up where it is seen face on.
    fn step(&self, at: &PenPoint, hit: Option<&Hit>, on: &dyn Surface) -> f32 {
        match hit.map(|h| on.world_per_view(h)) {
            Some(scale) => on.spacing(at) / (scale * self.length).max(1e-20),
            None => BLIND_STEP / self.length,
        }
    }
}

/// Surface hit at a share of the path's length, and its distance from the last dab, in spacings.
#[derive(Clone, Copy)]
struct Sight {
    at: f32,
    hit: Hit,
    off: f32,
}

/// Next step along a path.
enum Step {
    Dab(Sight),
    /// The surface leaps from the first, less than a spacing away, to the second, which is further.
    Leap(Sight, Sight),
    Lost(f32),
    End,
}

/// The next point a spacing away along a path from `start`, by advancing `step` and narrowing down
/// where the spacing is reached. `seek` says what is met.
fn advance(
    start: f32,
    step: f32,
    here: Option<Sight>,
    seek: &mut dyn FnMut(f32) -> Option<Sight>,
) -> Step {
    let off = |s: &Option<Sight>| s.map_or(f32::INFINITY, |s| s.off);
    let (mut low, mut low_at) = (here, start);
    match here {
        Some(here) if (*EVEN.start()..=*ACCEPT.end()).contains(&here.off) => {
            return Step::Dab(here);
        }
        // The surface moved under the pen since.
        Some(here) if here.off > 1.0 => return Step::Leap(Sight { off: 0.0, ..here }, here),
        _ => {}
    }
    loop {
        // Onward by what is missing, at least a tenth of a step, so that the walk always ends.
        let missing = if low.is_some() { (AIM - off(&low)).clamp(0.1, 1.0) } else { 1.0 };
        let mut high_at = (low_at + (step * missing).max(1e-5)).min(1.0);
        let mut high = seek(high_at);
        if off(&high) < *EVEN.start() {
            if high_at >= 1.0 {
                return Step::End;
            }
            (low, low_at) = (high, high_at);
            continue;
        }
        for k in 0..MAX_BISECTIONS {
            let good = if k < AIMED { &EVEN } else { &ACCEPT };
            let share = (AIM - off(&low)) / (off(&high) - off(&low));
            let aimed = k < AIMED && high.is_some() && share.is_finite();
            let share = if aimed { share.clamp(0.1, 0.9) } else { 0.5 };
            let mid_at = low_at + share * (high_at - low_at);
            if good.contains(&off(&high)) || mid_at <= low_at || mid_at >= high_at {
                break;
            }
            let mid = seek(mid_at);
            if off(&mid) < *EVEN.start() {
                (low, low_at) = (mid, mid_at);
            } else {
                (high, high_at) = (mid, mid_at);
            }
        }
        return match (low, high) {
            (_, Some(high)) if high.off <= *ACCEPT.end() => Step::Dab(high),
            (Some(low), _) if low.off >= *ACCEPT.start() => Step::Dab(low),
            (Some(low), Some(high)) => Step::Leap(low, high),
            _ => Step::Lost(high_at),
        };
    }
}

impl Spacer {
    /// At the beginning of a stroke. `aspect`: the view's width by its height.
    pub fn new(aspect: f32) -> Self {
        Spacer { last: None, leapt: false, aspect, dabs: 0, firmest: 0.0 }
    }

    /// The pen touches: a dab at once.
    pub fn begin(&mut self, at: &PenPoint, on: &mut dyn Surface) -> Flow {
        *self = Spacer::new(self.aspect);
        self.rest(at, on)
    }

    /// The stroke ends at `at`, to which the path was walked: a dab there, with the share of the
    /// strength that is due to the way from the last one. A stroke that came nowhere, or that laid
    /// its dabs before and after the pen was pressed, is a tap: it leaves what one dab does at
    /// `firmest`, the point of the greatest pressure, less what its firmest dab did.
    pub fn finish(&mut self, at: &PenPoint, firmest: &PenPoint, on: &mut dyn Surface) -> Flow {
        let mut flow = Flow::Go;
        if self.dabs > 1
            && let (Some(last), Some(hit)) = (self.last, on.pick(at.view))
        {
            let off = (hit.position - last).length() / on.spacing(at);
            if (ON_END..=1.0).contains(&off) {
                flow = self.place(at, &hit, off, &mut |on| on.pick(at.view), on);
            }
        }
        let most = if self.dabs > 1 { FAINT * firmest.pressure } else { firmest.pressure };
        if self.firmest < most
            && let Some(hit) = on.pick(firmest.view)
        {
            let share = 1.0 - self.firmest / firmest.pressure;
            flow = on.dab(firmest, &hit, Laid { tap: true, share, ..Laid::ALONE });
        }
        flow
    }

    /// A dab more where the pen rests: the run goes on from it.
    pub fn rest(&mut self, at: &PenPoint, on: &mut dyn Surface) -> Flow {
        match on.pick(at.view) {
            Some(hit) => self.place(at, &hit, 1.0, &mut |on| on.pick(at.view), on),
            None => Flow::Go,
        }
    }

    /// Lays a dab. `again` finds its place once more, on what the dab made of the surface.
    fn place(
        &mut self,
        at: &PenPoint,
        hit: &Hit,
        share: f32,
        again: &mut dyn FnMut(&mut dyn Surface) -> Option<Hit>,
        on: &mut dyn Surface,
    ) -> Flow {
        let along = self.last.and_then(|p| (hit.position - p).try_normalize());
        let flow = on.dab(at, hit, Laid { first: self.last.is_none(), along, share, tap: false });
        self.dabs = self.dabs.saturating_add(1);
        self.firmest = self.firmest.max(at.pressure);
        let now = again(on).map_or(hit.position, |h| h.position);
        // The dab may have folded its surface point out of sight.
        self.leapt = (now - hit.position).length() > JUMPED * on.spacing(at) + 1e-30;
        self.last = (!self.leapt).then_some(now);
        flow
    }

    /// Walks the segment from `from` to `to`, starting at the share `start` of it. Returns 1 when
    /// the whole segment was walked, else the share at which the budget ended.
    pub fn advance(
        &mut self,
        from: &PenPoint,
        to: &PenPoint,
        start: f32,
        on: &mut dyn Surface,
    ) -> f32 {
        let d = to.view - from.view;
        let length = (d.x * self.aspect).portable_hypot(d.y);
        let mut t = start;
        if length <= 0.0 || !length.is_finite() {
            return 1.0;
        }
        let way = Segment { from, to, length };
        let mut bridged = -1.0;
        while t < 1.0 {
            let flow = match self.next(&way, t, on) {
                Step::Dab(sight) => self.place_dabs(&way, &mut t, &sight, 1.0, on),
                Step::Leap(brink, _) if brink.off > ON_BRINK => {
                    self.place_dabs(&way, &mut t, &brink, brink.off, on)
                }
                Step::Leap(_, beyond) if beyond.at <= bridged => {
                    // The dabs laid to get there tore the surface away.
                    (self.last, self.leapt) = (None, true);
                    Flow::Go
                }
                Step::Leap(_, beyond) => {
                    (t, bridged) = (beyond.at, beyond.at);
                    self.bridge(&way.at(t), &beyond, on)
                }
                Step::Lost(at) => {
                    t = at;
                    self.last = None;
                    Flow::Go
                }
                Step::End => return 1.0,
            };
            if flow == Flow::Pause && t < 1.0 {
                return t;
            }
        }
        1.0
    }

    fn place_dabs(
        &mut self,
        way: &Segment<'_>,
        t: &mut f32,
        sight: &Sight,
        share: f32,
        on: &mut dyn Surface,
    ) -> Flow {
        *t = sight.at;
        let at = way.at(*t);
        self.place(&at, &sight.hit, share, &mut |on| on.pick(at.view), on)
    }

    fn next(&mut self, way: &Segment<'_>, mut start: f32, on: &mut dyn Surface) -> Step {
        let at = way.at(start);
        let hit = on.pick(at.view);
        let step = way.step(&at, hit.as_ref(), on);
        let Some(last) = self.last else {
            if std::mem::take(&mut self.leapt) {
                start = (start + step.max(1e-4)).min(1.0);
            }
            return first_seen(way, start, on);
        };
        let off = |hit: &Hit, at: &PenPoint, on: &dyn Surface| {
            (hit.position - last).length() / on.spacing(at)
        };
        let here = hit.map(|hit| Sight { at: start, hit, off: off(&hit, &at, on) });
        advance(start, step, here, &mut |t| {
            let at = way.at(t);
            let hit = on.pick(at.view)?;
            Some(Sight { at: t, hit, off: off(&hit, &at, on) })
        })
    }

    /// Bridges from the last dab, on a brink, to the surface seen `beyond`. Lays dabs on the hidden
    /// clay between if they can lead there; otherwise ends the run.
    fn bridge(&mut self, at: &PenPoint, beyond: &Sight, on: &mut dyn Surface) -> Flow {
        let spacing = on.spacing(at);
        let Some(from) = self.last else { return Flow::Go };
        let to = beyond.hit.position;
        let out = beyond.hit.normal;
        let far = BRIDGED * spacing;
        let mut flow = Flow::Go;
        let mut u = 0.0;
        // Straight below the line from brink to far side, as the far side lies.
        let below = |u: f32, on: &mut dyn Surface| {
            let from = from.lerp(to, u) + out * far;
            on.drop(Ray { origin: from, dir: -out }, 3.0 * far).filter(|h| h.normal.dot(out) > 0.0)
        };
        if beyond.off <= BRIDGED {
            for _ in 0..MOST_HIDDEN {
                let Some(last) = self.last else { break };
                if (to - last).length() <= spacing {
                    return flow;
                }
                let mut seek = |u: f32| {
                    let hit = below(u, on)?;
                    Some(Sight { at: u, hit, off: (hit.position - last).length() / spacing })
                };
                let here = Some(Sight { at: u, hit: beyond.hit, off: 0.0 });
                let Step::Dab(sight) = advance(u, 1.0 / beyond.off, here, &mut seek) else { break };
                u = sight.at;
                if self.place(at, &sight.hit, 1.0, &mut |on| below(u, on), on) == Flow::Pause {
                    flow = Flow::Pause;
                }
            }
        }
        self.last = None;
        flow
    }
}

/// The first point of the surface at or after `start`.
fn first_seen(way: &Segment<'_>, start: f32, on: &mut dyn Surface) -> Step {
    let step = (BLIND_STEP / way.length).max(1e-4);
    let (mut low, mut high) = (start, start);
    loop {
        if let Some(mut hit) = on.pick(way.at(high).view) {
            for _ in 0..6 {
                let mid = 0.5 * (low + high);
                if let Some(nearer) = on.pick(way.at(mid).view) {
                    (high, hit) = (mid, nearer);
                } else {
                    low = mid;
                }
            }
            return Step::Dab(Sight { at: high, hit, off: 1.0 });
        }
        if high >= 1.0 {
            return Step::End;
        }
        low = high;
        high = (high + step).min(1.0);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

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
        fn drop(&mut self, ray: Ray, _: f32) -> Option<Hit> {
            self.pick(Vec2::new(ray.origin.x, ray.origin.z))
        }
        fn dab(&mut self, _: &PenPoint, hit: &Hit, _: Laid) -> Flow {
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
        for height in
            [|_: f32| Some(0.0), |x: f32| Some(4.0 * x), |x: f32| Some((x * 20.0).sin() * 0.1)]
        {
            let mut field = Field { height, dabs: vec![], budget: usize::MAX };
            let mut spacer = Spacer::new(1.0);
            spacer.begin(&point(0.05), &mut field);
            assert_eq!(spacer.advance(&point(0.05), &point(0.95), 0.0, &mut field), 1.0);
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
                spacer.advance(&at(i), &at(i + 1), 0.0, &mut field);
            }
            field.dabs.len() as i64
        };
        assert!((run(1) - run(77)).abs() <= 2 && (run(1) - run(1000)).abs() <= 3);
    }

    #[test]
    fn a_stroke_ends_at_the_pen_and_a_tap_leaves_one_dab() {
        let mut field = Field { height: |_| Some(0.0), dabs: vec![], budget: usize::MAX };
        let mut spacer = Spacer::new(1.0);
        spacer.begin(&point(0.1), &mut field);
        spacer.advance(&point(0.1), &point(0.509), 0.0, &mut field);
        spacer.finish(&point(0.509), &point(0.3), &mut field);
        assert_eq!(field.dabs.last().map(|p| p.x), Some(0.509));
        // A touch without pressure, and then a slide that is shorter than the spacing.
        let light = PenPoint { pressure: 0.0, ..point(0.7) };
        field.dabs.clear();
        spacer.begin(&light, &mut field);
        spacer.advance(&light, &point(0.71), 0.0, &mut field);
        spacer.finish(&PenPoint { pressure: 0.1, ..point(0.71) }, &point(0.705), &mut field);
        assert_eq!(field.dabs.iter().map(|p| p.x).collect::<Vec<_>>(), [0.7, 0.705]);
        // One that was firm from the touch on has left its dab.
        field.dabs.clear();
        spacer.begin(&point(0.7), &mut field);
        spacer.finish(&point(0.7), &point(0.7), &mut field);
        assert_eq!(field.dabs.len(), 1);
    }

    #[test]
    fn a_gap_in_the_surface_is_crossed_and_the_far_side_begins_at_its_edge() {
        let height = |x: f32| if (0.4..0.6).contains(&x) { None } else { Some(0.0) };
        let mut field = Field { height, dabs: vec![], budget: usize::MAX };
        let mut spacer = Spacer::new(1.0);
        spacer.begin(&point(0.1), &mut field);
        spacer.advance(&point(0.1), &point(0.9), 0.0, &mut field);
        let before = field.dabs.iter().rfind(|p| p.x < 0.5).expect("dabs before the gap").x;
        let after = field.dabs.iter().find(|p| p.x > 0.5).expect("dabs after the gap").x;
        assert!(before > 0.375 && (0.6..0.601).contains(&after), "{before} {after}");
    }

    #[test]
    fn a_paused_walk_goes_on_where_it_stopped() {
        let mut field = Field { height: |_| Some(0.0), dabs: vec![], budget: 10 };
        let mut spacer = Spacer::new(1.0);
        spacer.begin(&point(0.0), &mut field);
        let mut t = spacer.advance(&point(0.0), &point(1.0), 0.0, &mut field);
        while t < 1.0 {
            field.budget = 10;
            t = spacer.advance(&point(0.0), &point(1.0), t, &mut field);
        }
        assert!(widest(&field.dabs) <= 1.05 * 0.02 && field.dabs.len() >= 50);
    }
}
