//! Levels of detail: each is the one below it, subdivided once (Loop 1987), plus what was sculpted
//! on it.
//!
//! Laws, for two neighbouring levels:
//! * Down and up again, with nothing done between, is the finer level as it was, bit for bit; so
//!   are up and down again.
//! * A coarser level takes over what was sculpted on the finer one since it was put in place, as
//!   nearly as it can: its vertices move so that their subdivision follows that best by least
//!   squares. What it can't follow stays as detail.
//! * What was done on the coarser level carries the detail of the finer one along and turns it with
//!   the surface: detail is kept in a frame of each vertex that the subdivided surface gives (its
//!   normal, and the way along its first edge). Where that surface stands still, the finer one
//!   does, to the bit.
//! * Mask and colours go along. A coarse vertex has those of the finer one that is at its place; a
//!   new finer vertex those of the middle of its edge. What a finer level had is kept wherever the
//!   coarser one was not painted over meanwhile.
//!
//! The clay itself knows one level: the one that is shown. The others travel beside it, and fit as
//! long as no triangle of the clay was cut; going to another level puts a whole new work in place,
//! computed by whoever asks and never in a tick.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::subdivide::{Stencils, edge_ends, loop_};
use sculptd_geometry::{PolyMesh, TriMesh};

/// Triangles of the finest level at most.
pub const MAX_TRIANGLES: u64 = 1 << 26;
/// Rounds of the fit of a coarser level: a sculpted form as wide as three of its edges is followed
/// to a hundredth.
const ROUNDS: usize = 24;

/// The reason why another level cannot be shown.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum LevelError {
    /// There is no coarser level.
    #[error("this is the lowest level")]
    Lowest,
    /// Triangles were cut since the level was made, so that the levels no longer fit.
    #[error("triangles were cut since the level was made: the levels no longer fit")]
    Cut,
    /// The finer level would have this many triangles, more than [`MAX_TRIANGLES`].
    #[error("{0} triangles; at most {MAX_TRIANGLES} are made")]
    TooMany(u64),
    /// The job was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A work on one level.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Its vertices and triangles.
    pub mesh: TriMesh,
    /// 0 to 1 for each vertex; none: nothing is masked.
    pub masks: Option<Vec<f32>>,
}

impl From<TriMesh> for Level {
    fn from(mesh: TriMesh) -> Level {
        Level { mesh, masks: None }
    }
}

/// A level below the one that is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Lower {
    left: Level,
    /// The vertices of the next finer level when it was built from this one.
    came: Vec<Vec3>,
}

/// A level above the one that is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Upper {
    /// As it was left; its triangles follow from those below.
    positions: Vec<Vec3>,
    colours: Option<Vec<[u8; 4]>>,
    masks: Option<Vec<f32>>,
    /// The next coarser level at that time.
    base: Vec<Vec3>,
    base_colours: Option<Vec<[u8; 4]>>,
    base_masks: Option<Vec<f32>>,
}

/// All levels but the one that is shown.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// Coarsest first.
    below: Vec<Lower>,
    /// Nearest first.
    above: Vec<Upper>,
    /// The fingerprint of the triangles of the one that is shown.
    shape: u64,
}

impl Levels {
    /// Returns the current level, 0 the coarsest, and the number of levels.
    pub fn at(&self) -> (usize, usize) {
        (self.below.len(), self.below.len() + 1 + self.above.len())
    }

    /// Returns true if the clay still has the triangles that it was shown with.
    pub fn fits(&self, now: &TriMesh) -> bool {
        self.shape == shape(now)
    }

