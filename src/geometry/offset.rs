//! Solids offset, hollowed and joined with a fillet, from the sampled signed distance: the level
//! set is extracted by dual marching cubes (Nielson 2004, see [`crate::remesh::dual`]) and its
//! vertices are moved to the exact distance.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::bvh::nearest_on_triangle;
use super::distance::DistanceSolid;
use super::grid::DistanceGrid;
use super::implicit::onto_zero;
use super::remesh::dual::extract;
use super::remesh::{LostParts, MARGIN, RemeshError, layout, lost_parts, middle};
use super::unfold::{even, settle_all};
use crate::TriMesh;
use crate::disjoint_sets::DisjointSets;
use crate::job::Job;

/// Newton steps that put a vertex at its distance from the old surface.
const STEPS: usize = 4;

/// A vertex settles within this share of the spacing. Along a ridge the way to the wanted distance
/// leads across it, and what went further would fold over its neighbours; left where it is, the
/// ridge is a little blunter.
const ROOM: f64 = 0.25;

/// Moves `p` until the surface is `distance` away (negative inside), as far as it can be in a few
/// steps.
fn settle(solid: &DistanceSolid, start: DVec3, distance: f64, h: f64) -> DVec3 {
    let mut p = start;
    for _ in 0..STEPS {
        let Some(n) = solid.tree.nearest(p, f64::INFINITY) else { return p };
        let away = p - n.point;
        let length = away.length();
        let error = distance.abs() - length;
        if length < h * 1e-3 || error.abs() < h * 1e-4 {
            return p;
        }
        p += away * (error.clamp(-h, h) / length);
        p = start + (p - start).clamp_length_max(h * ROOM);
    }
    p
}

/// A surface, and the spacing of the samples that it was made from.
struct OffsetSurface {
    points: Vec<Vec3>,
    faces: Vec<[u32; 3]>,
    spacing: f64,
}

impl OffsetSurface {
    fn mesh(self) -> TriMesh {
        TriMesh { positions: self.points, triangles: self.faces, colours: None }
    }
}

/// The surface at `distance` from the solid's, possibly of nothing.
fn at_distance(
    solid: &DistanceSolid,
    distance: f64,
    side: usize,
    job: &Job,
) -> Result<OffsetSurface, RemeshError> {
    let grid = DistanceGrid::band(
        [solid],
        |[d]| d - distance,
        layout(solid, distance.max(0.0), side)?,
        job,
    )?;
    let h = grid.spacing;
    let (from, faces) = extract(&grid, middle, job)?;
    let mut moved = even(&from, &faces, h * ROOM);
    moved.par_iter_mut().try_for_each(|p| {
        job.check()?;
        *p = settle(solid, p.as_dvec3(), distance, h).as_vec3();
        Ok::<_, RemeshError>(())
    })?;
    Ok(OffsetSurface { points: settle_all(&from, moved, &faces, job)?, faces, spacing: h })
}

/// A solid grown or shrunk.
#[derive(Debug, Clone)]
pub struct Offset {
    /// The new surface.
    pub mesh: TriMesh,
    /// Its least distance from the old one, over all of its triangles, in the mesh's unit.
    pub least: f64,
}

/// The surface at `distance` (mm; negative shrinks) from the solid's: a closed 2-manifold. Its
/// vertices are at one distance to about a ten-thousandth of the spacing except at creases. Where
/// triangles cut across a bend they come nearer than their vertices, so the surface is made again,
/// farther away by what is missing, until none of it is nearer than `distance`; [`Offset::least`]
/// says what was reached. [`RemeshError::TooDeep`] where shrinking leaves nothing.
pub fn offset(
    solid: &DistanceSolid,
    distance: f64,
    side: usize,
    job: &Job,
) -> Result<Offset, RemeshError> {
    let wanted = distance.abs();
    let mut asked = wanted;
    let mut made = at_distance(solid, distance, side, job)?;
    if made.faces.is_empty() {
        return Err(if distance < 0.0 {
            too_deep(solid, wanted, job)?
        } else {
            RemeshError::Empty
        });
    }
    let mut least = least_wall(solid, &made, job)?;
    for _ in 0..ROUNDS {
        if least >= wanted {
            break;
        }
        asked += (wanted - least) * 1.05 + made.spacing * 1e-4;
        let next = at_distance(solid, asked.copysign(distance), side, job)?;
        if next.faces.is_empty() {
            break;
        }
        made = next;
        least = least_wall(solid, &made, job)?;
    }
    job.progress(1.0);
    Ok(Offset { mesh: made.mesh(), least })
}

