//! Stroke parameterisation (Schmidt 2013, "Stroke parameterization"; the map about one point:
//! Schmidt, Grimm, Wyvill 2006, "Interactive decal compositing with discrete exponential maps").
//!
//! Each vertex near the stroke gets `(u, v)`: `u` along the stroke by arc length, `v` across it, 0
//! on the axis. Each sample of the stroke makes a chart about itself and carries coordinates
//! outwards in the order of distance. A vertex takes the mean of its visited neighbours' estimates,
//! each weighted by 1 / its distance. An estimate is the neighbour's place plus the edge, unrolled
//! into its tangent plane at full length. The smallest rotation from one normal to the other
//! carries the direction of `u`. The coordinates give the distance of a vertex from a sample.
//!
//! A vertex is in the chart of the nearest sample, and a vertex between two samples is in both
//! charts: it takes a mean that blends from one to the other along the stroke, so that the spacing
//! of the samples matters little. If two samples at `s1` and `s2` give `u1` and `u2`, a sample at
//! `s` between them would give `u1 + (u2 - u1) (s - s1) / (s2 - s1)`; the vertex belongs to the
//! sample that gives `s` itself.
//!
//! Samples lie `STEP` apart along the stroke, by arc length from its beginning, wherever dabs
//! lie: between two dabs the path is the cubic that touches the surface at both. The direction of
//! the stroke at a sample is that of the parabola through it and the two before it.
//!
//! All is measured on the surface as it was when the stroke began, so the relief does not bend its
//! own coordinates; a new sample touches only vertices that are nearer to it than to all before.

use glam::{Quat, Vec2, Vec3};

use crate::brush::geodesic::{Geodesic, Key, ring};
use crate::{Clay, Page, Reach};

/// A sample of a stroke on the surface as it was.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrokeSample {
    /// The position, in mesh units.
    pub point: Vec3,
    /// Unit, of the surface there.
    pub normal: Vec3,
    /// Unit, in the tangent plane, along the stroke.
    pub along: Vec3,
    /// Length of the stroke up to it, mesh units.
    pub u: f32,
}

/// A place that a stroke goes to: a point and the unit normal there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StrokePlace {
    /// On the surface as it is; where that was when the stroke began is estimated.
    Now(Vec3, Vec3),
    /// On the surface as it was when the stroke began.
    Found(Vec3, Vec3),
}

/// The way between two samples, in the radii that coordinates are carried.
const STEP: f32 = 0.19;
/// Samples that one dab may add: the spacing is a radius at most, and a longer way is a leap.
const MOST: f32 = 6.0;
/// Neighbours of a vertex that are remembered from one look at its ring to the next.
const OPEN: usize = 12;
/// The greatest difference of charts along the stroke: beyond it is a fold, where the coordinates
/// are not unique.
const FOLD: f32 = 0.7;

/// A stroke being unrolled.
#[derive(Debug, Default)]
pub struct StrokeParameters {
    /// The coordinates of each vertex.
    pub walk: Geodesic,
    /// The number of the stroke.
    stroke: u32,
    last: Option<StrokeSample>,
    /// The sample before the last one.
    before: Option<StrokeSample>,
    /// The end of the stroke so far, the normal there, and the length up to there.
    end: Option<(Vec3, Vec3)>,
    length: f32,
    /// The last two places where the pen touched the clay, newest first.
    touches: [Option<Vec3>; 2],
    /// The position of the next sample along the stroke.
    next: f32,
    /// Samples so far; a vertex remembers which one it belongs to.
    count: u32,
}

impl StrokeParameters {
    /// The sample that a vertex belongs to, counted from 1.
    pub fn owner(&self, page: u32, v: usize) -> u32 {
        self.walk.owner(page, v)
    }

    /// Returns the distance of a place from the stroke so far: from its axis, or from its beginning
    /// or end where the place is beyond them.
    pub fn off_stroke(&self, [u, v]: [f32; 2]) -> f32 {
        let beyond = (-u).max(u - self.length).max(0.0);
        Vec2::new(beyond, v).length()
    }

    /// Samples so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Returns the last two places where the pen touched the clay, newest first, as passed to
    /// [`StrokeParameters::touch`] in this stroke and on this clay.
    pub fn touched(&self, mesh: &Clay, stroke: u32) -> [Option<Vec3>; 2] {
        let same = self.stroke == stroke && !self.walk.is_stale(mesh);
        if same { self.touches } else { [None; 2] }
    }

    /// Keeps where the pen touches the clay, and where it did before.
    pub fn touch(&mut self, touches: [Option<Vec3>; 2]) {
        self.touches = touches;
    }

