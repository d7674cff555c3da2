//! A region of the view: a box, one side of a line, or a polygon; and what is seen in it.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::scene::ObjectTransform;
use sculptd_clay::face_sets::PartEdit;

/// Corners of a polygon at most.
pub const MOST_CORNERS: usize = 1000;

/// A region of the view, (0, 0) top left to (1, 1) bottom right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ViewRegion {
    /// Between two opposite corners.
    Box([Vec2; 2]),
    /// What lies to the left of the line from the first point to the second, as it is seen.
    Line([Vec2; 2]),
    /// A closed polygon, as a lasso draws it freely or a polyline sets it point by point; 3 to
    /// [`MOST_CORNERS`] corners. Where it crosses itself, what lies inside an odd number of times.
    Polygon(Arc<Vec<Vec2>>),
}

/// What is done with the face sets of what is seen in a region, all the way through the active
/// object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SetsRegion {
    /// Where.
    pub region: ViewRegion,
    /// What is done with it.
    pub edit: PartEdit,
    /// Only what faces the eye.
    pub front_faces: bool,
}

impl ViewRegion {
    /// Whether it is a region: a line has a length, a polygon as many corners as it may have, and
    /// every number is finite.
    pub fn is_sane(&self) -> bool {
        match self {
            ViewRegion::Box(ends) => ends.iter().all(|p| p.is_finite()),
            ViewRegion::Line([a, b]) => a.is_finite() && b.is_finite() && a != b,
            ViewRegion::Polygon(all) => {
                (3..=MOST_CORNERS).contains(&all.len()) && all.iter().all(|p| p.is_finite())
            }
        }
    }

    /// Whether a place of the view lies in it. `aspect`: the view's width over its height.
    fn holds(&self, at: Vec2, aspect: f32) -> bool {
        match self {
            ViewRegion::Box([a, b]) => at.cmpge(a.min(*b)).all() && at.cmple(a.max(*b)).all(),
            ViewRegion::Line([a, b]) => {
                // The view's y goes down: what lies to the left has a cross product below 0.
                let wide = Vec2::new(aspect, 1.0);
                ((*b - *a) * wide).perp_dot((at - *a) * wide) < 0.0
            }
            ViewRegion::Polygon(corners) => {
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).filter(|(a, b)| crosses(at, **a, **b)).count() % 2 == 1
            }
        }
    }
}

/// A region before a camera, as an object sees it: made ready for many places.
#[derive(Debug)]
pub(crate) struct RegionSeen {
    region: ViewRegion,
    /// Of a polygon.
    bands: Option<Bands>,
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
        RegionSeen { region: region.clone(), bands, camera: *camera, transform, front_faces }
    }

    /// Whether a vertex of the object, place and normal, is seen in the region.
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
        (!self.front_faces || facing()) && camera.project(p).is_some_and(within)
    }

    /// What a vertex costs, as a multiple of what writing it does.
    pub(crate) fn cost(&self) -> u64 {
        PROJECTED + self.bands.as_ref().map_or(0, |b| b.most() as u64 / TESTED)
    }
}

/// What it costs to find where a vertex is seen, as a multiple of what writing it costs.
const PROJECTED: u64 = 3;
/// Edges of a polygon that a place is compared with in the time that writing a vertex takes.
const TESTED: u64 = 16;
/// Bands that a polygon is parted into, from top to bottom.
const BANDS: usize = 128;

/// The edges of a polygon by the bands of the view that they touch, so that a place is compared
/// with those of its own band alone.
#[derive(Debug)]
struct Bands {
    top: f32,
    /// Bands per height of the view.
    scale: f32,
    edges: Vec<[Vec2; 2]>,
    /// Where the edges of each band begin, and where those of the last one end.
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

/// Whether an edge of a polygon crosses the level line from a place to the right.
fn crosses(at: Vec2, a: Vec2, b: Vec2) -> bool {
    (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * ((at.y - a.y) / (b.y - a.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(region: &ViewRegion, x: f32, y: f32) -> bool {
        region.holds(Vec2::new(x, y), 1.6)
    }

    #[test]
    fn a_region_holds_what_lies_in_it() {
        let at = Vec2::new;
        let corners = ViewRegion::Box([at(0.6, 0.2), at(0.2, 0.4)]);
        assert!(held(&corners, 0.3, 0.3) && !held(&corners, 0.3, 0.5));
        // Upwards through the middle: what is left of it is the left half.
        let line = ViewRegion::Line([at(0.5, 0.9), at(0.5, 0.1)]);
        assert!(held(&line, 0.4, 0.3) && !held(&line, 0.6, 0.3));
        // An L, whose notch is outside.
        let l = [(0.1, 0.1), (0.3, 0.1), (0.3, 0.5), (0.7, 0.5), (0.7, 0.7), (0.1, 0.7)];
        let l = ViewRegion::Polygon(Arc::new(l.map(|(x, y)| at(x, y)).to_vec()));
        assert!(held(&l, 0.2, 0.2) && held(&l, 0.6, 0.6) && !held(&l, 0.5, 0.3));
        // A star drawn in one line is hollow in its middle.
        let star = [(0.5, 0.1), (0.7, 0.9), (0.1, 0.4), (0.9, 0.4), (0.3, 0.9)];
        let star = ViewRegion::Polygon(Arc::new(star.map(|(x, y)| at(x, y)).to_vec()));
        assert!(held(&star, 0.5, 0.25) && !held(&star, 0.5, 0.5));
    }

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

    #[test]
    fn what_is_no_region_is_told() {
        let sane = |region: ViewRegion| region.is_sane();
        let at = Vec2::new;
        assert!(sane(ViewRegion::Box([Vec2::ZERO, Vec2::ONE])));
        assert!(!sane(ViewRegion::Line([Vec2::ONE, Vec2::ONE])));
        assert!(!sane(ViewRegion::Polygon(Arc::new(vec![Vec2::ZERO, Vec2::ONE]))));
        assert!(!sane(ViewRegion::Box([at(f32::NAN, 0.0), Vec2::ONE])));
    }
}
