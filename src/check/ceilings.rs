//! Heights above which nothing blocks a ray along one direction: a pyramid of grids over the plan,
//! each cell with the highest face that looks against the ray. Most rays of a part end without one
//! look at the tree (Greene, Kass and Miller, "Hierarchical Z-buffer visibility", 1993).

use glam::{DVec2, DVec3, IVec2};

use crate::part::PreparedPart;

/// Most cells along a side of the finest grid; a power of two.
const FINEST: usize = 1024;
/// Most cells that a face covers along a side of the grid that it is entered in, less one.
const SPAN: i32 = 2;
/// Roundings of a coordinate by which a ray in single precision may pass beside its line.
const ROUNDINGS: f64 = 256.0;

/// The faces that block rays along one direction.
pub(crate) struct Ceilings {
    along: DVec3,
    plan: [DVec3; 2],
    corner: DVec2,
    /// Cells of the finest grid in a unit of length, and along a side.
    scale: f64,
    side: usize,
    /// The finest grid first, each next one with half the cells along a side.
    levels: Vec<Vec<f64>>,
    slack: f64,
}

impl Ceilings {
    /// The faces of `part` that look against `along`, which is of unit length.
    pub fn new(part: &PreparedPart, along: DVec3) -> Ceilings {
        let (u, v) = along.any_orthonormal_pair();
        let flat = |p: DVec3| DVec2::new(p.dot(u), p.dot(v));
        let (lo, hi) = part
            .places
            .iter()
            .map(|&p| flat(p))
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let slack = ROUNDINGS * part.rounding();
        let size = (hi - lo).max_element() + 2.0 * slack;
        let side = ((part.triangles() as f64).sqrt() as usize).next_power_of_two().min(FINEST);
        let scale = side as f64 / size.max(f64::MIN_POSITIVE);
        let levels =
            (0..=side.ilog2()).map(|l| vec![f64::NEG_INFINITY; (side >> l).pow(2)]).collect();
        let corner = lo - slack;
        let mut out = Ceilings { along, plan: [u, v], corner, scale, side, levels, slack };
        for t in 0..part.triangles() as u32 {
            let against = part.normals[t as usize].dot(along) < 0.0;
            let Some(corners) = part.corners(t).filter(|_| against) else { continue };
            let [a, b, c] = corners.map(flat);
            let (first, last) =
                (out.cell(a.min(b).min(c) - slack), out.cell(a.max(b).max(c) + slack));
            let height = corners.map(|p| p.dot(along)).into_iter().fold(f64::MIN, f64::max);
            let mut level = 0i32;
            while IVec2::max_element((last >> level) - (first >> level)) > SPAN {
                level += 1;
            }
            let (first, last) = (first >> level, last >> level);
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let cell =
                        &mut out.levels[level as usize][y as usize * (side >> level) + x as usize];
                    *cell = cell.max(height);
                }
            }
        }
        out
    }

    fn cell(&self, p: DVec2) -> IVec2 {
        let most = DVec2::splat(self.side as f64 - 1.0);
        ((p - self.corner) * self.scale).clamp(DVec2::ZERO, most).as_ivec2()
    }

    /// Returns true if no face blocks a ray from `from`. False if one may.
    pub fn open_above(&self, from: DVec3) -> bool {
        let height = from.dot(self.along) - self.slack;
        let cell = self.cell(DVec2::new(from.dot(self.plan[0]), from.dot(self.plan[1])));
        self.levels.iter().enumerate().all(|(level, heights)| {
            let at = cell >> level as i32;
            heights[at.y as usize * (self.side >> level) + at.x as usize] < height
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use sculptd_geometry::PolyMesh;
    use sculptd_geometry::job::Job;
    use sculptd_geometry::shapes::{cuboid, icosphere};

    /// A lumpy ball, and a block with a long thin plate over it.
    pub(crate) fn parts() -> Vec<PreparedPart> {
        let mut lump = icosphere(10.0, 20).to_poly();
        for p in &mut lump.positions {
            *p *= 1.0 + 0.3 * ((p.x * 0.9).sin() * (p.y * 0.8).cos() * (p.z * 1.1).sin());
        }
        let mut block = cuboid(DVec3::ZERO, DVec3::new(30.0, 20.0, 5.0));
        let plate = cuboid(DVec3::new(-40.0, 9.0, 8.0), DVec3::new(80.0, 9.5, 8.25));
        let base = block.positions.len() as u32;
        block.positions.extend(&plate.positions);
        plate.faces().for_each(|f| {
            block.push_face(&f.iter().map(|v| v + base).collect::<Vec<_>>());
        });
        let ready = |m: &PolyMesh| PreparedPart::new(m, 1.0, &Job::default()).expect("prepared");
        [lump, block].iter().map(ready).collect()
    }

    #[test]
    fn no_ray_from_an_open_place_is_blocked() {
        for part in parts() {
            let points = crate::columns::surface_points(&part, 3000);
            for along in sculptd_geometry::projection::spread_directions(40) {
                let ceilings = Ceilings::new(&part, along);
                let (mut open, mut free) = (0, 0);
                for &(p, t) in &points {
                    let from = p + part.normals[t as usize] * (16.0 * part.rounding());
                    let blocked = part.blocked(from, along, 0.0);
                    assert!(!(ceilings.open_above(from) && blocked), "{from} {along}");
                    // Only from faces that look that way rays are asked for.
                    if part.normals[t as usize].dot(along) > 0.0 {
                        open += usize::from(ceilings.open_above(from));
                        free += usize::from(!blocked);
                    }
                }
                let few = part.triangles() < 1000;
                assert!(few || open * 2 > free, "{open} of {free} are known to be free");
            }
        }
    }
}
