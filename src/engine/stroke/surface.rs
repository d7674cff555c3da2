//! Input and output of a stroke: the pen at an instant, the surface under it, and the position of a
//! dab within its stroke.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use sculptd_clay::{Hit, Ray};

/// A pen at an instant, mapped to the view.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PenPoint {
    /// View coordinates, (0, 0) top left to (1, 1) bottom right.
    pub view: Vec2,
    /// 0 to 1.
    pub pressure: f32,
    /// Radians, as in [`sculptd_devices::Pen`].
    pub tilt: Option<Vec2>,
    /// The other end of the pen: what the brush does, the other way round.
    pub inverted: bool,
}

impl PenPoint {
    /// Between this point (`t` = 0) and `to` (1). A tilt that only one of them has is taken as is.
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

/// Budget of the tick: whether another dab may be laid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Lay the next dab.
    Go,
    /// Stop here; the rest of the path is walked in the next tick.
    Pause,
}

/// Method that turns a pen's path into dabs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrokeMethod {
    /// One a spacing.
    Spaced,
    /// One a report.
    Each,
    /// The brush receives the pen's position and does the rest.
    Held,
    /// A straight line, once the pen lifts.
    Line,
    /// A curve that is laid by handles first; see [`crate::stroke::curve_stroke`].
    Curve,
}

/// Relation of a dab to the previous one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Laid {
    /// The first of a run: the one before it, if there is one, may be any way off.
    pub first: bool,
    /// Direction from the one before it, of length one; none for the first of a run.
    pub along: Option<Vec3>,
    /// The part of a whole dab's strength that is due to the way since the one before it: 1, and
    /// less where a dab had to be laid before a whole spacing was travelled. Above 0, at most 1.
    pub share: f32,
    /// The dab of a pen that was lifted where it came down: its pressure counts in full, however
    /// softly the stroke began.
    pub tap: bool,
}

impl Laid {
    /// A dab by itself.
    pub const ALONE: Laid = Laid { first: true, along: None, share: 1.0, tap: false };
}

/// Surface that a stroke is drawn on.
pub trait Surface {
    /// Returns the first hit of the ray through a point of the view.
    fn pick(&mut self, view: Vec2) -> Option<Hit>;
    /// The wanted distance between dabs here, mesh units, > 0.
    fn spacing(&self, at: &PenPoint) -> f32;
    /// Length of the string by which the brush follows the pen in a stroke that begins here, in
    /// heights of the view; 0: none.
    fn string(&mut self, _at: &PenPoint) -> f32 {
        0.0
    }
    /// World length of a step of one view height at the hit's depth.
    fn world_per_view(&self, hit: &Hit) -> f32;
    /// Returns the method that turns the pen's path into dabs.
    fn way(&self) -> StrokeMethod {
        StrokeMethod::Spaced
    }
    /// A held brush: the pen came down here, or is here now.
    fn hold(&mut self, _at: &PenPoint, _began: bool) -> Flow {
        Flow::Go
    }
    /// The surface along a ray that is not one of sight, at most `far` mesh units from its origin.
    fn drop(&mut self, ray: Ray, far: f32) -> Option<Hit>;
    /// Applies a dab.
    fn dab(&mut self, at: &PenPoint, hit: &Hit, laid: Laid) -> Flow;
}