/// A hollowed solid.
#[derive(Debug, Clone)]
pub struct Hollow {
    /// The old surface, bit by bit, and the cavity's, turned inwards.
    pub mesh: TriMesh,
    /// Triangles of the cavity; they come last.
    pub cavity: usize,
    /// Spacing of the samples that the cavity was made from.
    pub spacing: f64,
    /// The thinnest place of the wall, in the mesh's unit.
    pub wall: f64,
}

/// The cavity everywhere further than `depth` inside, without partitions thinner than `wall`.
fn cavity_at(
    solid: &DistanceSolid,
    depth: f64,
    wall: f64,
    side: usize,
    job: &Job,
) -> Result<OffsetSurface, RemeshError> {
    let deep = at_distance(solid, -depth, side, job)?;
    let h = deep.spacing;
    let deep = OffsetSurface { faces: without_specks(&deep.points, deep.faces, h), ..deep };
    if deep.faces.is_empty() {
        return Err(RemeshError::Empty);
    }
    closed(deep, wall * 0.5, job)
}

/// The cavity at the depth that is asked for.
fn first_cavity(
    solid: &DistanceSolid,
    wall: f64,
    side: usize,
    job: &Job,
) -> Result<OffsetSurface, RemeshError> {
    match cavity_at(solid, wall, wall, side, job) {
        Err(RemeshError::Empty) => Err(too_deep(solid, wall, job)?),
        made => made,
    }
}

/// Samples along the longest side by which the deepest place is found.
const DEPTH_SIDE: usize = 64;

/// The error for a part that is nowhere `asked` deep. A part in which no sample is inside encloses
/// nothing.
fn too_deep(solid: &DistanceSolid, asked: f64, job: &Job) -> Result<RemeshError, RemeshError> {
    let grid = DistanceGrid::sample(solid, layout(solid, 0.0, DEPTH_SIDE)?, job)?;
    let deepest = -grid.values.iter().fold(0f32, |least, v| least.min(*v)) as f64;
    Ok(if deepest > 0.0 { RemeshError::TooDeep { asked, deepest } } else { RemeshError::Empty })
}

/// A surface `depth` inside passes a flat or right-angled part of the old one within this many of
/// it.
const CORNER: f64 = 1.8;

/// Returns the parts of `old` with no surface beneath them at about `depth`: there the solid is
/// thinner than twice the depth. `solid` was built from `old`; `new` holds the vertices of the
/// surface at that depth.
pub fn too_thin(
    old: &TriMesh,
    solid: &DistanceSolid,
    new: &[Vec3],
    depth: f64,
    side: usize,
) -> Option<LostParts> {
    let (lo, hi) = old.bounds();
    let spacing = (hi - lo).max_element() as f64 / side.max(1) as f64;
    lost_parts(old, solid, new, CORNER * depth + 2.0 * spacing)
}

/// Rounds after which the least distance is as it is: the second, as a rule, finds nothing.
const ROUNDS: usize = 8;
/// Steps by which a place in a triangle comes to the one that is nearest to the old surface.
const DESCENT: usize = 12;

