//! Rays and hits.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A half-line. `t` counts in lengths of `dir`: with unit length it is a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The start of the ray.
    pub origin: Vec3,
    /// The direction; not zero.
    pub dir: Vec3,
}

/// The point where a ray meets the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// The point that was hit.
    pub position: Vec3,
    /// Interpolated vertex normal, unit length.
    pub normal: Vec3,
    /// The page whose triangle was hit.
    pub page: u32,
    /// Within the page.
    pub triangle: u32,
    /// Weights of the triangle's corners, they sum to 1.
    pub barycentric: [f32; 3],
}