    /// Extends the stroke to a place on the surface. Coordinates are carried as far as `radius`,
    /// which should be a little more than the brush's, so that every vertex beside the stroke
    /// between two samples is reached from one of them. Returns true if vertices have coordinates:
    /// a stroke has no direction before its second sample, which then also serves the first.
    pub fn step(&mut self, mesh: &Clay, stroke: u32, to: StrokePlace, radius: f32) -> bool {
        if self.stroke != stroke || self.walk.is_stale(mesh) {
            self.walk.begin(mesh);
            (self.stroke, self.last, self.before) = (stroke, None, None);
            (self.end, self.length, self.next, self.count) = (None, 0.0, 0.0, 0);
            self.touches = [None; 2];
        }
        let found = match to {
            StrokePlace::Found(point, normal) => Some((point, normal)),
            StrokePlace::Now(point, normal) => self.as_it_was(mesh, point, normal, radius),
        };
        let Some((point, normal)) = found else { return false };
        let Some((from, old)) = self.end.replace((point, normal)) else {
            self.sample(mesh, point, normal, radius);
            return false;
        };
        let way = point - from;
        let chord = way.length();
        if !(chord > 0.0) {
            return self.count > 1;
        }
        // Of an arc whose normals turn by so much.
        let bend = (normal - old).dot(way) / chord;
        let length = chord * (1.0 + bend * bend / 24.0);
        if length > MOST * STEP * radius {
            self.next = self.length + length;
        }
        let touching = |n: Vec3| flat(way, n).unwrap_or(way / chord) * chord;
        let (t0, t1) = (touching(old), touching(normal));
        while self.next <= self.length + length {
            let t = (self.next - self.length) / length;
            let (t2, t3) = (t * t, t * t * t);
            let bow = t0 * (t3 - 2.0 * t2 + t) + t1 * (t3 - t2);
            let at = from + way * (3.0 * t2 - 2.0 * t3) + bow;
            let up = old.lerp(normal, t).try_normalize().unwrap_or(normal);
            self.sample(mesh, at, up, radius);
        }
        self.length += length;
        self.count > 1
    }

    /// The next sample of the stroke.
    fn sample(&mut self, mesh: &Clay, point: Vec3, normal: Vec3, radius: f32) {
        let mut sample = StrokeSample { point, normal, along: Vec3::ZERO, u: self.next };
        self.next += STEP * radius;
        let Some(last) = self.last else {
            self.last = Some(sample);
            return;
        };
        let Some(step) = flat(point - last.point, normal) else { return };
        sample.along = step;
        if let Some(before) = self.before {
            let bend = flat(last.point - before.point, normal).map_or(Vec3::ZERO, |s| step - s);
            // Beyond 60 degrees it is a corner and no curve.
            if bend.length_squared() < 1.0 {
                sample.along = (step + bend * 0.5).try_normalize().unwrap_or(step);
            }
        } else {
            // The first sample takes the direction of the second.
            let first = StrokeSample { along: turn(normal, last.normal, step), ..last };
            self.spread(mesh, &first, radius);
        }
        self.before = Some(last);
        self.spread(mesh, &sample, radius);
        self.last = Some(sample);
    }

    /// The point as it was when the stroke began: moved back as its neighbourhood was moved.
    fn as_it_was(&self, mesh: &Clay, now: Vec3, normal: Vec3, radius: f32) -> Option<(Vec3, Vec3)> {
        let mut nearest: Option<(f32, Key)> = None;
        mesh.each_page(&Reach::Sphere { centre: now, radius: radius * 0.5 }, |number, page| {
            for v in 0..page.own() {
                let d2 = (page.point(v) - now).length_squared();
                if page.normal(v).dot(normal) > 0.0 && nearest.is_none_or(|n| d2 < n.0) {
                    nearest = Some((d2, (number, v as u16)));
                }
            }
        });
        let (_, key) = nearest?;
        let (mut moved, mut turned, mut sum) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        let mut add = |(page, v): Key| {
            let (new, old) = (mesh.page(page), mesh.before(page));
            let (p, q) = (new.point(v as usize), old.point(v as usize));
            let w = 1.0 / ((p - now).length_squared() + radius * radius * 1e-4);
            moved += (p - q) * w;
            turned += old.normal(v as usize) * w;
            sum += w;
        };
        add(key);
        ring(|i| mesh.page(i), key, |to, _| add(to));
        Some((now - moved / sum, turned.try_normalize()?))
    }