/// The least distance from the solid's surface to a cavity: of each of its triangles the nearest
/// of seven places, from which projections onto the old surface and back onto the triangle in turns
/// (von Neumann's alternating projections) lead to the nearest place of all around.
fn least_wall(
    solid: &DistanceSolid,
    cavity: &OffsetSurface,
    job: &Job,
) -> Result<f64, RemeshError> {
    let least = cavity
        .faces
        .par_chunks(256)
        .map(|faces| {
            job.check()?;
            let mut least = f64::INFINITY;
            for face in faces {
                let corners = face.map(|v| cavity.points[v as usize].as_dvec3());
                let [a, b, c] = corners;
                let middles = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) / 3.0];
                // A bound makes the search faster: from places much farther no descent leads below.
                let span = (b - a).length().max((c - a).length());
                let mut near = None;
                for p in corners.into_iter().chain(middles) {
                    let bound = near.map_or(least + 0.5 * span, |(d, _)| d);
                    if let Some(n) = solid.tree.nearest(p, bound) {
                        near = Some((n.distance(), n.point));
                    }
                }
                let Some((mut distance, mut point)) = near else { continue };
                for _ in 0..DESCENT {
                    let (p, _) = nearest_on_triangle(point, corners);
                    let Some(n) = solid.tree.nearest(p, distance) else { break };
                    let gained = distance - n.distance();
                    (distance, point) = (n.distance(), n.point);
                    if gained <= 1e-6 * distance {
                        break;
                    }
                }
                least = least.min(distance);
            }
            Ok(least)
        })
        .collect::<Result<Vec<f64>, RemeshError>>()?;
    Ok(least.into_iter().fold(f64::INFINITY, f64::min))
}

/// Hollows `mesh` to a wall of at least `wall`: the old surface is kept, and a cavity everywhere
/// further than `wall` inside is cut out, together with every partition within it that is thinner
/// than the wall. The wall is measured over each of the cavity's triangles, and the cavity is made
/// again, deeper, until none is nearer than `wall`; [`Hollow::wall`] says what was reached.
/// [`RemeshError::TooDeep`] where the solid is nowhere thick enough for a cavity.
pub fn hollow(
    mesh: &TriMesh,
    solid: &DistanceSolid,
    wall: f64,
    side: usize,
    job: &Job,
) -> Result<Hollow, RemeshError> {
    // A cavity's chords come nearer to the old surface than its vertices do: what is missing of the
    // wall is measured and added until nothing is.
    let (mut depth, mut cavity) = (wall, first_cavity(solid, wall, side, job)?);
    let mut least = least_wall(solid, &cavity, job)?;
    for _ in 0..ROUNDS {
        if least >= wall {
            break;
        }
        depth += (wall - least) * 1.05 + cavity.spacing * 1e-4;
        cavity = cavity_at(solid, depth, wall, side, job)?;
        least = least_wall(solid, &cavity, job)?;
    }
    let OffsetSurface { points: inner, faces, spacing: h } = cavity;
    let mut out = mesh.clone();
    let base = out.positions.len() as u32;
    // Only the points that a cavity kept uses, in their order.
    let mut used = vec![false; inner.len()];
    faces.iter().flatten().for_each(|&v| used[v as usize] = true);
    let mut number = vec![0; inner.len()];
    for ((number, _), next) in number.iter_mut().zip(&used).filter(|(_, u)| **u).zip(base..) {
        *number = next;
    }
    out.positions.extend(inner.iter().zip(&used).filter(|(_, u)| **u).map(|(p, _)| *p));
    let of = |v: u32| number[v as usize];
    out.triangles.extend(faces.iter().map(|&[a, b, c]| [of(a), of(c), of(b)]));
    if let Some(c) = &mut out.colours {
        c.resize(out.positions.len(), [255; 4]);
    }
    job.progress(1.0);
    Ok(Hollow { mesh: out, cavity: faces.len(), spacing: h, wall: least })
}

/// The cavity grown by `radius` and shrunk again (Serra, "Image analysis and mathematical
/// morphology", 1982). Where the solid is about twice the wall thick, what lies further inside than
/// the wall falls into several rooms with partitions as thin as may be between them; this takes out
/// every partition that a ball of `radius` does not fit into, and leaves all else.
fn closed(cavity: OffsetSurface, radius: f64, job: &Job) -> Result<OffsetSurface, RemeshError> {
    let h = cavity.spacing;
    let next = |made: OffsetSurface, distance: f64| {
        let solid = DistanceSolid::build(&made.mesh(), job)?;
        let (lo, hi) = solid.tree.bounds();
        let longest = (hi - lo).max_element() as f64 + 2.0 * distance.max(0.0);
        let side = (longest / h).ceil() as usize + 1 + 2 * MARGIN;
        at_distance(&solid, distance, side.clamp(8, 1024), job)
    };
    let back = next(next(cavity, radius)?, -radius)?;
    let faces = without_specks(&back.points, back.faces, h);
    if faces.is_empty() { Err(RemeshError::Empty) } else { Ok(OffsetSurface { faces, ..back }) }
}

