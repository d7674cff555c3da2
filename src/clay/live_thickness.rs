//! Walls or gaps of clay that is being sculpted, by the definition *ray*: after each change only
//! what could have changed is measured again.
//!
//! The bound: a vertex's value depends on nothing outside the box around the vertex and its ray's
//! hit. Its own normal comes from triangles that touch it; a triangle that is hit, passed through
//! or newly in the way meets that box, before the change or after it. So the vertices whose box
//! meets a box of changed triangles, as they were or as they are, are measured again, and no others
//! can differ: the map equals a full recomputation bit for bit once nothing is stale. A ray that
//! hits nothing has no end: its vertex is measured again where the ray itself meets such a box, as
//! a triangle that is newly in its way does. Most rays through air are of this kind.
//!
//! On a sharp edge the ray of a vertex points askew between the sides. If it meets no opposite
//! side, the vertex has the least wall under the faces around it, each measured along the face's
//! normal from a place a little way into the face.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use crate::{Ranks, Snapshot};
use sculptd_geometry::TriMesh;
use sculptd_geometry::bvh::{Bvh8, Parents, Ray};
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::thickness::MeasuredSide;
use sculptd_geometry::thickness::changes::EarlierVersion;
use sculptd_geometry::thickness::cone::{Cone, Outliers, Weights};
use sculptd_geometry::thickness::ray::{Caster, Correction, Site};

/// Boxes grow by this share of the largest coordinate, more than a hit's rounding.
const MARGIN: f32 = 1e-5;

/// The box of a ray that hits nothing: of everything.
const OPEN: (Vec3, Vec3) = (Vec3::NEG_INFINITY, Vec3::INFINITY);

/// The box of several rays of which one hits nothing: measured again after each change.
const ANYWHERE: (Vec3, Vec3) = (Vec3::MIN, Vec3::MAX);

/// The cosine of 40 degrees: faces turned by more from each other meet in a sharp edge, and a side
/// turned by more from parallel is not the opposite side of a wall.
const COS_40: f32 = 0.766_044_44;

/// The share of the way from a vertex to the middle of a face, where the wall under it is measured.
const INTO_FACE: f32 = 0.01;

/// A value, and where it was measured.
#[derive(Debug, Clone, Copy)]
struct MeasuredVertex {
    value: f32,
    reach: (Vec3, Vec3),
    place: Vec3,
    /// Out of the clay, of unit length.
    out: Vec3,
}

/// The map and all that keeps it up to date.
#[derive(Debug)]
pub struct LiveMap {
    snapshot: Snapshot,
    side: MeasuredSide,
    /// From the clay's numbers to the mesh's.
    ranks: Ranks,
    mesh: TriMesh,
    tree: Bvh8,
    parents: Parents,
    starts: Vec<u32>,
    around: Vec<u32>,
    face_normals: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// True where faces meet in a sharp edge.
    sharp: Vec<bool>,
    /// A third of the faces around each vertex.
    areas: Vec<f32>,
    axis: Cone,
    values: Vec<f32>,
    /// Around each vertex and its hit; [`OPEN`] where its ray hits nothing.
    reach: Vec<(Vec3, Vec3)>,
    stale: Vec<u32>,
    is_stale: Vec<bool>,
}

/// The clay has another topology than the map: make a new map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the clay's topology changed")]
pub struct Rebuild;

