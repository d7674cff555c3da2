//! The wall or the gap under the pointer, by the definition *ray*: where the ray along the normal
//! leaves the clay again, or meets it. Looked up in the clay itself, not in the map, so it holds
//! between vertices too.

use glam::Vec3;

use sculptd_clay::{Hit, Ray};
use sculptd_daemon::Published;
use sculptd_geometry::thickness::MeasuredSide;

/// The ray begins this far below the surface, of the largest coordinate: beyond the rounding of the
/// point where it begins.
const BELOW: f32 = 2e-6;

/// A wall or a gap at a place of the surface, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProbedWall {
    /// On the surface.
    pub place: Vec3,
    /// Away from the measured side: outward at a wall, inward at a gap.
    pub normal: Vec3,
    /// Along the normal to the opposite side.
    pub thickness: f32,
    /// Outward on the opposite side.
    pub opposite: Vec3,
}

/// The largest ball in the wall at a place, by the definition *sphere*, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallBall {
    /// On the surface.
    pub place: Vec3,
    /// Away from the ball.
    pub normal: Vec3,
    /// Its diameter.
    pub diameter: f32,
}

impl WallBall {
    /// Returns true if it touches the surface near enough to a place to be shown for it.
    pub fn is_at(&self, place: Vec3) -> bool {
        self.place.distance(place) <= 0.1 * self.diameter
    }
}

/// Returns the wall behind the surface that is seen on a ray, or the gap in front of it, along the
/// normal of the triangle that is hit; `None` if nothing is hit, if it is hit from inside, or if
/// there is no surface on that side.
pub fn wall_on(state: &Published, ray: Ray, side: MeasuredSide) -> Option<ProbedWall> {
    let to_world = state.transform();
    let own = to_world.inverse().ray(ray);
    // Vertex normals of a hard-edged part are no face's.
    let flat = |hit: &Hit| {
        let [a, b, c] = state.mesh.page(hit.page).corners(hit.triangle as usize);
        (b - a).cross(c - a).normalize_or(hit.normal)
    };
    let near = state.mesh.pick(own)?;
    let normal = flat(&near);
    // The inside of a form, through a cut.
    if normal.dot(own.dir) > 0.0 {
        return None;
    }
    let (lo, hi) = state.mesh.bounds();
    let normal = if side == MeasuredSide::Wall { normal } else { -normal };
    let below = lo.abs().max(hi.abs()).max_element() * BELOW;
    let far = state.mesh.pick(Ray { origin: near.position - normal * below, dir: -normal })?;
    Some(ProbedWall {
        place: to_world.point(near.position),
        normal: to_world.direction(normal),
        thickness: (f64::from(far.t + below) * to_world.scale) as f32,
        opposite: to_world.direction(flat(&far)),
    })
}