    /// Returns the next finer level, with the details sculpted there, if any. `levels` are those
    /// that came with `now`; a mesh without any is its lowest level.
    pub fn up(
        levels: Option<&Levels>,
        now: &Level,
        job: &Job,
    ) -> Result<(Level, Levels), LevelError> {
        let triangles = now.mesh.triangles.len() as u64 * 4;
        if triangles > MAX_TRIANGLES {
            return Err(LevelError::TooMany(triangles));
        }
        let fresh = || Levels { shape: shape(&now.mesh), ..Levels::default() };
        let mut levels = levels.cloned().unwrap_or_else(fresh);
        if !levels.fits(&now.mesh) {
            return Err(LevelError::Cut);
        }
        let coarse = now.mesh.to_poly();
        let ends = edge_ends(&coarse, job)?;
        let smooth = loop_(&coarse, 1, job)?;
        job.check()?;
        let mut new = Level { mesh: triangle_mesh(&smooth), masks: None };
        let kept = if levels.above.is_empty() { None } else { Some(levels.above.remove(0)) };
        if let Some(kept) = &kept {
            let n = now.mesh.positions.len();
            if kept.positions.len() != new.mesh.positions.len() || kept.base.len() != n {
                return Err(LevelError::Cut);
            }
            let mut base = coarse;
            base.positions = kept.base.iter().map(|p| p.as_dvec3()).collect();
            base.colours = None;
            let then = frames(&loop_(&base, 1, job)?);
            job.check()?;
            let all = frames(&smooth).into_iter().zip(then).zip(&kept.positions);
            for (p, ((now, then), was)) in new.mesh.positions.iter_mut().zip(all) {
                *p = if now == then { *was } else { carried(*was, &then, &now) };
            }
        }
        let kept = kept.as_ref();
        let colours = Painted {
            now: now.mesh.colours.as_deref(),
            base: kept.and_then(|k| k.base_colours.as_deref()),
            kept: kept.and_then(|k| k.colours.as_deref()),
            free: [255; 4],
        };
        let mean = |a: [u8; 4], b: [u8; 4]| std::array::from_fn(|i| u8::midpoint(a[i], b[i]));
        new.mesh.colours = colours.up(&ends, now.mesh.positions.len(), kept.is_some(), mean);
        let masks = Painted {
            now: now.masks.as_deref(),
            base: kept.and_then(|k| k.base_masks.as_deref()),
            kept: kept.and_then(|k| k.masks.as_deref()),
            free: 0.0,
        };
        new.masks = masks.up(&ends, now.mesh.positions.len(), kept.is_some(), |a, b| (a + b) * 0.5);
        job.check()?;
        levels.below.push(Lower { left: now.clone(), came: new.mesh.positions.clone() });
        levels.shape = shape(&new.mesh);
        Ok((new, levels))
    }

    /// One level coarser, which follows what was sculpted on this one; the rest of that waits.
    pub fn down(&self, now: &Level, job: &Job) -> Result<(Level, Levels), LevelError> {
        let mut levels = self.clone();
        let Lower { left: mut coarse, came } = levels.below.pop().ok_or(LevelError::Lowest)?;
        if !levels.fits(&now.mesh) || came.len() != now.mesh.positions.len() {
            return Err(LevelError::Cut);
        }
        let n = coarse.mesh.positions.len();
        if came != now.mesh.positions {
            let moved = |(p, q): (&Vec3, &Vec3)| p.as_dvec3() - q.as_dvec3();
            let wanted: Vec<DVec3> = now.mesh.positions.iter().zip(&came).map(moved).collect();
            let by = Stencils::of(&coarse.mesh.to_poly(), job)?.fit(&wanted, ROUNDS, job)?;
            for (p, by) in coarse.mesh.positions.iter_mut().zip(by) {
                *p = (p.as_dvec3() + by).as_vec3();
            }
        }
        coarse.mesh.colours = now.mesh.colours.as_ref().map(|c| c[..n].to_vec());
        coarse.masks = now.masks.as_ref().map(|m| m[..n].to_vec());
        levels.above.insert(0, Upper::of(now.clone(), &coarse));
        levels.shape = shape(&coarse.mesh);
        Ok((coarse, levels))
    }

    /// Replaces the next finer level, which was changed after this one was made of it. `shown` is
    /// this level, which has taken over what it can of that; going up again gives `finer` to the
    /// bit.
    pub fn keep_above(&mut self, finer: Level, shown: &Level) {
        if let Some(above) = self.above.first_mut() {
            *above = Upper::of(finer, shown);
        }
    }
}

impl Upper {
    /// A level that is left for the next coarser one.
    fn of(left: Level, base: &Level) -> Upper {
        Upper {
            positions: left.mesh.positions,
            colours: left.mesh.colours,
            masks: left.masks,
            base: base.mesh.positions.clone(),
            base_colours: base.mesh.colours.clone(),
            base_masks: base.masks.clone(),
        }
    }
}

/// Something painted on the vertices of a coarse level, now and as it was, and on those of the
/// finer one, as it was.
struct Painted<'a, T> {
    now: Option<&'a [T]>,
    base: Option<&'a [T]>,
    kept: Option<&'a [T]>,
    /// The value where nothing was painted.
    free: T,
}

