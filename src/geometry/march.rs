//! Rays through a sampled distance: each step is as long as the distance allows (Hart, "Sphere
//! tracing: a geometric method for the antialiased ray tracing of implicit surfaces", 1996).

use glam::DVec3;

use super::grid::DistanceGrid;

/// Nearer to the surface than this is a hit, where the caller does not say: a thousandth of a unit,
/// but never more than a fiftieth of the spacing.
pub fn default_epsilon(grid: &DistanceGrid) -> f64 {
    (grid.spacing * 0.02).min(1e-3)
}

/// Steps before a ray is left to the mesh.
const MOST_STEPS: usize = 4096;

/// The result of marching a ray through the field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MarchOutcome {
    /// The ray enters the solid; the distance along it at which it comes within `epsilon`.
    Hit(f64),
    /// The ray passes the solid.
    Miss,
    /// The ray comes closer to the surface than the field's error, so the mesh must decide.
    Unsure,
}

/// The greatest error of the trilinear interpolant of a distance, in spacings. A distance changes
/// by no more than the distance moved. The mean square distance to the corners of a cell, with the
/// interpolant's weights, is `x (1 - x) + y (1 - y) + z (1 - z)`, at most 3/4.
const INTERPOLATION: f64 = 0.867;

/// Finds where the ray from `origin` along `dir` (of unit length) comes within `epsilon` of the
/// solid, or enters it. A hit continues into the solid by more than the interpolation error. A miss
/// keeps away by more than that from where it enters the grid's box to where it leaves it.
/// Everything between is [`MarchOutcome::Unsure`], a band of about a spacing around the outline.
pub fn march(grid: &DistanceGrid, origin: DVec3, dir: DVec3, epsilon: f64) -> MarchOutcome {
    let (lo, hi) = (grid.origin, grid.end());
    let inverse = dir.recip();
    let (a, b) = ((lo - origin) * inverse, (hi - origin) * inverse);
    // An axis along which the ray does not move gives NaN on the box's own side: not a bound.
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        if dir[axis] == 0.0 {
            if origin[axis] < lo[axis] || origin[axis] > hi[axis] {
                return MarchOutcome::Miss;
            }
            continue;
        }
        enter = enter.max(a[axis].min(b[axis]));
        leave = leave.min(a[axis].max(b[axis]));
    }
    let unsure = INTERPOLATION * grid.spacing;
    let (mut t, mut hit, mut close) = (enter, None, false);
    for _ in 0..MOST_STEPS {
        if t > leave {
            return if close { MarchOutcome::Unsure } else { MarchOutcome::Miss };
        }
        let d = grid.interpolate(origin + dir * t) as f64;
        if d < epsilon && hit.is_none() {
            hit = Some(t);
        }
        if d < -unsure {
            return MarchOutcome::Hit(hit.unwrap_or(t));
        }
        // The true distance is at least `d - unsure`, so a long step meets nothing before its end;
        // of a short one the surface may be an eighth of a spacing away from both ends.
        close |= d < epsilon + unsure + grid.spacing * 0.125;
        t += (d.abs() - unsure).max(grid.spacing * 0.25);
    }
    MarchOutcome::Unsure
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_the_surface_the_field_does_not_decide() {
        // A ball of radius 3 in a grid of spacing 1.
        let n = 11;
        let values = (0..n * n * n)
            .map(|i| {
                let p = DVec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64);
                ((p - 5.0).length() - 3.0) as f32
            })
            .collect();
        let grid = DistanceGrid { origin: DVec3::splat(-5.0), spacing: 1.0, size: [n; 3], values };
        let down = |x: f64| march(&grid, DVec3::new(x, 0.0, 20.0), DVec3::NEG_Z, 0.01);
        assert!(matches!(down(0.0), MarchOutcome::Hit(t) if (t - 17.0).abs() < 0.5));
        assert_eq!(down(4.5), MarchOutcome::Miss);
        assert_eq!((down(2.9), down(3.2)), (MarchOutcome::Unsure, MarchOutcome::Unsure));
    }
}
