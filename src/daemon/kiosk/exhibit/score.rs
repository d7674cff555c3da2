//! How near a work is to its goal, by signed distance in both directions.

use std::sync::Arc;

use glam::DVec3;
use serde::Serialize;

use sculptd_geometry::TriMesh;
use sculptd_geometry::distance::DistanceSolid;
use sculptd_geometry::job::{Cancelled, Job};

/// A form to sculpt towards, ready for questions of distance.
#[derive(Debug)]
pub struct Goal {
    pub mesh: Arc<TriMesh>,
    /// Distance up to which a place counts as right, in the mesh's unit.
    pub tolerance: f64,
    solid: DistanceSolid,
    areas: Vec<f64>,
    /// [`Score::off`] of the form that visitors start from.
    off_at_start: f64,
}

/// The nearness of a work to its goal. Distances are those that `sculptd distance` measures, in the
/// meshes' unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Score {
    /// From 0 to 1: the mean of two shares, of the work's surface that is within the tolerance of
    /// the goal's, and of the goal's surface that is within the tolerance of the work's. A vertex
    /// stands for a third of the area of its triangles.
    pub near: f64,
    /// The mean of two mean distances beyond the tolerance, of the work's surface from the goal's
    /// and of the goal's from the work's.
    pub off: f64,
    /// From 0 to 1: the share of the start's [`Score::off`] that is gone. Each cut towards the goal
    /// adds to it.
    pub done: f64,
    /// Greatest distance of a vertex of the work outside the goal; 0: none is outside.
    pub too_much: f64,
    /// Greatest distance of a vertex of the goal outside the work; 0: none is outside.
    pub too_little: f64,
}

impl Score {
    /// Returns [`Score::done`] in whole percent, rounded down: 100 only if all of it is right.
    pub fn percent(&self) -> u32 {
        (self.done * 100.0 + 1e-9).floor().clamp(0.0, 100.0) as u32
    }
}

impl Goal {
    /// Prepares a goal for works that begin as `start`.
    ///
    /// # Errors
    /// Returns a message if the surface is not closed: it has no inside then.
    pub fn new(mesh: TriMesh, start: &TriMesh, tolerance: f64, job: &Job) -> Result<Goal, String> {
        let solid = DistanceSolid::build(&mesh, job).map_err(|e| e.to_string())?;
        if mesh.triangles.is_empty() || !solid.topology.closed {
            return Err("expected a closed surface; `sculptd remesh` makes one of any mesh".into());
        }
        let areas = vertex_areas(&mesh);
        let mut goal = Goal { mesh: Arc::new(mesh), tolerance, solid, areas, off_at_start: 0.0 };
        goal.off_at_start = goal.score(start, job).map_err(|e| e.to_string())?.off;
        Ok(goal)
    }

    /// Measures a work, on the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn score(&self, work: &TriMesh, job: &Job) -> Result<Score, Cancelled> {
        let solid = DistanceSolid::build(work, job)?;
        let there = one_way(&self.solid, work, &vertex_areas(work), self.tolerance, job)?;
        let back = one_way(&solid, &self.mesh, &self.areas, self.tolerance, job)?;
        let near = (there.near + back.near) * 0.5;
        let off = (there.off + back.off) * 0.5;
        // A start that is right already has no way to go.
        let start = self.off_at_start;
        let done = if start > 0.0 { (1.0 - off / start).max(0.0) } else { near };
        Ok(Score { near, off, done, too_much: there.outside, too_little: back.outside })
    }
}

/// The surface of one mesh against another.
struct OneWay {
    /// Share within the tolerance.
    near: f64,
    /// Mean distance beyond the tolerance.
    off: f64,
    /// Greatest distance outside.
    outside: f64,
}

/// Measures the surface of `mesh` against `solid`.
fn one_way(
    solid: &DistanceSolid,
    mesh: &TriMesh,
    areas: &[f64],
    tolerance: f64,
    job: &Job,
) -> Result<OneWay, Cancelled> {
    let points: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    let distances = solid.signed_distances(&points, job)?;
    let (mut near, mut off, mut all, mut outside) = (0.0, 0.0, 0.0, 0.0f64);
    // In order, so that the sums have the same bits with any number of threads.
    for (d, area) in distances.iter().zip(areas).filter(|(d, _)| d.is_finite()) {
        all += area;
        near += if d.abs() <= tolerance { *area } else { 0.0 };
        off += (d.abs() - tolerance).max(0.0) * area;
        outside = outside.max(*d);
    }
    let mean = |sum: f64| if all > 0.0 { sum / all } else { 0.0 };
    Ok(OneWay { near: mean(near), off: mean(off), outside })
}

/// A third of the area of the triangles at each vertex.
fn vertex_areas(mesh: &TriMesh) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.positions.len()];
    for (t, names) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
        let third = (b - a).cross(c - a).length() / 6.0;
        names.iter().for_each(|&v| areas[v as usize] += third);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_geometry::{implicit, shapes};

    #[test]
    fn a_larger_ball_is_too_much_and_a_smaller_one_too_little_by_their_difference() {
        let job = Job::default();
        let start = shapes::icosphere(20.0, 32);
        let goal = Goal::new(shapes::icosphere(10.0, 32), &start, 0.5, &job).expect("closed");
        let score = |radius: f32| goal.score(&shapes::icosphere(radius, 32), &job).expect("scored");
        let same = score(10.0);
        assert_eq!((same.percent(), same.near), (100, 1.0));
        assert!(same.too_much < 1e-6 && same.too_little < 1e-6, "{same:?}");
        let larger = score(12.0);
        // Of the way from 9.5 beyond the tolerance, 1.5 are left.
        let done = 1.0 - 1.5 / 9.5;
        assert!((larger.done - done).abs() < 0.01 && larger.near == 0.0, "{larger:?}");
        assert!((larger.too_much - 2.0).abs() < 0.02, "{larger:?}");
        assert!(larger.too_little == 0.0, "{larger:?}");
        let smaller = score(7.0);
        assert!(smaller.too_much == 0.0 && (smaller.too_little - 3.0).abs() < 0.02, "{smaller:?}");
        // Within the tolerance.
        assert_eq!(score(10.3).percent(), 100);
    }

    #[test]
    fn half_a_work_is_half_right() {
        let job = Job::default();
        let cube = |x: f64| {
            let field = move |p: DVec3| {
                let half = DVec3::new(x, 10.0, 10.0) * 0.5;
                ((p - half).abs() - half).max_element()
            };
            let bounds = (DVec3::ZERO, DVec3::new(x, 10.0, 10.0));
            implicit::surface(field, bounds, 100, &job).expect("a cube")
        };
        let goal = Goal::new(cube(20.0), &cube(10.0), 0.25, &job).expect("closed");
        let half = goal.score(&cube(10.0), &job).expect("scored");
        // Of the work's 600 all but its new end of 100 is right; of the goal's 1,000, 500.
        let expected = (500.0 / 600.0 + 500.0 / 1000.0) / 2.0;
        assert!((half.near - expected).abs() < 0.03, "{half:?}, expected {expected}");
        assert_eq!(half.percent(), 0, "it is the start");
        assert!(half.too_much < 0.2 && (half.too_little - 10.0).abs() < 0.2, "{half:?}");
    }

    #[test]
    fn an_open_goal_is_refused() {
        let open = shapes::grid(10.0, 10.0, 4, 4).triangulate().0;
        let ball = shapes::icosphere(10.0, 8);
        assert!(Goal::new(open, &ball, 1.0, &Job::default()).is_err_and(|e| e.contains("closed")));
    }
}