impl<T: Copy + PartialEq> Painted<'_, T> {
    /// On the finer level of `n` old vertices and one for each edge. `known`: that level was there
    /// before.
    fn up(
        &self,
        ends: &[(u32, u32)],
        n: usize,
        known: bool,
        mean: impl Fn(T, T) -> T,
    ) -> Option<Vec<T>> {
        if self.now.is_none() && self.kept.is_none() {
            return None;
        }
        let at = |of: Option<&[T]>, v: usize| of.map_or(self.free, |of| of[v]);
        let same = |v: u32| at(self.now, v as usize) == at(self.base, v as usize);
        let old = (0..n as u32).map(|v| (v, v));
        let all = old.chain(ends.iter().copied()).enumerate().map(|(f, (u, v))| {
            if known && same(u) && same(v) {
                at(self.kept, f)
            } else if u == v {
                at(self.now, u as usize)
            } else {
                mean(at(self.now, u as usize), at(self.now, v as usize))
            }
        });
        Some(all.collect())
    }
}

/// A place of a vertex and the frame of the surface there.
type Frame = (DVec3, [DVec3; 3]);

/// Transforms a point from one frame to another.
fn carried(p: Vec3, from: &Frame, to: &Frame) -> Vec3 {
    let off = p.as_dvec3() - from.0;
    let [x, y, z] = from.1.map(|axis| axis.dot(off));
    let [along, across, out] = to.1;
    (to.0 + along * x + across * y + out * z).as_vec3()
}

/// A number that other triangles, or the same in another order, do not have: FNV's way over their
/// corners.
fn shape(mesh: &TriMesh) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325 ^ mesh.positions.len() as u64;
    mesh.triangles
        .iter()
        .flatten()
        .fold(start, |h, &v| (h ^ u64::from(v)).wrapping_mul(0x0000_0100_0000_01b3))
}

fn triangle_mesh(mesh: &PolyMesh) -> TriMesh {
    TriMesh {
        positions: mesh.positions.iter().map(|p| p.as_vec3()).collect(),
        triangles: mesh.corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        colours: None,
    }
}

