//! Trimming: what is seen within a box, or on one side of a line, is cut off the work, all the way
//! through, by a Boolean.

use glam::{Vec2, Vec3};
use serde::Deserialize;

use super::published::Published;
use crate::boolean_jobs::{self, Joined};
use crate::operations::{OperationError, Target};
use sculptd_engine::camera::Camera;
use sculptd_geometry::boolean::Operation;
use sculptd_geometry::job::Job;
use sculptd_geometry::{PolyMesh, TriMesh};

/// A part of the view, (0, 0) top left to (1, 1) bottom right.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Part {
    /// Two opposite corners: x, y, x, y.
    Box([f32; 4]),
    /// The part left of the direction from the first point to the second.
    Line([f32; 4]),
}

impl Part {
    /// Its corners, in order; `None` for one without an area.
    fn corners(&self, aspect: f32) -> Option<[Vec2; 4]> {
        match *self {
            Part::Box([x0, y0, x1, y1]) => {
                let (lo, hi) =
                    (Vec2::new(x0.min(x1), y0.min(y1)), Vec2::new(x0.max(x1), y0.max(y1)));
                let sane = lo.is_finite() && hi.is_finite() && (hi - lo).min_element() > 1e-4;
                sane.then(|| [lo, Vec2::new(lo.x, hi.y), hi, Vec2::new(hi.x, lo.y)])
            }
            Part::Line([x0, y0, x1, y1]) => {
                let scale = Vec2::new(aspect, 1.0);
                let (a, b) = (Vec2::new(x0, y0) * scale, Vec2::new(x1, y1) * scale);
                let along = (b - a).try_normalize().filter(|_| (b - a).length() > 1e-4)?;
                // y runs down: this is to the left as seen. Four views are further than any work in
                // view.
                let left = Vec2::new(along.y, -along.x);
                let (back, ahead) = (a - along * 4.0, b + along * 4.0);
                Some([back, ahead, ahead + left * 4.0, back + left * 4.0].map(|p| p / scale))
            }
        }
    }
}

/// Returns the solid that is visible within a part of the view, from in front of a ball to behind
/// it.
pub fn trim_solid(camera: &Camera, part: &Part, middle: Vec3, radius: f32) -> Option<TriMesh> {
    let corners = part.corners(camera.aspect)?;
    let back = camera.backward();
    let margin = radius * 1.1;
    let mut near = margin;
    if !camera.orthographic {
        near = near.min((camera.eye() - middle).dot(back) - radius * 1e-3);
    }
    if near <= -margin {
        return None;
    }
    let at = |corner: Vec2, plane: f32| {
        let ray = camera.ray(corner);
        let t = ((ray.origin - middle).dot(back) - plane) / -ray.dir.dot(back);
        ray.origin + ray.dir * t
    };
    let mut out = TriMesh::default();
    out.positions.extend(corners.map(|c| at(c, near)));
    out.positions.extend(corners.map(|c| at(c, -margin)));
    let quads =
        [[0, 1, 2, 3], [7, 6, 5, 4], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]];
    out.triangles
        .extend(quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]));
    let volume: f32 = (0..out.triangles.len())
        .map(|t| {
            let [a, b, c] = out.corners(t).map(|p| p - middle);
            a.dot(b.cross(c))
        })
        .sum();
    if !volume.is_finite() {
        return None;
    }
    if volume < 0.0 {
        out.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Some(out)
}

/// Cuts the part off the active object and waits for the loop to install the result.
///
/// # Errors
/// Why nothing was changed.
pub fn carry_out(to: Target<'_>, part: &Part, job: &Job) -> Result<Joined, OperationError> {
    // The held object is not trimmed.
    boolean_jobs::carry_out(to, |now| tool(now, part), false, Operation::Difference, job)
}

/// Returns the solid to cut off, in the world's frame. It encloses every visible point of the
/// active object in that part.
///
/// # Errors
/// Returns an error if nothing is visible there.
pub fn tool(now: &Published, part: &Part) -> Result<PolyMesh, OperationError> {
    let (lo, hi) = now.transform().bounds(now.mesh.bounds());
    let (middle, radius) = ((lo + hi) * 0.5, (hi - lo).length() * 0.5);
    let plain = trim_solid(&now.camera, part, middle, radius).ok_or(OperationError::NoPart)?;
    Ok(plain.to_poly())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prism_is_what_is_seen_within_the_part() {
        for orthographic in [false, true] {
            let camera = Camera { orthographic, ..Camera::default() };
            let part = Part::Box([0.6, 0.7, 0.3, 0.2]);
            let solid = trim_solid(&camera, &part, Vec3::ZERO, 1.0).expect("a solid");
            let want = [[0.3, 0.2], [0.3, 0.7], [0.6, 0.7], [0.6, 0.2]];
            for (k, p) in solid.positions.iter().enumerate() {
                let seen = camera.project(*p).expect("before the eye");
                assert!((seen - Vec2::from(want[k % 4])).length() < 1e-5, "{seen}");
            }
            let line = Part::Line([0.5, 1.0, 0.5, 0.0]);
            let left = trim_solid(&camera, &line, Vec3::ZERO, 1.0).expect("a solid");
            assert!(
                left.positions
                    .iter()
                    .all(|p| camera.project(*p).expect("before the eye").x < 0.501)
            );
        }
        let none = Part::Box([0.3, 0.2, 0.3, 0.9]);
        assert!(trim_solid(&Camera::default(), &none, Vec3::ZERO, 1.0).is_none());
    }
}
