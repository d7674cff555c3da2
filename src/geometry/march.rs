//! Rays through a sampled distance: each step is as long as the distance allows (Hart, "Sphere
//! tracing", 1996).

use glam::DVec3;

use super::grid::DistanceGrid;

/// Nearer to the surface than this is a hit, where the caller does not say: a thousandth of a unit,
/// but never more than a fiftieth of the spacing.
pub fn default_epsilon(grid: &DistanceGrid) -> f64 {
    (grid.spacing * 0.02).min(1e-3)
}

/// Steps before a ray that creeps along the surface counts as a miss.
const MOST_STEPS: usize = 4096;

/// Where along `dir` (of unit length) the ray from `origin` comes within `epsilon` of the solid or
/// enters it; `None` once it has passed the grid's box. Trilinear interpolation errs by about
/// `spacing^2` times the curvature: rays that pass the outline within a voxel may be judged
/// otherwise than by the mesh.
pub fn march(grid: &DistanceGrid, origin: DVec3, dir: DVec3, epsilon: f64) -> Option<f64> {
    let (lo, hi) = (grid.origin, grid.end());
    let inverse = dir.recip();
    let (a, b) = ((lo - origin) * inverse, (hi - origin) * inverse);
    // An axis along which the ray does not move gives NaN on the box's own side: not a bound.
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        if dir[axis] == 0.0 {
            if origin[axis] < lo[axis] || origin[axis] > hi[axis] {
                return None;
            }
            continue;
        }
        enter = enter.max(a[axis].min(b[axis]));
        leave = leave.min(a[axis].max(b[axis]));
    }
    let mut t = enter;
    for _ in 0..MOST_STEPS {
        if t > leave {
            return None;
        }
        let d = grid.interpolate(origin + dir * t) as f64;
        if d < epsilon {
            return Some(t);
        }
        t += d;
    }
    None
}