/// For each vertex of a triangle mesh its place and its frame: along its first edge, across it,
/// outwards; orthonormal, and the axes of space where the surface has no direction.
fn frames(mesh: &PolyMesh) -> Vec<Frame> {
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
    use glam::Quat;
    use sculptd_geometry::shapes;

    fn up(levels: Option<&Levels>, now: &Level) -> (Level, Levels) {
        Levels::up(levels, now, &Job::default()).expect("there is room")
    }

    fn down(levels: &Levels, now: &Level) -> (Level, Levels) {
        levels.down(now, &Job::default()).expect("a level below")
    }

    /// A form on its second level, with detail, mask and colour on both levels above the lowest.
    fn sculpted() -> (Level, Levels) {
        let (mut one, levels) = up(None, &shapes::icosphere(1.0, 6).into());
        one.mesh.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.05 * (p.x * 7.0).sin());
        let (mut two, levels) = up(Some(&levels), &one);
        two.mesh.positions.iter_mut().for_each(|p| *p *= 1.0 + 0.01 * (p.y * 23.0).sin());
        two.masks = Some(two.mesh.positions.iter().map(|p| (p.z * 9.0).sin().max(0.0)).collect());
        two.mesh.colours =
            Some(two.mesh.positions.iter().map(|p| [(p.x * 90.0) as u8, 7, 9, 255]).collect());
        (two, levels)
    }

    fn widest(a: &TriMesh, b: &TriMesh) -> f32 {
        a.positions.iter().zip(&b.positions).map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max)
    }

    #[test]
    fn down_and_up_again_is_where_it_was_to_the_bit() {
        let (two, levels) = sculpted();
        assert_eq!(levels.at(), (2, 3));
        let (one, lower) = down(&levels, &two);
        let (base, lowest) = down(&lower, &one);
        let end = lowest.down(&base, &Job::default());
        assert_eq!((lowest.at(), end), ((0, 3), Err(LevelError::Lowest)));
        let (again, levels) = up(Some(&lowest), &base);
        assert!(again == one);
        let (top, levels) = up(Some(&levels), &again);
        assert!(levels.at() == (2, 3) && top == two);
        // And down once more: what was taken over is not taken over twice.
        assert!(down(&levels, &top).0 == one);
    }

    #[test]
    fn up_and_down_again_is_where_it_was_to_the_bit() {
        let mut base = Level::from(shapes::icosphere(1.0, 6));
        base.masks = Some((0..base.mesh.positions.len()).map(|v| (v % 5) as f32 / 4.0).collect());
        base.mesh.colours =
            Some((0..base.mesh.positions.len()).map(|v| [v as u8, 1, 2, 3]).collect());
        let (one, levels) = up(None, &base);
        let (two, higher) = up(Some(&levels), &one);
        let (back, lower) = down(&higher, &two);
        assert!(back == one && down(&lower, &back).0 == base);
        let mask = one.masks.expect("it came along");
        assert!(mask.iter().all(|m| (0.0..=1.0).contains(m)) && mask.contains(&0.125));
    }

    #[test]
    fn the_coarse_level_takes_over_what_was_sculpted_finer() {
        let (one, levels) = up(None, &shapes::icosphere(1.0, 12).into());
        let (two, levels) = up(Some(&levels), &one);
        // A broad swelling that a coarse level can show, on one side.
        let mut swollen = two.clone();
        for p in &mut swollen.mesh.positions {
            let near = (1.0 - (*p - Vec3::X).length_squared() / 0.6).max(0.0);
            *p *= 1.0 + 0.2 * near * near;
        }
        let (coarse, lower) = down(&levels, &swollen);
        let (coarsest, lowest) = down(&lower, &coarse);
        for (level, flat) in [(&coarse, &one), (&coarsest, &shapes::icosphere(1.0, 12).into())] {
            let top = |l: &Level| l.mesh.positions.iter().map(|p| p.x).fold(0.0, f32::max);
            let raised = top(level) - top(flat);
            assert!((raised - 0.2).abs() < 0.03, "{raised} of 0.2");
            let still = |(p, q): (&Vec3, &Vec3)| p.x > -0.5 || p == q;
            assert!(
                level.mesh.positions.iter().zip(&flat.mesh.positions).all(still),
                "the far side stays"
            );
        }
        // Its bare subdivision is nearly all that was sculpted.
        let (bare, _) = up(None, &coarse);
        let (all, left) = (widest(&swollen.mesh, &two.mesh), widest(&bare.mesh, &swollen.mesh));
        assert!(left < 0.03 * all, "{left} of {all} is left as detail");
        // A coarse vertex has no say over what is far from it, to the bit.
        let (mut edited, v) = (coarsest, 0);
        edited.mesh.positions[v] *= 1.1;
        let at = edited.mesh.positions[v];
        let (again, levels) = up(Some(&lowest), &edited);
        let (top, _) = up(Some(&levels), &again);
        let far = |(p, q): (&Vec3, &Vec3)| (*q - at).length() < 0.9 || p == q;
        assert!(top.mesh.positions.iter().zip(&swollen.mesh.positions).all(far));
        assert!(widest(&top.mesh, &swollen.mesh) > 0.02);
    }

    #[test]
    fn a_coarse_level_that_is_moved_and_turned_takes_the_detail_along() {
        let (two, levels) = sculpted();
        let (one, lower) = down(&levels, &two);
        let (mut base, lowest) = down(&lower, &one);
        let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(-1.1);
        let place = |p: Vec3| turn * p + Vec3::new(3.0, -1.0, 0.5);
        base.mesh.positions.iter_mut().for_each(|p| *p = place(*p));
        let (again, levels) = up(Some(&lowest), &base);
        let (top, _) = up(Some(&levels), &again);
        let off = top
            .mesh
            .positions
            .iter()
            .zip(&two.mesh.positions)
            .map(|(a, b)| (*a - place(*b)).length());
        let worst = off.fold(0.0, f32::max);
        assert!(worst < 6e-6, "the detail is off by {worst}");
        assert!(top.masks == two.masks && top.mesh.colours == two.mesh.colours);
    }

    #[test]
    fn what_is_painted_on_a_coarse_level_covers_the_finer_one_there_and_only_there() {
        let (two, levels) = sculpted();
        let (mut one, lower) = down(&levels, &two);
        let painted = |p: &Vec3| p.y > 0.3;
        let mut mask = one.masks.take().expect("it came along");
        for (p, m) in one.mesh.positions.iter().zip(&mut mask) {
            *m = if painted(p) { 1.0 } else { *m };
        }
        one.masks = Some(mask);
        let (top, _) = up(Some(&lower), &one);
        let (now, was) = (top.masks.expect("masked"), two.masks.expect("masked"));
        for (v, p) in two.mesh.positions.iter().enumerate() {
            if p.y > 0.6 {
                assert_eq!(now[v], 1.0);
            } else if p.y < 0.0 {
                assert_eq!(now[v], was[v]);
            }
        }
    }

    #[test]
    fn cut_triangles_do_not_fit() {
        let (mut two, levels) = sculpted();
        two.mesh.triangles.pop();
        assert_eq!(levels.down(&two, &Job::default()), Err(LevelError::Cut));
        assert_eq!(Levels::up(Some(&levels), &two, &Job::default()), Err(LevelError::Cut));
    }
}