impl LiveMap {
    /// Prepares the map of a snapshot; every vertex is stale.
    pub fn new(snapshot: &Snapshot, side: MeasuredSide, job: &Job) -> Result<LiveMap, Cancelled> {
        let mesh = snapshot.to_tri();
        let tree = Bvh8::build(&mesh, job)?;
        let (n, triangles) = (mesh.positions.len(), mesh.triangles.len());
        let mut starts = vec![0u32; n + 1];
        mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
        for v in 0..n {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut around = vec![0u32; triangles * 3];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            for &v in corners {
                around[next[v as usize] as usize] = t as u32;
                next[v as usize] += 1;
            }
        }
        job.check()?;
        let parents = tree.parents(triangles);
        let mut map = LiveMap {
            snapshot: snapshot.clone(),
            side,
            ranks: snapshot.ranks(),
            tree,
            parents,
            starts,
            around,
            face_normals: (0..triangles).into_par_iter().map(|t| face_normal(&mesh, t)).collect(),
            normals: Vec::new(),
            sharp: Vec::new(),
            areas: Vec::new(),
            axis: Cone::new(1, 0.0, Weights::Plain),
            values: vec![f32::NAN; n],
            reach: vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); n],
            stale: (0..n as u32).collect(),
            is_stale: vec![true; n],
            mesh,
        };
        job.check()?;
        map.normals = (0..n).into_par_iter().map(|v| map.normal(v)).collect();
        map.sharp = (0..n).into_par_iter().map(|v| map.is_sharp(v)).collect();
        map.areas = (0..n).into_par_iter().map(|v| map.area(v)).collect();
        Ok(map)
    }

    /// Takes a newer snapshot: the tree and the normals follow at once, values that may have
    /// changed become stale. Costs what moved, and a look at every vertex's box.
    pub fn advance(&mut self, newer: &Snapshot) -> Result<(), Rebuild> {
        if newer.vertex_count() != self.mesh.positions.len()
            || newer.page_count() != self.snapshot.page_count()
        {
            return Err(Rebuild);
        }
        let mut moved: Vec<(u32, Vec3)> = Vec::new();
        let mut same = true;
        newer.each_changed(&self.snapshot, |number, page| {
            let old = self.snapshot.page(number);
            same &= Arc::ptr_eq(old.topology(), page.topology());
            for (v, &id) in page.topology().ids.iter().enumerate() {
                let to = page.point(v);
                // After cuts, numbers have gaps: another topology, which is reported below.
                let Some(row) = self.ranks.find(id) else { continue };
                if self.mesh.positions.get(row as usize).is_some_and(|at| *at != to) {
                    moved.push((row, to));
                }
            }
        });
        if !same {
            return Err(Rebuild);
        }
        self.snapshot = newer.clone();
        if moved.is_empty() {
            return Ok(());
        }
        let mut triangles: Vec<u32> = moved
            .iter()
            .flat_map(|&(v, _)| {
                &self.around[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
            })
            .copied()
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        let before: Vec<_> = triangles.iter().map(|&t| bounds(&self.mesh, t)).collect();
        for &(v, to) in &moved {
            self.mesh.positions[v as usize] = to;
        }
        let largest = self.mesh.positions.iter().fold(0.0f32, |m, p| m.max(p.abs().max_element()));
        let margin = Vec3::splat(largest * MARGIN);
        let mut boxes: Vec<(Vec3, Vec3)> = triangles
            .iter()
            .zip(before)
            .map(|(&t, old)| {
                let new = bounds(&self.mesh, t);
                (old.0.min(new.0) - margin, old.1.max(new.1) + margin)
            })
            .collect();
        for &t in &triangles {
            self.face_normals[t as usize] = face_normal(&self.mesh, t as usize);
        }
        let mut touched: Vec<u32> =
            triangles.iter().flat_map(|&t| self.mesh.triangles[t as usize]).collect();
        touched.sort_unstable();
        touched.dedup();
        for &v in &touched {
            self.normals[v as usize] = self.normal(v as usize);
            self.sharp[v as usize] = self.is_sharp(v as usize);
            self.areas[v as usize] = self.area(v as usize);
        }
        self.tree.refit(&self.mesh, &triangles, &mut self.parents);
        coarsen(&mut boxes);
        let all = boxes
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let is_stale = &self.is_stale;
        let met = |v: u32, by: (Vec3, Vec3)| {
            let (v, own) = (v as usize, self.reach[v as usize]);
            if own == OPEN {
                ray_meets(self.mesh.positions[v], self.ray_direction(v), by)
            } else {
                boxes_intersect(own, by)
            }
        };
        let mut fresh: Vec<u32> = (0..self.reach.len() as u32)
            .into_par_iter()
            .filter(|&v| !is_stale[v as usize] && met(v, all) && boxes.iter().any(|&b| met(v, b)))
            .collect();
        // A vertex beside a changed triangle has a new normal and a new ray.
        fresh.extend(touched.iter().filter(|&&v| !is_stale[v as usize]));
        fresh.sort_unstable();
        fresh.dedup();
        for &v in &fresh {
            self.is_stale[v as usize] = true;
        }
        self.stale.extend(fresh);
        Ok(())
    }

    /// Measures at most `most` stale vertices, those nearest to `brush` first, on the current rayon
    /// pool; returns how many are stale still. With [`Job::cancel`] nothing of this call is kept.
    pub fn work(&mut self, brush: Vec3, most: usize, job: &Job) -> Result<usize, Cancelled> {
        let far = |v: &u32| self.mesh.positions[*v as usize].distance_squared(brush);
        if most < self.stale.len() {
            self.stale
                .select_nth_unstable_by(most, |a, b| far(a).total_cmp(&far(b)).then(a.cmp(b)));
        }
        let mut now: Vec<u32> = self.stale[..most.min(self.stale.len())].to_vec();
        // In the order of the loaded mesh: neighbours in memory, as a rule in space.
        now.sort_unstable();
        let caster = self.caster();
        let found: Vec<MeasuredVertex> = now
            .par_chunks(256)
            .map(|chunk| {
                job.check()?;
                Ok(chunk.iter().map(|&v| self.measure(&caster, v as usize)).collect::<Vec<_>>())
            })
            .collect::<Result<Vec<_>, Cancelled>>()?
            .concat();
        for (&v, found) in now.iter().zip(found) {
            self.values[v as usize] = found.value;
            self.reach[v as usize] = found.reach;
            self.is_stale[v as usize] = false;
        }
        let is_stale = &self.is_stale;
        self.stale.retain(|&v| is_stale[v as usize]);
        Ok(self.stale.len())
    }

    /// One a vertex of the loaded mesh; NaN where there is none, or none yet.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns the outward normal of each vertex, along which it is measured; zero without one.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Returns the area for which each vertex stands, in the clay's unit squared.
    pub fn areas(&self) -> &[f32] {
        &self.areas
    }

    /// Returns a flag for each value, true if it was measured on an older state of the clay.
    pub fn is_stale(&self) -> &[bool] {
        &self.is_stale
    }

    /// Vertices still to be measured.
    pub fn stale(&self) -> usize {
        self.stale.len()
    }

    /// Returns the side on which the map measures.
    pub fn side(&self) -> MeasuredSide {
        self.side
    }

    /// Returns the diameter of the largest ball between the place of the surface that is nearest to
    /// `place` and the side opposite, by the definition *sphere*; `None` where nothing holds one.
    pub fn ball(&self, place: Vec3) -> Option<f32> {
        let near = self.tree.nearest(place.as_dvec3(), f64::INFINITY)?;
        let own = [near.triangle];
        let (point, normal) = (near.point.as_vec3(), self.face_normals[near.triangle as usize]);
        let away = normal * self.sign();
        let site = Site { point, away, along: Vec3::ZERO, own: &own, clear: f32::INFINITY };
        self.caster().wall_ball(&site).map(|ball| ball.diameter)
    }

    /// Returns each vertex's wall less that of the earlier version at the place from which the
    /// vertex came, on the current rayon pool; NaN where either is not known.
    ///
    /// # Errors
    /// Returns an error if the job was cancelled.
    pub fn changes(&self, earlier: &EarlierVersion, job: &Job) -> Result<Vec<f32>, Cancelled> {
        let caster = self.caster();
        let change = |v: usize| {
            let (mut place, mut out) = (self.mesh.positions[v], self.normals[v]);
            if self.sharp[v] {
                let measured = self.measure(&caster, v);
                (place, out) = (measured.place, measured.out);
            }
            let clear = |dir, [t_min, t_max]: [f32; 2]| {
                !self.tree.any_hit(Ray { origin: place, dir, t_min, t_max }, |_| true)
            };
            let known = self.values[v].is_finite();
            let was = known.then(|| earlier.wall(place.as_dvec3(), out, clear)).flatten();
            was.map_or(f32::NAN, |was| self.values[v] - was)
        };
        let all: Vec<u32> = (0..self.values.len() as u32).collect();
        let found = all.par_chunks(256).map(|chunk| {
            job.check()?;
            Ok(chunk.iter().map(|&v| change(v as usize)).collect::<Vec<f32>>())
        });
        Ok(found.collect::<Result<Vec<_>, Cancelled>>()?.concat())
    }

    /// Of the snapshot that the map follows.
    pub fn revision(&self) -> u64 {
        self.snapshot.revision()
    }

    /// 1 where normals point out of the measured side, -1 where into it.
    fn sign(&self) -> f32 {
        if self.side == MeasuredSide::Wall { 1.0 } else { -1.0 }
    }

    /// The direction of a vertex's ray; zero where it has none.
    fn ray_direction(&self, v: usize) -> Vec3 {
        -(self.normals[v] * self.sign())
    }

    fn caster(&self) -> Caster<'_> {
        Caster {
            tree: &self.tree,
            face_normals: &self.face_normals,
            corner_normals: &[],
            sign: self.sign(),
            cone: &self.axis,
            outliers: Outliers::Keep,
            correction: Correction::None,
            acute: None,
        }
    }

    fn measure(&self, caster: &Caster<'_>, v: usize) -> MeasuredVertex {
        let (point, out) = (self.mesh.positions[v], self.normals[v]);
        let away = -self.ray_direction(v);
        let mut straight =
            MeasuredVertex { value: f32::NAN, reach: (point, point), place: point, out };
        if away == Vec3::ZERO {
            return straight;
        }
        let own = self.around(v);
        let site = Site { point, away, along: Vec3::ZERO, own, clear: f32::INFINITY };
        let hit = caster.hit(&site, -away);
        match hit {
            Some(hit) => {
                let end = point - away * hit.t;
                (straight.value, straight.reach) = (hit.t, (point.min(end), point.max(end)));
            }
            None => straight.reach = OPEN,
        }
        if !self.sharp[v] || hit.is_some_and(|hit| self.is_opposed(hit.triangle, away)) {
            return straight;
        }
        self.under_faces(caster, v, straight)
    }

    /// Returns the least wall under the faces around a sharp vertex; `straight`, with a larger box,
    /// where there is none.
    fn under_faces(
        &self,
        caster: &Caster<'_>,
        v: usize,
        straight: MeasuredVertex,
    ) -> MeasuredVertex {
        let (point, own) = (self.mesh.positions[v], self.around(v));
        let mut least: Option<MeasuredVertex> = None;
        let mut reach = if straight.reach == OPEN { ANYWHERE } else { straight.reach };
        for &t in own {
            let out = self.face_normals[t as usize];
            if out == Vec3::ZERO {
                continue;
            }
            let [a, b, c] = self.mesh.corners(t as usize);
            let (place, away) = (point.lerp((a + b + c) / 3.0, INTO_FACE), out * self.sign());
            let site = Site { point: place, away, along: Vec3::ZERO, own, clear: f32::INFINITY };
            let Some(hit) = caster.hit(&site, -away) else {
                reach = ANYWHERE;
                continue;
            };
            let end = place - away * hit.t;
            reach = (reach.0.min(place).min(end), reach.1.max(place).max(end));
            let thinner = least.is_none_or(|least| hit.t < least.value);
            if thinner && self.is_opposed(hit.triangle, away) {
                least = Some(MeasuredVertex { value: hit.t, reach, place, out });
            }
        }
        MeasuredVertex { reach, ..least.unwrap_or(straight) }
    }

    /// Returns true if a facet is within 40 degrees of parallel to the place that faces `away`.
    fn is_opposed(&self, triangle: u32, away: Vec3) -> bool {
        -self.face_normals[triangle as usize].dot(away) * self.sign() >= COS_40
    }

    fn around(&self, v: usize) -> &[u32] {
        &self.around[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    fn is_sharp(&self, v: usize) -> bool {
        let around = self.around(v);
        let meet = |t: u32, u: u32| {
            let other = self.mesh.triangles[u as usize];
            self.mesh.triangles[t as usize].iter().filter(|c| other.contains(c)).count() == 2
        };
        let folded = |t: u32, u: u32| {
            self.face_normals[t as usize].dot(self.face_normals[u as usize]) < COS_40 && meet(t, u)
        };
        around.iter().enumerate().any(|(i, &t)| around[..i].iter().any(|&u| folded(t, u)))
    }

    fn area(&self, v: usize) -> f32 {
        let area = |&t: &u32| {
            let [a, b, c] = self.mesh.corners(t as usize);
            (b - a).cross(c - a).length() / 6.0
        };
        self.around(v).iter().map(area).sum()
    }

    fn normal(&self, v: usize) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for &t in self.around(v) {
            let c = self.mesh.triangles[t as usize];
            let k = c.iter().position(|&x| x as usize == v).unwrap_or(0);
            let p = self.mesh.corners(t as usize);
            sum += self.face_normals[t as usize]
                * sculptd_geometry::thickness::surface::corner_angle(p, k);
        }
        sum.normalize_or_zero()
    }
}

