//! Shells that cross each other or themselves as one solid: all places that the surface goes around
//! more often in its direction than against it (Zhou, Grinspun, Zorin and Jacobson, "Mesh
//! arrangements for solid geometry", 2016).

use glam::DVec3;

use super::box_tree::Span;
use super::broad_phase::SurfaceView;
use super::classify::{WindingOracle, probe};
use super::emit::FaceOrigin;
use super::global::Engine;
use super::parts::shells_of_faces;
use super::{
    BooleanError, BooleanOptions, Operation, OwnCrossings, ResultFaces, compute, global, reach,
    self_arrangement,
};
use crate::PolyMesh;
use crate::job::{Cancelled, Job};
use crate::self_intersection;

/// Places within the box at which a solved surface is compared with the one it came from, and faces
/// of it beside which that is done.
const PLACES: u32 = 1000;
const FACES: usize = 300;

/// A solved surface, and the face that each of its faces came from.
pub(super) type Solved = (PolyMesh, Vec<FaceOrigin>);

/// Returns the solid of all places that a self-crossing surface winds around, counted with its
/// direction: a shell that faces inwards subtracts. The mesh must be closed. The result is
/// triangles that cross nothing.
///
/// If the shells all face outwards and each crosses only others, they are united one by one.
/// Otherwise, and if the tolerance would decide, the surface is arranged with itself. If that is
/// inconsistent, the global engine rebuilds the whole, which takes up to a thousand times as long.
/// Each result is compared with the winding number of `mesh` at 1,000 places and beside 300 faces
/// before it is returned.
///
/// # Errors
/// Returns [`BooleanError::Inconsistent`] if neither gives a result that passes.
pub fn solve(mesh: &PolyMesh, job: &Job) -> Result<PolyMesh, BooleanError> {
    solved(mesh, job).map(|made| made.0)
}

/// As [`solve`], with the origins of the faces.
pub(super) fn solved(mesh: &PolyMesh, job: &Job) -> Result<Solved, BooleanError> {
    let parts = shells_of_faces(mesh);
    let outwards = |m: &(PolyMesh, Vec<u32>)| super::emit::measure(&m.0).0 > 0.0;
    let apart = parts.len() > 1 && parts.iter().all(outwards);
    let clean = apart && {
        let mut alone = true;
        for (part, _) in &parts {
            alone &=
                self_intersection::pairs(&part.positions, &part.triangles().0, job)?.is_empty();
        }
        alone
    };
    if clean
        && let Some(sum) = united(&parts, true, job)?
        && differs(mesh, &sum.0, job)?.is_none()
    {
        return Ok(sum);
    }
    if let Some(made) = arranged(mesh, job)? {
        return Ok(made);
    }
    let mut failed = Vec::new();
    for engine in [Engine::Perturbed, Engine::Rational] {
        let why = match global::solve(mesh, engine, job)? {
            Ok(made) => match differs(mesh, &made.0, job)? {
                None => return Ok(made),
                Some(why) => why,
            },
            Err(why) => why,
        };
        failed.push(format!("{}: {why}", engine.name()));
    }
    if apart
        && let Some(sum) = united(&parts, false, job)?
        && differs(mesh, &sum.0, job)?.is_none()
    {
        return Ok(sum);
    }
    Err(BooleanError::Inconsistent(failed.join("; ")))
}

/// The solid by an arrangement of the surface with itself, decided by what rounding alone does.
/// None where that does not fit together, crosses itself, or is another solid. With the face that
/// each of its faces came from.
pub(super) fn arranged(mesh: &PolyMesh, job: &Job) -> Result<Option<Solved>, Cancelled> {
    let eps = reach(&mesh.positions) * 2f64.powi(-49);
    let made = self_arrangement::solid(mesh, eps.max(f64::MIN_POSITIVE), job)?;
    let Ok((made, origins)) = made else { return Ok(None) };
    let crossed = self_intersection::pairs(&made.positions, &made.triangles().0, job)?;
    let good = crossed.is_empty() && differs(mesh, &made, job)?.is_none();
    Ok(good.then_some((made, origins)))
}

/// The union of shells, two and two, each with its faces in the whole: none where two of them give
/// no result, or where `strictly` and the tolerance decided something.
fn united(
    parts: &[(PolyMesh, Vec<u32>)],
    strictly: bool,
    job: &Job,
) -> Result<Option<Solved>, BooleanError> {
    let options = BooleanOptions {
        faces: ResultFaces::Triangles,
        own_crossings: OwnCrossings::Keep,
        ..BooleanOptions::default()
    };
    let mut left: Vec<(PolyMesh, Vec<u32>)> = parts.to_vec();
    while left.len() > 1 {
        let mut next = Vec::with_capacity(left.len().div_ceil(2));
        for two in left.chunks(2) {
            let [a, b] = two else {
                next.extend_from_slice(two);
                continue;
            };
            let operands = [&a.0, &b.0];
            let (made, report) = match compute(operands, &[Operation::Union], &options, job, || 0.0)
            {
                Err(BooleanError::Cancelled(e)) => return Err(e.into()),
                Err(_) => return Ok(None),
                Ok(made) => made,
            };
            if strictly && report.depends_on_tolerance {
                return Ok(None);
            }
            let from = |o: &FaceOrigin| [&a.1, &b.1][o.operand as usize][o.face as usize];
            next.extend(made.into_iter().map(|s| {
                let faces = s.origins.iter().map(from).collect();
                (s.mesh, faces)
            }));
        }
        left = next;
    }
    let origin = |face| FaceOrigin { operand: 0, face };
    Ok(left.pop().map(|(mesh, faces)| (mesh, faces.into_iter().map(origin).collect())))
}

