//! Strokes drawn as guides: the orientation near a guide follows it.

use glam::DVec3;

use super::hierarchy::{FieldHold, FieldLevel};
use super::input::QuadInput;
use super::target::ProjectionTarget;

/// The distance from a guide within which its direction applies, in sides of a quad.
const REACH: f64 = 0.5;

/// Sets the direction of the vertices near the guides. Lines and pinned vertices keep theirs.
pub(super) fn apply(
    level: &mut FieldLevel,
    guides: &[Vec<DVec3>],
    input: &QuadInput,
    target: &ProjectionTarget,
) {
    // Points along the guides, on the surface: place and direction.
    let mut points: Vec<(DVec3, DVec3)> = Vec::new();
    for guide in guides {
        for ends in guide.windows(2) {
            let [a, b] = [ends[0], ends[1]].map(|p| (p - input.centre) / input.unit);
            let length = a.distance(b);
            if !(length > 0.0) || !length.is_finite() {
                continue;
            }
            let pieces = ((length / (REACH * 0.5)).ceil() as usize).clamp(1, 100_000);
            for k in 0..=pieces {
                let p = a.lerp(b, k as f64 / pieces as f64);
                if let Some((on, _)) = target.nearest(p) {
                    points.push((on, (b - a) / length));
                }
            }
        }
    }
    points.sort_by(|p, q| p.0.x.total_cmp(&q.0.x));
    for v in 0..level.positions.len() {
        if level.hold[v] != FieldHold::Free {
            continue;
        }
        let p = level.positions[v];
        let from = points.partition_point(|q| q.0.x < p.x - REACH);
        let near = points[from..]
            .iter()
            .take_while(|q| q.0.x <= p.x + REACH)
            .map(|q| (q.0.distance_squared(p), q.1))
            .filter(|q| q.0 <= REACH * REACH)
            .min_by(|x, y| x.0.total_cmp(&y.0));
        if let Some((_, along)) = near {
            let n = level.normals[v];
            level.along[v] = (along - n * along.dot(n)).normalize_or_zero();
        }
    }
}
