//! Stroke parameterisation (Schmidt 2013, "Stroke parameterization"; the map about one point:
//! Schmidt, Grimm, Wyvill 2006, "Interactive decal compositing with discrete exponential maps").
//!
//! Each vertex near the stroke gets `(u, v)`: `u` along the stroke by arc length, `v` across it, 0
//! on the axis. It belongs to the stroke's sample that is nearest over the edges. From there
//! coordinates are carried outwards in the order of distance: a vertex takes the mean of what its
//! nearer neighbours say, each weighing 1 / its distance, and each says: my own place, and from
//! there along the edge, laid into my tangent plane at its full length. The direction of `u` is
//! carried by the smallest turn that takes one normal to the other.
//!
//! The distance over the edges decides only which sample a vertex belongs to and where the walk
//! ends: it is up to 1.4 times too long, more in one direction of the mesh than in another. How far
//! a vertex is from the stroke is told by its coordinates ([`StrokeParameters::off_stroke`]).
//!
//! All is measured on the surface as it was when the stroke began, so the relief does not bend its
//! own coordinates; a new sample touches only vertices that are nearer to it than to all before.

use glam::{Quat, Vec2, Vec3};

use crate::brush::geodesic::{Geodesic, Key, ring};
use crate::{Clay, Page, Reach};

/// A sample of a stroke on the surface as it was.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StrokeSample {
    /// Where it lies, mesh units.
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

/// A stroke being unrolled.
#[derive(Debug, Default)]
pub struct StrokeParameters {
    /// The coordinates of each vertex.
    pub walk: Geodesic,
    /// Which stroke it is.
    stroke: u32,
    last: Option<StrokeSample>,
    /// Samples so far; a vertex remembers which one it belongs to.
    count: u32,
}

impl StrokeParameters {
    /// The sample that a vertex belongs to, counted from 1.
    pub fn owner(&self, page: u32, v: usize) -> u32 {
        self.walk.owner(page, v)
    }

    /// How far a place is from the stroke as far as it came: from its axis, and before its first or
    /// beyond its newest sample from that sample.
    pub fn off_stroke(&self, [u, v]: [f32; 2]) -> f32 {
        let newest = self.last.map_or(0.0, |last| last.u);
        let beyond = (-u).max(u - newest).max(0.0);
        Vec2::new(beyond, v).length()
    }

    /// Samples so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Goes on to a place on the surface; coordinates are carried as far as `radius`,
    /// which should be a little more than the brush's, so that what lies beside the stroke between
    /// two samples is reached from one of them. Returns whether vertices got coordinates: a
    /// stroke has no direction before its second sample, which then also serves the first. The
    /// first of the two is number [`StrokeParameters::count`] - 1.
    pub fn step(&mut self, mesh: &Clay, stroke: u32, to: StrokePlace, radius: f32) -> bool {
        if self.stroke != stroke || self.walk.is_stale(mesh) {
            self.walk.begin(mesh);
            (self.stroke, self.last, self.count) = (stroke, None, 0);
        }
        let found = match to {
            StrokePlace::Found(point, normal) => Some((point, normal)),
            StrokePlace::Now(point, normal) => self.as_it_was(mesh, point, normal, radius),
        };
        let Some((point, normal)) = found else { return false };
        let Some(last) = self.last else {
            self.last = Some(StrokeSample { point, normal, along: Vec3::ZERO, u: 0.0 });
            return false;
        };
        let way = point - last.point;
        let flat = way - normal * way.dot(normal);
        let Some(direction) = flat.try_normalize() else { return false };
        let along = if last.along == Vec3::ZERO {
            // The first sample takes the direction of the second.
            let back = turn(normal, last.normal, direction);
            let first = StrokeSample { along: back, ..last };
            self.spread(mesh, &first, radius);
            direction
        } else {
            // Between the segment before and this one.
            let before = turn(last.normal, normal, last.along);
            (direction + before).try_normalize().unwrap_or(direction)
        };
        let sample = StrokeSample { point, normal, along, u: last.u + way.length() };
        self.spread(mesh, &sample, radius);
        self.last = Some(sample);
        true
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

    /// Carries coordinates from a sample to every vertex that is nearer to it than to those before.
    pub fn spread(&mut self, mesh: &Clay, from: &StrokeSample, radius: f32) {
        self.count += 1;
        let owner = self.count;
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
        // The vertices about the sample are measured from it.
        let start = |walk: &mut Geodesic, key: Key| {
            let page = mesh.before(key.0);
            let (p, n) = (page.point(key.1 as usize), page.normal(key.1 as usize));
            let d = (p - from.point).length();
            if walk.offer(mesh, key, d, owner) {
                let at = laid(from.normal, from.along, p - from.point);
                let place = [from.u + at[0], at[1]];
                walk.settle(mesh, key, place, [turn(from.normal, n, from.along), n]);
            }
        };
        start(walk, key);
        ring(|i| mesh.before(i), key, |to, _| start(walk, to));
        while let Some((key, d)) = walk.take() {
            let page = mesh.before(key.0);
            let (p, n) = (page.point(key.1 as usize), page.normal(key.1 as usize));
            if !walk.is_settled(key, owner) {
                let (mut place, mut sum) = (Vec2::ZERO, 0.0f32);
                let (mut along, mut normal) = (Vec3::ZERO, Vec3::ZERO);
                ring(
                    |i| mesh.before(i),
                    key,
                    |other, q| {
                        let Some((far, at, [e, m])) = walk.settled(other) else { return };
                        if far >= d {
                            return;
                        }
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
                walk.settle(mesh, key, place, [flat.normalize_or(along), n]);
            }
            ring(
                |i| mesh.before(i),
                key,
                |to, q| {
                    let e = d + (q - p).length();
                    if e < radius {
                        walk.offer(mesh, to, e, owner);
                    }
                },
            );
        }
    }
}

/// A vector laid into the tangent plane of `normal` at its full length, as (along, across).
fn laid(normal: Vec3, along: Vec3, d: Vec3) -> [f32; 2] {
    let flat = d - normal * d.dot(normal);
    let stretch = d.length_squared() / flat.length_squared();
    let flat = if stretch.is_finite() { flat * stretch.sqrt() } else { Vec3::ZERO };
    [flat.dot(along), flat.dot(normal.cross(along))]
}

/// `v`, turned as `from` must be to become `to`.
fn turn(from: Vec3, to: Vec3, v: Vec3) -> Vec3 {
    if from == Vec3::ZERO || to == Vec3::ZERO { v } else { Quat::from_rotation_arc(from, to) * v }
}
