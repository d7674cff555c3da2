//! Volume, area, dimensions and projected areas: what a cost estimate asks of a part.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::distance::DistanceSolid;
use crate::job::{Cancelled, Job};
use crate::{Aabb, TriMesh};

/// Strips that a projection is cut into: see [`projected_area`].
const STRIPS: usize = 2048;

/// What [`measures`] gives. Lengths in the mesh's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Enclosed volume; of an open mesh, what the divergence theorem says of it, which means
    /// little.
    pub volume: f64,
    /// The sum of the triangles' areas.
    pub area: f64,
    /// Extent along x, y and z.
    pub dimensions: [f64; 3],
    /// Centre of the enclosed volume; `None` where there is no volume.
    pub centroid: Option<DVec3>,
}

/// Measures a mesh, see [`measures_of`].
pub fn measures(mesh: &TriMesh) -> Measures {
    let positions: Vec<DVec3> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    measures_of(&positions, &mesh.triangles)
}

/// Measures triangles in double precision, about the box's centre and in units of its size: a part
/// far from the origin loses nothing, and no intermediate result overflows. Vertices that no
/// triangle uses count for nothing.
pub fn measures_of(positions: &[DVec3], triangles: &[[u32; 3]]) -> Measures {
    let used = triangles.iter().flatten().map(|&v| positions[v as usize]);
    let bounds = Aabb::of(used);
    if triangles.is_empty() {
        return Measures { volume: 0.0, area: 0.0, dimensions: [0.0; 3], centroid: None };
    }
    let (centre, size) = (bounds.centre(), bounds.size());
    let unit = Some(size.max_element()).filter(|s| *s > 0.0).unwrap_or(1.0);
    let (mut six, mut twice, mut moment) = (0.0f64, 0.0f64, DVec3::ZERO);
    for t in triangles {
        let [a, b, c] = t.map(|v| (positions[v as usize] - centre) / unit);
        let v = a.dot(b.cross(c));
        six += v;
        moment += (a + b + c) * v;
        twice += (b - a).cross(c - a).length();
    }
    Measures {
        volume: six / 6.0 * unit * unit * unit,
        area: twice * 0.5 * unit * unit,
        dimensions: size.to_array(),
        centroid: (six != 0.0).then(|| centre + moment / (4.0 * six) * unit),
    }
}

/// Places that [`overlaps`] looks at, evenly over the triangles, and most of them on one.
const LOOKED_AT: usize = 4096;
const ON_ONE: usize = 64;

/// Returns true if a closed surface overlaps itself: a place outside a triangle is inside the
/// solid, by the winding number. Tests about 4,096 places, at most 64 of them on one triangle, so
/// an overlap smaller than their spacing can be missed.
pub fn overlaps(mesh: &TriMesh, job: &Job) -> Result<bool, Cancelled> {
    let solid = DistanceSolid::build(mesh, job)?;
    let (lo, hi) = mesh.bounds();
    let step = (hi - lo).as_dvec3().length() * 1e-5;
    let sign = if measures(mesh).volume < 0.0 { -1.0 } else { 1.0 };
    let every = mesh.triangles.len().div_ceil(LOOKED_AT).max(1);
    let places = (LOOKED_AT / mesh.triangles.len().max(1)).clamp(1, ON_ONE);
    // The centroid first, then the plastic number's low-discrepancy sequence (Roberts, 2018).
    let weights: Vec<DVec2> = (0..places)
        .map(|i| {
            let q = DVec2::splat(1.0 / 3.0)
                + DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3) * i as f64;
            let q = q.fract();
            if q.x + q.y > 1.0 { DVec2::ONE - q } else { q }
        })
        .collect();
    let chosen: Vec<usize> = (0..mesh.triangles.len()).step_by(every).collect();
    let found = chosen
        .par_chunks(64)
        .map(|chunk| {
            job.check()?;
            Ok(chunk.iter().any(|&t| {
                let [a, b, c] = mesh.corners(t).map(Vec3::as_dvec3);
                let normal = (b - a).cross(c - a).normalize_or_zero() * sign;
                let inside = |q: &DVec2| {
                    let p = a + (b - a) * q.x + (c - a) * q.y + normal * step;
                    solid.winding(p) * sign > 0.5
                };
                normal != DVec3::ZERO && weights.iter().any(inside)
            }))
        })
        .collect::<Result<Vec<bool>, Cancelled>>()?;
    Ok(found.contains(&true))
}

