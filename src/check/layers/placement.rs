//! How a part stands: its first layer, whether it tips over, and whether it fits its machine.

use glam::{DVec2, DVec3};
use sculptd_geometry::PolyMesh;
use sculptd_geometry::portable::PortableMath;
use sculptd_geometry::section::Slicer;

use crate::part::{PreparedPart, Standing};

/// Turns about the build direction that are tried, over a quarter turn.
const TURNS: usize = 90;

/// The first layer of a part.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FirstLayer {
    /// Its area, at half the height of the layer.
    pub area: f64,
    /// Its centre; the origin where it has no area.
    pub centre: DVec3,
    /// The convex hull in the plan, counter-clockwise.
    pub hull: Vec<DVec2>,
}

/// Cuts the part at half the height of its first layer.
pub fn first_layer(part: &PreparedPart, stand: &Standing, layer: f64) -> FirstLayer {
    let level = stand.plate + (layer * 0.5).min((stand.top - stand.plate) * 0.5);
    let (low, high) = (level - part.tolerance, level + part.tolerance);
    let mut mesh = PolyMesh::new();
    let mut names = vec![u32::MAX; part.places.len()];
    for t in &part.topology().triangles {
        let Some(h) = (t[0] != u32::MAX).then(|| t.map(|v| stand.heights[v as usize])) else {
            continue;
        };
        if h[0].min(h[1]).min(h[2]) > high || h[0].max(h[1]).max(h[2]) < low {
            continue;
        }
        let corners = t.map(|v| {
            if names[v as usize] == u32::MAX {
                names[v as usize] = mesh.positions.len() as u32;
                mesh.positions.push(part.places[v as usize]);
            }
            names[v as usize]
        });
        mesh.push_face(&corners);
    }
    let Some(slicer) = Slicer::new(&mesh, stand.up) else { return FirstLayer::default() };
    let section = slicer.at(level);
    let (u, v) = stand.plan();
    let points = section.contours.iter().flat_map(|c| &c.points);
    let hull = convex_hull(points.map(|p| DVec2::new(p.dot(u), p.dot(v))).collect());
    FirstLayer { area: section.area, centre: section.centroid.unwrap_or_default(), hull }
}

/// Returns true if an area reaches a limit; a tie up to rounding does.
pub fn covers(part: &PreparedPart, area: f64, limit: f64) -> bool {
    area >= limit - 4.0 * part.tolerance * limit.sqrt() - 1e-9 * limit
}

/// The convex hull, counter-clockwise, without points on its sides (Andrew, 1979).
pub fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.retain(|p| p.is_finite());
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull: Vec<DVec2> = Vec::with_capacity(points.len() + 1);
    let chain = |hull: &mut Vec<DVec2>, p: DVec2, least: usize| {
        while hull.len() >= least + 2 {
            let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
            if (b - a).perp_dot(p - a) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    };
    points.iter().for_each(|&p| chain(&mut hull, p, 0));
    let lower = hull.len() - 1;
    points.iter().rev().skip(1).for_each(|&p| chain(&mut hull, p, lower));
    hull.pop();
    hull
}

/// Returns the depth of a point in a convex hull; negative outside, or if the hull has no area.
fn depth_in(hull: &[DVec2], p: DVec2) -> f64 {
    if hull.len() < 3 {
        let far = hull.iter().map(|h| h.distance(p)).fold(f64::INFINITY, f64::min);
        return -far;
    }
    let sides = (0..hull.len()).map(|i| (hull[i], hull[(i + 1) % hull.len()]));
    sides.map(|(a, b)| (b - a).normalize_or_zero().perp_dot(p - a)).fold(f64::INFINITY, f64::min)
}

/// The angle, degrees, by which a part can be tilted before it falls: from the edge of its first
/// layer that is nearest to its centre of mass. Negative where it falls by itself.
pub fn tip_angle(stand: &Standing, layer: &FirstLayer, centre_of_mass: DVec3) -> f64 {
    let (u, v) = stand.plan();
    let p = DVec2::new(centre_of_mass.dot(u), centre_of_mass.dot(v));
    let height = (centre_of_mass.dot(stand.up) - stand.plate).max(f64::MIN_POSITIVE);
    depth_in(&layer.hull, p).portable_atan2(height).to_degrees()
}

/// The extent of the part along the plan's two directions and the build direction.
pub fn extent(part: &PreparedPart, stand: &Standing) -> [f64; 3] {
    let (u, v) = stand.plan();
    let along = |d: DVec3| {
        let all = part.topology().triangles.iter().filter(|t| t[0] != u32::MAX).flatten();
        let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &n| {
            let h = part.places[n as usize].dot(d);
            (lo.min(h), hi.max(h))
        });
        (hi - lo).max(0.0)
    };
    [along(u), along(v), stand.top - stand.plate]
}

/// Returns `None` if a part fits into a box, turned about the build direction; else the excess of
/// its best fit, and the index of width, depth or height.
pub fn too_large(part: &PreparedPart, stand: &Standing, room: [f64; 3]) -> Option<(f64, usize)> {
    let size = extent(part, stand);
    let slack = part.tolerance;
    let over = |size: [f64; 3]| {
        let by = [0, 1, 2].map(|i| size[i] - room[i]);
        (0..3).map(|i| (by[i], i)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0))
    };
    let straight = [over(size), over([size[1], size[0], size[2]])];
    let best = straight.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    if best.0 <= slack {
        return None;
    }
    let (u, v) = stand.plan();
    let flat = part.places.iter().map(|p| DVec2::new(p.dot(u), p.dot(v))).collect();
    let hull = convex_hull(flat);
    let turned = (1..TURNS).map(|i| {
        let angle = std::f64::consts::FRAC_PI_2 * i as f64 / TURNS as f64;
        let x = DVec2::new(angle.portable_cos(), angle.portable_sin());
        let wide = |d: DVec2| {
            let (lo, hi) = hull.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), p| {
                (lo.min(p.dot(d)), hi.max(p.dot(d)))
            });
            hi - lo
        };
        let (a, b) = (wide(x), wide(x.perp()));
        let both = [over([a, b, size[2]]), over([b, a, size[2]])];
        if both[0].0 <= both[1].0 { both[0] } else { both[1] }
    });
    let best = turned.chain([best]).min_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > slack).then_some(best)
}
