//! How far a surface is from another one at its farthest place (the directed Hausdorff distance),
//! between bounds that contain the truth.
//!
//! Of a piece of a triangle, each corner gives a lower bound. Two upper bounds hold for all of it.
//! The distance to one triangle of the other surface is convex, so it is greatest at a corner of
//! the piece. And no distance changes faster than its place, so the distance of the middle and the
//! radius bound it too. Pieces whose upper bound is too far above the lower bound of the whole are
//! quartered (branch and bound). The result does not depend on the number of threads.

use glam::DVec3;
use rayon::prelude::*;

use crate::TriMesh;
use crate::bvh::{Bvh8, nearest_on_triangle};
use crate::job::{Cancelled, Job};

/// The upper bound may be this share above the lower one.
const TOLERANCE: f64 = 0.02;
/// Rounds of quartering.
const ROUNDS: usize = 16;
/// Pieces that are open at a time; with more of them the bound stays as it is.
const MOST: usize = 1 << 20;
/// Pieces that one task works through.
const CHUNK: usize = 256;

/// The distance of the farthest place of a surface from another surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Some place is as far as this, in the meshes' unit.
    pub at_least: f64,
    /// No place is farther than this.
    pub at_most: f64,
    /// The place that is [`Deviation::at_least`] away.
    pub place: DVec3,
}

/// A part of a triangle, and for each corner the nearest triangle of the other surface.
#[derive(Debug, Clone, Copy)]
struct Piece {
    corners: [DVec3; 3],
    near: [u32; 3],
}

/// The other surface.
struct Other<'a> {
    tree: &'a Bvh8,
    mesh: &'a TriMesh,
}

/// A distance and where it was found.
type FarPlace = (f64, DVec3);

fn farther(a: FarPlace, b: FarPlace) -> FarPlace {
    if b.0 > a.0 { b } else { a }
}

impl Other<'_> {
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.triangles[triangle as usize].map(|v| self.mesh.positions[v as usize].as_dvec3())
    }

    /// The distance of a place and its nearest triangle.
    fn nearest(&self, p: DVec3) -> (f64, u32) {
        let found = self.tree.nearest(p, f64::INFINITY);
        found.map_or((f64::INFINITY, u32::MAX), |n| (n.distance(), n.triangle))
    }

    /// An upper bound of the distance of a piece, by one triangle of the other surface.
    fn by_triangle(&self, piece: &Piece, triangle: u32) -> f64 {
        let other = self.corners(triangle);
        let distance = |p: &DVec3| (*p - nearest_on_triangle(*p, other).0).length();
        piece.corners.iter().map(distance).fold(0.0, f64::max)
    }

    /// The same, by the nearest triangles of its corners.
    fn by_corners(&self, piece: &Piece) -> f64 {
        let near = piece.near;
        let is_new = |k: &usize| near[*k] != u32::MAX && !near[..*k].contains(&near[*k]);
        let bounds = (0..3).filter(is_new).map(|k| self.by_triangle(piece, near[k]));
        bounds.fold(f64::INFINITY, f64::min)
    }

    /// An upper bound by the middle, and the middle's distance.
    fn by_middle(&self, piece: &Piece) -> (f64, FarPlace) {
        let [a, b, c] = piece.corners;
        let middle = (a + b + c) / 3.0;
        let radius = piece.corners.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
        let (distance, triangle) = self.nearest(middle);
        let by_triangle = match triangle {
            u32::MAX => f64::INFINITY,
            triangle => self.by_triangle(piece, triangle),
        };
        ((distance + radius).min(by_triangle), (distance, middle))
    }

    /// The four quarters of a piece, and the farthest of their new corners.
    fn quarters(&self, piece: &Piece) -> ([Piece; 4], FarPlace) {
        let ([a, b, c], [na, nb, nc]) = (piece.corners, piece.near);
        let middles = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
        let found = middles.map(|p| (self.nearest(p), p));
        let far = found.map(|((d, _), p)| (d, p)).into_iter().fold((0.0, a), farther);
        let [(ab, nab), (bc, nbc), (ca, nca)] = found.map(|((_, near), p)| (p, near));
        let piece = |corners, near| Piece { corners, near };
        let all = [
            piece([a, ab, ca], [na, nab, nca]),
            piece([ab, b, bc], [nab, nb, nbc]),
            piece([ca, bc, c], [nca, nbc, nc]),
            piece([ab, bc, ca], [nab, nbc, nca]),
        ];
        (all, far)
    }
}

