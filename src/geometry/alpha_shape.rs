//! The alpha shape of points in a plane: the triangles of their Delaunay triangulation whose
//! circumcircle has a radius of at most alpha (Edelsbrunner, Kirkpatrick and Seidel 1983).

use glam::DVec2;
use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::silhouette::{Chain, PlaneRegion};

/// Returns the polygons and the area of the shape of `points`, which must be finite. For random
/// points the area is low by about the perimeter times half their spacing: they are rarely on the
/// border.
pub fn alpha_shape(points: &[DVec2], alpha: f64) -> (Vec<PlaneRegion>, f64) {
    let (lo, hi) = points
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    let inputs: Vec<Point2<f64>> = points.iter().map(|p| Point2::new(p.x, p.y)).collect();
    let Ok(delaunay) = DelaunayTriangulation::<Point2<f64>>::bulk_load(inputs) else {
        return (Vec::new(), 0.0);
    };
    let mut chain = Chain::new(lo, hi);
    let mut area = 0.0;
    for face in delaunay.inner_faces() {
        let (_, radius_squared) = face.circumcircle();
        if radius_squared > alpha * alpha {
            continue;
        }
        let [a, b, c] = face.positions().map(|p| DVec2::new(p.x, p.y));
        area += (b - a).perp_dot(c - a).abs() * 0.5;
        let [a, b, c] = [a, b, c].map(|p| chain.grid_coordinates(p));
        chain.push(a, b);
        chain.push(b, c);
        chain.push(c, a);
    }
    (chain.resolve(), area)
}