/// Removes cavities that are too flat for the sampling to resolve: where a solid is about twice the
/// wall thick, its middle gives flat flakes. Leaving one out makes the part more solid there, never
/// thinner.
fn without_specks(points: &[Vec3], faces: Vec<[u32; 3]>, h: f64) -> Vec<[u32; 3]> {
    let mut shells = DisjointSets::new(points.len());
    for &[a, b, c] in &faces {
        shells.join(a, b);
        shells.join(b, c);
    }
    // Six times the volume and twice the area of each cavity, about one of its points.
    let mut sums = vec![(0.0f64, 0.0f64); points.len()];
    for &face in &faces {
        let home = shells.root(face[0]);
        let [a, b, c] = face.map(|v| (points[v as usize] - points[home as usize]).as_dvec3());
        let sum = &mut sums[home as usize];
        sum.0 += a.dot(b.cross(c));
        sum.1 += (b - a).cross(c - a).length();
    }
    // A ball of radius r has 3 V / A = r, a sheet of thickness t has 1.5 t.
    let mut keeps = |v: u32| {
        let (volume, area) = sums[shells.root(v) as usize];
        volume > h * area
    };
    faces.into_iter().filter(|f| keeps(f[0])).collect()
}

/// The smaller of two distances, rounded within `k` of where they are equal (Quilez's quadratic
/// polynomial): at most `k / 4` less. No steeper than its arguments.
pub fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    if k <= 0.0 {
        return a.min(b);
    }
    let x = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - x * x * k * 0.25
}