/// A piece that is not decided, and its upper bound.
type Open = (Piece, f64);

/// The distance of the farthest place of the surface `from` from the surface `to`. `tree` was built
/// from `to`. The bounds differ by at most two per cent and `resolution` (in the meshes' unit),
/// unless that takes more than a million pieces at a time. An empty `from` is nowhere, so 0 away;
/// everything is infinitely far from an empty `to`.
///
/// # Errors
/// Returns [`Cancelled`] once the job is cancelled.
pub fn deviation(
    from: &TriMesh,
    to: &TriMesh,
    tree: &Bvh8,
    resolution: f64,
    job: &Job,
) -> Result<Deviation, Cancelled> {
    let other = Other { tree, mesh: to };
    let corner = |v: &u32| from.positions[*v as usize].as_dvec3();
    let near: Vec<(f64, u32)> =
        from.positions.par_iter().map(|p| other.nearest(p.as_dvec3())).collect();
    job.check()?;
    let start = from.triangles.first().map_or(DVec3::ZERO, |t| corner(&t[0]));
    let used = from.triangles.iter().flatten();
    let mut least = used.map(|v| (near[*v as usize].0, corner(v))).fold((0.0, start), farther);
    if !least.0.is_finite() {
        return Ok(Deviation { at_least: least.0, at_most: least.0, place: least.1 });
    }
    let goal = |least: f64| least * (1.0 + TOLERANCE) + resolution;
    // Of the decided pieces.
    let mut most: f64 = least.0;
    let mut open: Vec<Piece> = from
        .triangles
        .iter()
        .map(|t| Piece { corners: t.each_ref().map(corner), near: t.map(|v| near[v as usize].1) })
        .collect();
    for round in 0..=ROUNDS {
        let (limit, asked) = (goal(least.0), &other);
        let looked: Vec<(Vec<Open>, f64, FarPlace)> = open
            .par_chunks(CHUNK)
            .map(|pieces| {
                job.check()?;
                let (mut undecided, mut most, mut far) = (Vec::new(), 0.0f64, (0.0, start));
                for piece in pieces {
                    let mut bound = asked.by_corners(piece);
                    if bound > limit {
                        let (by_middle, middle) = asked.by_middle(piece);
                        far = farther(far, middle);
                        bound = bound.min(by_middle);
                    }
                    match bound <= limit {
                        true => most = most.max(bound),
                        false => undecided.push((*piece, bound)),
                    }
                }
                Ok((undecided, most, far))
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut undecided: Vec<Open> = Vec::new();
        for (pieces, decided, far) in looked {
            (most, least) = (most.max(decided), farther(least, far));
            undecided.extend(pieces);
        }
        // The lower bound has grown meanwhile.
        let limit = goal(least.0);
        undecided.retain(|(_, bound)| {
            let is_open = *bound > limit;
            if !is_open {
                most = most.max(*bound);
            }
            is_open
        });
        if undecided.is_empty() {
            break;
        }
        if round == ROUNDS || undecided.len() > MOST / 4 {
            most = undecided.iter().fold(most, |m, (_, bound)| m.max(*bound));
            break;
        }
        let quartered: Vec<([Piece; 4], FarPlace)> =
            undecided.par_iter().map(|(piece, _)| other.quarters(piece)).collect();
        least = quartered.iter().map(|q| q.1).fold(least, farther);
        open = quartered.into_iter().flat_map(|q| q.0).collect();
    }
    Ok(Deviation { at_least: least.0, at_most: most.max(least.0), place: least.1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;
    use glam::Vec3;

    fn of(from: &TriMesh, to: &TriMesh, resolution: f64) -> Deviation {
        let job = Job::default();
        let tree = Bvh8::build(to, &job).expect("a tree");
        deviation(from, to, &tree, resolution, &job).expect("not cancelled")
    }

    /// The farthest of many places of `from`, each by every triangle of `to`.
    fn sampled(from: &TriMesh, to: &TriMesh, steps: u32) -> f64 {
        let place = |mesh: &TriMesh, v: u32| mesh.positions[v as usize].as_dvec3();
        let distance = |p: DVec3| {
            let one =
                |t: &[u32; 3]| (p - nearest_on_triangle(p, t.map(|v| place(to, v))).0).length();
            to.triangles.iter().map(one).fold(f64::INFINITY, f64::min)
        };
        let mut most = 0.0f64;
        for t in &from.triangles {
            let [a, b, c] = t.map(|v| place(from, v));
            for i in 0..=steps {
                for j in 0..=steps - i {
                    let (u, v) = (f64::from(i) / f64::from(steps), f64::from(j) / f64::from(steps));
                    most = most.max(distance(a + (b - a) * u + (c - a) * v));
                }
            }
        }
        most
    }

    #[test]
    fn a_surface_is_not_away_from_itself_and_everything_is_far_from_nothing() {
        let ball = shapes::icosphere(1.0, 6);
        let found = of(&ball, &ball, 0.0);
        assert!(found.at_least < 1e-12 && found.at_most < 1e-12, "{found:?}");
        let nothing = TriMesh::default();
        assert_eq!(of(&nothing, &ball, 0.0).at_most, 0.0);
        assert_eq!(of(&ball, &nothing, 0.0).at_least, f64::INFINITY);
    }

    #[test]
    fn balls_of_two_sizes_are_as_far_apart_as_their_radii() {
        let (small, large) = (shapes::icosphere(1.0, 20), shapes::icosphere(1.5, 20));
        let found = of(&small, &large, 1e-3);
        // Facets lie a little inside.
        assert!(found.at_least > 0.49 && found.at_most < 0.515, "{found:?}");
        assert!(found.at_least <= found.at_most);
    }

    #[test]
    fn the_bounds_contain_what_samples_find() {
        let mut seed = 9u64;
        let mut part = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f32 / 16_777_216.0
        };
        for round in 0..20 {
            let mut shape = |segments| {
                let mut mesh = shapes::icosphere(1.0, segments);
                for p in &mut mesh.positions {
                    *p *= 1.0 + 0.3 * (part() - 0.5);
                    p.x *= 1.4;
                }
                mesh
            };
            let (a, b) = (shape(3), shape(2 + round % 4));
            for (from, to) in [(&a, &b), (&b, &a)] {
                let (found, seen) = (of(from, to, 1e-4), sampled(from, to, 12));
                assert!(seen <= found.at_most + 1e-12, "round {round}: {seen} of {found:?}");
                let gap = found.at_most - found.at_least;
                assert!(gap <= 0.02 * found.at_least + 1e-4 + 1e-12, "round {round}: {found:?}");
                assert!(found.at_least >= 0.9 * seen, "round {round}: {seen} of {found:?}");
            }
        }
    }

    #[test]
    fn a_thin_part_that_was_lost_is_far_from_what_is_left() {
        let cuboid = |half: DVec3| shapes::cuboid(-half, half).triangulate().0;
        let plate = cuboid(DVec3::new(5.0, 5.0, 0.5));
        let mut with_pin = plate.clone();
        let pin = cuboid(DVec3::new(0.05, 0.05, 2.0));
        let base = with_pin.positions.len() as u32;
        with_pin.positions.extend(pin.positions.iter().map(|p| *p + Vec3::Z * 2.0));
        with_pin.triangles.extend(pin.triangles.iter().map(|t| t.map(|v| v + base)));
        let (lost, kept) = (of(&with_pin, &plate, 1e-3), of(&plate, &with_pin, 1e-3));
        assert!(lost.at_least > 3.0, "{lost:?}");
        assert!(kept.at_most < 0.1, "{kept:?}");
    }

    #[test]
    fn more_threads_find_the_same_bits() {
        let (a, b) = (shapes::icosphere(1.0, 12), shapes::uv_sphere(1.02, 18, 30).triangulate().0);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("made");
            pool.install(|| of(&a, &b, 1e-4))
        };
        assert_eq!(with(1), with(5));
    }
}
