//! A region of the view: a box, one side of a line, or a polygon.

use std::sync::Arc;

use glam::Vec2;
use serde::{Deserialize, Serialize};

use sculptd_clay::face_sets::PartEdit;

/// Corners of a polygon at most.
pub const MOST_CORNERS: usize = 1000;

/// A region of the view, (0, 0) top left to (1, 1) bottom right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ViewRegion {
    /// Between two opposite corners.
    Box([Vec2; 2]),
    /// The left side of the line from the first point to the second, as seen in the view.
    Line([Vec2; 2]),
    /// A closed polygon, from a lasso or a polyline; 3 to [`MOST_CORNERS`] corners. If it crosses
    /// itself, a point is inside by the even-odd rule.
    Polygon(Arc<Vec<Vec2>>),
}

/// Edit of the face sets seen in a region, all the way through the active object.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SetsRegion {
    /// The region.
    pub region: ViewRegion,
    /// Edit of the faces inside.
    pub edit: PartEdit,
    /// Only what faces the eye.
    pub front_faces: bool,
}

impl ViewRegion {
    /// Returns true if the region is valid: a line has a length, a polygon has an allowed number of
    /// corners, and every number is finite.
    pub fn is_sane(&self) -> bool {
        match self {
            ViewRegion::Box(ends) => ends.iter().all(|p| p.is_finite()),
            ViewRegion::Line([a, b]) => a.is_finite() && b.is_finite() && a != b,
            ViewRegion::Polygon(all) => {
                (3..=MOST_CORNERS).contains(&all.len()) && all.iter().all(|p| p.is_finite())
            }
        }
    }

    /// Returns true if the region contains a point of the view. `aspect`: the view's width over its
    /// height.
    pub(crate) fn holds(&self, at: Vec2, aspect: f32) -> bool {
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

/// Returns true if an edge of a polygon crosses the horizontal ray from a point to the right.
pub(crate) fn crosses(at: Vec2, a: Vec2, b: Vec2) -> bool {
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
    fn what_is_no_region_is_told() {
        let sane = |region: ViewRegion| region.is_sane();
        let at = Vec2::new;
        assert!(sane(ViewRegion::Box([Vec2::ZERO, Vec2::ONE])));
        assert!(!sane(ViewRegion::Line([Vec2::ONE, Vec2::ONE])));
        assert!(!sane(ViewRegion::Polygon(Arc::new(vec![Vec2::ZERO, Vec2::ONE]))));
        assert!(!sane(ViewRegion::Box([at(f32::NAN, 0.0), Vec2::ONE])));
    }
}
