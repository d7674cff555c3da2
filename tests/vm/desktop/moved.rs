//! Which vertices strokes have moved, and how far from the pen's path.

use std::path::PathBuf;

use glam::{DVec2, Vec3};
use sculptd_engine::camera::Camera;
use serde_json::json;

use super::drive::ask;

/// The positions of all vertices, in order.
pub fn vertices(name: &str) -> Vec<Vec3> {
    let path = PathBuf::from(format!("/tmp/{name}.obj"));
    ask("export", &json!({ "path": path }));
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    let line = |l: &str| {
        let mut numbers = l.strip_prefix("v ")?.split_whitespace().map(str::parse::<f32>);
        let mut next = || numbers.next()?.ok();
        Some(Vec3::new(next()?, next()?, next()?))
    };
    text.lines().filter_map(line).collect()
}

/// The view on the desktop: corner and size, pixels.
#[derive(Debug, Clone, Copy)]
pub struct ViewRect {
    pub corner: DVec2,
    pub size: DVec2,
}

/// Measures the distance of moved vertices from the segments of the paths. Returns the number of
/// moved vertices, the number outside the brush's reach, and the greatest distance in radii of the
/// brush.
pub fn beside(
    before: &[Vec3],
    after: &[Vec3],
    paths: &[(DVec2, DVec2)],
    camera: &Camera,
    view: &ViewRect,
    radius: f32,
) -> (usize, usize, f64) {
    let (mut moved, mut outside, mut worst) = (0, 0, 0.0f64);
    for (a, b) in before.iter().zip(after).filter(|(a, b)| a.distance(**b) > 1e-6) {
        moved += 1;
        // The position now or before: a dab acts on the surface at its time.
        let off = |p: Vec3| {
            let at = camera.project(p)?;
            let pixel = view.corner + view.size * at.as_dvec2();
            let depth = (camera.eye() - p).dot(camera.backward());
            let reach = f64::from(radius / camera.world_per_view(depth.max(1e-3))) * view.size.y;
            let near = paths.iter().map(|(a, b)| to_segment(pixel, *a, *b));
            Some((near.fold(f64::INFINITY, f64::min) - 3.0) / reach)
        };
        let least = [*a, *b].into_iter().filter_map(off).fold(f64::INFINITY, f64::min);
        outside += usize::from(least > 1.05);
        worst = worst.max(least);
    }
    (moved, outside, worst)
}

fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let s = ((p - a).dot(along) / along.length_squared().max(1e-9)).clamp(0.0, 1.0);
    p.distance(a + along * s)
}
