//! What an object shows in a region of the view.

use glam::{Vec2, Vec3};

use crate::camera::{Camera, Projection};
use crate::scene::ObjectTransform;
use crate::view_region::{ViewRegion, crosses};

/// A region before a camera, as an object sees it: made ready for many places.
#[derive(Debug)]
pub(crate) struct RegionSeen {
    region: ViewRegion,
    /// Of a polygon.
    bands: Option<Bands>,
    projection: Projection,
    camera: Camera,
    /// From the object to the world.
    transform: ObjectTransform,
    /// Only what faces the eye.
    front_faces: bool,
}

impl RegionSeen {
    /// A region that is sane, in this view, for an object that stands here.
    pub(crate) fn new(
        region: &ViewRegion,
        front_faces: bool,
        camera: &Camera,
        transform: ObjectTransform,
    ) -> RegionSeen {
        let bands = match region {
            ViewRegion::Polygon(corners) => Some(Bands::new(corners)),
            _ => None,
        };
        let (region, projection) = (region.clone(), camera.projection());
        RegionSeen { region, bands, projection, camera: *camera, transform, front_faces }
    }

    /// Returns true if a vertex of the object, with this position and normal, is seen in the
    /// region.
    pub(crate) fn holds(&self, p: Vec3, normal: Vec3) -> bool {
        let camera = &self.camera;
        let p = self.transform.point(p);
        let facing = || {
            let to_eye = if camera.orthographic { camera.backward() } else { camera.eye() - p };
            self.transform.direction(normal).dot(to_eye) > 0.0
        };
        let within = |at: Vec2| match &self.bands {
            Some(bands) => bands.hold(at),
            None => self.region.holds(at, camera.aspect),
        };
        (!self.front_faces || facing()) && self.projection.project(p).is_some_and(within)
    }

    /// Returns true if a vertex within a box of the object may be seen in the region. False means
    /// that none is.
    pub(crate) fn may_hold(&self, lo: Vec3, hi: Vec3) -> bool {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for corner in 0..8u32 {
            let side = |bit: u32| corner >> bit & 1 == 1;
            let p = Vec3::select(glam::BVec3::new(side(0), side(1), side(2)), hi, lo);
            // Partly behind the eye, it may be seen anywhere.
            let Some(at) = self.projection.project(self.transform.point(p)) else { return true };
            (low, high) = (low.min(at), high.max(at));
        }
        let ends = |all: &[Vec2]| {
            let first = (Vec2::INFINITY, Vec2::NEG_INFINITY);
            all.iter().fold(first, |(l, h), p| (l.min(*p), h.max(*p)))
        };
        let (from, to) = match &self.region {
            ViewRegion::Box(corners) => ends(corners),
            ViewRegion::Polygon(corners) => ends(corners),
            ViewRegion::Line(_) => return true,
        };
        // Margin for rounding: a point of the box may project slightly beyond its corners.
        let slack = (high - low) * 1e-3 + 1e-4;
        (low - slack).cmple(to).all() && (high + slack).cmpge(from).all()
    }

    /// Returns the cost of testing a vertex, as a multiple of the cost of writing it.
    pub(crate) fn cost(&self) -> u64 {
        PROJECTED + self.bands.as_ref().map_or(0, |b| b.most() as u64 / TESTED)
    }
}

/// Cost of projecting a vertex, as a multiple of the cost of writing it.
const PROJECTED: u64 = 3;
/// Edges of a polygon that can be tested in the time that writing a vertex takes.
const TESTED: u64 = 16;
/// Number of bands that divide a polygon from top to bottom.
const BANDS: usize = 128;

/// The edges of a polygon, grouped by the bands of the view that they touch. A point is tested only
/// against the edges of its band.
#[derive(Debug)]
struct Bands {
    top: f32,
    /// Bands per height of the view.
    scale: f32,
    edges: Vec<[Vec2; 2]>,
    /// Start of each band's edges, and the end of the last one.
    starts: Vec<u32>,
    order: Vec<u16>,
}

impl Bands {
    fn new(corners: &[Vec2]) -> Bands {
        let next = corners.iter().cycle().skip(1);
        let edges: Vec<[Vec2; 2]> = corners.iter().zip(next).map(|(a, b)| [*a, *b]).collect();
        let top = corners.iter().map(|c| c.y).fold(f32::INFINITY, f32::min);
        let foot = corners.iter().map(|c| c.y).fold(f32::NEG_INFINITY, f32::max);
        let mut bands = Bands {
            top,
            scale: BANDS as f32 / (foot - top),
            edges,
            starts: vec![0; BANDS + 1],
            order: Vec::new(),
        };
        let touched: Vec<_> = bands
            .edges
            .iter()
            .map(|[a, b]| bands.of(a.y.min(b.y))..=bands.of(a.y.max(b.y)))
            .collect();
        for band in touched.iter().cloned().flatten() {
            bands.starts[band + 1] += 1;
        }
        for band in 0..BANDS {
            bands.starts[band + 1] += bands.starts[band];
        }
        bands.order.resize(bands.starts[BANDS] as usize, 0);
        let mut free = bands.starts.clone();
        for (edge, touched) in touched.into_iter().enumerate() {
            for band in touched {
                bands.order[free[band] as usize] = edge as u16;
                free[band] += 1;
            }
        }
        bands
    }

    /// The band of a height. It never falls where the height grows, so that an edge is in the band
    /// of each height that it spans.
    fn of(&self, y: f32) -> usize {
        (((y - self.top) * self.scale) as usize).min(BANDS - 1)
    }

    fn hold(&self, at: Vec2) -> bool {
        let band = self.of(at.y);
        let edges = &self.order[self.starts[band] as usize..self.starts[band + 1] as usize];
        let crossed = edges.iter().filter(|e| {
            let [a, b] = self.edges[usize::from(**e)];
            crosses(at, a, b)
        });
        crossed.count() % 2 == 1
    }

    /// Edges of the band that has most.
    fn most(&self) -> u32 {
        self.starts.windows(2).map(|two| two[1] - two[0]).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn bands_hold_what_the_polygon_holds() {
        // Lines drawn to and fro, level and upright ones, one that has no height at all.
        let star = |n: usize, k: usize| -> Vec<Vec2> {
            let angle = |i: usize| (i * k) as f32 / n as f32 * std::f32::consts::TAU;
            (0..n).map(|i| Vec2::splat(0.5) + 0.4 * Vec2::from_angle(angle(i))).collect()
        };
        let square = [(0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8)];
        let flat = [(0.1, 0.5), (0.9, 0.5), (0.4, 0.5)];
        let square = square.map(|(x, y)| Vec2::new(x, y)).to_vec();
        let flat = flat.map(|(x, y)| Vec2::new(x, y)).to_vec();
        for corners in [square, flat, star(5, 2), star(1000, 1), star(999, 400)] {
            let bands = Bands::new(&corners);
            let plain = ViewRegion::Polygon(Arc::new(corners.clone()));
            let places = (0..101 * 101).map(|i| Vec2::new((i % 101) as f32, (i / 101) as f32));
            let places = places.map(|p| p * 0.012 - 0.1).chain(corners);
            let mut inside = 0;
            for at in places {
                assert_eq!(bands.hold(at), plain.holds(at, 1.6), "{at}");
                inside += usize::from(bands.hold(at));
            }
            assert!(inside > 500 || bands.scale.is_infinite(), "{inside}");
        }
        assert!(!Bands::new(&star(5, 2)).hold(Vec2::NAN));
    }
}