    /// Carries coordinates from a sample to every vertex that is nearer to it than to those before,
    /// or that lies ahead of the one before it.
    pub fn spread(&mut self, mesh: &Clay, from: &StrokeSample, radius: f32) {
        self.count += 1;
        let (owner, before) = (self.count, self.before.map_or(f32::INFINITY, |b| b.u));
        let walk = &mut self.walk;
        let mut seed: Option<(f32, Key)> = None;
        let look = |number: u32, page: &Page| {
            for v in 0..page.own() {
                let d2 = (page.point(v) - from.point).length_squared();
                if page.normal(v).dot(from.normal) > 0.0 && seed.is_none_or(|s| d2 < s.0) {
                    seed = Some((d2, (number, v as u16)));
                }
            }
        };
        let near = Reach::Sphere { centre: from.point, radius };
        mesh.each_page_before(&near, look);
        let Some((_, key)) = seed else { return };
        // Takes coordinates in this chart, and interpolates those between it and the chart before.
        let settle = |walk: &mut Geodesic, key: Key, place: [f32; 2], frame: [Vec3; 2]| {
            let (source, old) = walk.source(key);
            walk.settle(mesh, key, place, frame);
            walk.set_distance(mesh, key, Vec2::new(place[0] - from.u, place[1]).length());
            let step = from.u - before;
            if source + 1 == owner && source > 0 && step > 0.0 {
                let drift = ((place[0] - old[0]) / step).clamp(-FOLD, FOLD);
                let t = ((old[0] - before) / step / (1.0 - drift)).clamp(0.0, 1.0);
                walk.tell(mesh, key, Vec2::from(old).lerp(Vec2::from(place), t).to_array());
            }
        };
        // The vertices about the sample are measured from it.
        let start = |walk: &mut Geodesic, key: Key| {
            let page = mesh.before(key.0);
            let (p, n) = (page.point(key.1 as usize), page.normal(key.1 as usize));
            let d = (p - from.point).length();
            walk.offer_ahead(mesh, key, (owner, before), d, || d, f32::INFINITY);
            if walk.owner(key.0, key.1 as usize) == owner && !walk.is_settled(key, owner) {
                let at = laid(from.normal, from.along, p - from.point);
                let place = [from.u + at[0], at[1]];
                settle(walk, key, place, [turn(from.normal, n, from.along), n]);
                walk.requeue(key);
            }
        };
        start(walk, key);
        ring(|i| mesh.before(i), key, |to, _| start(walk, to));
        // The neighbours of a vertex that have no coordinates in this chart yet.
        let mut open = [((0, 0), Vec3::ZERO); OPEN];
        while let Some((key, _)) = walk.take() {
            let page = mesh.before(key.0);
            let mut opened = OPEN + 1;
            let (p, n) = (page.point(key.1 as usize), page.normal(key.1 as usize));
            if !walk.is_settled(key, owner) {
                let (mut place, mut sum) = (Vec2::ZERO, 0.0f32);
                let (mut along, mut normal) = (Vec3::ZERO, Vec3::ZERO);
                opened = 0;
                ring(
                    |i| mesh.before(i),
                    key,
                    |other, q| {
                        let Some((at, [e, m])) = walk.settled_by(other, owner) else {
                            if let Some(slot) = open.get_mut(opened) {
                                *slot = (other, q);
                            }
                            opened += 1;
                            return;
                        };
                        let w = 1.0 / (p - q).length().max(1e-20);
                        place += (Vec2::from(at) + Vec2::from(laid(m, e, p - q))) * w;
                        along += e * w;
                        normal += m * w;
                        sum += w;
                    },
                );
                if !(sum > 0.0) {
                    continue;
                }
                // The mean of the neighbours' directions, turned as their mean normal must be.
                let along = turn(normal.normalize_or_zero(), n, along);
                let flat = along - n * along.dot(n);
                let place = (place / sum).to_array();
                settle(walk, key, place, [flat.normalize_or(along), n]);
            }
            let Some((at, [e, m])) = walk.settled_by(key, owner) else { continue };
            let mut offer = |to: Key, q: Vec3| {
                // No way over a surface is shorter than the straight one. Where relief is so
                // steep that coordinates fold, this alone keeps the walk within the radius.
                let straight = (q - from.point).length();
                let told = || {
                    let [u, v] = laid(m, e, q - p);
                    Vec2::new(at[0] + u - from.u, at[1] + v).length()
                };
                walk.offer_ahead(mesh, to, (owner, before), straight, told, radius);
            };
            match open.get(..opened) {
                Some(open) => open.iter().for_each(|&(to, q)| offer(to, q)),
                None => ring(|i| mesh.before(i), key, offer),
            }
        }
    }
}

/// The direction of a vector in the plane of a normal.
fn flat(d: Vec3, normal: Vec3) -> Option<Vec3> {
    (d - normal * d.dot(normal)).try_normalize()
}

/// A vector laid into the tangent plane of `normal` at its full length, as (along, across).
fn laid(normal: Vec3, along: Vec3, d: Vec3) -> [f32; 2] {
    let flat = d - normal * d.dot(normal);
    let stretch = d.length_squared() / flat.length_squared();
    let flat = if stretch.is_finite() { flat * stretch.sqrt() } else { Vec3::ZERO };
    [flat.dot(along), flat.dot(normal.cross(along))]
}

/// `v`, turned as `from` must be to become `to`. The rotation is written out by its components: in
/// vectors of four the fourth would be whatever lay there, often a subnormal number, and a product
/// with one of those takes a hundred cycles.
fn turn(from: Vec3, to: Vec3, v: Vec3) -> Vec3 {
    if from == Vec3::ZERO || to == Vec3::ZERO {
        return v;
    }
    let [x, y, z, w] = Quat::from_rotation_arc(from, to).to_array();
    let along = w * w - (x * x + y * y + z * z);
    let dot = v.x * x + v.y * y + v.z * z;
    let dot = dot + dot;
    let rotated = |v: f32, b: f32, cross: f32| (v * along + b * dot) + cross * (w + w);
    Vec3::new(
        rotated(v.x, x, y * v.z - z * v.y),
        rotated(v.y, y, z * v.x - x * v.z),
        rotated(v.z, z, x * v.y - y * v.x),
    )
}