/// Area of the part's shadow along `direction` (any length but zero). The shadow is cut into
/// strips; in the middle of each the union of all triangles is exact, so what is lost is only the
/// curvature of the outline within a strip: about 1e-6 of the area for smooth outlines, nothing for
/// a box along the axes.
pub fn projected_area(mesh: &TriMesh, direction: Vec3, job: &Job) -> Result<f64, Cancelled> {
    let d = direction.as_dvec3().normalize_or_zero();
    if d == DVec3::ZERO || mesh.triangles.is_empty() {
        return Ok(0.0);
    }
    // Strips run along x of the projection where the direction is an axis, so that a box's sides
    // fall on their borders.
    let (u, v) = d.any_orthonormal_pair();
    let flat: Vec<DVec2> = mesh
        .positions
        .iter()
        .map(|p| p.as_dvec3())
        .map(|p| DVec2::new(p.dot(u), p.dot(v)))
        .collect();
    let front = front_faces(&flat, &mesh.triangles);
    let triangles = front.as_ref().unwrap_or(&mesh.triangles);
    let Some(strips) = Strips::new(&flat, triangles, STRIPS) else { return Ok(0.0) };
    job.check()?;
    let lengths: Vec<f64> = (0..STRIPS)
        .into_par_iter()
        .map(|s| {
            job.check()?;
            Ok(union(&mut strips.spans(s, &flat, triangles)))
        })
        .collect::<Result<_, Cancelled>>()?;
    Ok(lengths.iter().sum::<f64>() * strips.height)
}

