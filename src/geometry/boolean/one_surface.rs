//! Both operands are one surface (`common` detects it), in whatever order of vertices, faces and
//! corners. The results follow from that, without cutting a surface at itself, which takes very
//! long where it crosses itself often.

use super::emit::{self, FaceOrigin};
use super::pieces::Placement;
use super::{BooleanSolid, Operation, attributes};
use crate::PolyMesh;
use crate::job::{Cancelled, Job};

/// The results where both operands are one surface: the first operand, or nothing. None where the
/// operand is not a closed manifold as it is.
pub fn results(
    operand: &PolyMesh,
    operations: &[Operation],
    triangles: bool,
    job: &Job,
) -> Result<Option<Vec<BooleanSolid>>, Cancelled> {
    let mut solids = Vec::with_capacity(operations.len());
    for &operation in operations {
        let (mut mesh, mut origins) = (PolyMesh::new(), Vec::new());
        if operation.takes(0, Placement::Same, false).is_some() {
            if triangles && operand.faces().any(|f| f.len() != 3) {
                return Ok(None);
            }
            mesh.face_starts = operand.face_starts.clone();
            mesh.corners = operand.corners.clone();
            origins.extend(
                (0..operand.face_count() as u32).map(|face| FaceOrigin { operand: 0, face }),
            );
        }
        let facts = emit::finish(&mut mesh, &operand.positions, job)?;
        if !facts.closed {
            return Ok(None);
        }
        attributes::carry(&mut mesh, &origins, [operand, operand]);
        solids.push(BooleanSolid { operation, mesh, origins, facts });
    }
    Ok(Some(solids))
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::super::{BooleanOptions, BooleanReport, ResultFaces, compute};
    use super::*;
    use crate::check;
    use crate::shapes::{cuboid, icosphere, torus};

    fn four(a: &PolyMesh, b: &PolyMesh, faces: ResultFaces) -> (Vec<BooleanSolid>, BooleanReport) {
        let options = BooleanOptions { faces, ..BooleanOptions::default() };
        compute([a, b], &Operation::ALL, &options, &Job::default(), || 0.0).expect("a result")
    }

    /// Returns true if the operands were recognised as one surface: nothing was cut or classified.
    fn at_once(report: &BooleanReport) -> bool {
        report
            .phases
            .iter()
            .all(|(name, _)| matches!(*name, "broad_phase" | "weld" | "emit" | "check"))
    }

    /// The mesh with its vertices and faces backwards, and each face from its second corner on.
    fn shuffled(mesh: &PolyMesh) -> PolyMesh {
        let last = mesh.positions.len() as u32 - 1;
        let mut out = PolyMesh { positions: mesh.positions.clone(), ..PolyMesh::new() };
        out.positions.reverse();
        for f in (0..mesh.face_count()).rev() {
            let mut ring: Vec<u32> = mesh.face(f).iter().map(|v| last - v).collect();
            ring.rotate_left(1);
            out.push_face(&ring);
        }
        out
    }

    /// Both meshes as one, whatever they have to do with each other.
    fn beside(a: &PolyMesh, b: &PolyMesh) -> PolyMesh {
        let (mut out, first) = (a.clone(), a.positions.len() as u32);
        out.positions.extend(&b.positions);
        b.faces().for_each(|f| out.push_face(&f.iter().map(|v| v + first).collect::<Vec<_>>()));
        out
    }

    fn shapes() -> Vec<(&'static str, PolyMesh)> {
        let axis = DVec3::new(0.3, -0.7, 0.55).normalize();
        let turn = DMat3::from_axis_angle(axis, 0.7);
        let turned = |mut mesh: PolyMesh| {
            mesh.positions.iter_mut().for_each(|p| *p = turn * *p + DVec3::new(3.0, 0.1, -2.0));
            mesh
        };
        let ball = icosphere(1.0, 6).to_poly();
        let moved = |by: f64| {
            let mut mesh = ball.clone();
            mesh.positions.iter_mut().for_each(|p| p.x += by);
            mesh
        };
        vec![
            ("a ball", ball.clone()),
            ("a turned ring", turned(torus(2.0, 0.5, 16, 8))),
            ("a turned box", turned(cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.7)))),
            // Cut at itself it would not end where it crosses itself.
            ("balls through each other", beside(&ball, &moved(0.7))),
        ]
    }

    #[test]
    fn a_solid_with_itself_is_itself_and_nothing() {
        for (name, mesh) in shapes() {
            let facts = check::report(&mesh, false, &Job::default()).expect("a report");
            let volume = facts.volume.expect("closed");
            // A polygon from another corner on may come in other triangles, which is another
            // surface where it is not flat.
            let turns = mesh.faces().all(|f| f.len() == 3).then(|| ("shuffled", shuffled(&mesh)));
            for (how, other) in [("as it is", mesh.clone())].into_iter().chain(turns) {
                let (made, report) = four(&mesh, &other, ResultFaces::AsOperands);
                assert!(at_once(&report), "{name} {how}: {:?}", report.phases);
                assert!(!report.depends_on_tolerance, "{name} {how}: {:?}", report.warnings);
                for solid in &made {
                    let what = format!("{name} {how} {}", solid.operation.name());
                    let whole =
                        matches!(solid.operation, Operation::Union | Operation::Intersection);
                    if !whole {
                        assert_eq!(
                            (solid.mesh.face_count(), solid.facts.volume),
                            (0, 0.0),
                            "{what}"
                        );
                        assert!(solid.facts.closed && solid.facts.manifold, "{what}");
                        continue;
                    }
                    // The first operand, face by face and bit by bit.
                    assert_eq!(solid.mesh.face_count(), mesh.face_count(), "{what}");
                    for f in 0..mesh.face_count() {
                        let origin = solid.origins[f];
                        assert_eq!((origin.operand, origin.face as usize), (0, f), "{what}");
                        let places = |m: &PolyMesh| -> Vec<DVec3> {
                            m.face(f).iter().map(|&v| m.positions[v as usize]).collect()
                        };
                        assert_eq!(places(&solid.mesh), places(&mesh), "{what} {f}");
                    }
                    assert!((solid.facts.volume - volume).abs() <= 1e-12 * volume, "{what}");
                    assert_eq!(solid.facts.components, facts.components, "{what}");
                }
            }
        }
    }

    #[test]
    fn a_solid_with_itself_in_triangles_where_it_has_polygons() {
        let mesh = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 0.7));
        let (made, _) = four(&mesh, &shuffled(&mesh), ResultFaces::Triangles);
        for solid in made {
            let whole = matches!(solid.operation, Operation::Union | Operation::Intersection);
            assert_eq!(
                solid.mesh.face_count(),
                if whole { 12 } else { 0 },
                "{:?}",
                solid.operation
            );
            assert!(solid.mesh.faces().all(|f| f.len() == 3));
            assert!((solid.facts.volume - if whole { 1.4 } else { 0.0 }).abs() < 1e-12);
        }
    }

    #[test]
    fn one_vertex_elsewhere_is_another_surface() {
        let mesh = icosphere(1.0, 6).to_poly();
        let mut other = mesh.clone();
        other.positions[17] *= 1.01;
        let (made, report) = four(&mesh, &other, ResultFaces::AsOperands);
        assert!(!at_once(&report), "{:?}", report.phases);
        let of = |o: Operation| made.iter().find(|s| s.operation == o).map(|s| s.facts.volume);
        let grown = of(Operation::ReverseDifference).expect("asked for");
        assert!(of(Operation::Difference).expect("asked for").abs() < 1e-12);
        let facts =
            |m: &PolyMesh| check::report(m, false, &Job::default()).expect("a report").volume;
        let more = facts(&other).expect("closed") - facts(&mesh).expect("closed");
        assert!(more > 1e-4 && (grown - more).abs() < 1e-12, "{grown} {more}");
    }
}
