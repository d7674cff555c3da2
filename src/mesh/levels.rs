//! Levels of detail: each is the one below it, subdivided once (Loop 1987), plus what was sculpted on it.
//!
//! What was sculpted is kept as displacements in a frame of each vertex that the subdivided surface of the level below gives
//! (its normal, and the way along its first edge). So a change of a coarse level carries the detail of all finer ones along
//! and turns it with the surface.
//!
//! The clay itself knows one level: the one that is shown. The others travel beside it, and fit as long as no triangle of the
//! clay was cut; going to another level puts a whole new work in place, computed by whoever asks and never in a tick. The
//! mask stays behind.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::subdivide::loop_;
use super::{PolyMesh, TriMesh};
use crate::analysis::cancel::{Cancelled, Job};

/// Triangles of the finest level at most.
pub const MAX_TRIANGLES: u64 = 1 << 26;

#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LevelError {
    #[error("this is the lowest level")]
    Lowest,
    #[error("triangles were cut since the level was made: the levels no longer fit")]
    Cut,
    #[error("{0} triangles; at most {MAX_TRIANGLES} are made")]
    TooMany(u64),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What a level has beyond the one below it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Detail {
    /// In the frame of each vertex, mesh units.
    offsets: Vec<[f32; 3]>,
    colours: Option<Vec<[u8; 4]>>,
}

/// All levels but the one that is shown.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// The coarser ones, coarsest first, as they were left.
    below: Vec<TriMesh>,
    /// What the finer ones add, nearest first.
    above: Vec<Detail>,
    /// The fingerprint of the triangles of the one that is shown.
    shape: u64,
}

impl Levels {
    /// Which level is shown, 0 the coarsest, and how many there are.
    pub fn at(&self) -> (usize, usize) {
        (self.below.len(), self.below.len() + 1 + self.above.len())
    }

    /// Whether the clay is still of the triangles that it was shown with.
    pub fn fits(&self, now: &TriMesh) -> bool {
        self.shape == shape(now)
    }

    /// One level finer: what was sculpted there, or as yet nothing. `levels`: those that came with `now`; a mesh without any
    /// is its own lowest.
    pub fn up(levels: Option<&Levels>, now: &TriMesh, job: &Job) -> Result<(TriMesh, Levels), LevelError> {
        let triangles = now.triangles.len() as u64 * 4;
        if triangles > MAX_TRIANGLES {
            return Err(LevelError::TooMany(triangles));
        }
        let mut levels = levels.cloned().unwrap_or_else(|| Levels { shape: shape(now), ..Levels::default() });
        if !levels.fits(now) {
            return Err(LevelError::Cut);
        }
        let smooth = loop_(&now.to_poly(), 1, job)?;
        let mut new = plain(&smooth);
        if !levels.above.is_empty() {
            let detail = levels.above.remove(0);
            if detail.offsets.len() != new.positions.len() {
                return Err(LevelError::Cut);
            }
            job.check()?;
            for (v, (p, [along, across, out])) in frames(&smooth).into_iter().enumerate() {
                let [x, y, z] = detail.offsets[v].map(f64::from);
                new.positions[v] = (p + along * x + across * y + out * z).as_vec3();
            }
            if detail.colours.is_some() {
                new.colours = detail.colours;
            }
        }
        levels.below.push(now.clone());
        levels.shape = shape(&new);
        Ok((new, levels))
    }

    /// One level coarser, as it was left; what was sculpted on this one waits.
    pub fn down(&self, now: &TriMesh, job: &Job) -> Result<(TriMesh, Levels), LevelError> {
        let mut levels = self.clone();
        let coarse = levels.below.pop().ok_or(LevelError::Lowest)?;
        if !levels.fits(now) {
            return Err(LevelError::Cut);
        }
        let smooth = loop_(&coarse.to_poly(), 1, job)?;
        if smooth.positions.len() != now.positions.len() {
            return Err(LevelError::Cut);
        }
        job.check()?;
        let offsets = frames(&smooth)
            .into_iter()
            .zip(&now.positions)
            .map(|((p, frame), q)| frame.map(|axis| (q.as_dvec3() - p).dot(axis) as f32))
            .collect();
        levels.above.insert(0, Detail { offsets, colours: now.colours.clone() });
        levels.shape = shape(&coarse);
        Ok((coarse, levels))
    }
}

