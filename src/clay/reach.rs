//! What part of space a dab or a query concerns.

use glam::Vec3;

/// Parts of a capsule's axis that are looked at one by one.
const STEPS: usize = 4;

/// A closed part of space, mesh units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// All points within `radius` of `centre`.
    Sphere {
        /// The centre.
        centre: Vec3,
        /// The radius, > 0.
        radius: f32,
    },
    /// All points within `radius` of the segment between `from` and `to`.
    Capsule {
        /// The start of the axis.
        from: Vec3,
        /// The end of the axis.
        to: Vec3,
        /// The distance to the axis, > 0.
        radius: f32,
    },
}

impl Reach {
    /// Returns true if the reach may touch a box; never false for a box that it touches.
    #[inline]
    pub fn touches(&self, lo: Vec3, hi: Vec3) -> bool {
        match *self {
            Reach::Sphere { centre, radius } => {
                (centre - centre.clamp(lo, hi)).length_squared() <= radius * radius
            }
            Reach::Capsule { from, to, radius } => {
                if !((from.min(to) - radius).cmple(hi).all()
                    && (from.max(to) + radius).cmpge(lo).all())
                {
                    return false;
                }
                // A ball around the box against the axis: cheap, and never wrongly "no".
                let (middle, half) = ((lo + hi) * 0.5, (hi - lo).length() * 0.5);
                if self.distance_squared(middle) > (radius + half) * (radius + half) * 1.000_001 {
                    return false;
                }
                // The box against points of the axis: no other is further than half a step from
                // one of them.
                let along = to - from;
                let far = radius + along.length() * (0.5 / STEPS as f32);
                let far2 = far * far * 1.000_001;
                (0..=STEPS).any(|i| {
                    let p = from + along * (i as f32 / STEPS as f32);
                    (p - p.clamp(lo, hi)).length_squared() <= far2
                })
            }
        }
    }

    /// Squared distance to the sphere's centre or the capsule's axis.
    #[inline]
    pub fn distance_squared(&self, p: Vec3) -> f32 {
        match *self {
            Reach::Sphere { centre, .. } => (p - centre).length_squared(),
            Reach::Capsule { from, to, .. } => {
                let along = to - from;
                let length2 = along.length_squared();
                let t = if length2 > 0.0 {
                    ((p - from).dot(along) / length2).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                (p - (from + along * t)).length_squared()
            }
        }
    }

    /// The radius of the sphere or of the capsule.
    pub fn radius(&self) -> f32 {
        match *self {
            Reach::Sphere { radius, .. } | Reach::Capsule { radius, .. } => radius,
        }
    }

    /// Returns true if the point is within the reach, its border included.
    #[inline]
    pub fn contains(&self, p: Vec3) -> bool {
        self.distance_squared(p) <= self.radius() * self.radius()
    }
}