/// Two solids as one, with a fillet of about `radius` along their seam; a radius of zero is the
/// plain union.
pub fn smooth_union(
    a: &DistanceSolid,
    b: &DistanceSolid,
    radius: f64,
    side: usize,
    job: &Job,
) -> Result<TriMesh, RemeshError> {
    let k = radius.max(0.0) * 2.0;
    let ((alo, ahi), (blo, bhi)) = (a.tree.bounds(), b.tree.bounds());
    layout(a, 0.0, side)?;
    layout(b, 0.0, side)?;
    let room = DVec3::splat(k * 0.25);
    let both = (alo.min(blo).as_dvec3() - room, ahi.max(bhi).as_dvec3() + room);
    let shape = DistanceGrid::layout(both, side, MARGIN);
    let grid = DistanceGrid::band([a, b], |[p, q]| smooth_min(p, q, k), shape, job)?;
    let h = grid.spacing;
    let field = |p: DVec3| smooth_min(a.signed_distance(p), b.signed_distance(p), k);
    let (mut positions, triangles) = extract(&grid, middle, job)?;
    if triangles.is_empty() {
        return Err(RemeshError::Empty);
    }
    onto_zero(&mut positions, &field, h, job)?;
    job.progress(1.0);
    Ok(TriMesh { positions, triangles, colours: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PolyMesh;
    use crate::shapes::{cuboid, icosphere};

    #[test]
    fn the_wall_is_nowhere_thinner_than_asked() {
        let ball = icosphere(10.0, 12);
        let job = Job::default();
        let solid = DistanceSolid::build(&ball, &job).unwrap();
        let made = hollow(&ball, &solid, 2.0, 32, &job).unwrap();
        let cavity = &made.mesh.triangles[made.mesh.triangles.len() - made.cavity..];
        let mut least = f64::INFINITY;
        for t in cavity {
            let [a, b, c] = t.map(|v| made.mesh.positions[v as usize].as_dvec3());
            // Other places than those from which the cavity was made.
            for (u, v) in [(0.25, 0.0), (0.25, 0.25), (0.6, 0.2), (0.1, 0.45)] {
                let p = a + (b - a) * u + (c - a) * v;
                let near = solid.tree.nearest(p, f64::INFINITY).unwrap();
                least = least.min(near.distance());
            }
        }
        assert!((1.999..2.2).contains(&least), "{least}");
        assert!(made.wall >= 2.0 && made.wall <= least + 1e-6, "{} {least}", made.wall);
    }

    #[test]
    fn no_place_of_an_offset_is_nearer_than_asked() {
        let ball = icosphere(10.0, 6);
        let job = Job::default();
        let solid = DistanceSolid::build(&ball, &job).unwrap();
        for distance in [1.5, -1.5] {
            // Coarse, so that chords come visibly nearer than vertices do.
            let made = offset(&solid, distance, 16, &job).unwrap();
            let mut least = f64::INFINITY;
            for t in &made.mesh.triangles {
                let [a, b, c] = t.map(|v| made.mesh.positions[v as usize].as_dvec3());
                for i in 0..=12 {
                    for j in 0..=12 - i {
                        let p =
                            a + (b - a) * (f64::from(i) / 12.0) + (c - a) * (f64::from(j) / 12.0);
                        least = least.min(solid.tree.nearest(p, f64::INFINITY).unwrap().distance());
                    }
                }
            }
            assert!((1.5..1.7).contains(&least), "{least}");
            assert!(made.least >= 1.5 && made.least <= least + 1e-6, "{} {least}", made.least);
        }
    }

    #[test]
    fn a_wall_thicker_than_half_of_the_part_is_an_error_with_figures() {
        let plate = cuboid(DVec3::ZERO, DVec3::new(20.0, 20.0, 4.0)).triangulate().0;
        let job = Job::default();
        let solid = DistanceSolid::build(&plate, &job).unwrap();
        for e in [
            hollow(&plate, &solid, 2.5, 64, &job).unwrap_err(),
            offset(&solid, -2.5, 64, &job).unwrap_err(),
        ] {
            let RemeshError::TooDeep { asked, deepest } = e else { panic!("{e}") };
            assert!(asked == 2.5 && (deepest - 2.0).abs() < 0.35, "{deepest}");
            assert!(e.to_string().contains("half of the part's greatest thickness"));
        }
    }

    #[test]
    fn a_fin_that_an_offset_takes_away_is_reported_and_a_block_is_not() {
        let job = Job::default();
        let mut part = cuboid(DVec3::ZERO, DVec3::new(20.0, 20.0, 8.0));
        let lost = |part: &PolyMesh| {
            let part = part.triangulate().0;
            let solid = DistanceSolid::build(&part, &job).unwrap();
            let made = offset(&solid, -1.0, 64, &job).unwrap();
            too_thin(&part, &solid, &made.mesh.positions, 1.0, 64)
        };
        assert_eq!(lost(&part), None);
        let fin = cuboid(DVec3::new(9.5, 2.0, 7.0), DVec3::new(10.5, 18.0, 20.0));
        part.positions.extend(&fin.positions);
        fin.faces().for_each(|f| part.push_face(&f.iter().map(|v| v + 8).collect::<Vec<_>>()));
        let found = lost(&part).expect("the fin");
        assert!(found.place.z > 8.0 && found.area > 300.0, "{found:?}");
    }

    #[test]
    fn an_inner_edge_between_samples_is_found() {
        // The corner of a notch that reaches into the solid, at no sample of any triangle.
        let l = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let ring = [l(0., 0.), l(10., 0.), l(10., 4.3), l(4.7, 4.3), l(4.7, 10.), l(0., 10.)];
        let mut mesh = TriMesh::default();
        for z in [0.0, 8.0] {
            mesh.positions.extend(ring.map(|p| p + Vec3::Z * z));
        }
        for t in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
            mesh.triangles.extend([[t[0], t[2], t[1]], t.map(|v| v + 6)]);
        }
        for i in 0..6 {
            let j = (i + 1) % 6;
            mesh.triangles.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
        }
        let job = Job::default();
        let solid = DistanceSolid::build(&mesh, &job).unwrap();
        let made = hollow(&mesh, &solid, 1.1, 24, &job).unwrap();
        let cavity = &made.mesh.triangles[made.mesh.triangles.len() - made.cavity..];
        let mut least = f64::INFINITY;
        for t in cavity {
            let [a, b, c] = t.map(|v| made.mesh.positions[v as usize].as_dvec3());
            for i in 0..=12 {
                for j in 0..=12 - i {
                    let p = a + (b - a) * (f64::from(i) / 12.0) + (c - a) * (f64::from(j) / 12.0);
                    least = least.min(solid.tree.nearest(p, f64::INFINITY).unwrap().distance());
                }
            }
        }
        assert!(least >= 1.1, "{least}, told {}", made.wall);
    }
}
