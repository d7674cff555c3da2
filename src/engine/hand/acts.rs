//! What a hand asks of the world, as plain data.

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::{Similarity, Volume};
use crate::scene::ObjectTransform;
use sculptd_clay::Reach;
use sculptd_clay::brush;

/// Something that a hand does to the clay, the view or what it holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Act {
    /// A fingertip or a fist pushes clay away.
    Push(Push),
    /// A pinch carries clay along.
    Drag(Drag),
    /// A flat hand presses and smooths.
    Palm(PalmPress),
    /// View fractions, as [`crate::camera::Camera::orbit`] takes them.
    Orbit(Vec2),
    /// The work moves by this much of the world.
    Move(Vec3),
    /// Above 1 comes nearer.
    Zoom(f32),
    /// The tracked volume was moved, turned and scaled under two pinches; the camera goes with it.
    Hold {
        /// The volume one frame ago.
        before: Volume,
        /// The volume now.
        after: Volume,
    },
    /// The thing in the hands goes along.
    Carry(Similarity),
}

impl Act {
    /// Lengthens this act by the next one of its kind; `false` if they are of different kinds.
    pub fn join(&mut self, next: &Act) -> bool {
        match (self, next) {
            (Act::Push(a), Act::Push(b)) => a.to = b.to,
            (Act::Drag(a), Act::Drag(b)) => a.to = b.to,
            (Act::Palm(a), Act::Palm(b)) => (a.to, a.normal) = (b.to, b.normal),
            (Act::Orbit(a), Act::Orbit(b)) => *a += *b,
            (Act::Move(a), Act::Move(b)) => *a += *b,
            (Act::Zoom(a), Act::Zoom(b)) => *a *= *b,
            (Act::Hold { after: a, .. }, Act::Hold { after: b, .. }) => *a = *b,
            (Act::Carry(a), Act::Carry(b)) => *a = a.then(b),
            _ => return false,
        }
        true
    }
}

/// A ball swept from one place to another, world units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Push {
    /// Centre of the ball at the start.
    pub from: Vec3,
    /// Centre of the ball at the end.
    pub to: Vec3,
    /// The radius of the ball, > 0.
    pub radius: f32,
    /// Share of the full displacement, 0 to 1.
    pub strength: f32,
}

impl Push {
    /// The same in the frame of an object; `own`: from the world to the object.
    pub fn seen_from(&self, own: &ObjectTransform) -> Self {
        if own.is_none() {
            return *self;
        }
        Push {
            from: own.point(self.from),
            to: own.point(self.to),
            radius: self.radius * own.scale as f32,
            ..*self
        }
    }

    /// The part of space that the sweep touches.
    pub fn reach(&self) -> Reach {
        Reach::Capsule { from: self.from, to: self.to, radius: self.radius }
    }

    /// The brush that makes the sweep.
    pub fn kernel(&self) -> brush::Push {
        brush::Push::new(self.from, self.to, self.radius, self.strength)
    }
}

/// Two fingertips that hold clay and carry it along.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drag {
    /// Between the fingertips one frame ago, world units.
    pub from: Vec3,
    /// Between the fingertips now.
    pub to: Vec3,
    /// Radius of clay that moves along, in world units, > 0.
    pub radius: f32,
    /// Share of the way that clay goes along, 0 to 1.
    pub strength: f32,
}

impl Drag {
    /// The same in the frame of an object; `own`: from the world to the object.
    pub fn seen_from(&self, own: &ObjectTransform) -> Self {
        if own.is_none() {
            return *self;
        }
        Drag {
            from: own.point(self.from),
            to: own.point(self.to),
            radius: self.radius * own.scale as f32,
            ..*self
        }
    }

    /// The part of space that goes along.
    pub fn reach(&self) -> Reach {
        Reach::Sphere { centre: self.from, radius: self.radius }
    }

    /// The brush that carries the clay.
    pub fn kernel(&self) -> brush::Drag {
        brush::Drag::new(self.from, (self.to - self.from) * self.strength, self.radius)
    }
}

/// A palm pressed on the clay: a disc, facing along `normal`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PalmPress {
    /// The middle of the palm one frame ago, world units.
    pub from: Vec3,
    /// The middle of the palm now.
    pub to: Vec3,
    /// Out of the palm, unit length.
    pub normal: Vec3,
    /// The radius of the disc, world units, > 0.
    pub radius: f32,
    /// Share of the full pressure, 0 to 1.
    pub strength: f32,
}

impl PalmPress {
    /// The same in the frame of an object; `own`: from the world to the object.
    pub fn seen_from(&self, own: &ObjectTransform) -> Self {
        if own.is_none() {
            return *self;
        }
        PalmPress {
            from: own.point(self.from),
            to: own.point(self.to),
            normal: own.direction(self.normal),
            radius: self.radius * own.scale as f32,
            ..*self
        }
    }

    /// The part of space that the disc touches.
    pub fn reach(&self) -> Reach {
        Reach::Capsule { from: self.from, to: self.to, radius: self.radius }
    }

    /// The brush that presses.
    pub fn kernel(&self) -> brush::Palm {
        brush::Palm::new(self.from, self.to, self.normal, self.radius, self.strength)
    }
}