/// The triangles that turn one way in the projection, where its edges add up to nothing: then every
/// place is in as many of these as of the others, and they have the whole shadow. None where some
/// edge has no partner.
fn front_faces(flat: &[DVec2], triangles: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
    let mix = |x: u64, by: u64| {
        let z = (x ^ (x >> 32)).wrapping_mul(by);
        (z ^ (z >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb)
    };
    // By position, not by index: files of loose triangles repeat each corner.
    let name = |p: &DVec2| {
        // Zero of either sign is one place.
        let [x, y] = [p.x + 0.0, p.y + 0.0].map(f64::to_bits);
        mix(mix(x, 0xff51_afd7_ed55_8ccd) ^ y.rotate_left(29), 0xbf58_476d_1ce4_e5b9)
    };
    let names: Vec<u64> = flat.par_iter().map(name).collect();
    // An edge as a number of 128 bits, with its direction as its sign.
    let edge = |a: u64, b: u64| {
        let (lo, hi) = (a.min(b), a.max(b));
        let both = mix(lo, 0xff51_afd7_ed55_8ccd) ^ hi;
        let n = u128::from(mix(both, 0xbf58_476d_1ce4_e5b9)) << 64
            | u128::from(mix(both.wrapping_add(0x9e37_79b9_7f4a_7c15), 0xd6e8_feb8_6659_fd93));
        match a.cmp(&b) {
            std::cmp::Ordering::Less => n,
            std::cmp::Ordering::Equal => 0,
            std::cmp::Ordering::Greater => n.wrapping_neg(),
        }
    };
    let sum = triangles.par_iter().map(|t| {
        let [a, b, c] = t.map(|v| names[v as usize]);
        edge(a, b).wrapping_add(edge(b, c)).wrapping_add(edge(c, a))
    });
    let front = |t: &&[u32; 3]| {
        let [a, b, c] = t.map(|v| flat[v as usize]);
        (b - a).perp_dot(c - a) > 0.0
    };
    (sum.reduce(|| 0, u128::wrapping_add) == 0)
        .then(|| triangles.iter().filter(front).copied().collect())
}

/// A plane cut into strips along x, and the triangles that cross the middle of each.
pub(crate) struct Strips {
    /// The lower border of the lowest strip.
    pub lo: f64,
    /// Of each strip.
    pub height: f64,
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Strips {
    /// `count` strips over all triangles, whose corners index `flat`; None where they have no
    /// height.
    pub fn new(flat: &[DVec2], triangles: &[[u32; 3]], count: usize) -> Option<Strips> {
        let used = triangles.iter().flatten().map(|&i| flat[i as usize].y);
        let (lo, hi) =
            used.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
        let height = (hi - lo) / count as f64;
        if height <= 0.0 || !height.is_finite() {
            return None;
        }
        // The triangles that cross the middle of each strip: counted, then filled.
        let range = |t: &[u32; 3]| {
            let y = t.map(|i| flat[i as usize].y);
            let (a, b) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
            let first = (((a - lo) / height - 0.5).ceil()).max(0.0) as usize;
            let last = (((b - lo) / height - 0.5).floor() + 1.0).max(0.0) as usize;
            first..last.clamp(first, count.max(first))
        };
        let mut starts = vec![0u32; count + 1];
        for t in triangles {
            range(t).filter(|&s| s < count).for_each(|s| starts[s + 1] += 1);
        }
        for s in 0..count {
            starts[s + 1] += starts[s];
        }
        let mut next = starts.clone();
        let mut members = vec![0u32; starts[count] as usize];
        for (i, t) in triangles.iter().enumerate() {
            for s in range(t).filter(|&s| s < count) {
                members[next[s] as usize] = i as u32;
                next[s] += 1;
            }
        }
        Some(Strips { lo, height, starts, members })
    }

    /// Returns the spans of the middle of strip `s` inside the triangles, one for each triangle.
    pub fn spans(&self, s: usize, flat: &[DVec2], triangles: &[[u32; 3]]) -> Vec<(f64, f64)> {
        let y = self.lo + (s as f64 + 0.5) * self.height;
        self.members[self.starts[s] as usize..self.starts[s + 1] as usize]
            .iter()
            .filter_map(|&t| crossed_at(triangles[t as usize].map(|i| flat[i as usize]), y))
            .collect()
    }
}

/// Returns the span of the line at `y` inside a triangle.
fn crossed_at(p: [DVec2; 3], y: f64) -> Option<(f64, f64)> {
    let (mut lo, mut hi) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        // From the lower end always, so that both triangles of an edge find the same point.
        let (mut a, mut b) = (p[k], p[(k + 1) % 3]);
        if a.y > b.y {
            std::mem::swap(&mut a, &mut b);
        }
        if a.y <= y && y < b.y {
            let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
            lo = lo.min(x);
            hi = hi.max(x);
        }
    }
    (lo < hi).then_some((lo, hi))
}

/// Total length of the union.
fn union(spans: &mut [(f64, f64)]) -> f64 {
    spans.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let (mut total, mut end) = (0.0, f64::NEG_INFINITY);
    for &(a, b) in spans.iter() {
        if b > end {
            total += b - a.max(end);
            end = b;
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::cuboid;

    #[test]
    fn shells_that_overlap_are_found_and_cavities_are_not() {
        let boxes = |second: (f64, f64), turned: bool| {
            let mut mesh = cuboid(DVec3::ZERO, DVec3::ONE).triangulate().0;
            let (lo, hi) = second;
            let other = cuboid(DVec3::splat(lo), DVec3::splat(hi)).triangulate().0;
            let base = mesh.positions.len() as u32;
            mesh.positions.extend(&other.positions);
            mesh.triangles.extend(other.triangles.iter().map(|t| {
                let [a, b, c] = t.map(|v| v + base);
                if turned { [a, c, b] } else { [a, b, c] }
            }));
            overlaps(&mesh, &Job::default()).unwrap()
        };
        assert!(boxes((0.5, 1.5), false));
        assert!(!boxes((2.0, 3.0), false));
        assert!(!boxes((0.25, 0.75), true), "a cavity");
    }

    #[test]
    fn front_faces_alone_have_the_shadow() {
        let whole = crate::shapes::torus(3.0, 1.0, 40, 24).triangulate().0;
        let mut open = whole.clone();
        open.triangles.pop();
        // Every corner repeated, as in STL.
        let loose = TriMesh {
            positions: (0..whole.triangles.len()).flat_map(|t| whole.corners(t)).collect(),
            triangles: (0..whole.triangles.len() as u32)
                .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
                .collect(),
            colours: None,
        };
        for d in [Vec3::X, Vec3::Z, Vec3::new(0.3, -0.2, 0.9)] {
            let (u, v) = d.as_dvec3().normalize().any_orthonormal_pair();
            let flat = |m: &TriMesh| -> Vec<DVec2> {
                let p = m.positions.iter().map(|p| p.as_dvec3());
                p.map(|p| DVec2::new(p.dot(u), p.dot(v))).collect()
            };
            for mesh in [&whole, &loose] {
                let front = front_faces(&flat(mesh), &mesh.triangles).expect("closed");
                assert!(front.len() * 2 <= mesh.triangles.len() + 100, "{}", front.len());
            }
            assert!(front_faces(&flat(&open), &open.triangles).is_none());
            // One triangle of both sides less is not seen: all of them were looked at.
            let area = |m: &TriMesh| projected_area(m, d, &Job::default()).unwrap();
            let all = area(&open);
            assert!((area(&whole) - all).abs() < 1e-9 + 0.01 * all, "{d}");
            assert!((area(&whole) - area(&loose)).abs() < 1e-9 * all, "{d}");
        }
    }

    #[test]
    fn overlapping_spans_count_once() {
        assert_eq!(union(&mut [(3.0, 4.0), (0.0, 1.0), (0.5, 2.0), (0.6, 0.7)]), 3.0);
        assert_eq!(union(&mut []), 0.0);
    }

    #[test]
    fn a_tetrahedron_is_measured_exactly() {
        let mesh = TriMesh {
            positions: [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0]
                .map(|p| p + 100.0)
                .to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            colours: None,
        };
        let m = measures(&mesh);
        assert!((m.volume - 8.0 / 6.0).abs() < 1e-9);
        assert!((m.area - (6.0 + 2.0 * 3f64.sqrt())).abs() < 1e-9);
        assert_eq!(m.dimensions, [2.0; 3]);
        assert!((m.centroid.unwrap() - DVec3::splat(100.5)).length() < 1e-6);
        let job = Job::default();
        for d in [Vec3::X, Vec3::Y, Vec3::NEG_Z] {
            assert!((projected_area(&mesh, d, &job).unwrap() - 2.0).abs() < 1e-6, "{d}");
        }
        // Along the diagonal the shadow is the slanted face itself.
        let slanted = projected_area(&mesh, Vec3::ONE, &job).unwrap();
        assert!((slanted - 2.0 * 3f64.sqrt()).abs() < 1e-5, "{slanted}");
    }
}
