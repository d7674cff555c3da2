//! Masks, colours and movements of an old surface on a new one: those of the nearest place on the
//! old.

use glam::{DVec3, Vec3};

use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::{Cancelled, Job};

/// A place on the old surface: its triangle, and how much of each corner is in it.
#[derive(Debug, Clone, Copy)]
pub struct OldPlace {
    /// Position on the old surface.
    pub point: DVec3,
    /// Index of the triangle that contains the point.
    pub triangle: usize,
    weights: [f64; 3],
}

impl OldPlace {
    /// Returns the place in a triangle that has these parts of its corners.
    pub fn within(old: &TriMesh, triangle: usize, weights: [f64; 3]) -> OldPlace {
        let corners = old.corners(triangle).map(Vec3::as_dvec3);
        let point = (0..3).map(|i| corners[i] * weights[i]).sum();
        OldPlace { point, triangle, weights }
    }

    /// The normal of its triangle, of length 1; zero where that has no area.
    pub fn normal(&self, old: &TriMesh) -> DVec3 {
        let [a, b, c] = old.corners(self.triangle).map(Vec3::as_dvec3);
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// A value of each old vertex here.
    pub fn value(&self, old: &TriMesh, values: &[f32]) -> f32 {
        let t = old.triangles[self.triangle];
        (0..3).map(|i| f64::from(values[t[i] as usize]) * self.weights[i]).sum::<f64>() as f32
    }

    /// A shift of each old vertex here.
    pub fn shift(&self, old: &TriMesh, by: impl Fn(usize) -> DVec3) -> DVec3 {
        let t = old.triangles[self.triangle];
        (0..3).map(|i| by(t[i] as usize) * self.weights[i]).sum()
    }

    /// A colour of each old vertex here.
    pub fn colour(&self, old: &TriMesh, colours: &[[u8; 4]]) -> [u8; 4] {
        let t = old.triangles[self.triangle];
        std::array::from_fn(|k| {
            let each = |i: usize| f64::from(colours[t[i] as usize][k]) * self.weights[i];
            (0..3).map(each).sum::<f64>().round().clamp(0.0, 255.0) as u8
        })
    }
}

/// The nearest place on the old surface to each of these; `None` where there is none.
pub fn places(
    old: &TriMesh,
    solid: &DistanceSolid,
    points: &[Vec3],
    job: &Job,
) -> Result<Vec<Option<OldPlace>>, Cancelled> {
    let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let nearest = solid.nearest(&points, job)?;
    let at = nearest.iter().map(|n| {
        let n = n.as_ref()?;
        let triangle = n.triangle as usize;
        let [a, b, c] = old.corners(triangle).map(Vec3::as_dvec3);
        let area = |p: DVec3, q: DVec3| (p - n.point).cross(q - n.point).length();
        let w = [area(b, c), area(c, a), area(a, b)];
        let sum = w[0] + w[1] + w[2];
        let weights = if sum > 0.0 { w.map(|x| x / sum) } else { [1.0, 0.0, 0.0] };
        Some(OldPlace { point: n.point, triangle, weights })
    });
    Ok(at.collect())
}

/// A value of each old vertex at each of the places; 0 where there is none.
pub fn values(old: &TriMesh, values: &[f32], places: &[Option<OldPlace>]) -> Vec<f32> {
    places.iter().map(|p| p.map_or(0.0, |p| p.value(old, values))).collect()
}

/// The old colours at each of the places; `None` where the old surface has none.
pub fn colours(old: &TriMesh, places: &[Option<OldPlace>]) -> Option<Vec<[u8; 4]>> {
    let colours = old.colours.as_ref().filter(|c| c.len() == old.positions.len())?;
    Some(places.iter().map(|p| p.map_or([255; 4], |p| p.colour(old, colours))).collect())
}