/// A place that is inside of one and outside of the other, in words.
fn differs(before: &PolyMesh, after: &PolyMesh, job: &Job) -> Result<Option<String>, Cancelled> {
    let span = Span::of(before.positions.iter().copied());
    let size = span.hi - span.lo;
    let eps = size.length() * 1e-9;
    let triangles = [before, after].map(|m| m.triangles().0);
    let mut oracles = [0, 1].map(|s| {
        let at = &[before, after][s].positions[..];
        WindingOracle::new(SurfaceView { triangles: &triangles[s], at, base: 0 }, span, eps)
    });
    let mut compare = |p: DVec3| -> Result<Option<String>, Cancelled> {
        let [old, new] = &mut oracles;
        let (Some(old), Some(new)) = (old.clear_winding(p, job)?, new.clear_winding(p, job)?)
        else {
            return Ok(None);
        };
        Ok(((old > 0) != (new > 0)).then(|| {
            format!(
                "the surface goes around ({:.6}, {:.6}, {:.6}) {old} times, the solid {new} times",
                p.x, p.y, p.z
            )
        }))
    };
    // A Halton sequence (bases 2, 3 and 5) over the box.
    let halton = |mut i: u32, base: u32| {
        let (mut value, mut part) = (0.0, 1.0);
        while i > 0 {
            part /= f64::from(base);
            value += part * f64::from(i % base);
            i /= base;
        }
        value
    };
    for i in 1..=PLACES {
        let p = span.lo + size * DVec3::new(halton(i, 2), halton(i, 3), halton(i, 5));
        if let Some(why) = compare(p)? {
            return Ok(Some(why));
        }
    }
    for (mesh, triangles) in [before, after].iter().zip(&triangles) {
        for t in triangles.iter().step_by(triangles.len().div_ceil(FACES).max(1)) {
            let (area, place) = probe(&[t], &mesh.positions);
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            let beside =
                (b - a).cross(c - a).normalize_or_zero() * (area.sqrt() * 1e-3).max(16.0 * eps);
            for p in [place + beside, place - beside] {
                if let Some(why) = compare(p)? {
                    return Ok(Some(why));
                }
            }
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::repair::flip;
    use crate::shapes::cuboid;

    fn solved(list: &[(f64, f64, bool)]) -> f64 {
        let mut mesh = PolyMesh::new();
        for &(lo, hi, turned) in list {
            let mut b = cuboid(DVec3::splat(lo), DVec3::splat(hi));
            if turned {
                flip(&mut b);
            }
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(&b.positions);
            b.faces()
                .for_each(|f| mesh.push_face(&f.iter().map(|c| c + first).collect::<Vec<_>>()));
        }
        let made = solve(&mesh, &Job::default()).expect("a solid");
        super::super::emit::measure(&made).0
    }

    #[test]
    fn boxes_that_overlap_hold_each_other_and_take_away() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} instead of {b}");
        near(solved(&[(0.0, 2.0, false), (1.0, 3.0, false)]), 15.0);
        near(solved(&[(0.0, 3.0, false), (1.0, 2.0, false)]), 27.0);
        near(solved(&[(0.0, 3.0, false), (1.0, 2.0, true)]), 26.0);
        near(solved(&[(0.0, 2.0, false), (1.0, 3.0, true)]), 7.0);
    }

    #[test]
    fn an_arrangement_is_enough_where_nothing_lies_in_one_plane() {
        // A ring that goes through itself, and three balls with a part in common: there three
        // triangles meet in one point.
        let mut balls = PolyMesh::new();
        for (i, centre) in [[0.0, 0.0, 0.0], [0.9, 0.2, -0.1], [0.3, 0.8, 0.25]].iter().enumerate()
        {
            let ball = crate::shapes::icosphere(1.0, 5).to_poly();
            let first = balls.positions.len() as u32;
            balls.positions.extend(ball.positions.iter().map(|p| *p + DVec3::from(*centre)));
            let mut groups = balls.groups.take().unwrap_or_default();
            for f in ball.faces() {
                balls.push_face(&f.iter().map(|c| c + first).collect::<Vec<_>>());
                groups.push(i as u32);
            }
            balls.groups = Some(groups);
        }
        let united = {
            let parts = shells_of_faces(&balls);
            let made = united(&parts, true, &Job::default()).expect("runs").expect("so");
            super::super::emit::measure(&made.0)
        };
        for (mesh, volume) in
            [(crate::shapes::torus(1.0, 1.3, 24, 17), None), (balls, Some(united.0))]
        {
            let (made, origins) = arranged(&mesh, &Job::default()).expect("runs").expect("a solid");
            let facts = crate::check::report(&made, true, &Job::default()).expect("a report");
            assert!(facts.closed && facts.manifold && facts.self_intersections == Some(0));
            // Nothing moved: each face is in the plane of the face that it came from. The
            // comparison of winding numbers shows that the solid is the right one.
            assert_eq!(origins.len(), made.face_count());
            for (face, origin) in made.faces().zip(&origins) {
                let from = mesh.face(origin.face as usize);
                let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[from[k] as usize]);
                let normal = (b - a).cross(c - a).normalize();
                let off = face.iter().map(|&v| (made.positions[v as usize] - a).dot(normal).abs());
                assert!(off.fold(0.0, f64::max) < 1e-14);
            }
            if let Some(volume) = volume {
                let own = super::super::emit::measure(&made).0;
                assert!((own - volume).abs() < 1e-12 * volume, "{own} instead of {volume}");
            }
            let groups = made.groups.as_ref().map(Vec::len);
            assert_eq!(groups, mesh.groups.as_ref().map(|_| made.face_count()));
        }
    }
}
