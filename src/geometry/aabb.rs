//! The axis-aligned box.

use glam::DVec3;
use serde::Serialize;

/// An axis-aligned box in double precision, in the unit of what it was made from. As JSON it is
/// `{"min": [x, y, z], "max": [x, y, z]}`.
///
/// ```
/// use glam::DVec3;
/// use sculptd_geometry::Aabb;
///
/// let b = Aabb::of([DVec3::ZERO, DVec3::new(1.0, 4.0, 2.0)]);
/// assert_eq!((b.centre(), b.size().max_element()), (DVec3::new(0.5, 2.0, 1.0), 4.0));
/// assert!(Aabb::EMPTY.is_empty());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Aabb {
    /// The lower corner; +infinity in an empty box.
    pub min: DVec3,
    /// The upper corner; -infinity in an empty box.
    pub max: DVec3,
}

impl Aabb {
    /// The box that holds nothing: the neutral element of [`Aabb::join`].
    pub const EMPTY: Aabb = Aabb { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, |b, p| Aabb { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box around both.
    pub fn join(self, other: Aabb) -> Aabb {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Returns true if the boxes have a point in common; a shared face counts.
    pub fn meets(&self, other: &Aabb) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// The box with each side moved outwards by `by`.
    pub fn grown(self, by: f64) -> Aabb {
        Aabb { min: self.min - by, max: self.max + by }
    }

    /// Returns true if the box holds no point, or has a coordinate that is not a number.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The middle; zero for an empty box. Halved before the sum, which therefore cannot overflow.
    pub fn centre(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.min * 0.5 + self.max * 0.5 }
    }

    /// The extents along x, y and z; zero for an empty box.
    pub fn size(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }
}