/// A number that other triangles, or the same in another order, do not have: FNV's way over their corners.
fn shape(mesh: &TriMesh) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325 ^ mesh.positions.len() as u64;
    mesh.triangles
        .iter()
        .flatten()
        .fold(start, |h, &v| (h ^ u64::from(v)).wrapping_mul(0x0000_0100_0000_01b3))
}

fn plain(mesh: &PolyMesh) -> TriMesh {
    TriMesh {
        positions: mesh.positions.iter().map(|p| p.as_vec3()).collect(),
        triangles: mesh.corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        colours: mesh.colours.clone(),
    }
}

/// For each vertex of a triangle mesh its place and its frame: along its first edge, across it, outwards; orthonormal, and
/// the axes of space where the surface has no direction.
fn frames(mesh: &PolyMesh) -> Vec<(DVec3, [DVec3; 3])> {
    let mut normals = vec![DVec3::ZERO; mesh.positions.len()];
    let mut first = vec![DVec3::ZERO; mesh.positions.len()];
    for t in mesh.corners.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|v| mesh.positions[v as usize]);
        let area = (b - a).cross(c - a);
        for (v, edge) in [(t[0], b - a), (t[1], c - b), (t[2], a - c)] {
            normals[v as usize] += area;
            if first[v as usize] == DVec3::ZERO {
                first[v as usize] = edge;
            }
        }
    }
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let frame = |n: DVec3, e: DVec3| {
        let out = n.try_normalize()?;
        let along = (e - out * e.dot(out)).try_normalize()?;
        Some([along, out.cross(along), out])
    };
    let all = mesh.positions.iter().zip(normals.into_iter().zip(first));
    all.map(|(p, (n, e))| (*p, frame(n, e).unwrap_or(axes))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use glam::{Quat, Vec3};

    /// A form on its second level, with detail on both levels above the lowest.
    fn sculpted() -> (TriMesh, Levels) {
        let job = Job::default();
        let base = shapes::icosphere(1.0, 6);
        let (mut one, levels) = Levels::up(None, &base, &job).expect("there is room");
        one.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.05 * (p.x * 7.0).sin());
        let (mut two, levels) = Levels::up(Some(&levels), &one, &job).expect("there is room");
        two.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.01 * (p.y * 23.0).sin());
        (two, levels)
    }

    #[test]
    fn down_and_up_again_is_where_it_was() {
        let job = Job::default();
        let (two, levels) = sculpted();
        assert_eq!(levels.at(), (2, 3));
        let (one, lower) = levels.down(&two, &job).expect("a level below");
        let (base, lowest) = lower.down(&one, &job).expect("another");
        assert_eq!((lowest.at(), lowest.down(&base, &job)), ((0, 3), Err(LevelError::Lowest)));
        assert_eq!(base, shapes::icosphere(1.0, 6));
        let (again, levels) = Levels::up(Some(&lowest), &base, &job).expect("up");
        let (top, levels) = Levels::up(Some(&levels), &again, &job).expect("up");
        assert_eq!(levels.at(), (2, 3));
        assert_eq!(top.triangles, two.triangles);
        let off = top.positions.iter().zip(&two.positions).map(|(a, b)| (*a - *b).length());
        assert!(off.fold(0.0, f32::max) < 1e-6);
    }

    #[test]
    fn a_coarse_level_that_is_moved_and_turned_takes_the_detail_along() {
        let job = Job::default();
        let (two, levels) = sculpted();
        let (one, lower) = levels.down(&two, &job).expect("a level below");
        let (mut base, lowest) = lower.down(&one, &job).expect("another");
        let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(-1.1);
        let place = |p: Vec3| turn * p + Vec3::new(3.0, -1.0, 0.5);
        base.positions.iter_mut().for_each(|p| *p = place(*p));
        let (again, levels) = Levels::up(Some(&lowest), &base, &job).expect("up");
        let (top, _) = Levels::up(Some(&levels), &again, &job).expect("up");
        let off = top.positions.iter().zip(&two.positions).map(|(a, b)| (*a - place(*b)).length());
        let worst = off.fold(0.0, f32::max);
        assert!(worst < 4e-6, "the detail is off by {worst}");
    }

    #[test]
    fn cut_triangles_do_not_fit() {
        let (mut two, levels) = sculpted();
        two.triangles.pop();
        assert_eq!(levels.down(&two, &Job::default()), Err(LevelError::Cut));
        assert_eq!(Levels::up(Some(&levels), &two, &Job::default()), Err(LevelError::Cut));
    }
}