fn face_normal(mesh: &TriMesh, t: usize) -> Vec3 {
    let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

fn bounds(mesh: &TriMesh, t: u32) -> (Vec3, Vec3) {
    let [a, b, c] = mesh.corners(t as usize);
    (a.min(b).min(c), a.max(b).max(c))
}

fn boxes_intersect(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}

/// Returns true if a ray meets a box. The box is larger than what is in it by more than the
/// rounding of the ray's distances.
fn ray_meets(from: Vec3, dir: Vec3, (lo, hi): (Vec3, Vec3)) -> bool {
    let (mut enters, mut leaves) = (0.0f32, f32::INFINITY);
    for axis in 0..3 {
        let (low, high) = (lo[axis] - from[axis], hi[axis] - from[axis]);
        if dir[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (low / dir[axis], high / dir[axis]);
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    enters <= leaves
}

/// At most 32 boxes that hold all: cut by the longest side of the whole, each part's union.
fn coarsen(boxes: &mut Vec<(Vec3, Vec3)>) {
    const PARTS: usize = 32;
    if boxes.len() <= PARTS {
        return;
    }
    let all = boxes
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let size = all.1 - all.0;
    let axis = size.max_position();
    boxes.sort_by(|a, b| a.0[axis].total_cmp(&b.0[axis]));
    let per = boxes.len().div_ceil(PARTS);
    *boxes = boxes
        .chunks(per)
        .map(|c| {
            c.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)))
        })
        .collect();
}
